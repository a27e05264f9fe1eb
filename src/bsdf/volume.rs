//! Scattering inside of a medium, as a path's vertex asks for it: a phase function in the place of
//! a BSDF. There is no surface and no cosine; the frame's normal is the direction where the path
//! came from.

use super::{BsdfSample, LobeFlags};
use crate::math::{Rgb, Vec2, Vec3};
use crate::medium::PhaseFunction;

/// What a collision does.
pub(super) const FLAGS: LobeFlags = LobeFlags(
    LobeFlags::SMOOTH.0 | LobeFlags::REFLECTION.0 | LobeFlags::TRANSMISSION.0 | LobeFlags::VOLUME.0,
);

/// A collision of a path that comes from local +z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Collision {
    phase: PhaseFunction,
    albedo: Rgb,
}

impl Collision {
    pub fn new(phase: PhaseFunction, albedo: Rgb) -> Self {
        Self { phase, albedo }
    }

    /// Phase function and density, which are the same.
    #[inline]
    pub fn eval_pdf(&self, wi: Vec3) -> (Rgb, f32) {
        let density = self.phase.eval(-wi.z);
        (Rgb::splat(density), density)
    }

    /// Draws a local direction.
    #[inline]
    pub fn sample(&self, u_lobe: f32, u: Vec2) -> BsdfSample {
        let wi = self.phase.sample(Vec3::NEG_Z, u_lobe, u);
        BsdfSample {
            wi,
            weight: Rgb::ONE,
            pdf: self.phase.eval(-wi.z),
            eta: 1.0,
            lobe: FLAGS,
        }
    }

    /// Share of the light that is scattered.
    pub fn albedo(&self) -> Rgb {
        self.albedo
    }

    /// How wide it scatters.
    pub fn roughness(&self) -> f32 {
        self.phase.roughness()
    }
}
