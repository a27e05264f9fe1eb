//! What each configuration came to: its error, its cost and its speed beside the first one's.
//!
//! Every configuration is run several times with other seeds, and runs of one round stand close
//! together in time. So a run is compared with the first configuration's run of the same round, at
//! one and the same time: the ratio of the errors is the ratio of the speeds, for the error of a
//! mean halves as its samples double. A difference is called clear when all rounds, two at least,
//! agree about it.

use super::Sweep;
use super::curve::{Curve, Scale, median};
use serde::Serialize;

/// Speeds nearer to each other than this are called equal, whatever the rounds say.
const EQUAL: f64 = 1.03;

/// What a configuration came to: medians of its runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Its name.
    pub name: String,
    /// Runs with measurements.
    pub runs: usize,
    /// Runs without.
    pub failures: usize,
    /// Error over time.
    pub curve: Curve,
    /// relMSE without the worst 0.1 % of the pixels, at the common time or after learning, if that
    /// is later.
    pub error: f64,
    /// The smallest and the largest of its runs.
    pub error_range: [f64; 2],
    /// relMSE of all pixels at the end.
    pub relmse: f64,
    /// How much faster it gets to the same error than the first configuration; 1 for that one
    /// itself.
    pub speed: Option<Speed>,
    /// The same of the means over blocks, without scales that the images are too small for.
    pub blocks: Vec<OfBlocks>,
    /// Samples a pixel at the end.
    pub spp: f64,
    /// Bytes at the most.
    pub peak_memory_bytes: Option<f64>,
    /// Bytes of the learned field.
    pub field_memory_bytes: f64,
    /// Bytes of the ray tracer's trees.
    pub accel_memory_bytes: f64,
    /// Seconds to build them.
    pub build_seconds: f64,
    /// Part of the rendering that learning took.
    pub train_share: f64,
}

/// What a configuration came to at a coarser scale.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OfBlocks {
    /// Which one.
    pub scale: Scale,
    /// Error over time.
    pub curve: Curve,
    /// See [`Finding::speed`].
    pub speed: Option<Speed>,
}

/// A ratio of speeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Speed {
    /// Median over the rounds.
    pub median: f64,
    /// Smallest.
    pub least: f64,
    /// Largest.
    pub most: f64,
    /// Whether the rounds agree that it is another than 1.
    pub clear: bool,
}

/// The finding of the configuration `name`, at the common time `seconds`. `None` without
/// measurements.
pub(super) fn finding(sweep: &Sweep, name: &str, seconds: f64) -> Option<Finding> {
    let runs: Vec<_> = sweep.runs_of(name).collect();
    let curves_at = |scale| -> Vec<Curve> {
        let curve = |stats| Curve::of(stats, sweep.setting.clock, scale);
        runs.iter().map(|(_, stats)| curve(stats)).collect()
    };
    let blocks = [Scale::Blocks4, Scale::Blocks16].map(|scale| OfBlocks {
        scale,
        curve: Curve::median(&curves_at(scale)),
        speed: speed(sweep, name, seconds, scale),
    });
    let curves = curves_at(Scale::Pixels);
    let errors: Vec<f64> = curves.iter().filter_map(|c| c.expected(seconds)).collect();
    let middle = |of: &dyn Fn(&super::RunStats) -> f64| {
        let mut values: Vec<f64> = runs.iter().map(|(_, s)| of(s)).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let own = sweep.runs.iter().filter(|r| r.configuration == name);
    let peaks = runs.iter().all(|(_, s)| s.peak_memory_bytes.is_some());
    Some(Finding {
        name: name.into(),
        runs: runs.len(),
        failures: own.filter(|r| r.stats.is_none()).count(),
        error: median(errors.clone())?,
        error_range: [
            errors.iter().copied().fold(f64::INFINITY, f64::min),
            errors.iter().copied().fold(0.0, f64::max),
        ],
        relmse: middle(&|s| s.errors.last().map_or(0.0, |e| e.relmse)),
        speed: speed(sweep, name, seconds, Scale::Pixels),
        blocks: blocks
            .into_iter()
            .filter(|b| b.curve.end().is_some())
            .collect(),
        spp: middle(&|s| s.spp as f64),
        peak_memory_bytes: peaks.then(|| middle(&|s| s.peak_memory_bytes.unwrap_or(0) as f64)),
        field_memory_bytes: middle(&|s| s.field_memory_bytes as f64),
        accel_memory_bytes: middle(&|s| s.accel_memory_bytes as f64),
        build_seconds: middle(&|s| s.build_seconds),
        train_share: middle(&|s| s.train_share()),
        curve: Curve::median(&curves),
    })
}

/// Compares the runs of a configuration with the first one's of the same rounds.
fn speed(sweep: &Sweep, name: &str, seconds: f64, scale: Scale) -> Option<Speed> {
    let first = &sweep.setting.configurations.first()?.name;
    let curve_of = |name: &str, round: u32| {
        let mut runs = sweep.runs_of(name);
        let (_, stats) = runs.find(|(run, _)| run.round == round)?;
        let curve = Curve::of(stats, sweep.setting.clock, scale);
        Some((curve.0.first()?[0], curve))
    };
    let ratio = |round: u32| {
        let ((a, first), (b, own)) = (curve_of(first, round)?, curve_of(name, round)?);
        // Who still learns at the common time is compared when it has learned.
        let seconds = seconds.max(a).max(b);
        Some(first.expected(seconds)? / own.expected(seconds)?)
    };
    let ratios: Vec<f64> = (0..sweep.setting.rounds).filter_map(ratio).collect();
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let most = ratios.iter().copied().fold(0.0, f64::max);
    let agree = least > EQUAL || most < 1.0 / EQUAL;
    Some(Speed {
        least,
        most,
        clear: ratios.len() > 1 && agree,
        median: median(ratios)?,
    })
}
