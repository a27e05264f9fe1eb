//! Pixels and the tiles they are stored in.

use super::extras::{ExtraSample, Extras};
use super::features::{FeatureSums, Features};
use super::late::Late;
use super::mattes::ShapeSums;
use crate::math::{Rgb, Vec3};

/// Width and height of a tile in pixels.
pub const TILE_SIZE: u32 = 16;

/// What one sample gives a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Radiance.
    pub radiance: Rgb,
    /// Weight by the reconstruction filter; of either sign.
    pub weight: f32,
    /// How many samples it stands for: not 1 where pixels take more or fewer than others.
    pub worth: f32,
    /// Reflectance of the first surface.
    pub albedo: Rgb,
    /// Its shading normal, world space.
    pub normal: Vec3,
    /// Its distance; 0 where nothing was met.
    pub depth: f32,
    /// What a denoiser is told, if that is more than albedo and normal of the first surface.
    pub features: Option<Features>,
}

impl Default for Sample {
    /// One that counts like any other and met nothing.
    fn default() -> Self {
        Self {
            radiance: Rgb::ZERO,
            weight: 1.0,
            worth: 1.0,
            albedo: Rgb::ZERO,
            normal: Vec3::ZERO,
            depth: 0.0,
            features: None,
        }
    }
}

/// Sums over the samples of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Sum of worth times weight times radiance.
    pub radiance: [f64; 3],
    /// Sum of its squares.
    pub squares: [f64; 3],
    /// Sum of worth times weight.
    pub weight: f64,
    /// Sum of worth.
    pub worth: f64,
    /// Sum of its squares.
    pub worth_squares: f64,
    /// Samples, those dropped not counted.
    pub count: u64,
    /// Sum of the first surfaces' reflectances.
    pub albedo: [f64; 3],
    /// Sum of their normals.
    pub normal: [f64; 3],
    /// Sum of distances of the samples that met something.
    pub depth: f64,
    /// Samples that met something.
    pub met: u64,
    /// What a denoiser is told besides.
    pub features: FeatureSums,
    /// The later half of the samples.
    pub late: Late,
}

/// Weights below this, a sample, are what rounding leaves of none.
const LEAST_WEIGHT: f64 = 1e-9;

impl Pixel {
    /// A pixel without samples.
    pub const EMPTY: Pixel = Pixel {
        radiance: [0.0; 3],
        squares: [0.0; 3],
        weight: 0.0,
        worth: 0.0,
        worth_squares: 0.0,
        count: 0,
        albedo: [0.0; 3],
        normal: [0.0; 3],
        depth: 0.0,
        met: 0,
        features: FeatureSums::EMPTY,
        late: Late::EMPTY,
    };

    /// Adds a finite sample of the image's sample number `index`; these never fall.
    #[inline]
    pub fn add(&mut self, index: u64, s: &Sample) {
        self.late.advance(index);
        let worth = f64::from(s.worth);
        // In f64: the product of two finite f32 would overflow beyond 3.4e38.
        let weight = worth * f64::from(s.weight);
        let values = s.radiance.to_array().map(|x| f64::from(x) * weight);
        for (c, value) in values.into_iter().enumerate() {
            self.radiance[c] += value;
            self.squares[c] += value * value;
            self.albedo[c] += f64::from(s.albedo[c]);
            self.normal[c] += f64::from(s.normal[c]);
        }
        if let Some(features) = &s.features {
            self.features.add(features, s.albedo, s.normal);
        }
        self.weight += weight;
        self.worth += worth;
        self.worth_squares += worth * worth;
        self.late.add(values, worth);
        self.count += 1;
        if s.depth > 0.0 {
            self.depth += f64::from(s.depth);
            self.met += 1;
        }
    }

    /// The pixel's radiance: weighted by the filter; 0 without samples.
    pub fn mean(&self) -> [f64; 3] {
        let scale = if self.weight > 0.0 {
            1.0 / self.weight
        } else {
            0.0
        };
        self.radiance.map(|sum| sum * scale)
    }

    /// Mean reflectance of what is seen behind mirrors and glass, at most 1: lobes and branches are
    /// chosen by lot, and few samples may come to more.
    pub fn seen_albedo(&self) -> [f64; 3] {
        let scale = 1.0 / self.count.max(1) as f64;
        let more = &self.features.albedo;
        std::array::from_fn(|c| ((self.albedo[c] + more[c]) * scale).clamp(0.0, 1.0))
    }

    /// Mean normal of that, each as it is weighted: shorter than 1 where they differ, 0 where
    /// nothing was met.
    pub fn seen_normal(&self) -> [f64; 3] {
        let count = self.count as f64;
        let weight = count + self.features.weight;
        let scale = match weight > LEAST_WEIGHT * count {
            true => 1.0 / weight,
            false => 0.0,
        };
        let more = &self.features.normal;
        std::array::from_fn(|c| (self.normal[c] + more[c]) * scale)
    }

    /// Variance of a sample, estimated from the spread of the samples; 0 with fewer than two. With
    /// `w` for their worth `S w^2 (x - mean)^2 / S w^2`, and the usual `n / (n - 1)`.
    pub fn variance_of_sample(&self) -> [f64; 3] {
        if self.count < 2 {
            return [0.0; 3];
        }
        let n = self.count as f64;
        let scale = n / (n - 1.0);
        std::array::from_fn(|c| {
            let mean = self.radiance[c] / self.worth;
            (self.squares[c] / self.worth_squares - mean * mean).max(0.0) * scale
        })
    }

    /// Variance of [`Pixel::mean`] over renders with other seeds if its samples are independent:
    /// that of a mean by weights that do not depend on the samples. Sobol points have less
    /// ([`super::Film::variances`]).
    pub fn variance_of_mean(&self) -> [f64; 3] {
        if self.count < 2 {
            return [0.0; 3];
        }
        let scale = self.worth_squares / (self.worth * self.worth);
        self.variance_of_sample().map(|v| v * scale)
    }
}

/// A rectangle of pixels: what one task renders.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// Left edge on the full film.
    pub x0: u32,
    /// Upper edge on the full film.
    pub y0: u32,
    /// Width, at most [`TILE_SIZE`].
    pub width: u32,
    /// Height, at most [`TILE_SIZE`].
    pub height: u32,
    /// Row by row; empty in a film that does not hold the tile.
    pub pixels: Vec<Pixel>,
    /// Further sums, pixel by pixel (see [`super::extras`]).
    pub extras: Vec<f64>,
    /// The shapes that each pixel sees; empty where nobody asks (see [`super::mattes`]).
    pub shapes: Vec<ShapeSums>,
    /// Every pixel has taken the samples from 0 up to this number, those dropped included.
    pub done: u64,
    /// Samples dropped because they were not finite.
    pub invalid: u64,
    /// The first of them: x, y, sample.
    pub first_invalid: Option<(u32, u32, u64)>,
}

impl Tile {
    /// Number of pixels, held or not.
    pub fn area(&self) -> usize {
        (self.width * self.height) as usize
    }

    /// Column and row on the full film of pixel `i`.
    #[inline]
    pub fn place(&self, i: usize) -> [u32; 2] {
        let i = i as u32;
        [self.x0 + i % self.width, self.y0 + i / self.width]
    }

    /// Whether the film holds the tile's pixels.
    pub fn is_held(&self) -> bool {
        !self.pixels.is_empty()
    }

    /// Adds sample number `index` of the tile's pixel `i`. One that is not finite is dropped and
    /// counted; says whether it was kept.
    #[inline]
    pub fn add(&mut self, i: usize, index: u64, sample: &Sample) -> bool {
        let colors = sample.radiance.is_finite() & sample.albedo.is_finite();
        let finite = colors
            & sample.normal.is_finite()
            & sample.depth.is_finite()
            & sample.features.as_ref().is_none_or(Features::is_finite)
            & sample.weight.is_finite()
            & sample.worth.is_finite();
        if finite {
            self.pixels[i].add(index, sample);
            return true;
        }
        self.invalid += 1;
        let [x, y] = self.place(i);
        self.first_invalid.get_or_insert((x, y, index));
        false
    }

    /// The same with what the sample brings besides.
    pub fn add_with(
        &mut self,
        i: usize,
        index: u64,
        (sample, extra): (&Sample, &ExtraSample),
        extras: &Extras,
    ) {
        if self.add(i, index, sample) {
            self.add_extras(i, extras, sample, extra);
        }
    }
}
