//! Which paths a tile takes, and how they begin.

use super::adaptive::{Shares, TileShares};
use super::render::View;
use super::reuse::Origin;
use super::wave::Outcome;
use crate::camera::CameraRay;
use crate::film::filter::FilterSampler;
use crate::film::{Sample, Tile};
use crate::math::{PathSampler, Vec2};
use std::ops::Range;

/// Samples of a tile.
#[derive(Clone, Debug)]
pub struct Part<'s> {
    /// Their numbers.
    pub samples: Range<u64>,
    /// How many paths each pixel takes for them; `None`: one.
    pub shares: Option<&'s TileShares>,
}

impl<'s> Part<'s> {
    /// Of tile number `tile`.
    pub fn new(samples: Range<u64>, shares: Option<&'s Shares>, tile: usize) -> Self {
        Self {
            samples,
            shares: shares.map(|shares| &shares[tile]),
        }
    }

    /// How many samples of a tile take about so many paths; at least one.
    pub fn samples_of(&self, paths: u64, tile: &Tile) -> u64 {
        let area = tile.area() as f32;
        let per_sample = self.shares.map_or(area, TileShares::per_sample);
        ((paths as f32 / per_sample) as u64).max(1)
    }

    /// The paths of a pixel for a sample.
    #[inline]
    pub fn starts(&self, pixel: u32, sample: u64) -> impl Iterator<Item = Start> + use<> {
        let (paths, worth) = match self.shares {
            Some(shares) => shares.paths(pixel as usize, sample),
            None => (sample..sample + 1, 1.0),
        };
        paths.zip(0..).map(move |(path, way)| Start {
            pixel,
            sample,
            way,
            path,
            weight: 1.0,
            worth,
        })
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
    pub path: u64,
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

/// How path number `path` of a pixel begins: its camera ray, the numbers to come, its filter weight.
#[inline]
pub fn first_ray(
    view: &View,
    filter: &FilterSampler,
    [x, y]: [u32; 2],
    path: u64,
) -> (CameraRay, PathSampler, f32) {
    let pixel = u64::from(y) * u64::from(view.film.width) + u64::from(x);
    let mut sampler = view.settings.sampler(pixel, path);
    let u = sampler.next4();
    let place = filter.sample(Vec2::new(u[0], u[1]));
    let center = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
    let lens = Vec2::new(u[2], u[3]);
    let ray = view.camera.ray(center + place.offset, lens);
    (ray, sampler, place.weight)
}

/// Adds the paths that the tile lacks, if it is held.
pub fn add(tile: &mut Tile, outcomes: &[Outcome], starts: &[Start]) {
    if !tile.is_held() {
        return;
    }
    for (outcome, start) in outcomes.iter().zip(starts) {
        if start.sample < tile.done {
            continue;
        }
        let sample = Sample {
            radiance: outcome.radiance,
            weight: start.weight,
            worth: start.worth,
            albedo: outcome.first.albedo,
            normal: outcome.first.normal,
            depth: outcome.first.depth,
        };
        tile.add(start.pixel as usize, start.path, &sample);
    }
}
