//! The first passes of a guided render: they teach the field while they draw the image.
//!
//! A pass is guided by what the passes before it have taught, so each is an unbiased estimate given the
//! ones before, and so is their sum. Passes double: the samples of the early ones, which know little, are
//! soon few beside the rest.

use super::guiding::Guide;
use super::learn::Learner;
use super::record::{Lessons, Records};
use super::render::{Job, Limits, PASS_SPP, Progress};
use super::reuse;
use super::trial::{self, trial};
use super::vertex::Walk;
use crate::film::Film;
use rayon::prelude::*;
use std::ops::Range;
use std::time::Duration;

/// Most paths of a pass that teach. What more of them tell is not worth the memory, some 400 bytes each.
const MOST_PUPILS: u64 = 1 << 19;

/// Renders passes and teaches the learner, until it wants no more or a limit is reached. The passes' sizes
/// depend on the limit in samples alone; when the time gets short, learning ends early.
pub(super) fn teach(
    job: &Job,
    learner: &mut Learner,
    film: &mut Film,
    limits: &Limits,
    elapsed: &dyn Fn() -> Duration,
) {
    let pixels = u64::from(film.width()) * u64::from(film.height());
    // What the tiles teach, in memory that is kept from pass to pass.
    let mut lessons = Vec::new();
    let mut from = 0;
    while learner.wants_more() && from < limits.spp {
        let begin = elapsed();
        let to = from + from.clamp(1, PASS_SPP).min(limits.spp - from);
        let paths = pixels * (to - from);
        let stride = paths.div_ceil(MOST_PUPILS);
        if !pass(
            job,
            film,
            from..to,
            (learner.guide(), stride as u32),
            &mut lessons,
        ) {
            return;
        }
        if to == limits.spp {
            return;
        }
        learner.take(&lessons, paths / stride);
        from = to;
        if from == trial::AFTER {
            let (verdict, chance) = trial(job, job.view.film, learner.guide());
            learner.judge(verdict);
            learner.aim(chance);
        }
        let progress = Progress {
            spp: film.spp_done(),
            spp_limit: limits.spp,
            samples: film.samples_done(),
            rays: job.spent(elapsed()).rays,
            elapsed: elapsed(),
            noise: film.noise(),
        };
        job.observer.pass_done(&progress, film);
        if job.observer.should_pause() {
            job.observer.paused(&job.spent(elapsed()), film);
        }
        if limits.are_met_by_noise(progress.spp, progress.noise) {
            return;
        }
        // The next pass takes twice as long.
        let time_is_short = |t| elapsed() + 2 * (elapsed() - begin) > t;
        if limits.time.is_some_and(time_is_short) {
            return;
        }
    }
}

/// Takes the samples `range` of every pixel, guided by `guide`; one in `stride` teaches, tile by tile. `false` if
/// the observer stopped it before all tiles were there.
fn pass(
    job: &Job,
    film: &mut Film,
    range: Range<u64>,
    (guide, stride): (&Guide, u32),
    lessons: &mut Vec<Lessons>,
) -> bool {
    let settings = reuse::while_teaching(job.view.settings);
    let walk = Walk {
        settings: &settings,
        guide: Some(guide.into()),
        ..job.view.walk()
    };
    let tiles = film.tiles_mut();
    lessons.resize_with(tiles.len(), Lessons::default);
    tiles
        .par_iter_mut()
        .zip(lessons)
        .with_max_len(1)
        .all(|(tile, lessons)| {
            if job.observer.should_stop() {
                return false;
            }
            lessons.clear();
            let mut records = Records::every(stride);
            let range = range.clone();
            job.render_tile(&walk, tile, range, &mut records, |records, outcomes| {
                records.conclude(outcomes, lessons);
            });
            true
        })
}
