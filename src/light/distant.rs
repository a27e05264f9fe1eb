//! Light from outside the scene: the same all around, from an image, from a sun's disk, or
//! parallel.

use super::latlong::{LatLong, Patch};
use crate::math::rgb::selection_weight;
use crate::math::warp::{
    cosine_hemisphere, cosine_hemisphere_pdf, uniform_cone, uniform_cone_pdf, uniform_sphere,
};
use crate::math::{Frame, Rgb, Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

/// A light that is infinitely far away.
#[derive(Debug)]
pub(super) enum Distant {
    /// The same radiance from everywhere.
    Constant(Rgb),
    /// An image.
    Map(Box<LatLong>),
    /// A disk of one radiance.
    Sun(Sun),
    /// Parallel light.
    Parallel {
        /// Unit direction towards the light.
        to_light: Vec3,
        irradiance: Rgb,
    },
}

/// What comes along a direction that was drawn.
#[derive(Clone, Copy, Debug)]
pub(super) enum Drawn {
    Known(Rgb),
    /// What the map has there.
    Map(Patch),
}

/// A disk of constant radiance in the sky.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sun {
    /// Unit direction to its centre.
    pub center: Vec3,
    /// `1 - cos` of its angular radius.
    pub one_minus_cos: f32,
    pub radiance: Rgb,
}

impl Sun {
    /// Solid angle it covers.
    pub fn solid_angle(&self) -> f32 {
        TAU * self.one_minus_cos
    }

    /// Whether the unit direction lies on the disk. The chord keeps its digits where the cosine
    /// would not: `1 - cos = |a - b|^2 / 2`.
    #[inline]
    pub fn contains(&self, dir: Vec3) -> bool {
        (dir - self.center).length_squared() <= 2.0 * self.one_minus_cos
    }
}

impl Distant {
    /// Whether no ray can meet it.
    pub fn is_delta(&self) -> bool {
        matches!(self, Distant::Parallel { .. })
    }

    /// An estimate of the irradiance on a surface with normal `n` (zero: facing the light).
    #[inline]
    pub fn importance(&self, n: Vec3) -> f32 {
        let facing = |dir: Vec3, slack: f32| {
            if n == Vec3::ZERO {
                1.0
            } else {
                (n.dot(dir) + slack).clamp(0.0, 1.0)
            }
        };
        match self {
            Distant::Constant(radiance) => selection_weight(*radiance) * PI,
            // A quarter of the integral: the irradiance if it came from everywhere alike.
            Distant::Map(map) => selection_weight(map.integral()) * 0.25,
            Distant::Sun(sun) => {
                let slack = (2.0 * sun.one_minus_cos).sqrt();
                selection_weight(sun.radiance) * sun.solid_angle() * facing(sun.center, slack)
            }
            Distant::Parallel {
                to_light,
                irradiance,
            } => selection_weight(*irradiance) * facing(*to_light, 0.0),
        }
    }

    /// Direction, radiance from there (for parallel light its irradiance), and density (0 for
    /// parallel light). May be `None` below the horizon of `n`, where the light would not count.
    ///
    /// The radiance is that of the place that was drawn: looking the direction up again would miss
    /// the edge of a sun now and then, by its rounding.
    #[inline]
    pub fn sample(&self, n: Vec3, u: Vec2) -> Option<(Vec3, Drawn, f32)> {
        let known = |(dir, radiance, pdf)| Some((dir, Drawn::Known(radiance), pdf));
        match self {
            Distant::Constant(radiance) if n == Vec3::ZERO => {
                known((uniform_sphere(u), *radiance, 0.25 * FRAC_1_PI))
            }
            Distant::Constant(radiance) => {
                let local = cosine_hemisphere(u);
                let dir = Frame::new(n).to_world(local);
                known((dir, *radiance, cosine_hemisphere_pdf(n.dot(dir))))
            }
            Distant::Map(map) => {
                let (dir, patch, pdf) = map.sample(n, u)?;
                Some((dir, Drawn::Map(patch), pdf))
            }
            Distant::Sun(sun) => {
                let local = uniform_cone(u, sun.one_minus_cos);
                let dir = Frame::new(sun.center).to_world(local);
                known((dir, sun.radiance, uniform_cone_pdf(sun.one_minus_cos)))
            }
            Distant::Parallel {
                to_light,
                irradiance,
            } => known((*to_light, *irradiance, 0.0)),
        }
    }

    /// Radiance along a direction that was drawn from this light.
    #[inline]
    pub fn radiance_of(&self, drawn: &Drawn) -> Rgb {
        match (drawn, self) {
            (Drawn::Known(radiance), _) => *radiance,
            (Drawn::Map(patch), Distant::Map(map)) => map.radiance_of(patch),
            (Drawn::Map(_), _) => Rgb::ZERO,
        }
    }

    /// Radiance from `dir`, and the density of [`Distant::sample`] there; 0 both for parallel
    /// light, which no ray meets.
    #[inline]
    pub fn radiance_pdf(&self, n: Vec3, dir: Vec3) -> (Rgb, f32) {
        match self {
            Distant::Constant(radiance) if n == Vec3::ZERO => (*radiance, 0.25 * FRAC_1_PI),
            Distant::Constant(radiance) => (*radiance, cosine_hemisphere_pdf(n.dot(dir))),
            Distant::Map(map) => map.radiance_pdf(dir),
            Distant::Sun(sun) if sun.contains(dir) => {
                (sun.radiance, uniform_cone_pdf(sun.one_minus_cos))
            }
            Distant::Sun(_) | Distant::Parallel { .. } => (Rgb::ZERO, 0.0),
        }
    }

    /// Radiance from `dir`; 0 for parallel light.
    #[inline]
    pub fn radiance(&self, dir: Vec3) -> Rgb {
        match self {
            Distant::Map(map) => map.radiance(dir),
            _ => self.radiance_pdf(Vec3::ZERO, dir).0,
        }
    }

    /// Integral of the radiance over all directions, or the irradiance of parallel light: power on
    /// a disk that faces it, per area.
    pub fn flux_per_area(&self) -> Rgb {
        match self {
            Distant::Constant(radiance) => *radiance * (4.0 * PI),
            Distant::Map(map) => map.integral(),
            Distant::Sun(sun) => sun.radiance * sun.solid_angle(),
            Distant::Parallel { irradiance, .. } => *irradiance,
        }
    }
}
