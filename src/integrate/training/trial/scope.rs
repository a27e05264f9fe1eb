//! The tiles of a trial: rendered into films that are thrown away.

use crate::film::{Film, FilmDescription, Shard, Tile};
use crate::integrate::camera_sample::Iteration;
use crate::integrate::context::PathContext;
use crate::integrate::guiding::Guidance;
use crate::integrate::manifold::rate::RateStatistics;
use crate::integrate::tiles::Job;
use rayon::prelude::*;
use std::ops::Range;

/// The trial's tiles: one in so many, at least.
pub(super) const SHARE: u32 = 8;
/// The trial's samples: numbers that no image reaches, of two point sets.
pub(super) const SETS: [u64; 2] = [1 << 40, (1 << 40) + (1 << 20)];
/// Samples of a pixel in each, at most and at least.
pub(super) const MAX_SPP: u64 = 4;
pub(super) const MIN_SPP: u64 = 2;
/// Tiles that a trial has at least, if the film does.
const FEWEST_TILES: u64 = 8;

/// How large a trial is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scope {
    /// One tile in so many,
    pub share: u32,
    /// and so many samples of each of their pixels by each point set.
    pub samples: u64,
}

/// Tiles rendered one way.
pub(super) struct Way {
    /// By point set.
    pub tiles: Vec<Vec<Tile>>,
    /// What manifold next-event estimation brought in each tile, by the first set.
    pub gains: Vec<RateStatistics>,
    /// Rays a path.
    pub rays: f64,
}

impl Way {
    /// Tile by tile, as both sets show it.
    pub fn pairs(&self) -> impl Iterator<Item = [&Tile; 2]> {
        let sets = self.tiles[0].iter().zip(&self.tiles[1]);
        sets.map(|(a, b)| [a, b])
    }
}

impl Scope {
    /// One for about so many paths of both sets together: many tiles rather than many samples, for
    /// an image has many places; at most an eighth of the film.
    pub fn new(film: &FilmDescription, paths: u64) -> Self {
        let all = Film::vacant(film.region());
        let tiles = all.tiles().len().max(1) as u64;
        let pixels: u64 = all.tiles().iter().map(|t| t.area() as u64).sum();
        let each = (pixels / tiles).max(1) * SETS.len() as u64;
        let most = (tiles / u64::from(SHARE))
            .max(FEWEST_TILES.min(tiles))
            .max(1);
        let samples = (paths / (each * most)).clamp(MIN_SPP, MAX_SPP);
        let wanted = (paths / (each * samples))
            .clamp(FEWEST_TILES.min(most), most)
            .max(1);
        Self {
            share: (tiles / wanted).max(1) as u32,
            samples,
        }
    }

    /// The tiles by both point sets.
    pub fn both(&self, job: &Job, film: &FilmDescription, guide: Option<Guidance>) -> Way {
        self.render(job, film, guide, &SETS)
    }

    /// The tiles by these point sets.
    pub fn render(
        &self,
        job: &Job,
        film: &FilmDescription,
        guide: Option<Guidance>,
        sets: &[u64],
    ) -> Way {
        let context = PathContext {
            guide,
            ..job.view.context()
        };
        let before = job.rays();
        let shard = Shard {
            index: 0,
            count: self.share,
        };
        let (mut tiles, mut gains, mut paths) = (Vec::new(), Vec::new(), 0);
        for &begin in sets {
            let mut film = Film::shard(film, shard);
            let found = take(job, &context, &mut film, begin..begin + self.samples);
            paths += film.held_pixels() * self.samples;
            let held = |tile: &&Tile| tile.is_held();
            tiles.push(film.tiles().iter().filter(held).cloned().collect());
            gains.push(found);
        }
        Way {
            tiles,
            gains: gains.swap_remove(0),
            rays: (job.rays() - before) as f64 / paths.max(1) as f64,
        }
    }

    /// The errors of a tile's pixels that both sets have rendered, each that of a single sample:
    /// squared, mean over the channels.
    pub fn errors<'t>(&self, [a, b]: [&'t Tile; 2]) -> impl Iterator<Item = f64> + use<'t> {
        let samples = self.samples as f64;
        a.pixels.iter().zip(&b.pixels).map(move |(p, q)| {
            let squares = p
                .mean()
                .into_iter()
                .zip(q.mean())
                .map(|(x, y)| (x - y).powi(2));
            samples * squares.sum::<f64>() / 6.0
        })
    }
}

/// Takes these samples of the tiles that a film holds; and what
/// manifold next-event estimation brought in each.
fn take(
    job: &Job,
    context: &PathContext,
    film: &mut Film,
    samples: Range<u64>,
) -> Vec<RateStatistics> {
    // A point set of its own.
    let iteration = Iteration::new(samples.start, None);
    let of_tile = |tile: &mut Tile| {
        let mut gains = RateStatistics::default();
        if !job.observer.should_stop() && !job.has_given_up() {
            let part = iteration.part(samples.clone(), 0);
            job.take_samples(context, tile, part, &mut gains, |_, _, _| {});
        }
        gains
    };
    let tiles = film.tiles_mut().par_iter_mut().with_max_len(1);
    tiles.filter(|tile| tile.is_held()).map(of_tile).collect()
}
