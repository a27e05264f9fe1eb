//! How noisy each pixel is.

use super::share::{RANGE, Share, Shares, TileShares};
use crate::film::{FLOOR, Film, Tile};
use crate::integrate::camera_sample::Iteration;
use crate::math::Rgb;
use crate::math::rng::{hash_all, unit_f32};
use crate::math::smooth::smooth;

/// This much of the paths is spread evenly: a pixel that looks calm may not have met its brightest
/// paths yet.
const EVEN: f32 = 0.2;
/// A pixel's variance is smoothed with those of its neighbours, by these weights on each axis.
const SMOOTH: [f32; 5] = [1.0, 2.0, 3.0, 2.0, 1.0];

/// Sums over the samples of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sums {
    /// Of what they count.
    worth: f32,
    /// Of the brightness.
    value: f32,
    /// Of its square.
    square: f32,
}

/// What the samples of a tile told.
#[derive(Clone, Debug, PartialEq)]
pub struct TileSurvey {
    pixels: Vec<Sums>,
    paths: u64,
    rays: u64,
}

/// What the samples of a film told.
#[derive(Clone, Debug)]
pub struct Survey {
    /// Tile by tile.
    pub tiles: Vec<TileSurvey>,
    /// Width and height.
    size: [usize; 2],
    seed: u64,
}

impl TileSurvey {
    /// Adds a sample of the tile's pixel `i` that counts for `worth` of them.
    #[inline]
    pub fn add(&mut self, i: usize, radiance: Rgb, worth: f32) {
        let value = radiance.element_sum() * (1.0 / 3.0);
        let square = value * value;
        if !(square.is_finite() && worth.is_finite()) {
            return;
        }
        let sums = &mut self.pixels[i];
        sums.worth += worth;
        sums.value += worth * value;
        sums.square += worth * square;
    }

    /// Takes note of the rays that so many paths took.
    pub fn add_rays(&mut self, rays: u64, paths: usize) {
        self.rays += rays;
        self.paths += paths as u64;
    }

    /// Rays a path.
    fn cost(&self) -> f32 {
        (self.rays as f32 / self.paths.max(1) as f32).max(1.0)
    }
}

impl Sums {
    /// Relative variance of a sample: no more than the number of samples it is told by, so that a
    /// single bright one says no more than that it is the only one.
    fn variance(&self) -> f32 {
        if self.worth <= 1.0 {
            return 0.0;
        }
        let mean = self.value / self.worth;
        let variance = (self.square / self.worth - mean * mean).max(0.0);
        variance / (mean * mean + FLOOR as f32)
    }
}

impl Survey {
    /// One of a film, without samples; `seed` is that of the random numbers by which shares are
    /// rounded.
    pub fn new(film: &Film, seed: u64) -> Self {
        let tile = |area| TileSurvey {
            pixels: vec![Sums::default(); area],
            paths: 0,
            rays: 0,
        };
        Self {
            tiles: film.tiles().iter().map(|t| tile(t.area())).collect(),
            size: [film.width() as usize, film.height() as usize],
            seed,
        }
    }

    /// The shares for the samples from number `from` on, which come after those of the iteration
    /// `before`.
    pub fn shares(&self, film: &Film, from: u64, before: &Iteration) -> Shares {
        let shares = relative(&smooth(&self.worthwhile(film), self.size, &SMOOTH));
        let of_tile = |(number, tile): (usize, &Tile)| {
            let share = |i: usize| {
                let taken = before.taken(number, i, from);
                let [x, y] = tile.place(i).map(u64::from);
                let lot = hash_all([self.seed, from, x, y]);
                let lots = [lot as u32, (lot >> 32) as u32].map(unit_f32);
                Share::new(shares[film.row_major(tile.place(i))], taken as u32, lots)
            };
            TileShares::new((0..tile.area()).map(share).collect())
        };
        film.tiles().iter().enumerate().map(of_tile).collect()
    }

    /// Variances row by row, each over what a path takes there.
    fn worthwhile(&self, film: &Film) -> Vec<f32> {
        let mut image = vec![0.0; self.size[0] * self.size[1]];
        for (tile, told) in film.tiles().iter().zip(&self.tiles) {
            let cost = told.cost();
            for (i, sums) in told.pixels.iter().enumerate() {
                image[film.row_major(tile.place(i))] = sums.variance() / cost;
            }
        }
        image
    }
}

/// Shares by variances, of mean 1.
fn relative(variances: &[f32]) -> Vec<f32> {
    let deviations: Vec<f32> = variances.iter().map(|v| v.sqrt()).collect();
    let share = |deviation: f32, scale: f64| {
        let share = EVEN + (1.0 - EVEN) * deviation * scale as f32;
        share.clamp(RANGE[0], RANGE[1])
    };
    let mean = |scale: f64| {
        let sum: f64 = deviations.iter().map(|d| f64::from(share(*d, scale))).sum();
        sum / deviations.len() as f64
    };
    let sum: f64 = deviations.iter().map(|d| f64::from(*d)).sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return vec![1.0; variances.len()];
    }
    // What clamping takes away or gives is made up for.
    let mut scale = deviations.len() as f64 / sum;
    for _ in 0..ROUNDS {
        scale *= (1.0 / mean(scale)).clamp(0.5, 2.0);
    }
    deviations.iter().map(|d| share(*d, scale)).collect()
}

/// Rounds of making up.
const ROUNDS: u32 = 12;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_have_a_mean_of_one_and_follow_the_deviation() {
        let mut variances = vec![1.0; 5000];
        variances.extend(vec![9.0; 1000]);
        variances.extend(vec![0.0; 1000]);
        let shares = relative(&variances);
        let mean = shares.iter().sum::<f32>() / shares.len() as f32;
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
        let ratio = (shares[5000] - EVEN) / (shares[0] - EVEN);
        assert!((ratio - 3.0).abs() < 1e-3, "{ratio}");
        assert_eq!(shares[6500], 0.25);
        // Few that are far worse than all others.
        let mut variances = vec![1.0; 10_000];
        variances[17] = 1e8;
        let shares = relative(&variances);
        assert_eq!(shares[17], 16.0);
        let mean = shares.iter().sum::<f32>() / shares.len() as f32;
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
        assert_eq!(relative(&[0.0; 9]), vec![1.0; 9]);
    }

    #[test]
    fn variance_is_that_of_a_sample_whatever_paths_count() {
        let mut survey = TileSurvey {
            pixels: vec![Sums::default(); 2],
            paths: 0,
            rays: 0,
        };
        for i in 0..10_000 {
            let value = Rgb::splat(if i % 4 == 0 { 2.0 } else { 0.4 });
            survey.add(0, value, 1.0);
            survey.add(1, value, if i < 5000 { 1.0 } else { 0.25 });
        }
        // 0.48 over 0.8^2 + 0.01.
        for sums in survey.pixels {
            assert!((sums.variance() / 0.7385 - 1.0).abs() < 1e-3, "{sums:?}");
        }
    }
}
