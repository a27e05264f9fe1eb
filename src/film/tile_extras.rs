//! What a tile's pixels carry besides: further sums, and the shapes that they see.

use super::mattes::{self, ShapeSum, ShapeSums};
use super::{ExtraSample, Extras, Sample, Tile};

impl Tile {
    /// The further sums of pixel `i`; empty if the film has none.
    pub fn extras_of(&self, i: usize) -> &[f64] {
        let count = self.extras.len() / self.area().max(1);
        &self.extras[i * count..(i + 1) * count]
    }

    /// Makes room for further sums.
    pub(super) fn carry(&mut self, extras: &Extras) {
        self.extras = vec![0.0; self.area() * extras.count()];
        if extras.mattes.is_some() {
            self.shapes = vec![ShapeSums::new(); self.area()];
        }
    }

    /// Adds a finite sample to the further sums of pixel `i`.
    pub(super) fn add_extras(&mut self, i: usize, of: &Extras, s: &Sample, extra: &ExtraSample) {
        let first = extra.first.filter(|_| s.depth > 0.0);
        let weight = f64::from(s.worth) * f64::from(s.weight);
        if let (Some(first), Some(shapes)) = (first, self.shapes.get_mut(i)) {
            mattes::add(shapes, first.shape, weight);
        }
        let count = of.count();
        let Some(sums) = self.extras.get_mut(i * count..(i + 1) * count) else {
            return;
        };
        // As with the depth: a mean over what was met.
        if let Some(first) = first {
            add(&mut sums[of.positions()], &first.position.to_array());
            add(&mut sums[of.uvs()], &first.uv.to_array());
            add(&mut sums[of.normals()], &first.normal.to_array());
        }
        if let (true, [covered]) = (s.depth > 0.0, &mut sums[of.alphas()]) {
            // By the weight of the picture's radiance, whose share it is.
            *covered += weight;
        }
        let sums = sums[of.lights()].chunks_exact_mut(3);
        for (sums, light) in sums.zip(extra.light) {
            for (sum, light) in sums.iter_mut().zip(light.to_array()) {
                let value = f64::from(light) * weight;
                *sum += if value.is_finite() { value } else { 0.0 };
            }
        }
    }

    /// The shapes that pixel `i` sees; none if the film does not ask.
    pub fn shapes_of(&self, i: usize) -> &[ShapeSum] {
        self.shapes.get(i).map_or(&[], |sums| sums)
    }

    /// The shapes that each of its pixels sees, one after the other, with the pixel's number.
    pub(super) fn all_shapes(&self) -> impl Iterator<Item = (u32, ShapeSum)> + '_ {
        let pixels = self.shapes.iter().zip(0..);
        pixels.flat_map(|(sums, pixel)| sums.iter().map(move |sum| (pixel, *sum)))
    }
}

/// Adds numbers to sums, of which there may be none.
fn add(sums: &mut [f64], values: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += match value.is_finite() {
            true => f64::from(*value),
            false => 0.0,
        };
    }
}
