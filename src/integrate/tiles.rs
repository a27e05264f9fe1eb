//! The samples of a tile, a wave at a time.

use super::camera_sample::{Iteration, Start, TileSamples, add, first_ray};
use super::context::{PathContext, View};
use super::guiding::Guidance;
use super::observer::PathObserver;
use super::progress::{Observer, Spent};
use super::wave::{Outcomes, Wave};
use crate::film::filter::FilterSampler;
use crate::film::{Film, Tile};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Samples that travel together: enough to fill the ray tracer's packets after most paths have
/// ended, few enough for a core's second-level cache.
const WAVE_SAMPLES: u64 = 4096;
/// Edges of a path that say that it may have no end.
const VERY_LONG: u32 = 10_000;

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

    /// The same, whose paths may be given up after so much time if they have no end.
    pub(super) fn ending_at(self, time_is_up: Option<Instant>) -> Self {
        Self { time_is_up, ..self }
    }

    /// The same for the samples of another iteration, guided by another field or none.
    pub(super) fn go_on(self, iteration: Iteration, guide: Option<Guidance<'a>>) -> Self {
        let view = View { guide, ..self.view };
        Self {
            view,
            iteration,
            ..self
        }
    }

    /// Whether a wave was given up: the render ends, for the next would fare no better.
    pub(super) fn has_given_up(&self) -> bool {
        self.given_up.load(Ordering::Relaxed)
    }

    /// Whether the time is up.
    pub(super) fn is_late(&self) -> bool {
        let late = |at: Instant| Instant::now() >= at + self.observer.time_aside();
        self.time_is_up.is_some_and(late)
    }

    /// Whether to give up a wave whose paths go on after so many edges.
    fn gives_up(&self, edges: u32) -> bool {
        if edges >= VERY_LONG {
            self.observer.path_is_long(edges);
        }
        let ends = self.observer.should_stop() || self.is_late();
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

    /// Takes the samples of every pixel up to `end`. With `in_time`, tiles that have samples get no
    /// more once the time is up. `false` if that, or the observer, stopped or paused it before all
    /// tiles were there.
    pub(super) fn pass(&self, film: &mut Film, end: u64, in_time: bool) -> bool {
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
                if in_time && tile.done > 0 && self.is_late() {
                    return;
                }
                let part = self.iteration.part(range, number);
                self.render_tile(&self.view.context(), tile, part, &mut (), |(), _, _| {});
            });
        film.held().all(|t| t.done >= end)
    }

    /// Takes samples of a tile's pixels, a wave at a time, and adds those that the tile lacks, if
    /// the film holds it. All paths of a pixel's share of a wave stand next to each other: their
    /// camera rays make coherent packets. `conclude` sees every wave's outcomes after `observer`
    /// has watched it. Returns the number of the sample that would come next: the end of the part,
    /// unless a wave was given up.
    pub(super) fn take_samples<W: PathObserver>(
        &self,
        context: &PathContext,
        tile: &mut Tile,
        part: TileSamples,
        observer: &mut W,
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
            let extras = &self.view.film.extras;
            let outcomes = wave.trace_image(context, observer, (&origins, extras), &gives_up);
            let Some(outcomes) = outcomes else { break };
            conclude(observer, &outcomes, &starts);
            let samples = (outcomes.image, outcomes.first_hits);
            add(tile, samples, (outcomes.recorded, extras), &starts);
            from = to;
        }
        if let Ok(mut waves) = self.waves.lock() {
            waves.push(wave);
        }
        from
    }

    /// The same for samples of the image: the tile has taken them then.
    pub(super) fn render_tile<W: PathObserver>(
        &self,
        context: &PathContext,
        tile: &mut Tile,
        part: TileSamples,
        observer: &mut W,
        conclude: impl FnMut(&mut W, &Outcomes, &[Start]),
    ) {
        let end = self.take_samples(context, tile, part, observer, conclude);
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
        part: &TileSamples,
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
