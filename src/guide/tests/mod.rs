//! Tests of the whole field, on synthetic light whose answer is known in closed form.

mod area;
mod convergence;
mod exact;
mod files;
mod hostile;
mod sampling;
pub(super) mod synthetic;
