//! How long a render will still take, by what its passes have taken so far.
//!
//! The first passes of a guided render know little and cost more, so the rate is that of the later
//! half of the samples. Learning is counted by itself: it takes time between passes, and ends when
//! enough was learned. Noise falls with the root of the samples; those of the later half tell how
//! noisy the samples to come are, for a field that has learned more makes better ones.

use crate::integrate::progress::{MIN_SPP_FOR_NOISE, PASS_SPP};

#[cfg(test)]
mod tests;

/// Most samples of a pass: after each there is a look at the noise.
const PASS: f64 = PASS_SPP as f64;
/// The first look that counts.
const FIRST_LOOK: f64 = MIN_SPP_FOR_NOISE as f64;
/// The variance of samples to come is between so many times that of the samples so far.
const VARIANCE: [f64; 2] = [0.25, 1.0];

/// What a render has come to at a moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mark {
    /// Samples a pixel, on average over the film.
    pub spp: f64,
    /// Seconds of drawing, learning left out.
    pub drawing: f64,
    /// Noise, with its own error added.
    pub noise: Option<f64>,
}

/// What learning between passes has come to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lessons {
    /// Seconds that the last lesson took.
    pub seconds: f64,
    /// Share of what is to be learned that it has taught.
    pub gain: f64,
    /// Share that all of them have.
    pub share: f64,
}

impl Lessons {
    /// Seconds that the others will take, if each is like the last and there can be so many: the
    /// records of a lesson are bounded, however large its pass.
    fn left(&self, most: f64) -> f64 {
        match self.gain > 0.0 && self.share < 1.0 {
            true => self.seconds * ((1.0 - self.share) / self.gain).ceil().min(most),
            false => 0.0,
        }
    }
}

/// When the render ends, whichever comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Samples a pixel; infinite where there is no limit.
    pub spp: f64,
    /// Seconds, learning included.
    pub seconds: Option<f64>,
    /// Noise.
    pub noise: Option<f64>,
}

/// The passes of a render.
#[derive(Clone, Debug, Default)]
pub struct History {
    marks: Vec<Mark>,
    /// What was learned between them.
    pub lessons: Lessons,
}

impl History {
    /// A render that begins, or goes on, at `from` samples a pixel.
    pub fn from(spp: f64) -> Self {
        Self {
            marks: vec![Mark {
                spp,
                ..Mark::default()
            }],
            lessons: Lessons::default(),
        }
    }

    /// Takes note of the end of a pass.
    pub fn add(&mut self, mark: Mark) {
        self.marks.push(mark);
    }

    /// Seconds from `now` on until the goal is reached, if anything tells. `elapsed` is the time so
    /// far, all that came before included.
    pub fn left(&self, goal: &Goal, now: Mark, elapsed: f64) -> Option<f64> {
        let by_time = goal.seconds.map(|seconds| (seconds - elapsed).max(0.0));
        let needed = match goal.noise.and_then(|target| self.spp_for(target)) {
            Some(spp) => Some(spp.min(goal.spp)),
            None => Some(goal.spp).filter(|spp| spp.is_finite()),
        };
        let by_samples = needed.and_then(|spp| {
            let left = (spp - now.spp).max(0.0) / self.rate(now)?;
            let taught = self.marks.last().map_or(0.0, |mark| mark.spp);
            // The last pass teaches nobody.
            Some(left + self.lessons.left(looks_before(taught, spp)))
        });
        match (by_time, by_samples) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        }
    }

    /// Samples a pixel in a second of drawing, by the later half of the samples.
    fn rate(&self, now: Mark) -> Option<f64> {
        let from = self.before(0.5 * now.spp)?;
        let (spp, seconds) = (now.spp - from.spp, now.drawing - from.drawing);
        (spp > 0.0 && seconds > 0.0).then(|| spp / seconds)
    }

    /// The last mark with at most so many samples, or else the first.
    fn before(&self, spp: f64) -> Option<Mark> {
        let found = self.marks.iter().rev().find(|mark| mark.spp <= spp);
        found.or(self.marks.first()).copied()
    }

    /// Samples a pixel at the look that finds the noise at `target`.
    fn spp_for(&self, target: f64) -> Option<f64> {
        let last = self.marks.last()?;
        let n = last.spp;
        // Variances add up: `sum` is that of the sum of a pixel's samples.
        let sum = (n * last.noise?).powi(2);
        let mean = sum / n;
        let half = self.before(0.5 * n).filter(|mark| mark.spp < n);
        let recent = half.and_then(|mark| {
            let before = (mark.spp * mark.noise?).powi(2);
            Some((sum - before) / (n - mark.spp))
        });
        let each = recent.unwrap_or(mean);
        let each = each.clamp(VARIANCE[0] * mean, VARIANCE[1] * mean);
        // target^2 m^2 = sum + (m - n) each, for m.
        let rest = (sum - n * each).max(0.0);
        let square = target * target;
        let m = (each + (each * each + 4.0 * square * rest).sqrt()) / (2.0 * square);
        m.is_finite().then(|| look_after(n, m.max(FIRST_LOOK)))
    }
}

/// The end of the first pass from `spp` on that has at least `wanted` samples a pixel.
fn look_after(mut spp: f64, wanted: f64) -> f64 {
    while spp < wanted && spp < PASS {
        spp += spp.clamp(1.0, PASS);
    }
    spp + ((wanted - spp) / PASS).ceil().max(0.0) * PASS
}

/// How many passes from `spp` on end before `end`.
fn looks_before(mut spp: f64, end: f64) -> f64 {
    let mut count = 0.0;
    while spp < PASS && spp + spp.max(1.0) < end {
        spp += spp.max(1.0);
        count += 1.0;
    }
    match spp >= PASS {
        true => count + (((end - spp) / PASS).ceil() - 1.0).max(0.0),
        false => count,
    }
}
