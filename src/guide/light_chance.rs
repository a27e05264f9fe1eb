//! How often to sample a light: the probability of next-event estimation at a vertex, learned for
//! each cell of R.
//!
//! A shadow ray costs as much as a ray that goes on, and where light comes in through the gap of a
//! door, through glass or through water it is blocked nearly always. So it is traced with a
//! probability p and counts 1/p times. To leave out light samples c with probability 1 - p adds
//! E\[c^2\] (1 - p)/p to the variance and saves their share of the cost; the best p is in
//! proportion to the root of E\[c^2\] against that of the spread which all light from the vertex
//! has anyway (Rath et al., "EARS: Efficiency-aware Russian roulette and splitting", 2022, for one
//! decision). What is rarely lit, but brightly, keeps its light samples: squares are what counts.
//!
//! Multiple importance sampling weighs by p, too: where shadow rays are blocked nearly always,
//! directions that meet a light by themselves count for more.

use super::bytes::{Reader, Writer};

/// No light is sampled less often than this: the cell may have been unlucky so far. (0.1 and 0.3
/// measure the same in six scenes.)
pub const LEAST_LIGHT: f32 = 0.2;

/// The chance over the ratio of both roots. In veach-ajar half of it takes 3 % of the rays and adds
/// a tenth to the variance; light samples everywhere would cost a tenth more rays and gain nothing.
const EAGERNESS: f64 = 5.0;

/// Light samples as bright as all that is reflected, which are taken for granted at the beginning.
const PRIOR: f64 = 4.0;

/// What a cell keeps when it is divided: its parts may differ.
const KEPT: f64 = 0.25;

/// What the light samples of a cell came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LightChance {
    /// Vertices.
    count: f64,
    /// Sum of the squares of what light samples brought.
    squares: f64,
    /// Sum of the squares of all that was reflected.
    reflected: f64,
}

impl LightChance {
    /// Size in a file.
    pub const BYTES: usize = 3 * 8;

    pub fn write(&self, w: &mut Writer) {
        w.f64(self.count);
        w.f64(self.squares);
        w.f64(self.reflected);
    }

    /// Reads what `write` wrote, if it is a state that sums can be in.
    pub fn read(r: &mut Reader) -> Option<Self> {
        let sums = Self {
            count: r.f64()?,
            squares: r.f64()?,
            reflected: r.f64()?,
        };
        let sound = |v: f64| v.is_finite() && v >= 0.0;
        (sound(sums.count) && sound(sums.squares) && sound(sums.reflected)).then_some(sums)
    }

    /// Adds a vertex: what its light sample brought, the chance with which that was taken, and all
    /// that the vertex reflected, both for the throughput 1. Numbers that are not finite are
    /// ignored.
    pub fn add(&mut self, light: f32, chance: f32, reflected: f32) {
        let square = f64::from(light) * f64::from(light) * f64::from(chance);
        if !(square.is_finite() && reflected.is_finite() && reflected >= 0.0) {
            return;
        }
        self.count += 1.0;
        self.squares += square;
        self.reflected += f64::from(reflected) * f64::from(reflected);
    }

    /// What a part of the cell starts with.
    pub fn of_part(self) -> Self {
        Self {
            count: KEPT * self.count,
            squares: KEPT * self.squares,
            reflected: KEPT * self.reflected,
        }
    }

    /// The chance that follows, within [`LEAST_LIGHT`] and 1.
    pub fn chance(&self) -> f32 {
        // Nothing was met, or all was dark.
        if self.reflected <= 0.0 {
            return 1.0;
        }
        let vertices = self.squares * self.count / self.reflected;
        let chance = EAGERNESS * ((vertices + PRIOR) / (self.count + PRIOR)).sqrt();
        (chance as f32).clamp(LEAST_LIGHT, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(vertices: usize, light: f32, every: usize) -> f32 {
        let mut cell = LightChance::default();
        for i in 0..vertices {
            let light = if i % every == 0 { light } else { 0.0 };
            cell.add(light, 1.0, light + 1.0);
        }
        cell.chance()
    }

    #[test]
    fn light_is_sampled_until_it_is_known_to_be_blocked() {
        assert_eq!(LightChance::default().chance(), 1.0);
        assert_eq!(after(396, 0.0, 1), 0.5);
        assert_eq!(after(10_000, 0.0, 1), LEAST_LIGHT);
    }

    #[test]
    fn light_that_matters_is_always_sampled_however_rare() {
        // A tenth of all light, and the rest is even.
        assert!((after(100_000, 0.1, 1) - 5.0 / 11.0).abs() < 0.01);
        // One sample in a hundred brings a hundred times what else there is.
        assert_eq!(after(10_000, 100.0, 100), 1.0);
        assert_eq!(after(10_000, 0.01, 100), LEAST_LIGHT);
    }

    #[test]
    fn the_unit_of_light_and_the_chance_so_far_do_not_matter() {
        let chance = |scale: f32, so_far: f32| {
            let mut cell = LightChance::default();
            for i in 0..1000 {
                let taken = (i % 8) as f32 / 8.0 < so_far;
                let light = if taken { 0.3 * scale / so_far } else { 0.0 };
                cell.add(light, so_far, scale);
            }
            cell.chance()
        };
        assert!((chance(1.0, 1.0) / chance(1e15, 1.0) - 1.0).abs() < 1e-4);
        assert!((chance(1.0, 1.0) / chance(1.0, 0.5) - 1.0).abs() < 1e-4);
        let mut cell = LightChance::default();
        cell.add(f32::INFINITY, 1.0, 1.0);
        cell.add(1.0, 1.0, f32::NAN);
        assert_eq!(cell, LightChance::default());
    }

    #[test]
    fn a_state_comes_back_from_its_bytes_and_nonsense_is_refused() {
        let mut cell = LightChance::default();
        cell.add(0.5, 0.5, 2.0);
        for (state, sound) in [
            (cell, true),
            (
                LightChance {
                    count: -1.0,
                    ..cell
                },
                false,
            ),
        ] {
            let mut w = Writer::default();
            state.write(&mut w);
            let bytes = w.into_bytes();
            assert_eq!(bytes.len(), LightChance::BYTES);
            let back = LightChance::read(&mut Reader::new(&bytes, bytes.len()));
            assert_eq!(back, sound.then_some(state));
        }
    }
}
