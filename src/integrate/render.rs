//! The loop around everything: passes of samples over tiles of the film, until enough.

use super::context::View;
use super::progress::{Limits, Observer, PASS_SPP, Progress, Spent, StoppedBy, Summary};
use super::tiles::Job;
use super::training::{Learner, train_passes};
use crate::film::Film;
use std::time::{Duration, Instant};

/// Where a sample of every pixel takes more than this share of the time, the last is left unfinished
/// when the time is up.
const COARSE: f64 = 0.1;

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
        let (pass, in_time) = pass_size(spp, limits, elapsed());
        if pass == 0 {
            break StoppedBy::Time;
        }
        let is_over = || observer.should_stop() || job.has_given_up() || in_time && job.is_late();
        while !job.pass(film, spp + pass, in_time) && !is_over() {
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
/// an eighth of what is left; 0 when the time is up. And whether the pass is to end with the time,
/// wherever it is.
fn pass_size(done: u64, limits: &Limits, elapsed: Duration) -> (u64, bool) {
    let doubled = done.clamp(1, PASS_SPP).min(limits.spp - done);
    let Some(time) = limits.time else {
        return (doubled, false);
    };
    let left = time.saturating_sub(elapsed).as_secs_f64();
    if left <= 0.0 && done > 0 {
        return (0, false);
    }
    if done == 0 {
        return (1, false);
    }
    let per_sample = elapsed.as_secs_f64() / done as f64;
    if per_sample > COARSE * time.as_secs_f64() {
        return (1, true);
    }
    if left < 0.5 * per_sample {
        return (0, false);
    }
    let fitting = (left / per_sample / 8.0).ceil().max(1.0) as u64;
    (doubled.min(fitting), false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_double_and_get_shorter_before_the_time_is_up() {
        let limits = |spp, seconds: Option<u64>| Limits {
            spp,
            time: seconds.map(Duration::from_secs),
            noise: None,
        };
        let of = |done, limits, seconds| pass_size(done, &limits, Duration::from_secs_f64(seconds));
        assert_eq!(of(0, limits(100, None), 0.0), (1, false));
        assert_eq!(of(16, limits(100, None), 1e6), (16, false));
        assert_eq!(of(96, limits(100, None), 1.0), (4, false));
        assert_eq!(of(1000, limits(9999, None), 1.0), (64, false));
        // The first samples come whatever they take.
        assert_eq!(of(0, limits(100, Some(10)), 20.0), (1, false));
        assert_eq!(of(64, limits(9999, Some(100)), 1.0), (64, false));
        // A second a sample, and 40 of them left.
        assert_eq!(of(60, limits(9999, Some(100)), 60.0), (5, false));
        assert_eq!(of(99, limits(9999, Some(100)), 99.6), (0, false));
        assert_eq!(of(99, limits(9999, Some(100)), 100.0), (0, false));
    }

    #[test]
    fn where_samples_are_long_the_last_ends_with_the_time() {
        let limits = Limits {
            spp: 100,
            time: Some(Duration::from_secs(10)),
            noise: None,
        };
        let of = |done, seconds| pass_size(done, &limits, Duration::from_secs(seconds));
        assert_eq!(of(1, 4), (1, true));
        assert_eq!(of(2, 9), (1, true));
        assert_eq!(of(3, 10), (0, false));
    }
}
