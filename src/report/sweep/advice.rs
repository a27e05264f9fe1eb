//! What to use for a draft, a normal and a final render, and what each costs.
//!
//! A purpose is a noise that it may have: the root of the relMSE without the worst pixels, which is
//! what `--noise` asks for. The cost is the time until a configuration's median curve gets there.
//! Where several get there as fast, as far as the rounds can tell, the one that stands first in the
//! plan is recommended: plans begin with what is simple.

use super::Sweep;
use super::curve::{Curve, Scale};
use super::finding::Finding;
use serde::Serialize;

/// Purposes, and the noise that each may have.
const PURPOSES: [(&str, f64); 3] = [("draft", 0.25), ("normal", 0.08), ("final", 0.02)];
/// Times nearer to each other than this are called equal.
const EQUAL: f64 = 1.1;
/// The reference's own error hides errors that are not this many times larger.
const ABOVE_REFERENCE: f64 = 4.0;

/// What to use for a purpose.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Advice {
    /// `draft`, `normal` or `final`.
    pub purpose: &'static str,
    /// The noise it may have, as `--noise` takes it.
    pub noise: f64,
    /// The configuration.
    pub name: String,
    /// Seconds of building, learning and rendering.
    pub seconds: f64,
    /// Whether runs got that far; otherwise the time is what the last point of the curve lets
    /// expect.
    pub measured: bool,
    /// Whether the reference is clean enough to tell.
    pub certain: bool,
}

/// Recommends, as far as there are measurements.
pub fn of(sweep: &Sweep, findings: &[Finding]) -> Vec<Advice> {
    let advice = |&(purpose, noise): &(&'static str, f64)| {
        let goal = noise * noise;
        let own = sweep.setting.reference.relmse;
        let (name, seconds, measured) = choose(sweep, findings, goal)?;
        Some(Advice {
            purpose,
            noise,
            name,
            seconds,
            measured,
            certain: own.is_none_or(|own| own * ABOVE_REFERENCE < goal),
        })
    };
    PURPOSES.iter().filter_map(advice).collect()
}

/// The configuration that comes down to the error `goal` first, or one that stands before it in the
/// plan and is not clearly slower; when, and whether that was measured.
fn choose(sweep: &Sweep, findings: &[Finding], goal: f64) -> Option<(String, f64, bool)> {
    let times = findings.iter().filter_map(|f| {
        let (seconds, measured) = f.curve.time_to(goal)?;
        Some((f, seconds, measured))
    });
    let times: Vec<_> = times.collect();
    let best = times.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let runs = sweep.runs_of(&best.0.name);
    let runs = runs.filter_map(|(_, stats)| {
        let curve = Curve::of(stats, sweep.setting.clock, Scale::Pixels);
        Some(curve.time_to(goal)?.0)
    });
    let slowest = runs.fold(EQUAL * best.1, f64::max);
    let chosen = times.iter().find(|t| t.1 <= slowest)?;
    Some((chosen.0.name.clone(), chosen.1, chosen.2))
}
