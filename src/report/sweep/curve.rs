//! Error over time.
//!
//! Between two points an error falls along a power of the time: a straight line on log axes.

use super::{Clock, ErrorPoint, RunStats};
use serde::Serialize;

/// What the error is measured on: noise that averages out within a few pixels is told from
/// blotches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Scale {
    /// Pixels: relMSE without the worst 0.1 % of them.
    Pixels,
    /// relMSE of the means over blocks of 4 x 4 pixels.
    Blocks4,
    /// relMSE of the means over blocks of 16 x 16 pixels.
    Blocks16,
}

impl Scale {
    /// All of them, the finest first.
    pub const ALL: [Self; 3] = [Self::Pixels, Self::Blocks4, Self::Blocks16];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pixels => "pixels",
            Self::Blocks4 => "4x4 blocks",
            Self::Blocks16 => "16x16 blocks",
        }
    }

    fn error(self, point: &ErrorPoint) -> Option<f64> {
        match self {
            Self::Pixels => Some(point.relmse_trimmed),
            Self::Blocks4 => point.relmse_4x4,
            Self::Blocks16 => point.relmse_16x16,
        }
    }
}

/// The error over time: seconds and relMSE at one scale, times growing.
///
/// Seconds count what a configuration can change: building the ray tracer, learning, rendering; not
/// reading the scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Curve(pub Vec<[f64; 2]>);

/// Points of a median curve a factor of ten in time.
const DENSITY: f64 = 16.0;

impl Curve {
    /// Of one run. Points without time or error, which log axes have no place for, are left out.
    pub fn of(stats: &RunStats, clock: Clock, scale: Scale) -> Self {
        let points = stats.errors.iter();
        let threads = stats.threads.max(1) as f64;
        let points = points.filter_map(|p| {
            let seconds = match (clock, p.cpu_seconds) {
                (Clock::Processors, Some(spent)) => spent / threads,
                _ => p.seconds,
            };
            Some([stats.build_seconds + seconds, scale.error(p)?])
        });
        let mut curve = Self::default();
        for [seconds, error] in points {
            let later = curve.end().is_none_or(|[t, _]| seconds > t);
            if later && seconds > 0.0 && error > 0.0 && (seconds + error).is_finite() {
                curve.0.push([seconds, error]);
            }
        }
        curve
    }

    /// The last point.
    pub fn end(&self) -> Option<[f64; 2]> {
        self.0.last().copied()
    }

    /// The error at a time within the curve.
    pub fn at(&self, seconds: f64) -> Option<f64> {
        let after = self.0.partition_point(|p| p[0] < seconds);
        let right = self.0.get(after)?;
        if right[0] == seconds {
            return Some(right[1]);
        }
        let left = self.0.get(after.checked_sub(1)?)?;
        let along = (seconds / left[0]).ln() / (right[0] / left[0]).ln();
        Some(left[1] * (right[1] / left[1]).powf(along))
    }

    /// The error at a time, or where the curve begins if that is later; beyond its end it is
    /// assumed to halve as time doubles, as the error of independent samples does.
    pub fn expected(&self, seconds: f64) -> Option<f64> {
        let (start, end) = (self.0.first()?, self.end()?);
        let seconds = seconds.max(start[0]);
        self.at(seconds).or(Some(end[1] * end[0] / seconds))
    }

    /// The time at which the error has come down to `goal` for good, and whether that was measured:
    /// beyond the end it is expected as [`Curve::expected`] does.
    pub fn time_to(&self, goal: f64) -> Option<(f64, bool)> {
        let end = self.end()?;
        if end[1] > goal {
            return Some((end[0] * end[1] / goal, false));
        }
        let Some(last_above) = self.0.iter().rposition(|p| p[1] > goal) else {
            return Some((self.0[0][0], true));
        };
        let (a, b) = (self.0[last_above], self.0[last_above + 1]);
        let along = (a[1] / goal).ln() / (a[1] / b[1]).ln();
        Some((a[0] * (b[0] / a[0]).powf(along), true))
    }

    /// The median of curves, from where all have begun to where the first ends; a single point
    /// where one ends before another begins.
    pub fn median(curves: &[Curve]) -> Self {
        let starts = curves.iter().filter_map(|c| Some(c.0.first()?[0]));
        let ends = curves.iter().filter_map(|c| Some(c.end()?[0]));
        let from = starts.fold(0.0, f64::max);
        let to = ends.fold(f64::INFINITY, f64::min).max(from);
        if from <= 0.0 || !to.is_finite() {
            return Self::default();
        }
        let steps = ((to / from).log10() * DENSITY).ceil();
        let times = (0..=steps as usize).map(|i| match i as f64 {
            last if last == steps => to,
            i => from * (to / from).powf(i / steps),
        });
        let point = |t: f64| {
            let errors = curves.iter().filter_map(|c| c.expected(t)).collect();
            Some([t, median(errors)?])
        };
        Self(times.filter_map(point).collect())
    }
}

/// The middle value, or the geometric mean of the two in the middle.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let n = values.len();
    let upper = *values.get(n / 2)?;
    match n % 2 {
        1 => Some(upper),
        _ => Some((values[n / 2 - 1] * upper).sqrt()),
    }
}
