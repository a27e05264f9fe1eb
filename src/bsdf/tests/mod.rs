//! Tests of the scattering models.
