//! What a point needs to know about a group of lights to judge how much they may send: the ball
//! they are in, the cone their normals are in, and their strength.
//!
//! After Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting"
//! (2018), with the cosine bounds of Pharr, Jakob, Humphreys (2023), 12.6.3: the importance is 0
//! only where no light of the group can arrive.

use crate::accel::Bounds;
use crate::math::Vec3;

/// Bounds of a group of lights. `strength` is intensity along the normal: radiance times area, or
/// power per solid angle, as luminance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    pub center: Vec3,
    pub radius: f32,
    pub axis: Vec3,
    /// Cosine of the angle around `axis` that holds all normals; -1 where there is light in all
    /// directions.
    pub cos_spread: f32,
    pub strength: f32,
}

/// The smallest squared distance that counts, relative to nothing: keeps a point on a point light
/// finite.
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

    /// An estimate of the irradiance at `p` on a surface with normal `n` (zero: on one that faces
    /// the light). 0 only if nothing can arrive.
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
        // Angle between the normals' axis and the direction from the light to p, less the spread,
        // less the ball.
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

/// Clusters side by side.
pub(super) const WIDTH: usize = 8;

/// Eight clusters, each property an array, so that one instruction works on several of them.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(super) struct Lanes {
    center: [[f32; WIDTH]; 3],
    radius: [f32; WIDTH],
    axis: [[f32; WIDTH]; 3],
    cos_spread: [f32; WIDTH],
    sin_spread: [f32; WIDTH],
    strength: [f32; WIDTH],
}

impl Lanes {
    /// Nothing shines.
    pub const EMPTY: Self = Self {
        center: [[0.0; WIDTH]; 3],
        radius: [0.0; WIDTH],
        axis: [[0.0; WIDTH]; 3],
        cos_spread: [0.0; WIDTH],
        sin_spread: [0.0; WIDTH],
        strength: [0.0; WIDTH],
    };

    /// Puts a cluster into a place.
    pub fn set(&mut self, place: usize, c: &Cluster) {
        for axis in 0..3 {
            self.center[axis][place] = c.center[axis];
            self.axis[axis][place] = c.axis[axis];
        }
        self.radius[place] = c.radius;
        self.cos_spread[place] = c.cos_spread;
        self.sin_spread[place] = sine(c.cos_spread);
        self.strength[place] = c.strength;
    }

    /// [`Cluster::importance`] of each; 0 in empty places.
    #[inline]
    pub fn importance(&self, p: Vec3, n: Vec3) -> [f32; WIDTH] {
        if n == Vec3::ZERO {
            self.evaluate::<false>(p, n)
        } else {
            self.evaluate::<true>(p, n)
        }
    }

    /// Without a branch, and in short loops over the lanes, each of which becomes vector
    /// instructions: what does not apply is computed and not taken.
    #[inline]
    fn evaluate<const FACING: bool>(&self, p: Vec3, n: Vec3) -> [f32; WIDTH] {
        let (mut d2, mut inv) = ([0.0; WIDTH], [0.0; WIDTH]);
        let (mut cos_axis, mut cos_in) = ([0.0; WIDTH], [0.0; WIDTH]);
        for i in 0..WIDTH {
            let x = self.center[0][i] - p.x;
            let y = self.center[1][i] - p.y;
            let z = self.center[2][i] - p.z;
            d2[i] = x * x + y * y + z * z;
            inv[i] = 1.0 / at_least(d2[i], CLOSEST).sqrt();
            let (a, b, c) = (self.axis[0][i], self.axis[1][i], self.axis[2][i]);
            cos_axis[i] = -(x * a + y * b + z * c) * inv[i];
            cos_in[i] = (x * n.x + y * n.y + z * n.z) * inv[i];
        }
        let (mut sin_ball, mut cos_ball) = ([0.0; WIDTH], [0.0; WIDTH]);
        for i in 0..WIDTH {
            sin_ball[i] = self.radius[i] * inv[i];
            cos_ball[i] = at_least(1.0 - sin_ball[i] * sin_ball[i], 0.0).sqrt();
        }
        let mut seen = [0.0; WIDTH];
        for i in 0..WIDTH {
            let (cos, sin) = less(
                cos_axis[i],
                sine(cos_axis[i]),
                self.cos_spread[i],
                self.sin_spread[i],
            );
            seen[i] = at_least(less(cos, sin, cos_ball[i], sin_ball[i]).0, 0.0);
        }
        if FACING {
            for i in 0..WIDTH {
                let arriving = less(cos_in[i], sine(cos_in[i]), cos_ball[i], sin_ball[i]).0;
                seen[i] *= at_least(arriving, 0.0);
            }
        }
        let mut importance = [0.0; WIDTH];
        for i in 0..WIDTH {
            let r2 = self.radius[i] * self.radius[i];
            let outside = seen[i] * inv[i] * inv[i];
            let inside = 1.0 / at_least(r2, CLOSEST);
            let here = if d2[i] <= r2 { inside } else { outside };
            importance[i] = at_most(self.strength[i] * here, f32::MAX * 1e-3);
        }
        importance
    }
}

/// `max` by one comparison, for numbers.
#[inline]
fn at_least(x: f32, least: f32) -> f32 {
    if x > least { x } else { least }
}

/// `min` by one comparison, for numbers.
#[inline]
fn at_most(x: f32, most: f32) -> f32 {
    if x < most { x } else { most }
}

#[inline]
fn sine(cos: f32) -> f32 {
    at_least(1.0 - cos * cos, 0.0).sqrt()
}

/// Cosine and sine of `max(0, a - b)`.
#[inline]
fn less(cos_a: f32, sin_a: f32, cos_b: f32, sin_b: f32) -> (f32, f32) {
    let cos = cos_a * cos_b + sin_a * sin_b;
    let sin = at_least(sin_a * cos_b - cos_a * sin_b, 0.0);
    let within = cos_a > cos_b;
    (
        if within { 1.0 } else { cos },
        if within { 0.0 } else { sin },
    )
}
