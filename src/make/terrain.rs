//! Mountains: ridged noise on a grid.

use super::half_quad;
use crate::math::DVec3;

/// Waves of the coarsest octave across the square.
const WAVES: f64 = 2.0;
/// Height of the mountains before the octaves are summed.
const HEIGHT: f64 = 0.5;
/// Amplitude of each octave over that of the one before.
const GAIN: f64 = 0.45;

/// A grid of `columns` by `rows` quads.
#[derive(Clone, Debug)]
pub struct Terrain {
    columns: u64,
    rows: u64,
    octaves: u32,
}

impl Terrain {
    /// Of about that many triangles.
    pub fn new(triangles: u64) -> Self {
        let columns = ((triangles / 2).isqrt()).max(2);
        let rows = (triangles / 2 / columns).max(2);
        // Finer than the grid would be noise without shape.
        let octaves = (columns as f64 / WAVES).log2().floor() as u32;
        Self {
            columns,
            rows,
            octaves: octaves.clamp(1, 16),
        }
    }

    pub fn vertices(&self) -> u64 {
        (self.columns + 1) * (self.rows + 1)
    }

    pub fn triangles(&self) -> u64 {
        2 * self.columns * self.rows
    }

    pub fn vertex(&self, i: u64) -> DVec3 {
        let (column, row) = (i % (self.columns + 1), i / (self.columns + 1));
        let (u, v) = (
            column as f64 / self.columns as f64,
            row as f64 / self.rows as f64,
        );
        DVec3::new(2.0 * u - 1.0, self.height(u, v), 2.0 * v - 1.0)
    }

    pub fn triangle(&self, i: u64) -> [u64; 3] {
        let quad = i / 2;
        let (column, row) = (quad % self.columns, quad / self.columns);
        let below = row * (self.columns + 1) + column;
        let above = below + self.columns + 1;
        half_quad([below, above, below + 1, above + 1], i % 2 == 1)
    }

    /// Ridges where the noise crosses zero; valleys stay smooth, as the finer octaves follow the
    /// height of the coarser ones (Musgrave, "Procedural Fractal Terrains").
    fn height(&self, u: f64, v: f64) -> f64 {
        let (mut sum, mut amplitude, mut frequency, mut weight) = (0.0, HEIGHT, WAVES, 1.0);
        for octave in 0..self.octaves {
            let n = noise(u * frequency, v * frequency, octave);
            let ridge = (1.0 - n.abs()).powi(2) * weight;
            sum += ridge * amplitude;
            weight = ridge.clamp(0.0, 1.0);
            amplitude *= GAIN;
            frequency *= 2.0;
        }
        sum - HEIGHT
    }
}

/// Smooth noise between -1 and 1: random values at whole numbers, joined by quintic curves.
fn noise(x: f64, y: f64, octave: u32) -> f64 {
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (fade(x - x0), fade(y - y0));
    let at = |dx: u32, dy: u32| {
        let (x, y) = (x0 as i64 as u32, y0 as i64 as u32);
        value(x.wrapping_add(dx), y.wrapping_add(dy), octave)
    };
    let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
    lerp(
        lerp(at(0, 0), at(1, 0), fx),
        lerp(at(0, 1), at(1, 1), fx),
        fy,
    )
}

fn fade(t: f64) -> f64 {
    t * t * t * (t * (6.0 * t - 15.0) + 10.0)
}

/// A random number between -1 and 1 for a lattice point, by the finaliser of MurmurHash3.
fn value(x: u32, y: u32, octave: u32) -> f64 {
    let mut h = u64::from(x) | u64::from(y) << 32;
    h = h.wrapping_add(u64::from(octave + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    h = (h ^ h >> 33).wrapping_mul(0xff51_afd7_ed55_8ccd);
    h = (h ^ h >> 33).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    h ^= h >> 33;
    (h >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}
