//! What rays meet, as scattering and emission need it.

use super::Scene;
use super::surface::{DARK, Surface, Surfaces};
use crate::accel::{Hit, Ray};
use crate::bsdf::Bsdf;
use crate::math::{Rgb, Vec3};
use crate::texture::SurfacePoint;

/// A point where a ray met a surface.
#[derive(Clone, Copy)]
pub struct Interaction<'s> {
    /// The surface.
    pub surface: &'s Surface,
    /// The point on it.
    pub point: SurfacePoint<'s>,
    /// Towards where the ray came from.
    pub wo: Vec3,
}

impl Surfaces {
    /// The point where `ray` met something; `None` where it left the scene. `footprint` is the
    /// width of the ray's cone there.
    #[inline(always)]
    pub fn interaction(&self, ray: &Ray, hit: &Hit, footprint: f32) -> Option<Interaction<'_>> {
        // No closure: it would be a function of its own, and the point handed over in memory.
        if !hit.is_some() {
            return None;
        }
        Some(Interaction {
            surface: &self.list[hit.shape as usize],
            point: self.point(ray, hit, footprint),
            wo: -ray.dir,
        })
    }

    /// How the surface scatters there.
    #[inline(always)]
    pub fn bsdf(&self, at: &Interaction) -> Bsdf {
        self.materials
            .resolve(at.surface.material, &at.point, at.wo)
    }
}

impl Interaction<'_> {
    /// Whether the surface carries an emitter.
    #[inline(always)]
    pub fn glows(&self) -> bool {
        self.surface.emitter != DARK
    }
}

impl Scene {
    /// The closest hit of a ray by itself. As a batch finds it: a ray of a packet may differ from a
    /// single one in the last bit.
    pub fn first_hit(&self, ray: &Ray) -> Hit {
        let mut hits = [Hit::NONE];
        self.rays.intersect_batch(&[*ray], &mut hits);
        hits[0]
    }

    /// Whether a ray is blocked, again as in a batch.
    pub fn is_blocked(&self, ray: &Ray) -> bool {
        let mut blocked = [false];
        self.rays.occluded_batch(&[*ray], &mut blocked);
        blocked[0]
    }

    /// Radiance that a surface sends back along a ray that met it.
    ///
    /// Opacity is no matter of what a surface emits (Mitsuba's meaning). Rays meet it by the chance
    /// of its opacity, so what they find there is worth more; light samples need no such chance.
    #[inline]
    pub fn emitted(&self, at: &Interaction) -> Rgb {
        let radiance = self.lights.emitted(at.surface.emitter, &at.point, at.wo);
        let materials = &self.surfaces.materials;
        if !materials.is_masked(at.surface.material) {
            return radiance;
        }
        // As the ray tracer asked for it.
        let finest = SurfacePoint {
            footprint: 0.0,
            ..at.point
        };
        let opacity = materials.opacity(at.surface.material, &finest);
        if opacity > 0.0 {
            radiance / opacity
        } else {
            Rgb::ZERO
        }
    }
}
