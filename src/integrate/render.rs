//! The loop around everything: passes of samples over tiles of the film, until enough.

use super::PathSettings;
use super::guiding::Guidance;
use super::learn::Learner;
use super::record::Witness;
use super::start::{Iteration, Part, Start, add, first_ray};
use super::teach::teach;
use super::vertex::Walk;
use super::wave::{Outcomes, Wave};
use crate::camera::Camera;
use crate::film::filter::FilterSampler;
use crate::film::{Film, FilmDescription, Noise, Tile};
use crate::scene::Scene;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// When to stop: whichever comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Samples a pixel.
    pub spp: u64,
    /// Wall-clock time of rendering.
    pub time: Option<Duration>,
    /// Noise of the image (see [`Film::noise`]).
    pub noise: Option<f32>,
}

impl Limits {
    /// Whether the noise after `spp` samples a pixel is as low as was asked for.
    pub(super) fn are_met_by_noise(&self, spp: u64, noise: Option<Noise>) -> bool {
        let target = self.noise.filter(|_| spp >= MIN_SPP_FOR_NOISE);
        target.is_some_and(|target| noise.is_some_and(|n| n.at_most() <= target))
    }
}

/// What stopped a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoppedBy {
    /// All samples were taken.
    Samples,
    /// The time was up.
    Time,
    /// The image was clean enough.
    Noise,
    /// The observer asked for it.
    Interrupt,
}

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Samples a pixel finished.
    pub spp: u64,
    /// Samples a pixel at most.
    pub spp_limit: u64,
    /// Samples taken over the whole film.
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Time since rendering began.
    pub elapsed: Duration,
    /// Noise, once there are enough samples to tell.
    pub noise: Option<Noise>,
}

/// Who watches a render. Called from the rendering threads between passes.
pub trait Observer: Sync {
    /// A pass over the whole film is done.
    fn pass_done(&self, progress: &Progress, film: &Film);
    /// A tile has got `samples` more. Called from many threads at once.
    fn tile_done(&self, samples: u64) {
        let _ = samples;
    }
    /// Asked before every tile: `true` ends the render soon.
    fn should_stop(&self) -> bool;
    /// Asked before every tile: `true` halts the render after the tiles in flight, so that
    /// [`Observer::paused`] sees a film that nobody is at. It then goes on where it was.
    fn should_pause(&self) -> bool {
        false
    }
    /// A path goes on after so many edges. Called from many threads at once, and more than once.
    fn path_is_long(&self, edges: u32) {
        let _ = edges;
    }
    /// Paths without an end in sight were given up, for the render is to end: their samples, and those that were
    /// traced with them, are left out.
    fn gave_up(&self) {}
    /// Time that [`Observer::pass_done`] has kept the render waiting for matters of its own: it does not
    /// count as rendering.
    fn time_aside(&self) -> Duration {
        Duration::ZERO
    }
    /// The render has halted.
    fn paused(&self, spent: &Spent, film: &Film) {
        let _ = (spent, film);
    }
}

/// What a render has cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spent {
    /// Wall-clock time.
    pub time: Duration,
    /// Rays traced, shadow rays included.
    pub rays: u64,
}

/// What a render came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Why it ended.
    pub stopped_by: StoppedBy,
    /// Samples a pixel.
    pub spp: u64,
    /// Samples taken over the whole film.
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Wall-clock time.
    pub elapsed: Duration,
    /// Noise at the end.
    pub noise: Option<Noise>,
}

/// Samples that travel together: enough to fill the ray tracer's packets after most paths have ended,
/// few enough for a core's second-level cache.
const WAVE_SAMPLES: u64 = 4096;
/// Edges of a path that say that it may have no end.
const VERY_LONG: u32 = 10_000;
/// Most samples a pixel takes in one pass: the interval between looks at the clock.
pub(super) const PASS_SPP: u64 = 64;

/// What is rendered, and how.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// From where.
    pub camera: &'a Camera,
    /// Size and filter of the film.
    pub film: &'a FilmDescription,
    /// How paths are traced.
    pub settings: &'a PathSettings,
    /// A learned field, to guide by.
    pub guide: Option<Guidance<'a>>,
}

impl<'a> View<'a> {
    /// What its paths share.
    pub fn walk(&self) -> Walk<'a> {
        Walk {
            scene: self.scene,
            settings: self.settings,
            guide: self.guide,
        }
    }
}

/// Renders until a limit is reached: the tiles that `film` holds, from the first sample on.
pub fn render(view: &View, film: &mut Film, limits: &Limits, observer: &dyn Observer) -> Summary {
    resume(view, None, film, limits, Spent::default(), observer)
}

/// Renders on from where `film` is, at a cost of `before` so far, until a limit is reached. Tiles may be
/// at different samples: each goes on at its own. Sums grow in sample order, so that the film becomes
/// what it would have become without the interruption.
///
/// With a `learner`, the first passes teach it and are guided by it, whatever guide the view has. What it
/// learns must not depend on which tiles the film holds, nor on where it was interrupted: these passes are
/// traced from the first on and over the whole film, and fill what is missing in the tiles held.
pub fn resume(
    view: &View,
    mut learner: Option<&mut Learner>,
    film: &mut Film,
    limits: &Limits,
    before: Spent,
    observer: &dyn Observer,
) -> Summary {
    let start = Instant::now();
    let elapsed = || before.time + start.elapsed().saturating_sub(observer.time_aside());
    let job = Job {
        time_is_up: limits.time.map(|t| start + t.saturating_sub(before.time)),
        ..Job::new(view, observer, before.rays)
    };
    let iteration = learner
        .as_deref_mut()
        .map(|learner| teach(&job, learner, film, limits, &elapsed));
    let job = Job {
        view: View {
            guide: learner.map_or(view.guide, |l| l.worthwhile_guide().map(Into::into)),
            ..*view
        },
        iteration: iteration.unwrap_or_default(),
        ..job
    };
    let mut spp = film.spp_done();
    // Between passes, where a render that was never interrupted looks at the noise.
    let between = film.held().all(|tile| tile.done == spp);
    let mut noise = film.noise().filter(|_| spp > 0 && between);
    let stopped_by = loop {
        if spp >= limits.spp {
            break StoppedBy::Samples;
        }
        if limits.are_met_by_noise(spp, noise) {
            break StoppedBy::Noise;
        }
        let pass = pass_size(spp, limits, elapsed());
        if pass == 0 {
            break StoppedBy::Time;
        }
        while !job.pass(film, spp + pass) && !observer.should_stop() && !job.has_given_up() {
            observer.paused(&job.spent(elapsed()), film);
        }
        if film.spp_done() < spp + pass {
            break match observer.should_stop() {
                true => StoppedBy::Interrupt,
                false => StoppedBy::Time,
            };
        }
        spp += pass;
        noise = film.noise();
        let progress = Progress {
            spp,
            spp_limit: limits.spp,
            samples: film.samples_done(),
            rays: job.spent(elapsed()).rays,
            elapsed: elapsed(),
            noise,
        };
        observer.pass_done(&progress, film);
    };
    let samples = film
        .tiles()
        .iter()
        .flat_map(|t| &t.pixels)
        .map(|p| p.count)
        .sum();
    Summary {
        stopped_by,
        spp,
        samples,
        rays: job.spent(elapsed()).rays,
        elapsed: elapsed(),
        noise,
    }
}

/// Below this many samples a pixel's own variance is not to be trusted.
const MIN_SPP_FOR_NOISE: u64 = 16;

/// Samples a pixel for the next pass: doubling from 1, bounded so that the time limit is met within
/// an eighth of what is left; 0 when the time is up.
fn pass_size(done: u64, limits: &Limits, elapsed: Duration) -> u64 {
    let doubled = done.clamp(1, PASS_SPP).min(limits.spp - done);
    let Some(time) = limits.time else {
        return doubled;
    };
    let left = time.saturating_sub(elapsed).as_secs_f64();
    if left <= 0.0 && done > 0 {
        return 0;
    }
    if done == 0 {
        return 1;
    }
    let per_sample = elapsed.as_secs_f64() / done as f64;
    if left < 0.5 * per_sample {
        return 0;
    }
    doubled.min((left / per_sample / 8.0).ceil().max(1.0) as u64)
}

/// What every tile of a render shares.
pub(super) struct Job<'a> {
    pub(super) view: View<'a>,
    filter: FilterSampler,
    pub(super) observer: &'a dyn Observer,
    /// Which paths the pixels take.
    iteration: Iteration,
    /// Rays that an earlier go has traced.
    rays_before: u64,
    /// Buffers not in use.
    waves: Mutex<Vec<Wave>>,
    /// When paths that have no end may be given up, by the clock.
    time_is_up: Option<Instant>,
    given_up: AtomicBool,
}

impl<'a> Job<'a> {
    pub(super) fn new(view: &View<'a>, observer: &'a dyn Observer, rays_before: u64) -> Self {
        Self {
            view: *view,
            filter: FilterSampler::new(view.film.filter),
            observer,
            iteration: Iteration::default(),
            rays_before,
            waves: Mutex::new(Vec::new()),
            time_is_up: None,
            given_up: AtomicBool::new(false),
        }
    }

    /// Whether a wave was given up: the render ends, for the next would fare no better.
    pub(super) fn has_given_up(&self) -> bool {
        self.given_up.load(Ordering::Relaxed)
    }

    /// Whether to give up a wave whose paths go on after so many edges.
    fn gives_up(&self, edges: u32) -> bool {
        if edges >= VERY_LONG {
            self.observer.path_is_long(edges);
        }
        let aside = || self.observer.time_aside();
        let late = |at: Instant| Instant::now() >= at + aside();
        let ends = self.observer.should_stop() || self.time_is_up.is_some_and(late);
        if ends && !self.given_up.swap(true, Ordering::Relaxed) {
            self.observer.gave_up();
        }
        ends
    }

    /// Rays traced in this go, by waves that are not in use.
    pub(super) fn rays(&self) -> u64 {
        let waves = self.waves.lock();
        waves.map_or(0, |waves| waves.iter().map(Wave::rays_traced).sum())
    }

    /// What the render has cost after `time`.
    pub(super) fn spent(&self, time: Duration) -> Spent {
        Spent {
            time,
            rays: self.rays_before + self.rays(),
        }
    }

    /// Takes the samples of every pixel up to `end`. `false` if the observer stopped or paused it before
    /// all tiles were there.
    fn pass(&self, film: &mut Film, end: u64) -> bool {
        film.tiles_mut()
            .par_iter_mut()
            .enumerate()
            .with_max_len(1)
            .for_each(|(number, tile)| {
                let range = tile.done..end;
                if !tile.is_held() || range.is_empty() {
                    return;
                }
                let observer = self.observer;
                if observer.should_stop() || observer.should_pause() || self.has_given_up() {
                    return;
                }
                let part = self.iteration.part(range, number);
                self.render_tile(&self.view.walk(), tile, part, &mut (), |(), _, _| {});
            });
        film.held().all(|t| t.done >= end)
    }

    /// Takes samples of a tile's pixels, a wave at a time, and adds those that the tile lacks,
    /// if the film holds it. All paths of a pixel's share of a wave stand next to each other: their
    /// camera rays make coherent packets. `conclude` sees every wave's outcomes after `witness` has
    /// watched it. Returns the number of the sample that would come next: the end of the part, unless a wave was
    /// given up.
    pub(super) fn take_samples<W: Witness>(
        &self,
        walk: &Walk,
        tile: &mut Tile,
        part: Part,
        witness: &mut W,
        mut conclude: impl FnMut(&mut W, &Outcomes, &[Start]),
    ) -> u64 {
        // A thread that panicked left a wave behind that nobody will read: go on with a new one.
        let idle = self.waves.lock().map_or(None, |mut w| w.pop());
        let mut wave = idle.unwrap_or_default();
        let per_wave = part.samples_of(WAVE_SAMPLES, tile);
        let mut from = part.samples.start;
        let (mut starts, mut origins) = (Vec::new(), Vec::new());
        while from < part.samples.end {
            let to = (from + per_wave).min(part.samples.end);
            self.begin(tile, &part, from..to, &mut wave, &mut starts);
            origins.clear();
            origins.extend(starts.iter().map(Start::origin));
            let gives_up = |edges| self.gives_up(edges);
            let outcomes = wave.trace_image(walk, witness, &origins, &gives_up);
            let Some(outcomes) = outcomes else { break };
            conclude(witness, &outcomes, &starts);
            add(tile, outcomes.image, &starts);
            from = to;
        }
        if let Ok(mut waves) = self.waves.lock() {
            waves.push(wave);
        }
        from
    }

    /// The same for samples of the image: the tile has taken them then.
    pub(super) fn render_tile<W: Witness>(
        &self,
        walk: &Walk,
        tile: &mut Tile,
        part: Part,
        witness: &mut W,
        conclude: impl FnMut(&mut W, &Outcomes, &[Start]),
    ) {
        let end = self.take_samples(walk, tile, part, witness, conclude);
        if tile.is_held() && tile.done < end {
            let samples = (end - tile.done) * tile.area() as u64;
            self.observer.tile_done(samples);
            tile.done = end;
        }
    }

    /// Fills a wave with the paths of all pixels for some samples.
    fn begin(
        &self,
        tile: &Tile,
        part: &Part,
        samples: Range<u64>,
        wave: &mut Wave,
        starts: &mut Vec<Start>,
    ) {
        wave.clear();
        starts.clear();
        let places = (0..tile.area()).map(|pixel| (pixel as u32, tile.place(pixel)));
        for (pixel, place) in places {
            for mut start in samples
                .clone()
                .flat_map(|sample| part.starts(pixel, sample))
            {
                let (ray, sampler, weight) = first_ray(&self.view, &self.filter, place, start.path);
                wave.push(ray, sampler);
                start.weight = weight;
                starts.push(start);
            }
        }
    }
}
