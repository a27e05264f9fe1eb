//! Which ray tracer answers.

use super::{AccelError, BuildSettings, Opacity, RayQuery, World};
use std::sync::Arc;

/// The ray tracers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Debian's Embree: the faster one.
    Embree,
    /// A tree in pure Rust.
    Obvhs,
}

impl Default for Backend {
    /// Embree where it is compiled in.
    fn default() -> Self {
        if cfg!(feature = "embree") {
            Self::Embree
        } else {
            Self::Obvhs
        }
    }
}

/// Builds the trees over `world` with the ray tracer of choice.
///
/// `opacity` answers for geometry with `masked` set; without it all geometry is opaque.
///
/// # Errors
/// See [`AccelError`].
pub fn build(
    world: World,
    settings: BuildSettings,
    opacity: Option<Arc<dyn Opacity>>,
    backend: Backend,
) -> Result<Box<dyn RayQuery>, AccelError> {
    match backend {
        #[cfg(feature = "embree")]
        Backend::Embree => Ok(Box::new(super::embree::Embree::build(
            world, settings, opacity,
        )?)),
        #[cfg(not(feature = "embree"))]
        Backend::Embree => Err(AccelError::NotCompiled("Embree")),
        Backend::Obvhs => Ok(Box::new(super::obvhs::Obvhs::build(
            world, settings, opacity,
        )?)),
    }
}

/// Prepares the calling thread for tracing: see
/// [`embree::prepare_thread`](super::embree::prepare_thread). For the start handler of a thread
/// pool; without Embree there is nothing to prepare.
pub fn prepare_thread() {
    #[cfg(feature = "embree")]
    super::embree::prepare_thread();
}
