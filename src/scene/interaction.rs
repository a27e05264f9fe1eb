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
    /// The surface that a ray met; `None` where it left the scene.
    #[inline(always)]
    pub fn met(&self, hit: &Hit) -> Option<&Surface> {
        hit.is_some().then(|| &self.list[hit.shape as usize])
    }

    /// How a surface scatters at a point, as seen from `wo`.
    #[inline(always)]
    pub fn bsdf(&self, surface: &Surface, point: &SurfacePoint, wo: Vec3) -> Bsdf {
        self.materials.resolve(surface.material, point, wo)
    }

    /// All of where `ray` met something; `None` where it left the scene. `footprint` is the width
    /// of the ray's cone there.
    ///
    /// Loops over many rays ask for surface, point and BSDF one by one: the point would be copied
    /// into the interaction, 168 bytes for each ray.
    pub fn interaction(&self, ray: &Ray, hit: &Hit, footprint: f32) -> Option<Interaction<'_>> {
        Some(Interaction {
            surface: self.met(hit)?,
            point: self.point(ray, hit, footprint),
            wo: -ray.dir,
        })
    }
}

impl Surface {
    /// Whether it carries an emitter.
    #[inline(always)]
    pub fn glows(&self) -> bool {
        self.emitter != DARK
    }
}

impl Interaction<'_> {
    /// How the surface scatters.
    pub fn bsdf(&self, surfaces: &Surfaces) -> Bsdf {
        surfaces.bsdf(self.surface, &self.point, self.wo)
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

    /// Radiance that a surface sends along `wo` from a point where a ray met it.
    ///
    /// Opacity is no matter of what a surface emits (Mitsuba's meaning). Rays meet it by the chance
    /// of its opacity, so what they find there is worth more; light samples need no such chance.
    #[inline]
    pub fn emitted(&self, surface: &Surface, point: &SurfacePoint, wo: Vec3) -> Rgb {
        let radiance = self.lights.emitted(surface.emitter, point, wo);
        let materials = &self.surfaces.materials;
        if !materials.is_masked(surface.material) {
            return radiance;
        }
        // As the ray tracer asked for it.
        let finest = SurfacePoint {
            footprint: 0.0,
            ..*point
        };
        let opacity = materials.opacity(surface.material, &finest);
        if opacity > 0.0 {
            radiance / opacity
        } else {
            Rgb::ZERO
        }
    }
}
