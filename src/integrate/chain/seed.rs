//! A beginning of a chain: where the light's image is seen.
//!
//! What is seen in a mirror or through a pane has a place of its own, behind the mirror, under the water, or in front of
//! who looks. Known from one place, it tells in which direction to look from another.

use super::follow::Kinds;
use crate::math::Vec3;

/// Angle by which photons miss the middle of the image that they came by: places that are not much farther apart than that,
/// as the image sees them, do not tell how far away it is.
const BLUR: f32 = 0.01;

/// A beginning of a chain: a light's image in a mirror or behind a pane, and how it comes about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seed {
    /// The direction in which it is seen from the origin of the scene, not a unit vector.
    towards: Vec3,
    /// How that turns with the place: one by the distance of the image. That of a sun under calm water is infinitely far
    /// away, that in a drop is near; what gathers light in front of the place has a negative distance.
    nearness: f32,
    /// What follows.
    pub chain: Kinds,
    /// The light at its end.
    pub beacon: u32,
    /// How often it is drawn, relative to others.
    pub weight: f32,
}

impl Seed {
    /// What a photon tells that comes to `place` from the unit direction `dir` and from a mirror or pane at `point`: as if
    /// the image were there.
    pub fn new(place: Vec3, dir: Vec3, point: Vec3, chain: Kinds, beacon: u32) -> Self {
        let nearness = place.distance(point).recip();
        Self {
            towards: dir + place * nearness,
            nearness,
            chain,
            beacon,
            weight: 1.0,
        }
    }

    /// The direction in which it is seen from a place, not a unit vector.
    #[inline]
    pub fn seen_from(&self, place: Vec3) -> Vec3 {
        self.towards - place * self.nearness
    }

    /// Moves the image to where the photons that came by it saw it, each in a direction from a place: least squares of
    /// `dir - mean dir = -nearness (place - mean place)` across the mean direction, with what was thought before as one
    /// more photon's word for it. A sun under water is far behind the surface; left there, its image took one of Newton's
    /// steps more, half the time.
    pub fn fit(&mut self, photons: &[(Vec3, Vec3)]) {
        let share = (photons.len() as f32).recip();
        let place = photons.iter().map(|(place, _)| *place).sum::<Vec3>() * share;
        let dir = photons.iter().map(|(_, dir)| *dir).sum::<Vec3>() * share;
        let axis = dir.normalize_or_zero();
        let doubt = (BLUR / self.nearness).powi(2);
        let (mut turned, mut moved) = (doubt * self.nearness, doubt);
        for photon in photons {
            let across = (photon.0 - place).reject_from_normalized(axis);
            turned -= across.dot(photon.1 - dir);
            moved += across.length_squared();
        }
        let nearness = turned / moved;
        if nearness.is_finite() {
            self.nearness = nearness;
            self.towards = dir + place * nearness;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest sine of the angle between where the fitted seed is seen, around the places of its photons, and
    /// where it should be.
    fn error(seen: impl Fn(Vec3) -> Vec3, pane: f32, photons: usize) -> f32 {
        let places: Vec<Vec3> = (0..photons)
            .map(|i| Vec3::new(5.0 + (i % 4) as f32 * 0.1, -3.0 + (i / 4) as f32 * 0.1, 1.0))
            .collect();
        let ways: Vec<(Vec3, Vec3)> = places.iter().map(|&p| (p, seen(p).normalize())).collect();
        let (place, dir) = ways[0];
        let mut seed = Seed::new(place, dir, place + dir * pane, Kinds::EMPTY, 0);
        let apart = |seed: &Seed, p: Vec3| seed.seen_from(p).normalize().cross(seen(p).normalize());
        assert!(apart(&seed, place).length() < 1e-5);
        seed.fit(&ways);
        let errors = places.iter().map(|&p| apart(&seed, p).length());
        errors.fold(0.0, f32::max)
    }

    /// Whether an image is near, infinitely far away or in front of who sees it, photons tell where it is, whatever pane
    /// they came through.
    #[test]
    fn an_image_is_fitted_to_its_photons() {
        let near = Vec3::new(5.5, -2.5, 2.5);
        for pane in [0.3, 1.0, 3.0] {
            assert!(error(|p| near - p, pane, 16) < 5e-3);
            assert!(error(|_| Vec3::new(0.2, 0.1, 1.0), pane, 16) < 5e-3);
            assert!(error(|p| p - Vec3::new(5.0, -3.0, -2.0), pane, 16) < 5e-3);
        }
    }

    /// One photon does not tell where the image is, only in which direction.
    #[test]
    fn a_single_photon_leaves_the_image_at_its_pane() {
        assert!(error(|_| Vec3::new(0.2, 0.1, 1.0), 1.0, 1) < 1e-5);
        let mut seed = Seed::new(Vec3::X, Vec3::Z, Vec3::new(1.0, 0.0, 2.0), Kinds::EMPTY, 0);
        seed.fit(&[(Vec3::X, Vec3::Z)]);
        let aside = seed.seen_from(Vec3::ZERO).normalize();
        assert!((aside - Vec3::new(1.0, 0.0, 2.0).normalize()).length() < 1e-5);
    }
}
