//! Which paths a tile takes, and how they begin.

use super::adaptive::{Shares, TileShares};
use super::context::View;
use super::path::FirstHit;
use super::recording::Recorded;
use crate::camera::CameraRay;
use crate::film::filter::FilterSampler;
use crate::film::{Extras, Sample, Tile};
use crate::math::{PathSampler, Rgb, Vec2};
use std::ops::Range;

/// Samples of the image that are taken by one and the same state of knowledge: field, mixture
/// fractions, shares of the pixels.
///
/// Earlier iterations decided on that state, so each iteration has random numbers that are
/// independent of theirs: in every pixel a Sobol sequence of its own. Given all before it, an
/// iteration is then an unbiased estimate of every pixel, and counts for a number of samples that
/// was fixed before it began. So the sum over the iterations is unbiased, too. tests/unbiased.rs
/// guards that.
#[derive(Clone, Debug, Default)]
pub struct Iteration {
    /// Its first sample of the image.
    from: u64,
    /// How many paths each pixel takes for a sample; `None`: one.
    shares: Option<Shares>,
}

impl Iteration {
    /// The iteration that begins with sample `from`.
    pub fn new(from: u64, shares: Option<Shares>) -> Self {
        Self { from, shares }
    }

    /// Paths that pixel `i` of a tile has taken before sample `sample`, which is not before the
    /// iteration.
    pub fn taken(&self, tile: usize, i: usize, sample: u64) -> u64 {
        match &self.shares {
            Some(shares) => shares[tile].of(i).taken(sample - self.from),
            None => sample,
        }
    }

    /// The first path of pixel `i` of a tile for sample `sample`, or the next one where that has
    /// none.
    pub fn path(&self, tile: usize, i: usize, sample: u64) -> PathNumber {
        PathNumber {
            begin: self.taken(tile, i, self.from),
            number: self.taken(tile, i, sample),
        }
    }

    /// Samples `samples` of tile number `tile`.
    pub fn part(&self, samples: Range<u64>, tile: usize) -> TileSamples<'_> {
        TileSamples {
            samples,
            from: self.from,
            shares: self.shares.as_ref().map(|shares| &shares[tile]),
        }
    }
}

/// Samples of a tile.
#[derive(Clone, Debug)]
pub struct TileSamples<'s> {
    /// Their numbers.
    pub samples: Range<u64>,
    /// First sample of their iteration.
    from: u64,
    /// How many paths each pixel takes for them; `None`: one.
    shares: Option<&'s TileShares>,
}

impl TileSamples<'_> {
    /// How many samples of a tile take about so many paths; at least one.
    pub fn samples_of(&self, paths: u64, tile: &Tile) -> u64 {
        let area = tile.area() as f32;
        let per_sample = self.shares.map_or(area, TileShares::per_sample);
        ((paths as f32 / per_sample) as u64).max(1)
    }

    /// The paths of a pixel for a sample.
    #[inline]
    pub fn starts(&self, pixel: u32, sample: u64) -> impl Iterator<Item = Start> + use<> {
        let (paths, begin, worth) = match self.shares {
            Some(shares) => {
                let share = shares.of(pixel as usize);
                let paths = share.paths(sample - self.from);
                (paths, share.begin(), share.worth())
            }
            None => (sample..sample + 1, self.from, 1.0),
        };
        paths.zip(0..).map(move |(path, way)| Start {
            pixel,
            sample,
            way,
            path: PathNumber {
                begin,
                number: path,
            },
            weight: 1.0,
            worth,
        })
    }
}

/// Number of a path among all paths of its pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathNumber {
    /// Number of the first path of its iteration: there its Sobol sequence begins.
    pub begin: u64,
    /// Its own number.
    pub number: u64,
}

impl PathNumber {
    /// The path of sample number `sample` where nothing was learned.
    pub fn plain(sample: u64) -> Self {
        Self {
            begin: 0,
            number: sample,
        }
    }
}

/// How a path of a tile begins.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Its pixel in the tile.
    pub pixel: u32,
    /// The sample of the image that it belongs to.
    sample: u64,
    /// Its number among the pixel's paths for that sample.
    way: u32,
    /// Its number among all of the pixel's paths.
    pub path: PathNumber,
    /// Its weight by the filter.
    pub weight: f32,
    /// How many samples it is worth.
    pub worth: f32,
}

impl Start {
    /// Which paths it may share with.
    pub fn origin(&self) -> Origin {
        Origin {
            pixel: self.pixel,
            // No image has so many samples that this is one of them.
            round: self.sample | u64::from(self.way) << 48,
        }
    }
}

/// How a path of a pixel begins: its camera ray, the numbers to come, its filter weight.
#[inline]
pub fn first_ray(
    view: &View,
    filter: &FilterSampler,
    [x, y]: [u32; 2],
    path: PathNumber,
) -> (CameraRay, PathSampler, f32) {
    let pixel = u64::from(y) * u64::from(view.film.width) + u64::from(x);
    let mut sampler = view.settings.sampler(pixel, path.begin, path.number);
    let u = sampler.next4();
    let place = filter.sample(Vec2::new(u[0], u[1]));
    let center = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
    let lens = Vec2::new(u[2], u[3]);
    let ray = view.camera.ray(center + place.offset, lens);
    (ray, sampler, place.weight)
}

/// Adds the paths that the tile lacks, if it is held: what they came to and what they met first;
/// what was recorded besides, and for which extras of the film.
pub fn add(
    tile: &mut Tile,
    (radiances, first_hits): (&[Rgb], &[FirstHit]),
    (recorded, extras): (&Recorded, &Extras),
    starts: &[Start],
) {
    if !tile.is_held() {
        return;
    }
    let plain = extras.is_empty();
    let samples = radiances.iter().zip(first_hits);
    for (number, ((&radiance, first), start)) in samples.zip(starts).enumerate() {
        if start.sample < tile.done {
            continue;
        }
        let sample = Sample {
            radiance,
            weight: start.weight,
            worth: start.worth,
            albedo: first.albedo,
            normal: first.normal,
            depth: first.depth,
            features: first.features,
        };
        let pixel = start.pixel as usize;
        match plain {
            true => _ = tile.add(pixel, start.sample, &sample),
            false => {
                let extra = recorded.of(number);
                tile.add_with(pixel, start.sample, (&sample, &extra), extras);
            }
        }
    }
}

/// Where a path of a wave comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin {
    /// A number for its pixel.
    pub pixel: u32,
    /// A number that it shares with one path of other pixels, and with none of its own.
    pub round: u64,
}
