//! The loop around everything: passes of samples over tiles of the film, until enough.

use super::context::View;
use super::progress::{Limits, Observer, PASS_SPP, Progress, Spent, StoppedBy, Summary};
use super::tiles::Job;
use super::training::{Learner, train_passes};
use crate::film::Film;
use std::time::{Duration, Instant};

/// Renders until a limit is reached: the tiles that `film` holds, from the first sample on.
pub fn render(view: &View, film: &mut Film, limits: &Limits, observer: &dyn Observer) -> Summary {
    resume(view, None, film, limits, Spent::default(), observer)
}

/// Renders on from where `film` is, at a cost of `before` so far, until a limit is reached. Tiles
/// may be at different samples: each goes on at its own. Sums grow in sample order, so that the
/// film becomes what it would have become without the interruption.
///
/// With a `learner`, the first passes teach it and are guided by it, whatever guide the view has.
/// What it learns must not depend on which tiles the film holds, nor on where it was interrupted:
/// these passes are traced from the first on and over the whole film, and fill what is missing in
/// the tiles held.
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
    let time_is_up = limits.time.map(|t| start + t.saturating_sub(before.time));
    let job = Job::new(view, observer, before.rays).ending_at(time_is_up);
    let iteration = learner
        .as_deref_mut()
        .map(|learner| train_passes(&job, learner, film, limits, &elapsed));
    let guide = learner.map_or(view.guide, |l| l.worthwhile_guide());
    let job = job.go_on(iteration.unwrap_or_default(), guide);
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
