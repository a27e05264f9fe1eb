//! Samples and photons that were not finite: said, with the command that shows the first one again.

use super::Failure;
use super::farm::quote;
use super::render_args::RenderArgs;
use crate::film::Film;
use crate::integrate::training::Learner;
use crate::report::stats::Stats;

/// What was left out of an image and of the field that guided it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Samples of pixels.
    pub samples: u64,
    /// Photons.
    pub photons: u64,
}

impl LeftOut {
    /// What was left out of an image that was measured, and of what was learned for it.
    pub fn of(stats: &Stats, learner: Option<&Learner>) -> Self {
        Self {
            samples: stats.invalid_samples,
            photons: learner.map_or(0, |l| l.counts().invalid),
        }
    }
}

/// Warns of samples that the film left out.
pub fn warn(film: &Film) {
    let Some((x, y, sample)) = film.first_invalid() else {
        return;
    };
    tracing::warn!(
        "{} samples were not finite and were left out; the first is sample {sample} of pixel {x},{y}. It is shown by\n  {}",
        film.invalid_samples(),
        command_for(x, y, sample)
    );
}

/// The command that was typed, with the words that trace one sample. Files are not written then.
fn command_for(x: u32, y: u32, sample: u64) -> String {
    let mut words: Vec<String> = std::env::args_os()
        .map(|word| quote(&word.to_string_lossy()))
        .collect();
    words.push(format!("--pixel {x},{y},{sample}"));
    words.join(" ")
}

/// With `--strict`, an error if anything was left out.
///
/// # Errors
/// [`Failure::Invalid`], exit code 3.
pub fn check(args: &RenderArgs, left_out: LeftOut) -> Result<(), Failure> {
    let LeftOut { samples, photons } = left_out;
    if !args.doubt.strict || left_out == LeftOut::default() {
        return Ok(());
    }
    Err(Failure::Invalid(format!(
        "{samples} samples and {photons} photons were not finite, and --strict was given"
    )))
}
