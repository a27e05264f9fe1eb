//! Phase functions: where a collision sends light. Densities over the sphere, which integrate to 1.

use crate::math::{Frame, Vec2, Vec3};
use std::f32::consts::PI;

/// The largest asymmetry: beyond it the peak is narrower than f32 can draw directions.
const MOST_ASYMMETRIC: f32 = 0.9999;
/// How many phase functions one may be a blend of.
pub const MOST_LOBES: usize = 4;

/// A phase function by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PhaseLobe {
    /// Henyey and Greenstein (1941), of asymmetry g: the mean cosine, -1 to 1; 0 is isotropic.
    HenyeyGreenstein(f32),
    /// Rayleigh: 3 (1 + cos^2) / (16 pi).
    Rayleigh,
}

impl PhaseLobe {
    /// Henyey and Greenstein of that asymmetry, which is cut to what can be drawn.
    pub fn henyey_greenstein(g: f32) -> Self {
        Self::HenyeyGreenstein(g.clamp(-MOST_ASYMMETRIC, MOST_ASYMMETRIC))
    }

    /// Density for the cosine between the directions of travel before and after, per steradian.
    #[inline]
    pub fn eval(self, cosine: f32) -> f32 {
        match self {
            Self::HenyeyGreenstein(g) => {
                // 1 + g^2 - 2 g cos, without cancellation near the peak.
                let peak = 1.0 - g.abs();
                let away = 1.0 - cosine * g.signum();
                let square = peak * peak + 2.0 * g.abs() * away;
                (1.0 - g * g) / (4.0 * PI * square * square.sqrt())
            }
            Self::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + cosine * cosine),
        }
    }

    /// Draws the cosine, by `u`.
    #[inline]
    fn sample_cosine(self, u: f32) -> f32 {
        match self {
            Self::HenyeyGreenstein(g) if g.abs() < 1e-3 => {
                // The inverse below to first order in g, where that would divide by 0.
                let c = 2.0 * u - 1.0;
                c + 1.5 * g * (1.0 - c * c)
            }
            Self::HenyeyGreenstein(g) => {
                let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
                (1.0 + g * g - s * s) / (2.0 * g)
            }
            Self::Rayleigh => {
                // The root of c^3 + 3 c = 8 u - 4 (Cardano; Frisvad 2011).
                let z = 4.0 * u - 2.0;
                let a = (z + (z * z + 1.0).sqrt()).cbrt();
                a - 1.0 / a
            }
        }
    }
}

/// A phase function: one, or a blend of a few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseFunction {
    /// Each with its share; the shares sum to 1.
    lobes: [(f32, PhaseLobe); MOST_LOBES],
    count: u8,
}

impl From<PhaseLobe> for PhaseFunction {
    fn from(lobe: PhaseLobe) -> Self {
        let mut lobes = [(0.0, lobe); MOST_LOBES];
        lobes[0].0 = 1.0;
        Self { lobes, count: 1 }
    }
}

impl PhaseFunction {
    /// The same to all directions.
    pub fn isotropic() -> Self {
        PhaseLobe::HenyeyGreenstein(0.0).into()
    }

    /// `1 - weight` of one and `weight` of another.
    ///
    /// # Errors
    /// When it would be made of more than [`MOST_LOBES`].
    pub fn blend(first: &Self, second: &Self, weight: f32) -> Result<Self, String> {
        let weight = weight.clamp(0.0, 1.0);
        let scaled = |of: &Self, by: f32| of.lobes().map(move |(share, lobe)| (share * by, lobe));
        let all: Vec<_> = scaled(first, 1.0 - weight)
            .chain(scaled(second, weight))
            .filter(|(share, _)| *share > 0.0)
            .collect();
        if all.len() > MOST_LOBES {
            let message = format!("a blend of more than {MOST_LOBES} phase functions");
            return Err(message);
        }
        let mut blend = *first;
        blend.count = all.len() as u8;
        blend.lobes[..all.len()].copy_from_slice(&all);
        Ok(blend)
    }

    /// Each with its share.
    #[inline]
    fn lobes(&self) -> impl Iterator<Item = (f32, PhaseLobe)> + use<> {
        self.lobes.into_iter().take(usize::from(self.count))
    }

    /// Density for the cosine between the directions of travel before and after, per steradian.
    #[inline]
    pub fn eval(&self, cosine: f32) -> f32 {
        self.lobes().map(|(share, l)| share * l.eval(cosine)).sum()
    }

    /// Draws the direction of travel after a collision, with the density [`PhaseFunction::eval`].
    #[inline]
    pub fn sample(&self, before: Vec3, u_lobe: f32, u: Vec2) -> Vec3 {
        let mut left = u_lobe;
        let mut chosen = self.lobes[0].1;
        for (share, lobe) in self.lobes() {
            chosen = lobe;
            if left < share {
                break;
            }
            left -= share;
        }
        let cosine = chosen.sample_cosine(u.x).clamp(-1.0, 1.0);
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let (s, c) = (2.0 * PI * u.y).sin_cos();
        Frame::new(before).to_world(Vec3::new(sine * c, sine * s, cosine))
    }

    /// How wide its narrowest lobe is, as a roughness: 1 for all directions alike.
    #[inline]
    pub fn roughness(&self) -> f32 {
        let width = |lobe| match lobe {
            PhaseLobe::HenyeyGreenstein(g) => 1.0 - f32::abs(g),
            PhaseLobe::Rayleigh => 1.0,
        };
        self.lobes().map(|(_, l)| width(l)).fold(1.0, f32::min)
    }
}
