//! Does guiding pay? A small trial during learning tells.
//!
//! Where next-event estimation and the BSDF find the light by themselves, a field only costs time. After
//! the first passes have taught it, an eighth of the tiles is rendered twice more, with the field and
//! without, into films that are thrown away. What counts is relative variance times cost. The decision has
//! to be the same on every machine, so cost is counted in rays, not read from a clock.
//!
//! A few samples say little about a sampler that finds a caustic once in ten thousand: it looks clean
//! until then. So guiding is stopped only where there is nothing to be afraid of: where the worst pixels,
//! which are left out of the comparison, do not outweigh all others, and where the unguided image does not
//! lack light that the guided one has. Measured after 4 samples of learning, as the ratio of unguided to
//! guided variance without the worst pixels, and how much the worst add to either: cornell 1.6, 1.1; exact
//! 0.92, 2.0; materials 0.83, 5.6; torus 0.82, 970; lux-pool 0.39, 310; cbox-caustics 1.4, 260. The last
//! three are where guiding gains most.

use super::chain::pays::{self, Gains};
use super::guiding::Guide;
use super::render::{Job, Observer, Progress, View};
use super::start::Iteration;
use super::vertex::Walk;
use crate::film::{FLOOR, Film, FilmDescription, Pixel, Shard, Tile};
use rayon::prelude::*;
use std::ops::Range;

/// Samples a pixel that must have taught the field before the trial.
pub const AFTER: u64 = 4;
/// The trial's tiles: one in so many.
const SHARE: u32 = 8;
/// The trial's samples: numbers that no image reaches.
const SAMPLES: Range<u64> = 1 << 40..(1 << 40) + 8;
/// A guided ray costs about this many unguided ones (1.3 in torus to 3.1 in an empty box, measured as rays
/// a second with and without `--guide double`).
const COST: f64 = 2.0;
/// The field is still learning: it may be behind by this factor and go on.
const PATIENCE: f64 = 1.25;
/// More light than this share found by guiding alone is more than chance.
const MISSED: f64 = 0.02;

/// Share of the pixels that count as the worst.
const WORST: f64 = 0.01;
/// The worst pixels outweigh the others when with them the mean is this many times larger.
const HEAVY: f64 = 10.0;

/// What the trial found.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Verdict {
    /// Mean relative variance of a guided sample, without the worst pixels.
    pub guided: f64,
    /// The same without guiding.
    pub unguided: f64,
    /// How much larger the means are with the worst pixels; the larger of the two ratios.
    pub tail: f64,
    /// Rays of a guided path.
    pub guided_rays: f64,
    /// Rays of an unguided path.
    pub unguided_rays: f64,
    /// Mean of the unguided image over that of the guided one.
    pub light_found: f64,
}

impl Verdict {
    /// How much less work guiding takes to the same error: above 1 it pays.
    pub fn gain(&self) -> f64 {
        let cost = |variance: f64, rays: f64| (variance * rays).max(f64::MIN_POSITIVE);
        cost(self.unguided, self.unguided_rays) / cost(self.guided, COST * self.guided_rays)
    }

    /// Whether to go on guiding.
    pub fn pays(&self) -> bool {
        // Nothing to tell apart: a black image, or no light at all.
        let even = self.guided <= 0.0 && self.unguided <= 0.0;
        even || self.tail > HEAVY || self.is_ahead() || self.light_found < 1.0 - MISSED
    }

    /// Whether guiding is ahead but for the worst pixels, or may soon be.
    pub fn is_ahead(&self) -> bool {
        self.gain() * PATIENCE >= 1.0
    }
}

/// Renders the trial's tiles both ways. What came of it, and how often it pays to aim at suns and lamps.
pub(super) fn trial(job: &Job, film: &FilmDescription, guide: &Guide) -> (Verdict, f32) {
    let (guided, guided_rays) = half(job, film, Some(guide));
    let (unguided, unguided_rays) = half(job, film, None);
    let mut verdict = Verdict {
        guided_rays,
        unguided_rays,
        ..Verdict::default()
    };
    let (mut light, mut light_unguided) = (0.0, 0.0);
    let mut aims = pays::Trial::default();
    let (mut of_guided, mut of_unguided) = (Vec::new(), Vec::new());
    for ((a, found), (b, _)) in guided.iter().zip(&unguided) {
        let (mean, mean_unguided) = (mean(a), mean(b));
        light += mean * a.area() as f64;
        light_unguided += mean_unguided * b.area() as f64;
        let scale = scale(0.5 * (mean + mean_unguided));
        aims.add(found, scale.sqrt());
        of_guided.extend(a.pixels.iter().map(|p| variance(p) / scale));
        of_unguided.extend(b.pixels.iter().map(|p| variance(p) / scale));
    }
    let (tail, tail_unguided);
    (verdict.guided, tail) = trimmed(&mut of_guided);
    (verdict.unguided, tail_unguided) = trimmed(&mut of_unguided);
    verdict.tail = tail.max(tail_unguided);
    verdict.light_found = if light > 0.0 {
        light_unguided / light
    } else {
        1.0
    };
    (
        verdict,
        aims.best(samples(&of_guided), verdict.guided, guided_rays),
    )
}

/// How often it pays to aim at suns and lamps where a view is guided by a field that was learned before.
pub fn aim(view: &View, guide: &mut Guide) {
    if guide.aiming.is_none() {
        return;
    }
    let observer = Unwatched;
    let job = Job::new(view, &observer, 0);
    let (tiles, rays) = half(&job, view.film, Some(guide));
    let mut aims = pays::Trial::default();
    let mut variances = Vec::new();
    for (tile, found) in &tiles {
        let scale = scale(mean(tile));
        aims.add(found, scale.sqrt());
        variances.extend(tile.pixels.iter().map(|p| variance(p) / scale));
    }
    let (variance, _) = trimmed(&mut variances);
    guide.aim(aims.best(samples(&variances), variance, rays));
}

/// Nobody looks on.
struct Unwatched;

impl Observer for Unwatched {
    fn pass_done(&self, _: &Progress, _: &Film) {}
    fn should_stop(&self) -> bool {
        false
    }
}

/// The trial's tiles rendered one way, and rays a path.
fn half(job: &Job, film: &FilmDescription, guide: Option<&Guide>) -> (Vec<(Tile, Gains)>, f64) {
    let shard = Shard {
        index: 0,
        count: SHARE,
    };
    let mut film = Film::shard(film, shard);
    let walk = Walk {
        guide: guide.map(Into::into),
        ..job.view.walk()
    };
    let before = job.rays();
    let trial = Iteration::new(SAMPLES.start, None);
    let gains: Vec<Gains> = film
        .tiles_mut()
        .par_iter_mut()
        .with_max_len(1)
        .map(|tile| {
            let mut gains = Gains::default();
            let ends = job.observer.should_stop() || job.has_given_up();
            if tile.is_held() && !ends {
                let part = trial.part(SAMPLES, 0);
                job.take_samples(&walk, tile, part, &mut gains, |_, _, _| {});
            }
            gains
        })
        .collect();
    let paths = (film.held_pixels() * (SAMPLES.end - SAMPLES.start)).max(1);
    let rays = (job.rays() - before) as f64 / paths as f64;
    let tiles = film.tiles().iter().cloned().zip(gains);
    let tiles = tiles.filter(|(tile, _)| tile.is_held());
    (tiles.collect(), rays)
}

/// Samples of all these pixels.
fn samples(pixels: &[f64]) -> f64 {
    pixels.len() as f64 * (SAMPLES.end - SAMPLES.start) as f64
}

/// What a variance is relative to in a tile of this mean.
fn scale(mean: f64) -> f64 {
    mean.powi(2) + FLOOR
}

/// Mean of a tile over pixels and channels.
fn mean(tile: &Tile) -> f64 {
    let sum: f64 = tile
        .pixels
        .iter()
        .map(|p| p.mean().iter().sum::<f64>())
        .sum();
    sum / (3 * tile.pixels.len().max(1)) as f64
}

/// Variance of a sample, mean over the channels.
fn variance(pixel: &Pixel) -> f64 {
    pixel.variance_of_mean().iter().sum::<f64>() * pixel.count as f64 / 3.0
}

/// The mean without the worst, and how much larger it is with them.
fn trimmed(values: &mut [f64]) -> (f64, f64) {
    values.sort_unstable_by(f64::total_cmp);
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len().max(1) as f64;
    let most = values.len() - (values.len() as f64 * WORST).ceil() as usize;
    let (with, without) = (mean(values), mean(&values[..most]));
    let tail = if with > 0.0 { with / without } else { 1.0 };
    (without, tail)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_pixel_in_a_hundred_is_left_out() {
        let mut values = vec![2.0; 200];
        (values[17], values[80]) = (1e3, 3e3);
        let (mean, tail) = trimmed(&mut values);
        assert!((mean - 2.0).abs() < 1e-12);
        assert!((tail - (198.0 * 2.0 + 4e3) / 200.0 / 2.0).abs() < 1e-9);
        assert_eq!(trimmed(&mut []), (0.0, 1.0));
        assert_eq!(trimmed(&mut [0.0; 5]), (0.0, 1.0));
    }

    #[test]
    fn guiding_stops_where_it_is_beaten_unless_light_is_missed() {
        let even = Verdict {
            guided: 1.0,
            unguided: 2.0,
            guided_rays: 5.0,
            unguided_rays: 5.0,
            tail: 1.5,
            light_found: 1.0,
        };
        assert!((even.gain() - 1.0).abs() < 1e-12 && even.pays());
        let beaten = Verdict {
            unguided: 1.0,
            ..even
        };
        assert!((beaten.gain() - 0.5).abs() < 1e-12 && !beaten.pays());
        let dark = Verdict {
            light_found: 0.9,
            ..beaten
        };
        assert!(dark.pays());
        let wild = Verdict {
            tail: 50.0,
            ..beaten
        };
        assert!(wild.pays());
        assert!(Verdict::default().pays());
    }
}
