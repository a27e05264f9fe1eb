//! What is believed of a Gaussian on the disk before any record: its least and its usual width.

use crate::guide::gaussian::Prior;

/// A lobe of a single record is one degree wide (standard deviation), and none is narrower than 0.3
/// degrees. (A spread of 2e-4 has 1.5 times the variance in a torus in glass, 5e-4 1.7 times; a
/// least variance of 1e-7 gains nothing.)
pub(super) const PRIOR: Prior = Prior {
    spread: 2e-5,
    least_variance: 1.5e-6,
};
