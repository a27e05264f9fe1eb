//! Mixtures of Gaussians over a part of the plane that stands for directions: what the cached
//! mixtures of [`super::gmm`] and the double hierarchy's own Gaussian model have in common.

mod domain;
mod lanes;
mod lobe;
mod mixture;

pub use domain::Domain;
pub use lanes::Lanes;
pub use lobe::{LOBES, Lobe, Prior, Statistics, maximise, positive};
pub use mixture::Mixture;

#[cfg(test)]
mod tests;
