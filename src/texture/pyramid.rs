//! Texels in memory: an image and its mip levels in the most compact form that keeps them as exact
//! as the file has them.
//!
//! 8-bit images stay 8-bit, with a table of 256 linear values; half floats stay halves. Every level
//! is half as wide and high as the one before, rounded down; its texels are exact area averages of
//! *linear* values, so that the mean is the same at every level.

use super::curve::Cleaner;
use super::storage::Storage;
use crate::image::header::Level;
use bytemuck::{Pod, Zeroable};
use half::f16;

/// A kind of stored texel: how to make it linear and back.
pub(super) trait Texel: Pod + Send + Sync {
    /// Linear value.
    fn decode(self, table: &[f32; 256]) -> f32;
    /// The closest texel to a linear value.
    fn encode(value: f32, table: &[f32; 256]) -> Self;
}

impl Texel for u8 {
    #[inline(always)]
    fn decode(self, table: &[f32; 256]) -> f32 {
        table[self as usize]
    }

    fn encode(value: f32, table: &[f32; 256]) -> Self {
        let above = table.partition_point(|&t| t < value).min(255);
        let below = above.saturating_sub(1);
        if value - table[below] < table[above] - value {
            below as u8
        } else {
            above as u8
        }
    }
}

/// A half float.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct Half(u16);

impl Texel for Half {
    /// Exact for finite halves, without a branch and without denormal floats, which threads that
    /// trace rays flush to zero. (Infinities were removed by [`Cleaner`].)
    #[inline(always)]
    fn decode(self, _: &[f32; 256]) -> f32 {
        let bits = u32::from(self.0);
        let normal = f32::from_bits(((bits & 0x7fff) << 13) + (112 << 23));
        let denormal = (bits & 0x3ff) as f32 * (1.0 / 16_777_216.0);
        let magnitude = if bits & 0x7c00 == 0 { denormal } else { normal };
        f32::from_bits(magnitude.to_bits() | ((bits & 0x8000) << 16))
    }

    fn encode(value: f32, _: &[f32; 256]) -> Self {
        Half(f16::from_f32(value).to_bits())
    }
}

impl Texel for f32 {
    #[inline(always)]
    fn decode(self, _: &[f32; 256]) -> f32 {
        self
    }

    fn encode(value: f32, _: &[f32; 256]) -> Self {
        value
    }
}

/// The levels of an image of `N` channels.
#[derive(Debug)]
pub(super) struct Pyramid<T, const N: usize> {
    levels: Vec<(Level, usize)>,
    texels: Storage<T, N>,
    table: Box<[f32; 256]>,
}

impl<T: Texel, const N: usize> Pyramid<T, N>
where
    [T; N]: Pod,
{
    /// Builds the levels over the finest, which `texels` holds; `mip` false leaves it at that. The
    /// error is why more texels cannot be stored.
    pub fn new(
        size: Level,
        mut texels: Storage<T, N>,
        table: Box<[f32; 256]>,
        cleaner: Cleaner,
        mip: bool,
    ) -> std::io::Result<Self> {
        let mut levels = vec![(size, 0)];
        let (mut from, mut at) = (size, 0);
        texels.settle()?;
        while mip && (from.width > 1 || from.height > 1) {
            let to = half_size(from);
            let columns = covers(from.width, to.width);
            let next = at + from.width as usize * from.height as usize;
            for rows in covers(from.height, to.height) {
                let fine = &texels.all()[at..];
                let row = shrunk_row(fine, from.width as usize, rows, &columns, &table);
                let coarse: Vec<[T; N]> = row
                    .iter()
                    .map(|p| p.map(|x| T::encode(cleaner.clean(x), &table)))
                    .collect();
                texels.push(&coarse)?;
            }
            texels.settle()?;
            levels.push((to, next));
            (from, at) = (to, next);
        }
        Ok(Self {
            levels,
            texels,
            table,
        })
    }

    /// Number of levels, at least 1.
    #[inline]
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// Size of a level that exists.
    #[inline]
    pub fn size(&self, level: usize) -> Level {
        self.levels[level].0
    }

    /// Four linear texels of a level: `(x0, y0) (x1, y0) (x0, y1) (x1, y1)`.
    #[inline(always)]
    pub fn quad(&self, level: usize, x: [u32; 2], y: [u32; 2]) -> [[f32; N]; 4] {
        let (size, at) = self.levels[level];
        let rows = y.map(|y| at + y as usize * size.width as usize);
        let texels = self.texels.all();
        let one = |row: usize, x: u32| texels[row + x as usize].map(|t| t.decode(&self.table));
        [
            one(rows[0], x[0]),
            one(rows[0], x[1]),
            one(rows[1], x[0]),
            one(rows[1], x[1]),
        ]
    }

    /// Bytes of texels in memory; 0 for texels on disk.
    pub fn memory_bytes(&self) -> usize {
        self.texels.memory_bytes()
    }
}

/// The next coarser level.
pub(super) fn half_size(size: Level) -> Level {
    Level {
        width: (size.width / 2).max(1),
        height: (size.height / 2).max(1),
    }
}

/// The texels of a finer row or column that one of a coarser covers: the first, and each one's
/// share. At most three: the ratio is below 3.
type Cover = (usize, [f32; 3]);

/// What each of `to` texels covers of `from`.
fn covers(from: u32, to: u32) -> Vec<Cover> {
    let ratio = f64::from(from) / f64::from(to);
    let cover = |i: u32| {
        let (lo, hi) = (f64::from(i) * ratio, f64::from(i + 1) * ratio);
        // Rounding may put an edge just below the integer that it is.
        let first = (lo + 1e-9).floor();
        let share = |k: usize| {
            let edge = first + k as f64;
            (((edge + 1.0).min(hi) - edge.max(lo)).max(0.0) / ratio) as f32
        };
        (first as usize, std::array::from_fn(share))
    };
    (0..to).map(cover).collect()
}

/// A row of area averages of the level that `fine` begins with.
fn shrunk_row<T: Texel, const N: usize>(
    fine: &[[T; N]],
    width: usize,
    (top, rows): Cover,
    columns: &[Cover],
    table: &[f32; 256],
) -> Vec<[f32; N]> {
    let mut out = vec![[0.0; N]; columns.len()];
    for (j, wy) in rows.iter().enumerate().filter(|(_, w)| **w > 1e-6) {
        let row = &fine[(top + j) * width..(top + j + 1) * width];
        for (sum, (left, shares)) in out.iter_mut().zip(columns) {
            for (i, wx) in shares.iter().enumerate().filter(|(_, w)| **w > 1e-6) {
                let p = row[left + i].map(|t| t.decode(table));
                (0..N).for_each(|c| sum[c] += p[c] * wx * wy);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    const ANY: Cleaner = Cleaner {
        keep_negative: true,
        half: false,
    };

    #[test]
    fn every_level_has_the_mean_of_the_first() {
        let mut rng = Pcg32::new(3, 1);
        for (width, height) in [(64, 64), (37, 5), (1, 9), (255, 127), (3, 3), (2, 1)] {
            let size = Level { width, height };
            let texels: Vec<[f32; 1]> = (0..width * height).map(|_| [rng.next_f32()]).collect();
            let mean = texels.iter().map(|t| f64::from(t[0])).sum::<f64>() / texels.len() as f64;
            let p = Pyramid::new(size, texels.into(), Box::new([0.0; 256]), ANY, true).unwrap();
            for l in 0..p.level_count() {
                let s = p.size(l);
                let all = (0..s.height).flat_map(|y| (0..s.width).map(move |x| (x, y)));
                let sum: f64 = all
                    .map(|(x, y)| f64::from(p.quad(l, [x; 2], [y; 2])[0][0]))
                    .sum();
                let level = sum / f64::from(s.width * s.height);
                assert!((level - mean).abs() < 1e-5, "{width}x{height} level {l}");
            }
            let last = p.size(p.level_count() - 1);
            assert_eq!((last.width, last.height), (1, 1));
        }
    }

    #[test]
    fn halves_decode_exactly_even_the_smallest() {
        for bits in 0..=u16::MAX {
            let h = f16::from_bits(bits);
            if h.is_finite() {
                let ours = Half(bits).decode(&[0.0; 256]);
                assert_eq!(ours.to_bits(), h.to_f32().to_bits(), "{bits:x}");
            }
        }
    }

    #[test]
    fn eight_bit_codes_survive_and_between_them_the_closest_wins() {
        let table = crate::texture::curve::Curve::Srgb.table();
        for code in 0..=255u8 {
            assert_eq!(u8::encode(table[code as usize], &table), code);
        }
        assert_eq!(u8::encode(0.4 * table[7] + 0.6 * table[8], &table), 8);
        assert_eq!(u8::encode(0.6 * table[7] + 0.4 * table[8], &table), 7);
        assert_eq!(
            (u8::encode(-1.0, &table), u8::encode(9.0, &table)),
            (0, 255)
        );
    }
}
