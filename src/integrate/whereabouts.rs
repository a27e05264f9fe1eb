//! Which medium a path is in.

use crate::accel::{Hit, Ray};
use crate::math::{Rgb, Vec3};
use crate::medium::{Boundary, MediumId, Segment, Spectrum};
use crate::scene::Scene;
use crate::scene::media::length;

/// Where a path is.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrate) struct Whereabouts {
    /// The media around the surface that the path has left.
    around: Boundary,
    /// Its geometric normal.
    ng: Vec3,
    /// How likely each channel was to make the path.
    pub spectrum: Spectrum,
}

impl Whereabouts {
    /// Of a path that begins inside a medium.
    pub fn inside(medium: MediumId) -> Self {
        Self {
            around: Boundary {
                interior: medium,
                exterior: medium,
            },
            ng: Vec3::Z,
            spectrum: Spectrum::default(),
        }
    }

    /// The medium that a ray along `dir` is in.
    #[inline]
    pub fn medium(&self, dir: Vec3) -> MediumId {
        self.around.beyond(self.ng, dir)
    }

    /// On or in a medium without a boundary.
    pub fn stay(&mut self, medium: MediumId) {
        self.around = Self::inside(medium).around;
    }

    /// What comes through along a ray to what it meets there, without index-matched surfaces
    /// between; and goes on from there. Exact where media are homogeneous.
    pub fn pass(
        &mut self,
        scene: &Scene,
        ray: &Ray,
        hit: &Hit,
        u: &mut impl FnMut() -> f32,
    ) -> Rgb {
        let medium = scene.media.list().get(self.medium(ray.dir));
        let segment = Segment {
            origin: ray.org,
            direction: ray.dir,
            length: length(ray, hit),
        };
        let passed = medium.map_or(Rgb::ONE, |medium| {
            medium.extinction.transmittance(&segment, u)
        });
        if hit.is_some() {
            self.arrive(scene, ray, hit);
        }
        passed
    }

    /// At a surface that a ray along `dir` has met.
    pub fn arrive(&mut self, scene: &Scene, ray: &Ray, hit: &Hit) {
        match scene.media.side(hit).boundary {
            Some(boundary) => {
                self.around = boundary;
                self.ng = scene.surfaces.point(ray, hit, 0.0).ng;
            }
            None => self.stay(self.medium(ray.dir)),
        }
    }
}
