//! Which configurations are better than the first, and is that more than chance?
//!
//! How runs are compared is said in [`super::finding`].

use super::Sweep;
use super::advice::{self, Advice};
use super::curve::{Curve, Scale};
use super::finding::{Finding, finding};
use serde::Serialize;

/// What a sweep came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Findings {
    /// Time at which errors are compared: the longest that every run has reached.
    pub seconds: f64,
    /// Each configuration that has measurements, in the order of the plan.
    pub configurations: Vec<Finding>,
    /// Points that no configuration beats both in time and in error.
    pub front: Vec<FrontPoint>,
    /// What to use.
    pub advice: Vec<Advice>,
    /// The smallest part of the processors that a run got.
    pub processor_share: Option<f64>,
}

/// A point of the Pareto front.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrontPoint {
    /// The configuration.
    pub name: String,
    /// Time.
    pub seconds: f64,
    /// Error then.
    pub error: f64,
}

impl Findings {
    /// Concludes.
    pub fn of(sweep: &Sweep) -> Self {
        let all = sweep.runs.iter().filter_map(|r| r.stats.as_ref());
        let ends = all.clone().filter_map(|s| {
            let curve = Curve::of(s, sweep.setting.clock, Scale::Pixels);
            Some(curve.end()?[0])
        });
        let seconds = ends.fold(f64::INFINITY, f64::min);
        let configurations: Vec<Finding> = sweep
            .setting
            .configurations
            .iter()
            .filter_map(|c| finding(sweep, &c.name, seconds))
            .collect();
        let front = front(&configurations);
        let shares = all.filter_map(|s| s.processor_share());
        Self {
            seconds,
            advice: advice::of(sweep, &configurations),
            processor_share: shares.reduce(f64::min),
            configurations,
            front,
        }
    }

    /// The finding of that name.
    pub fn get(&self, name: &str) -> Option<&Finding> {
        self.configurations.iter().find(|f| f.name == name)
    }
}

/// The lower left edge of all curves.
fn front(configurations: &[Finding]) -> Vec<FrontPoint> {
    let of = |f: &Finding| {
        let name = f.name.clone();
        let points = f.curve.0.clone().into_iter();
        points.map(move |[seconds, error]| FrontPoint {
            name: name.clone(),
            seconds,
            error,
        })
    };
    let mut points: Vec<FrontPoint> = configurations.iter().flat_map(of).collect();
    points.sort_by(|a, b| {
        let times = a.seconds.total_cmp(&b.seconds);
        times.then(a.error.total_cmp(&b.error))
    });
    let mut front: Vec<FrontPoint> = Vec::new();
    for point in points {
        if front.last().is_none_or(|last| point.error < last.error) {
            front.push(point);
        }
    }
    front
}
