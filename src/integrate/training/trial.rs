//! Does guiding pay? A small trial during learning tells.
//!
//! Where next-event estimation and the BSDF find the light by themselves, a field only costs time.
//! After the first training samples some of the tiles are rendered with the field and without, into
//! films that are thrown away: by numbers that no image uses, so that what is decided depends on no
//! sample that is kept. Each way is rendered twice, by point sets that know nothing of each other:
//! half the square of the difference is the error of a pixel as it comes out, with what Sobol
//! points gain over independent ones and with what neighbours share. What counts is that error,
//! relative to the tile, times what a path costs (see [`super::effort`]).
//!
//! The worst pixels count, too, but none for more than chance may give it: a pixel's error is cut
//! at the mean of the others times the cube root of their number, the same for both ways.
//!
//! A few samples say little about a sampler that finds a caustic once in ten thousand: it looks
//! clean until then. So guiding is stopped only where the worst pixels do not outweigh all others
//! and both images show the same light.

mod scope;

use super::effort;
use super::importance::FAR;
use crate::film::{FLOOR, Film, FilmDescription, Pixel, Tile};
use crate::guide::Cells;
use crate::integrate::context::View;
use crate::integrate::guiding::{Guidance, Guide};
use crate::integrate::manifold::rate::RateTrial;
use crate::integrate::progress::{Observer, Progress};
use crate::integrate::settings::PathSettings;
use crate::integrate::tiles::Job;
use scope::{SETS, Scope};

/// The field is still learning, and errors that are cut hide a part of what it gains: it may be
/// behind by this factor and go on, at first and when it is tried again. The gains that
/// trials found beside those of whole renders are in `EXPERIMENTS.md`.
const PATIENCE: [f64; 2] = [1.6, 1.5];
/// Relative error of an unguided sample, squared, below which no field pays: a guided sample takes
/// more than twice the time. (`tests/bench/regret.py`: terrace 0.07 and office 0.17, where guiding
/// has 0.45 and 0.74 of the efficiency; Cornell box 0.37, where it has 3 times; patch of sun 1.8,
/// corridor 23, where it has 1.8 and 8 times.) There a trial is not given [`PATIENCE`]
/// (`tests/bench/default.py`: glass and metal under a sky).
pub(super) const EASY: f64 = 0.25;
/// It is tried again where it is not ahead by this factor.
const CLEAR: f64 = 1.5;
/// Both ways find the same light: their images' means differ by no more than this share, one
/// standard error included. Else light is so rare for one of them that a trial cannot tell what it
/// costs to find. (Office, terrace, bathroom, `furnace`, `materials`, `exact`: within 0.03; glass,
/// a skylight, a pool, lamps behind a shade, a door ajar: 0.05 to 0.8.)
const SAME_LIGHT: f64 = 0.05;

/// Share of the pixels that count as the worst.
const WORST: f64 = 0.01;
/// The worst pixels outweigh the others when with them the mean is this many times larger. (In
/// rooms with windows or lamps 1.1 to 2.5, with lamps that shine from behind something 4 to 9, with
/// glass 6 to 11.)
pub(super) const HEAVY: f64 = 4.0;
/// Guiding goes on because of the worst pixels only if with it they enlarge the mean by a factor
/// that is smaller by this much. (tests/bench/regret.py compares the verdict with both ways.)
const CALMER: f64 = 1.5;
/// Relative error of a sample, squared, that nobody sees: a tail is measured against no less.
/// Where an even sky lights a cube all samples of a face are the same, and its edges outweigh
/// that by any factor.
const CLEAN: f64 = 0.01;

/// What the trial found.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Verdict {
    /// Samples of every pixel that had taught by then.
    pub after: u64,
    /// Whether it was tried before.
    pub again: bool,
    /// Mean relative error of a guided sample, squared.
    pub guided: f64,
    /// The same without guiding.
    pub unguided: f64,
    /// How much larger the mean is with the worst pixels, without guiding.
    pub tail: f64,
    /// The same with guiding.
    pub guided_tail: f64,
    /// Rays of a guided path.
    pub guided_rays: f64,
    /// Rays of an unguided path.
    pub unguided_rays: f64,
    /// Mean of the unguided image over that of the guided one.
    pub light_found: f64,
    /// Standard error of that.
    pub light_found_error: f64,
}

impl Verdict {
    /// How much less work guiding takes to the same error: above 1 it pays.
    pub fn gain(&self) -> f64 {
        let cost = |error: f64, path: f64| (error * path).max(f64::MIN_POSITIVE);
        cost(self.unguided, effort::path(self.unguided_rays))
            / cost(
                self.guided,
                effort::guided_path(self.guided_rays, self.unguided_rays),
            )
    }

    /// Whether to go on guiding.
    pub fn pays(&self) -> bool {
        // Nothing to tell apart: a black image, or no light at all.
        let even = self.guided <= 0.0 && self.unguided <= 0.0;
        let fear = self.tail > HEAVY && self.guided_tail * CALMER < self.tail;
        let apart = (self.light_found - 1.0).abs() + self.light_found_error;
        even || fear || apart > SAME_LIGHT || self.may_catch_up()
    }

    /// Whether guiding is ahead, or so little behind that it may soon be.
    pub fn may_catch_up(&self) -> bool {
        let patience = match self.unguided < EASY {
            true => 1.0,
            false => PATIENCE[usize::from(self.again)],
        };
        self.gain() * patience >= 1.0
    }

    /// Whether more training samples may change it.
    pub fn is_doubtful(&self) -> bool {
        !self.again && self.gain() < CLEAR
    }
}

/// Renders tiles both ways, each by about so many paths. What came of it, and the best rate of
/// manifold next-event estimation.
pub(super) fn trial(
    job: &Job,
    film: &FilmDescription,
    guide: Guidance,
    paths: u64,
) -> (Verdict, f32) {
    let scope = Scope::new(film, paths);
    let (guided, unguided) = (
        scope.both(job, film, Some(guide)),
        scope.both(job, film, None),
    );
    let mut verdict = Verdict {
        guided_rays: guided.rays,
        unguided_rays: unguided.rays,
        ..Verdict::default()
    };
    let mut light = Vec::new();
    let mut rates = RateTrial::default();
    let (mut of_guided, mut of_unguided, mut variances) = (Vec::new(), Vec::new(), Vec::new());
    for (a, b) in guided.pairs().zip(unguided.pairs()) {
        let (mean_a, mean_b) = (mean_of(a), mean_of(b));
        light.push([mean_a, mean_b].map(|mean| mean * a[0].area() as f64));
        let scale = scale(0.5 * (mean_a + mean_b));
        of_guided.extend(scope.errors(a).map(|e| e / scale));
        of_unguided.extend(scope.errors(b).map(|e| e / scale));
        variances.extend(a[0].pixels.iter().map(|p| variance(p) / scale));
    }
    for (tile, found) in guided.tiles[0].iter().zip(&guided.gains) {
        rates.add(found, scale(mean(tile)).sqrt());
    }
    (verdict.guided_tail, verdict.tail) = (tail(&mut of_guided), tail(&mut of_unguided));
    let most = most(&of_guided, &of_unguided);
    (verdict.guided, verdict.unguided) = (cut_mean(&of_guided, most), cut_mean(&of_unguided, most));
    (verdict.light_found, verdict.light_found_error) = ratio(&light);
    let samples = variances.len() as f64 * scope.samples as f64;
    let (variance, _) = trimmed(&mut variances);
    (verdict, rates.best(samples, variance, guided.rays))
}

/// The noise of an unguided sample: its mean relative error, squared, and how much larger that is
/// with the worst pixels; by about so many paths, none of them long.
pub(super) fn unguided_noise(view: &View, paths: u64) -> (f64, f64) {
    let settings = PathSettings {
        max_depth: view.settings.max_depth.min(FAR),
        ..view.settings.clone()
    };
    let view = View {
        settings: &settings,
        ..*view
    };
    let job = Job::new(&view, &Unwatched, 0);
    let scope = Scope::new(view.film, paths);
    let unguided = scope.both(&job, view.film, None);
    let mut errors = Vec::new();
    for pair in unguided.pairs() {
        let scale = scale(mean_of(pair));
        errors.extend(scope.errors(pair).map(|e| e / scale));
    }
    let tail = tail(&mut errors);
    (cut_mean(&errors, most(&errors, &[])), tail)
}

/// Finds the rate of manifold next-event estimation where a view is guided by a field that was
/// learned before.
pub fn try_manifold<F: Cells>(view: &View, guide: &mut Guide<F>)
where
    for<'a> Guidance<'a>: From<&'a Guide<F>>,
{
    if guide.manifold.is_none() {
        return;
    }
    let observer = Unwatched;
    let job = Job::new(view, &observer, 0);
    let scope = Scope::new(view.film, u64::MAX);
    let way = scope.render(&job, view.film, Some((&*guide).into()), &SETS[..1]);
    let mut rates = RateTrial::default();
    let mut variances = Vec::new();
    for (tile, found) in way.tiles[0].iter().zip(&way.gains) {
        let scale = scale(mean(tile));
        rates.add(found, scale.sqrt());
        variances.extend(tile.pixels.iter().map(|p| variance(p) / scale));
    }
    let samples = variances.len() as f64 * scope.samples as f64;
    let (variance, _) = trimmed(&mut variances);
    guide.set_manifold_rate(rates.best(samples, variance, way.rays));
}

/// The observer of a trial outside of a render: it never stops it.
struct Unwatched;

impl Observer for Unwatched {
    fn pass_done(&self, _: &Progress, _: &Film) {}
    fn should_stop(&self) -> bool {
        false
    }
}

/// What the second sums to over what the first sums to, and the standard error of that, by
/// linearisation: each tile's second less its first times the ratio has the mean 0. 1 where there
/// is nothing.
fn ratio(tiles: &[[f64; 2]]) -> (f64, f64) {
    let sum = |k: usize| tiles.iter().map(|t| t[k]).sum::<f64>();
    let (first, second) = (sum(0), sum(1));
    if first <= 0.0 {
        return (1.0, 0.0);
    }
    let ratio = second / first;
    let squares: f64 = tiles.iter().map(|t| (t[1] - ratio * t[0]).powi(2)).sum();
    (ratio, squares.sqrt() / first)
}

/// What an error is relative to in a tile of this mean.
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

/// Mean of a tile by both sets.
fn mean_of([a, b]: [&Tile; 2]) -> f64 {
    0.5 * (mean(a) + mean(b))
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
    (without, with.max(CLEAN) / without.max(CLEAN))
}

/// How much larger the mean is with the worst. Sorts.
fn tail(values: &mut [f64]) -> f64 {
    trimmed(values).1
}

/// What a pixel counts for at most: the mean of both ways' pixels without the worst, times the cube
/// root of their number. (With the square root of two thousand, the errors of an office by two ways
/// that differ by a tenth came out as 0.105 and 0.173 instead of 0.19 and 0.19.)
fn most(guided: &[f64], unguided: &[f64]) -> f64 {
    let mut all: Vec<f64> = guided.iter().chain(unguided).copied().collect();
    let root = (all.len() as f64).cbrt();
    trimmed(&mut all).0 * root
}

/// The mean of values, each cut at the most that it may be.
fn cut_mean(values: &[f64], most: f64) -> f64 {
    values.iter().map(|v| v.min(most)).sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests;
