//! What a point needs to know about a group of lights to judge how much they may send: the ball they
//! are in, the cone their normals are in, and their strength.
//!
//! After Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting"
//! (2018), with the cosine bounds of Pharr, Jakob, Humphreys (2023), 12.6.3: the importance is 0 only
//! where no light of the group can arrive.

use crate::accel::Bounds;
use crate::math::Vec3;

/// Bounds of a group of lights. `strength` is intensity along the normal: radiance times area, or
/// power per solid angle, as luminance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    pub center: Vec3,
    pub radius: f32,
    pub axis: Vec3,
    /// Cosine of the angle around `axis` that holds all normals; -1 where there is light in all directions.
    pub cos_spread: f32,
    pub strength: f32,
}

/// The smallest squared distance that counts, relative to nothing: keeps a point on a point light finite.
const CLOSEST: f32 = 1e-30;

impl Cluster {
    /// Around some points that share a cone of normals.
    pub fn around(points: &[Vec3], axis: Vec3, cos_spread: f32, strength: f32) -> Self {
        let bounds = points.iter().fold(Bounds::EMPTY, |b, &p| b.with(p));
        let center = bounds.center();
        // From the centre to the farthest point, not half the diagonal: tighter for triangles.
        let radius = points
            .iter()
            .map(|&p| (p - center).length())
            .fold(0.0, f32::max);
        Self {
            center,
            // Rounding must not leave a corner outside.
            radius: radius * 1.000_01,
            axis,
            cos_spread,
            strength,
        }
    }

    /// A ball that shines in all directions.
    pub fn ball(center: Vec3, radius: f32, strength: f32) -> Self {
        Self {
            center,
            radius: radius * 1.000_01,
            axis: Vec3::Z,
            cos_spread: -1.0,
            strength,
        }
    }

    /// An estimate of the irradiance at `p` on a surface with normal `n` (zero: on one that faces the
    /// light). 0 only if nothing can arrive.
    #[inline]
    pub fn importance(&self, p: Vec3, n: Vec3) -> f32 {
        let to = self.center - p;
        let d2 = to.length_squared();
        let r2 = self.radius * self.radius;
        if d2 <= r2 {
            return (self.strength / r2.max(CLOSEST)).min(f32::MAX * 1e-3);
        }
        let inv = 1.0 / d2.sqrt();
        let dir = to * inv;
        // Half-angle under which the ball is seen.
        let sin_ball = self.radius * inv;
        let cos_ball = (1.0 - sin_ball * sin_ball).max(0.0).sqrt();
        // Angle between the normals' axis and the direction from the light to p, less the spread, less the ball.
        let cos_axis = -dir.dot(self.axis);
        let (cos, sin) = less(
            cos_axis,
            sine(cos_axis),
            self.cos_spread,
            sine(self.cos_spread),
        );
        let leaving = less(cos, sin, cos_ball, sin_ball).0;
        if leaving <= 0.0 {
            return 0.0;
        }
        let mut importance = self.strength * leaving;
        if n != Vec3::ZERO {
            let cos_in = dir.dot(n);
            let arriving = less(cos_in, sine(cos_in), cos_ball, sin_ball).0;
            if arriving <= 0.0 {
                return 0.0;
            }
            importance *= arriving;
        }
        (importance / d2.max(CLOSEST)).min(f32::MAX * 1e-3)
    }
}

#[inline]
fn sine(cos: f32) -> f32 {
    (1.0 - cos * cos).max(0.0).sqrt()
}

/// Cosine and sine of `max(0, a - b)`.
#[inline]
fn less(cos_a: f32, sin_a: f32, cos_b: f32, sin_b: f32) -> (f32, f32) {
    if cos_a > cos_b {
        (1.0, 0.0)
    } else {
        (
            cos_a * cos_b + sin_a * sin_b,
            (sin_a * cos_b - cos_a * sin_b).max(0.0),
        )
    }
}
