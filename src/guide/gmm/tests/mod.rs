//! Tests of cached mixtures.

mod hostile;
mod learning;
mod sampling;
