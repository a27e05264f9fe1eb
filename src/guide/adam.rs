//! A search for a fraction: Adam (Kingma and Ba 2015) on its logit, with a weak pull towards 1/2.

use super::bytes::{Reader, Writer};

const RATE: f64 = 0.01;
const BETA1: f64 = 0.9;
const BETA2: f64 = 0.999;
const DECAY: f64 = 0.01;

/// A cell's fraction, and the state of the search for it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Adam {
    logit: f64,
    mean: f64,
    square: f64,
    steps: u32,
}

impl Adam {
    /// Size in a file.
    pub const BYTES: usize = 3 * 8 + 4;

    pub fn write(&self, w: &mut Writer) {
        w.f64(self.logit);
        w.f64(self.mean);
        w.f64(self.square);
        w.u32(self.steps);
    }

    /// Reads what `write` wrote, if it is a state that the search can be in.
    pub fn read(r: &mut Reader) -> Option<Self> {
        let adam = Self {
            logit: r.f64()?,
            mean: r.f64()?,
            square: r.f64()?,
            steps: r.u32()?,
        };
        let sound = (-20.0..=20.0).contains(&adam.logit)
            && adam.mean.is_finite()
            && adam.square.is_finite()
            && adam.square >= 0.0;
        sound.then_some(adam)
    }

    /// The fraction that it stands for.
    pub fn fraction(&self) -> f64 {
        1.0 / (1.0 + (-self.logit).exp())
    }

    /// What the means of so many steps lack: beta^n of both.
    pub fn lacking(&self) -> [f64; 2] {
        let n = self.steps.min(1 << 20) as i32;
        [BETA1.powi(n), BETA2.powi(n)]
    }

    /// One step against the gradient of the loss by the logit; `lacking` is what [`Adam::lacking`]
    /// said before it, and will say after it.
    pub fn step(&mut self, gradient: f64, lacking: &mut [f64; 2]) {
        self.steps = self.steps.saturating_add(1);
        let gradient = gradient + DECAY * self.logit;
        lacking[0] *= BETA1;
        lacking[1] *= BETA2;
        self.mean += (1.0 - BETA1) * (gradient - self.mean);
        self.square += (1.0 - BETA2) * (gradient * gradient - self.square);
        let m = self.mean / (1.0 - lacking[0]);
        let v = self.square / (1.0 - lacking[1]);
        self.logit = (self.logit - RATE * m / (v.sqrt() + 1e-8)).clamp(-20.0, 20.0);
    }
}
