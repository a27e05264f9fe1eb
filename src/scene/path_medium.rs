//! Which medium a path is in.

use super::Scene;
use crate::accel::{Hit, Ray};
use crate::light::Collision;
use crate::math::{Rgb, Vec3};
use crate::medium::{Boundary, ChannelWeights, MediumId, Segment};

/// The medium that a path is in, and what it has made of the channels.
#[derive(Clone, Copy, Debug)]
pub struct PathMedium {
    /// The media around the surface that the path has left.
    around: Boundary,
    /// Its geometric normal.
    ng: Vec3,
    /// How likely each channel was to make the path.
    pub weights: ChannelWeights,
    /// The path's last vertex, if it collided there and lights draw distances, too.
    pub collision: Option<Collision>,
}

impl PathMedium {
    /// Of a path that begins inside a medium.
    pub fn inside(medium: MediumId) -> Self {
        Self {
            around: Boundary {
                interior: medium,
                exterior: medium,
            },
            ng: Vec3::Z,
            weights: ChannelWeights::default(),
            collision: None,
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

    /// What comes through along a ray to what it has met. Exact where the medium is homogeneous.
    pub fn transmittance(
        &self,
        scene: &Scene,
        ray: &Ray,
        hit: &Hit,
        u: &mut impl FnMut() -> f32,
    ) -> Rgb {
        let medium = scene.media.list().get(self.medium(ray.dir));
        medium.map_or(Rgb::ONE, |medium| {
            medium.extinction.transmittance(&segment(ray, hit), u)
        })
    }

    /// The same, and the path is at what the ray has met from there on.
    pub fn pass(
        &mut self,
        scene: &Scene,
        ray: &Ray,
        hit: &Hit,
        u: &mut impl FnMut() -> f32,
    ) -> Rgb {
        let passed = self.transmittance(scene, ray, hit, u);
        if hit.is_some() {
            self.arrive(scene, ray, hit);
        }
        passed
    }

    /// Through an index-matched surface that a ray has met: the ray behind it.
    pub fn cross(&mut self, scene: &Scene, ray: &Ray, hit: &Hit) -> Ray {
        let point = scene.surfaces.point(ray, hit, 0.0);
        self.arrive_at(scene, ray, hit, || point.ng);
        let mut next = point.spawn_ray(ray.dir);
        next.tmax = ray.tmax - hit.t;
        next
    }

    /// At a surface that a ray has met.
    pub fn arrive(&mut self, scene: &Scene, ray: &Ray, hit: &Hit) {
        self.arrive_at(scene, ray, hit, || scene.surfaces.point(ray, hit, 0.0).ng);
    }

    /// The same, where the geometric normal is known, or found only if it is asked for.
    fn arrive_at(&mut self, scene: &Scene, ray: &Ray, hit: &Hit, ng: impl FnOnce() -> Vec3) {
        match scene.media.side(hit).boundary {
            Some(boundary) => {
                self.around = boundary;
                self.ng = ng();
            }
            None => self.stay(self.medium(ray.dir)),
        }
    }
}

/// The part of a ray that a hit ends, or its own end.
pub fn segment(ray: &Ray, hit: &Hit) -> Segment {
    Segment {
        origin: ray.org,
        direction: ray.dir,
        length: if hit.is_some() { hit.t } else { ray.tmax },
    }
}
