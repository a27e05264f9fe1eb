//! Photons against the power that lights have.
