//! Tables over the unit square, linear between their points, for pairs of parameters between which
//! they are linear, too; and drawing from such tables.
//!
//! This is the representation of measured materials (Dupuy and Jakob, "An Adaptive Parameterization
//! for Efficient Material Acquisition and Rendering", 2018). How samples are mapped is part of it: a
//! row by its mass first, then the place in the row.

use super::Vec2;
use super::distribution::sample_linear;
use std::ops::{Add, Mul};

/// Two lists of increasing numbers: there is a table for each pair, the second changes fastest.
#[derive(Clone, Debug)]
pub struct Knots([Vec<f32>; 2]);

/// The tables around a pair of parameters, by number, and their weights.
#[derive(Clone, Copy, Debug)]
pub struct Between([(usize, f32); 4]);

impl Knots {
    /// `None` unless both lists have an entry and increase.
    pub fn new(lists: [Vec<f32>; 2]) -> Option<Self> {
        let increases = |list: &Vec<f32>| list.windows(2).all(|pair| pair[0] < pair[1]);
        let usable = |list: &Vec<f32>| !list.is_empty() && increases(list);
        lists.iter().all(usable).then_some(Self(lists))
    }

    /// The tables around a pair; beyond the lists' ends those of the ends.
    #[inline]
    pub fn around(&self, parameters: [f32; 2]) -> Between {
        let [a, b] = [0, 1].map(|i| interval(&self.0[i], parameters[i]));
        let width = self.0[1].len();
        let pair = |x: (usize, f32), y: (usize, f32)| (x.0 * width + y.0, x.1 * y.1);
        Between([
            pair(a[0], b[0]),
            pair(a[0], b[1]),
            pair(a[1], b[0]),
            pair(a[1], b[1]),
        ])
    }
}

impl Between {
    /// The only table, where there is one.
    pub const ONLY: Self = Self([(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]);

    /// The weighted sum of what each table has.
    #[inline]
    fn blend<T: Mul<f32, Output = T> + Add<Output = T>>(&self, of: impl Fn(usize) -> T) -> T {
        let [(first, weight), rest @ ..] = self.0;
        rest.iter()
            .filter(|(_, weight)| *weight > 0.0)
            .fold(of(first) * weight, |sum, (i, weight)| {
                sum + of(*i) * *weight
            })
    }
}

/// The entries of a list on both sides of `x`, and their weights.
#[inline]
fn interval(list: &[f32], x: f32) -> [(usize, f32); 2] {
    let upper = list.partition_point(|entry| *entry <= x);
    let low = upper.clamp(1, list.len().max(2) - 1) - 1;
    let high = (low + 1).min(list.len() - 1);
    let span = list[high] - list[low];
    let t = if span > 0.0 {
        ((x - list[low]) / span).clamp(0.0, 1.0)
    } else {
        0.0
    };
    [(low, 1.0 - t), (high, t)]
}

/// Columns and rows of a table: at least 2 of each.
pub type Size = [usize; 2];

/// The cell of `points` equally spaced ones that a share `x` of the way lies in, and how far in it.
#[inline]
fn cell(x: f32, points: usize) -> (usize, f32) {
    // What is no number counts as 0.
    let share = if x > 0.0 { x.min(1.0) } else { 0.0 };
    let place = share * (points - 1) as f32;
    let i = (place as usize).min(points - 2);
    (i, place - i as f32)
}

/// Tables of numbers or colours.
#[derive(Clone, Debug)]
pub struct Tables<T> {
    size: Size,
    values: Vec<T>,
}

impl<T: Copy + Mul<f32, Output = T> + Add<Output = T>> Tables<T> {
    /// Tables one after the other, of rows one after the other.
    ///
    /// # Panics
    /// If a table has fewer than two rows or columns, or `values` are not as many as whole tables
    /// have.
    pub fn new(size: Size, values: Vec<T>) -> Self {
        assert!(
            size.iter().all(|n| *n >= 2),
            "a table needs two rows and two columns"
        );
        assert!(
            values.len() % (size[0] * size[1]) == 0,
            "these are no whole tables"
        );
        Self { size, values }
    }

    /// The value at a point of the unit square; `p.x` is the place along a row.
    #[inline]
    pub fn eval(&self, p: Vec2, between: &Between) -> T {
        let (column, x) = cell(p.x, self.size[0]);
        let (row, y) = cell(p.y, self.size[1]);
        let [left, right] = self.across(column, row, y, between);
        left * (1.0 - x) + right * x
    }

    /// The values at a height `y` inside of a cell, at its left and its right side.
    #[inline]
    fn across(&self, column: usize, row: usize, y: f32, between: &Between) -> [T; 2] {
        let [width, height] = self.size;
        [0, 1].map(|side| {
            let at = |row: usize| {
                between.blend(|table| self.values[(table * height + row) * width + column + side])
            };
            at(row) * (1.0 - y) + at(row + 1) * y
        })
    }
}

/// Tables of densities over the unit square, with the mapping from uniform samples to theirs.
#[derive(Clone, Debug)]
pub struct PiecewiseLinear {
    /// Densities in a unit in which the cells of a table sum up to 1.
    density: Tables<f32>,
    /// The mass of a row up to each of its points, for a row as high as a cell.
    along_row: Vec<f32>,
    /// The mass of the rows below each one.
    below: Vec<f32>,
    /// Cells of a table.
    cells: f32,
}

impl PiecewiseLinear {
    /// Of tables as in [`Tables::new`], whose values are not negative and are scaled. `None` if a
    /// table is 0 everywhere, or too large for its sum.
    ///
    /// # Panics
    /// As [`Tables::new`].
    pub fn new(size: Size, mut values: Vec<f32>) -> Option<Self> {
        let [width, height] = size;
        let mut along_row = Vec::with_capacity(values.len());
        let mut below = Vec::with_capacity(values.len() / width);
        for table in values.chunks_exact_mut(width * height) {
            let rows: Vec<Vec<f64>> = table.chunks_exact(width).map(cumulative).collect();
            let masses: Vec<f64> = rows.iter().map(|row| row[width - 1]).collect();
            let masses = cumulative(&masses);
            let scale = masses[height - 1].recip();
            if !(scale.is_finite() && scale > 0.0) {
                return None;
            }
            let scaled = |x: &f64| (x * scale) as f32;
            along_row.extend(rows.iter().flatten().map(scaled));
            below.extend(masses.iter().map(scaled));
            for value in table {
                *value = (f64::from(*value) * scale) as f32;
            }
        }
        Some(Self {
            density: Tables::new(size, values),
            along_row,
            below,
            cells: ((width - 1) * (height - 1)) as f32,
        })
    }

    /// The density at a point of the unit square.
    #[inline]
    pub fn density(&self, p: Vec2, between: &Between) -> f32 {
        self.density.eval(p, between) * self.cells
    }

    /// The point that a uniform sample is mapped to, and its density there.
    #[inline]
    pub fn sample(&self, u: Vec2, between: &Between) -> (Vec2, f32) {
        let [width, height] = self.density.size;
        let row = last_below(height, u.y, |i| self.below(i, between));
        let masses = [row, row + 1].map(|row| self.along_row(width - 1, row, between));
        let y = inside(masses, u.y - self.below(row, between));
        let up_to = |column: usize| {
            let [lower, upper] = [row, row + 1].map(|row| self.along_row(column, row, between));
            lower * (1.0 - y) + upper * y
        };
        let ux = u.x * (masses[0] * (1.0 - y) + masses[1] * y);
        let column = last_below(width, ux, up_to);
        let sides = self.density.across(column, row, y, between);
        let x = inside(sides, ux - up_to(column));
        let place = Vec2::new(column as f32 + x, row as f32 + y);
        let density = (sides[0] * (1.0 - x) + sides[1] * x) * self.cells;
        (
            place / Vec2::new((width - 1) as f32, (height - 1) as f32),
            density,
        )
    }

    /// The sample that is mapped to a point, and the density there.
    #[inline]
    pub fn invert(&self, p: Vec2, between: &Between) -> (Vec2, f32) {
        let [width, height] = self.density.size;
        let (column, x) = cell(p.x, width);
        let (row, y) = cell(p.y, height);
        let rows = [row, row + 1];
        let lerp = |[a, b]: [f32; 2], t: f32| a * (1.0 - t) + b * t;
        let masses = rows.map(|row| self.along_row(width - 1, row, between));
        let up_to = rows.map(|row| self.along_row(column, row, between));
        let sides = self.density.across(column, row, y, between);
        let across = lerp(up_to, y) + integral(sides, x);
        let whole = lerp(masses, y);
        let u = Vec2::new(
            if whole > 0.0 { across / whole } else { x },
            self.below(row, between) + integral(masses, y),
        );
        (u, lerp(sides, x) * self.cells)
    }

    #[inline]
    fn below(&self, row: usize, between: &Between) -> f32 {
        let height = self.density.size[1];
        between.blend(|table| self.below[table * height + row])
    }

    #[inline]
    fn along_row(&self, column: usize, row: usize, between: &Between) -> f32 {
        let [width, height] = self.density.size;
        between.blend(|table| self.along_row[(table * height + row) * width + column])
    }
}

/// The integral up to each point of a function that is linear between points one apart.
fn cumulative<T: Copy + Into<f64>>(values: &[T]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = values.windows(2).map(|pair| {
        sum += 0.5 * (pair[0].into() + pair[1].into());
        sum
    });
    std::iter::once(0.0).chain(steps).collect()
}

/// The integral from 0 to `t` of what goes from `a` to `b`.
#[inline]
fn integral([a, b]: [f32; 2], t: f32) -> f32 {
    t * (a + 0.5 * t * (b - a))
}

/// Where the integral of what goes from `a` to `b` is `mass`, between 0 and 1.
#[inline]
fn inside([a, b]: [f32; 2], mass: f32) -> f32 {
    let whole = 0.5 * (a + b);
    if whole > 0.0 {
        sample_linear(a, b, (mass / whole).clamp(0.0, 1.0))
    } else {
        0.5
    }
}

/// The last of `points` cells whose beginning is at most `u`.
#[inline]
fn last_below(points: usize, u: f32, begin: impl Fn(usize) -> f32) -> usize {
    let (mut low, mut high) = (0, points - 2);
    while low < high {
        let middle = (low + high).div_ceil(2);
        if begin(middle) <= u {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    /// Two by three tables of 5 by 4 points, with a cell that is 0.
    fn example() -> (Knots, PiecewiseLinear) {
        let knots = Knots::new([vec![-1.0, 0.5], vec![0.0, 1.0, 3.0]]).unwrap();
        let mut rng = Pcg32::new(4, 2);
        let mut values: Vec<f32> = (0..6 * 20).map(|_| 0.1 + rng.next_f32()).collect();
        for corner in [6, 7, 11, 12] {
            values[corner] = 0.0;
        }
        (knots, PiecewiseLinear::new([5, 4], values).unwrap())
    }

    #[test]
    fn densities_integrate_to_one_and_samples_follow_them() {
        let (knots, warp) = example();
        let mut rng = Pcg32::new(1, 1);
        for parameters in [
            [-1.0, 0.0],
            [0.1, 0.3],
            [0.5, 3.0],
            [9.0, -9.0],
            [-0.4, 2.9],
        ] {
            let between = knots.around(parameters);
            let n = 200;
            let (mut mass, mut mean) = (0.0, Vec2::ZERO);
            for i in 0..n * n {
                let p = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                let density = warp.density(p, &between) / (n * n) as f32;
                mass += density;
                mean += p * density;
            }
            assert!((mass - 1.0).abs() < 1e-3, "{parameters:?}: {mass}");
            let draws = 40_000;
            let mut drawn = Vec2::ZERO;
            for _ in 0..draws {
                let u = Vec2::new(rng.next_f32(), rng.next_f32());
                let (p, density) = warp.sample(u, &between);
                drawn += p / draws as f32;
                assert!((density / warp.density(p, &between) - 1.0).abs() < 1e-3);
                let (back, again) = warp.invert(p, &between);
                assert!((back - u).abs().max_element() < 2e-4, "{u} {back}");
                assert!((again / density - 1.0).abs() < 1e-3);
            }
            // The standard error of a mean of numbers in [0, 1] is at most 0.0015 here.
            assert!((drawn - mean).abs().max_element() < 0.006, "{drawn} {mean}");
        }
    }

    /// Four numbers by hand: the table 1 2 / 3 4 at (0.25, 0.5) is 2.25, times 2 and 1 halfway.
    #[test]
    fn values_are_linear_between_points_and_between_parameters() {
        let table = [1.0f32, 2.0, 3.0, 4.0];
        let values: Vec<f32> = [1.0, 2.0]
            .iter()
            .flat_map(|k| table.map(|v| v * k))
            .collect();
        let tables = Tables::new([2, 2], values);
        let knots = Knots::new([vec![0.0], vec![1.0, 2.0]]).unwrap();
        let at = |x| tables.eval(Vec2::new(0.25, 0.5), &knots.around([7.0, x]));
        for (x, expected) in [
            (0.0, 2.25),
            (1.0, 2.25),
            (1.5, 3.375),
            (2.0, 4.5),
            (5.0, 4.5),
        ] {
            assert!((at(x) - expected).abs() < 1e-6, "{x}: {}", at(x));
        }
        assert_eq!(tables.eval(Vec2::NAN, &Between::ONLY), 1.0);
    }

    #[test]
    fn lists_that_do_not_increase_and_tables_without_mass_are_refused() {
        assert!(Knots::new([vec![], vec![0.0]]).is_none());
        assert!(Knots::new([vec![1.0, 1.0], vec![0.0]]).is_none());
        assert!(Knots::new([vec![0.0, f32::NAN], vec![0.0]]).is_none());
        assert!(PiecewiseLinear::new([2, 2], vec![0.0; 4]).is_none());
    }
}
