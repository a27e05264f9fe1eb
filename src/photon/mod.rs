//! Photons: light traced forwards, from the emitters, to teach the field where it comes from.
//!
//! A photon leaves an emitter chosen by power ([`crate::light::Lights::emit`]), scatters by the
//! materials it meets and is thinned by Russian roulette. Wherever it lands on something that is
//! not a perfect mirror or clear glass, and wherever it collides in a medium, it leaves a
//! [`Landing`]. Nothing here stores photons: a
//! batch is traced in waves, each wave's landings are handed on and forgotten.
//!
//! Photon `i` of a seed is the same photon whatever the batch, the thread or the machine.

mod flight;
mod media;
pub mod schedule;
pub mod wave;

use crate::math::{Rgb, Vec3};

/// Where a photon landed, or collided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// Where, world space.
    pub position: Vec3,
    /// Unit direction towards where it came from.
    pub direction: Vec3,
    /// Unit shading normal there, on the side it came from; zero in a medium.
    pub normal: Vec3,
    /// Power it carried, divided by nothing: the sum over `n` photons over `n` is the flux.
    pub power: Rgb,
    /// Distance it flew since its last scattering.
    pub distance: f32,
    /// Scatterings since the emitter: 0 is direct light.
    pub bounces: u32,
    /// All scatterings so far were off mirrors or clear glass (and there was at least one): a
    /// caustic.
    pub specular: bool,
}

/// How photons are traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhotonSettings {
    /// Most scatterings of a photon.
    pub max_bounces: u32,
    /// Roulette starts after this many scatterings.
    pub roulette_after: u32,
    /// Stream of all random numbers.
    pub seed: u64,
}

/// What became of a number of photons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PhotonCounts {
    /// Photons that left an emitter.
    pub emitted: u64,
    /// Landings recorded.
    pub landings: u64,
    /// Photons dropped because a power or direction was not finite.
    pub invalid: u64,
    /// Rays traced.
    pub rays: u64,
}

impl std::ops::AddAssign for PhotonCounts {
    fn add_assign(&mut self, o: Self) {
        self.emitted += o.emitted;
        self.landings += o.landings;
        self.invalid += o.invalid;
        self.rays += o.rays;
    }
}
