//! The first passes of a guided render: they teach the field while they draw the image, and tell
//! where the noise is.
//!
//! A pass is guided by what the passes before it have taught, so each is an unbiased estimate given
//! the ones before, and so is their sum. Passes double: the samples of the early ones, which know
//! little, are soon few beside the rest.

use super::learner::Learner;
use super::record::{PathRecords, TrainingSamples};
use super::trial::{Verdict, trial};
use crate::film::Film;
use crate::integrate::adaptive::{self, Survey};
use crate::integrate::camera_sample::Iteration;
use crate::integrate::context::PathContext;
use crate::integrate::guiding::Guidance;
use crate::integrate::progress::{Learning, Limits, PASS_SPP, Progress};
use crate::integrate::tiles::Job;
use rayon::prelude::*;
use std::ops::Range;
use std::time::Duration;

/// Renders passes and teaches the learner, until it wants no more or a limit is reached. The
/// passes' sizes depend on the limit in samples alone; when the time gets short, learning ends
/// early. Returns the iteration that comes next.
pub(in crate::integrate) fn train_passes(
    job: &Job,
    learner: &mut Learner,
    film: &mut Film,
    limits: &Limits,
    elapsed: &dyn Fn() -> Duration,
) -> Iteration {
    let pixels = u64::from(film.width()) * u64::from(film.height());
    let mut told = PassRecords::new(job, film);
    let mut iteration = Iteration::default();
    let mut from = 0;
    while wants_more(job, learner, from, limits) && from < limits.spp {
        let begin = elapsed();
        let to = from + from.clamp(1, PASS_SPP).min(limits.spp - from);
        let paths = pixels * (to - from);
        let stride = paths.div_ceil(learner.most_training_paths());
        let guide = (learner.guide(), stride as u32);
        if !pass(job, film, (from..to, &iteration), guide, &mut told) || to == limits.spp {
            return iteration;
        }
        if learner.wants_more() {
            job.observer.learns(Learning::Paths);
            learner.take(&mut told.training_samples, paths / stride);
            job.observer.draws(learner.share_learned());
        }
        from = to;
        if learner.is_to_be_judged(from, pixels) {
            job.observer.learns(Learning::Trial);
            let paths = learner.trial_paths();
            let (verdict, rate) = trial(job, job.view.film, learner.guide(), paths);
            job.observer.draws(learner.share_learned());
            job.observer.learns(Learning::Photons);
            learner.judge(
                &job.view,
                Verdict {
                    after: from,
                    ..verdict
                },
            );
            learner.set_manifold_rate(rate);
            job.observer.draws(learner.share_learned());
        }
        let spreads = job.view.settings.guided.adaptive && from >= adaptive::FIRST;
        let shares = spreads.then(|| told.survey.shares(film, from, &iteration));
        iteration = Iteration::new(from, shares);
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
        // The next pass takes twice as long.
        let time_is_short = |t| elapsed() + 2 * (elapsed() - begin) > t;
        if limits.are_met_by_noise(progress.spp, progress.noise)
            || limits.time.is_some_and(time_is_short)
        {
            break;
        }
    }
    iteration
}

/// Whether another pass is to teach the field, or to tell how to spread the samples to come.
fn wants_more(job: &Job, learner: &Learner, done: u64, limits: &Limits) -> bool {
    let guides = learner.worthwhile_guide().is_some();
    let surveys = job.view.settings.guided.adaptive && guides && learner.has_taken_paths();
    let few = done < adaptive::FEWEST && 2 * adaptive::FEWEST <= limits.spp;
    learner.wants_more() || surveys && few
}

/// What a pass tells, in memory that is kept from pass to pass.
struct PassRecords {
    /// For the field, tile by tile.
    training_samples: Vec<TrainingSamples>,
    /// For the shares of the pixels.
    survey: Survey,
}

impl PassRecords {
    fn new(job: &Job, film: &Film) -> Self {
        let mut training_samples = Vec::new();
        training_samples.resize_with(film.tiles().len(), TrainingSamples::default);
        Self {
            training_samples,
            survey: Survey::new(film, job.view.settings.seed),
        }
    }
}

/// Takes the samples `range` of an iteration, guided by `guide`; one in `stride` teaches, tile by
/// tile. `false` if the observer stopped it before all tiles were there.
fn pass(
    job: &Job,
    film: &mut Film,
    (range, iteration): (Range<u64>, &Iteration),
    (guide, stride): (Guidance, u32),
    told: &mut PassRecords,
) -> bool {
    let context = PathContext {
        guide: Some(guide),
        ..job.view.context()
    };
    film.tiles_mut()
        .par_iter_mut()
        .zip(&mut told.training_samples)
        .zip(&mut told.survey.tiles)
        .enumerate()
        .with_max_len(1)
        .all(|(number, ((tile, training_samples), survey))| {
            if job.observer.should_stop() || job.has_given_up() {
                return false;
            }
            training_samples.clear();
            let mut records = PathRecords::every(stride);
            let part = iteration.part(range.clone(), number);
            job.render_tile(
                &context,
                tile,
                part,
                &mut records,
                |records, outcomes, starts| {
                    records.conclude(outcomes.own, training_samples);
                    survey.add_rays(outcomes.rays, starts.len());
                    for (radiance, start) in outcomes.image.iter().zip(starts) {
                        let weighted = *radiance * start.weight;
                        survey.add(start.pixel as usize, weighted, start.worth);
                    }
                },
            );
            !job.has_given_up()
        })
}
