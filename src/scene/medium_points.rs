//! Where media are: the medium at a place, and points spread through all media as their extinction
//! is. From these the field measures how much of a medium lies in a cell.

use super::Scene;
use super::free_flight::MOST_PASSED;
use crate::accel::{Hit, Ray};
use crate::math::{Pcg32, Vec2, Vec3, warp};
use crate::medium::MediumId;
use rayon::prelude::*;

/// Places that are tried at most.
const MOST_TRIED: usize = 1 << 18;
/// Places that one task tries.
const PIECE: usize = 1 << 12;
/// Rays that look for what is outside of all bodies.
const LOOKS: u32 = 64;

impl Scene {
    /// The medium that a ray is in at its begin, by the first boundary of media that it comes to
    /// (`hit` is the first surface); the one outside of all bodies where there is none.
    pub fn medium_along(&self, ray: &Ray, hit: &Hit) -> MediumId {
        self.facing_medium(ray, hit).unwrap_or(self.media.outside)
    }

    /// The medium on this side of the first boundary along a ray.
    fn facing_medium(&self, ray: &Ray, hit: &Hit) -> Option<MediumId> {
        if !self.media.has_boundaries {
            return None;
        }
        let (mut ray, mut hit) = (*ray, *hit);
        for _ in 0..MOST_PASSED {
            if !hit.is_some() {
                break;
            }
            let point = self.surfaces.point(&ray, &hit, 0.0);
            if let Some(boundary) = self.media.side(&hit).boundary {
                return Some(boundary.beyond(point.ng, -ray.dir));
            }
            ray = point.spawn_ray(ray.dir);
            hit = self.rays.intersect(&ray);
        }
        None
    }

    /// The medium at the begin of a ray: along it, or in other directions where no boundary is
    /// ahead.
    pub(super) fn medium_around(&self, ray: &Ray) -> MediumId {
        let mut rng = Pcg32::new(0, 0x6579);
        let mut elsewhere = || warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32()));
        (0..=LOOKS)
            .find_map(|look| {
                let dir = if look == 0 { ray.dir } else { elsewhere() };
                let ray = Ray::new(ray.org, dir);
                self.facing_medium(&ray, &self.rays.intersect(&ray))
            })
            .unwrap_or(self.media.outside)
    }

    /// The medium outside of all bodies: what a ray from there meets first, or `otherwise`.
    pub(super) fn outside_medium(&self, otherwise: MediumId) -> MediumId {
        let bounds = self.rays.bounds();
        let mut rng = Pcg32::new(0, 0x0075);
        let mut look = || {
            let mut on_sphere = || warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32()));
            let origin = bounds.center() + 2.0 * bounds.radius() * on_sphere();
            let target = bounds.center() + 0.5 * bounds.radius() * on_sphere();
            let ray = Ray::new(origin, (target - origin).normalize_or(Vec3::Z));
            self.facing_medium(&ray, &self.rays.intersect(&ray))
        };
        (0..LOOKS).find_map(|_| look()).unwrap_or(otherwise)
    }

    /// At most `count` points in media that scatter, as dense as sigma_t is on average over the
    /// channels, and the integral of that over the volume, an area. Empty where nothing scatters.
    pub fn medium_points(&self, count: usize, seed: u64) -> (Vec<Vec3>, f64) {
        let region = self.media.region;
        if !self.media.scatter() || region.is_empty() {
            return (Vec::new(), 0.0);
        }
        let tries = count.min(MOST_TRIED);
        let pieces: Vec<usize> = (0..tries).step_by(PIECE).collect();
        let tried: Vec<(Vec3, f64)> = pieces
            .par_iter()
            .flat_map_iter(|&from| {
                let mut rng = Pcg32::new(seed ^ from as u64, 0x3ed1);
                (from..(from + PIECE).min(tries)).map(move |_| {
                    let [x, y, z, u, v] = std::array::from_fn(|_| rng.next_f32());
                    let p = region.min + (region.max - region.min) * Vec3::new(x, y, z);
                    (
                        p,
                        self.extinction_at(p, warp::uniform_sphere(Vec2::new(u, v))),
                    )
                })
            })
            .collect();
        let sum = tried.iter().map(|t| t.1).sum::<f64>();
        let size = (region.max - region.min).as_dvec3();
        let cross_section = sum / tries as f64 * size.element_product();
        match sum > 0.0 && cross_section.is_finite() {
            true => (resample(&tried, sum, tries), cross_section),
            false => (Vec::new(), 0.0),
        }
    }

    /// Mean extinction at a place, if what is there scatters.
    fn extinction_at(&self, p: Vec3, look: Vec3) -> f64 {
        let ray = Ray::new(p, look);
        let hit = match self.media.has_boundaries {
            true => self.rays.intersect(&ray),
            false => Hit::NONE,
        };
        let medium = self.media.list().get(self.medium_along(&ray, &hit));
        let extinction = medium.map(|m| &m.extinction).filter(|e| e.scatters());
        extinction.map_or(0.0, |e| e.sigma_t(p).as_dvec3().element_sum() / 3.0)
    }
}

/// So many of the weighted points, each as often as its weight says (systematic resampling).
fn resample(weighted: &[(Vec3, f64)], sum: f64, count: usize) -> Vec<Vec3> {
    let (mut running, mut next) = (0.0, 0usize);
    let mut points = Vec::with_capacity(count);
    for (point, weight) in weighted {
        running += weight;
        while next < count && (next as f64 + 0.5) / count as f64 * sum < running {
            points.push(*point);
            next += 1;
        }
    }
    points
}
