//! Reconstruction filters, sampled by importance.

use crate::math::Vec2;

/// A separable reconstruction filter. Radii in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Constant over `radius`.
    Box {
        /// Half width, 0.5 for one pixel.
        radius: f32,
    },
    /// Linear falloff.
    Tent {
        /// Half width.
        radius: f32,
    },
    /// Gaussian of standard deviation `stddev`, cut at 4 of them and lowered to reach 0 there.
    Gaussian {
        /// Standard deviation, Mitsuba's default 0.5.
        stddev: f32,
    },
    /// Mitchell and Netravali, radius 2.
    Mitchell {
        /// B.
        b: f32,
        /// C.
        c: f32,
    },
    /// Catmull and Rom, radius 2.
    CatmullRom,
    /// Windowed sinc.
    Lanczos {
        /// Half width.
        lobes: f32,
    },
}

/// A place on the film drawn from a filter.
#[derive(Clone, Copy, Debug)]
pub struct FilterSample {
    /// Offset from the pixel's centre, pixels.
    pub offset: Vec2,
    /// filter / density: 1 for filters without negative lobes, of either sign for those with.
    pub weight: f32,
}
