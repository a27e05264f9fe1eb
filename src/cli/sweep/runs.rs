//! The runs of a sweep, one after the other, within its budget.

use super::args::SweepArgs;
use super::child::{self, Outcome};
use super::schedule::{file, order, words_of};
use super::state;
use crate::cli::Failure;
use crate::cli::bar::Part;
use crate::cli::console::Console;
use crate::cli::interrupt::Interrupt;
use crate::cli::waiting::{Said, Waiting};
use crate::report::sweep::{Configuration, Run, Sweep};
use crate::report::words;
use std::ffi::OsString;
use std::time::{Duration, Instant};

/// A run that takes so many times what was to be expected, and [`HANGING`] more, hangs.
const HANGS: f64 = 3.0;
const HANGING: f64 = 20.0;
/// A budget may be passed by this much of it, so that a run that has begun can end.
const OVER_BUDGET: f64 = 0.05;

/// Who looks on, who may end it, and the words that start the program, where it is not a file of its
/// own.
pub type Watch<'a> = (&'a Console, &'a Interrupt, &'a [OsString]);

/// Why no more runs are made.
pub enum Ended {
    /// All are there.
    Complete,
    /// There is no time for another.
    BudgetSpent,
    /// The user wants an end.
    Interrupted,
}

/// Makes the runs that are missing, in a budget that began at `start`.
///
/// # Errors
/// When the report cannot be written.
pub fn go_through(
    sweep: &mut Sweep,
    args: &SweepArgs,
    watch: Watch,
    start: Instant,
) -> Result<Ended, Failure> {
    let setting = sweep.setting.clone();
    let total = total(sweep);
    let (count, each) = (setting.configurations.len(), words::time(setting.seconds));
    tracing::info!(
        "{count} configurations, {} rounds, {each} each: {} of {total} runs are there",
        setting.rounds,
        sweep.runs.len()
    );
    let mut made = 0;
    for round in 0..setting.rounds {
        for configuration in order(&setting.configurations, round) {
            if sweep.has(&configuration.name, round) {
                continue;
            }
            let left = args.budget.saturating_sub(start.elapsed());
            // One run at least, so that every start gets further.
            let may_end = made > 0;
            if may_end && expected(sweep, configuration) > left.as_secs_f64() {
                return Ok(Ended::BudgetSpent);
            }
            let hangs = HANGING + HANGS * expected(sweep, configuration);
            let longest = match may_end {
                true => hangs.min(left.as_secs_f64() + OVER_BUDGET * args.budget.as_secs_f64()),
                false => hangs,
            };
            let times = Times {
                expected: expected(sweep, configuration),
                longest,
                left: left.as_secs_f64(),
            };
            let (outcome, run) = make(sweep, args, watch, (configuration, round), times);
            match outcome {
                Outcome::Interrupted => return Ok(Ended::Interrupted),
                // It was the budget that ended it: the next go tries it again.
                Outcome::TooLate if longest < hangs => return Ok(Ended::BudgetSpent),
                _ => {}
            }
            made += 1;
            sweep.runs.push(run);
            state::write(&args.output, sweep)?;
            say(sweep, total);
        }
    }
    Ok(Ended::Complete)
}

/// Seconds of a run.
#[derive(Clone, Copy)]
struct Times {
    /// That it will take.
    expected: f64,
    /// After which it is ended.
    longest: f64,
    /// That are left of the budget when it begins.
    left: f64,
}

/// Makes one run. What came of it, and its entry in the report.
fn make(
    sweep: &Sweep,
    args: &SweepArgs,
    (console, interrupt, program): Watch,
    (configuration, round): (&Configuration, u32),
    times: Times,
) -> (Outcome, Run) {
    let words = words_of(&sweep.setting, args, configuration, round);
    let stats = file(args, configuration, "json");
    let (name, number) = (configuration.name.clone(), sweep.runs.len() + 1);
    let total = total(sweep);
    let start = Instant::now();
    let waiting = Waiting::start(console, move |seconds| {
        let name = format!("{number}/{total}  {name}, round {}", round + 1);
        runs_now(name, seconds, times)
    });
    let longest = times.longest;
    let limit = Duration::from_secs_f64(longest);
    let outcome = child::run((program, &words), &stats, limit, interrupt);
    drop(waiting);
    let (stats, failure) = match &outcome {
        Outcome::Measured(stats) => (Some((**stats).clone()), None),
        Outcome::TooLate => (None, Some(format!("it did not end within {longest:.0} s"))),
        Outcome::Failed(why) => (None, Some(why.clone())),
        Outcome::Interrupted => (None, None),
    };
    if let Some(why) = &failure {
        tracing::warn!("{}: {why}", configuration.name);
    }
    let run = Run {
        configuration: configuration.name.clone(),
        round,
        command: child::typed(&words),
        failure,
        wall_seconds: start.elapsed().as_secs_f64(),
        stats,
    };
    (outcome, run)
}

/// What is said while a run goes on.
fn runs_now(name: String, seconds: f64, times: Times) -> Said {
    let left = words::time((times.left - seconds).max(0.0));
    let parts = vec![
        Part::new(0, name),
        Part::new(
            1,
            format!(
                "runs {} of about {}",
                words::time(seconds),
                words::time(times.expected)
            ),
        ),
        Part::new(2, format!("{left} of the budget left")),
    ];
    let share = seconds / times.expected.max(1e-3);
    Said::new(Some(share.min(1.0)), parts)
}

/// Runs of the whole plan.
fn total(sweep: &Sweep) -> usize {
    sweep.setting.configurations.len() * sweep.setting.rounds as usize
}

/// Seconds that a run will take: what the configuration took before, or else what the others did.
fn expected(sweep: &Sweep, configuration: &Configuration) -> f64 {
    let ended = || sweep.runs.iter().filter(|run| run.stats.is_some());
    let own = ended().filter(|run| run.configuration == configuration.name);
    let own = own.map(|run| run.wall_seconds).reduce(f64::max);
    let (count, sum) = ended().fold((0, 0.0), |(n, sum), run| (n + 1, sum + run.wall_seconds));
    let others = if count > 0 {
        sum / f64::from(count)
    } else {
        0.0
    };
    own.unwrap_or(others).max(sweep.setting.seconds)
}

fn say(sweep: &Sweep, total: usize) {
    let Some(run) = sweep.runs.last() else { return };
    let error = run.stats.as_ref().and_then(|s| s.errors.last());
    let error = error.map_or("no measurement".into(), |e| {
        format!("relMSE {}", crate::report::table::number(e.relmse_trimmed))
    });
    let (done, name, round) = (sweep.runs.len(), &run.configuration, run.round + 1);
    tracing::info!("{done}/{total}  {name}, round {round}: {error}");
}
