//! Which shapes a pixel sees, and how much of each: what mattes of objects and materials are made
//! of.
//!
//! A pixel keeps a sum of filter weights for every shape that any of its samples has met, however
//! many those are. With a fixed number of places, what is seen last would have to go without, and
//! which that is would depend on where a render was interrupted. Sums grow in the order of the
//! samples like all others.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What shapes are called, and what they are made of.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mattes {
    /// Names of objects. Several shapes may be one object.
    pub objects: Vec<String>,
    /// Names of materials.
    pub materials: Vec<String>,
    /// Of each shape, the numbers of its object and of its material.
    pub shapes: Vec<[u32; 2]>,
}

/// What mattes tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatteKind {
    /// Objects.
    Object,
    /// Materials.
    Material,
}

impl Mattes {
    /// Those of shapes with these names of objects and materials. What has the same name is the
    /// same.
    pub fn new<'n>(shapes: impl IntoIterator<Item = [&'n str; 2]>) -> Self {
        let mut known = [BTreeMap::new(), BTreeMap::new()];
        let mut names = [Vec::new(), Vec::new()];
        let mut number = |kind: usize, name: &'n str| {
            *known[kind].entry(name).or_insert_with(|| {
                names[kind].push(name.to_owned());
                names[kind].len() as u32 - 1
            })
        };
        let shapes = shapes.into_iter();
        let shapes = shapes.map(|[object, material]| [number(0, object), number(1, material)]);
        let shapes = shapes.collect();
        let [objects, materials] = names;
        Self {
            objects,
            materials,
            shapes,
        }
    }

    /// Names of a kind.
    pub fn names(&self, kind: MatteKind) -> &[String] {
        match kind {
            MatteKind::Object => &self.objects,
            MatteKind::Material => &self.materials,
        }
    }

    /// The sums of shapes as those of what a kind tells apart: by number, ascending.
    pub fn sums(&self, kind: MatteKind, shapes: &[ShapeSum]) -> Vec<(u32, f64)> {
        let mut sums: Vec<(u32, f64)> = Vec::with_capacity(shapes.len());
        for sum in shapes {
            let Some(of) = self.shapes.get(sum.shape as usize) else {
                continue;
            };
            let number = of[kind as usize];
            match sums.iter_mut().find(|known| known.0 == number) {
                Some(known) => known.1 += sum.weight,
                None => sums.push((number, sum.weight)),
            }
        }
        sums.sort_unstable_by_key(|sum| sum.0);
        sums
    }
}

/// How much a pixel sees of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeSum {
    /// Number of the shape.
    pub shape: u32,
    /// Sum of worth times weight of the samples that have met it.
    pub weight: f64,
}

/// The shapes that a pixel sees, by number, ascending.
pub type ShapeSums = Vec<ShapeSum>;

/// Bytes that a pixel takes which sees few shapes.
pub(super) const USUAL_BYTES: usize = size_of::<ShapeSums>() + 4 * size_of::<ShapeSum>();

/// Adds a sample that has met a shape.
pub(super) fn add(sums: &mut ShapeSums, shape: u32, weight: f64) {
    match sums.binary_search_by_key(&shape, |sum| sum.shape) {
        Ok(at) => sums[at].weight += weight,
        Err(at) => sums.insert(at, ShapeSum { shape, weight }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_of_one_name_are_one_object_and_sums_keep_the_order_of_samples() {
        let mattes = Mattes::new([["a", "x"], ["b", "y"], ["a", "y"]]);
        assert_eq!(mattes.objects, ["a", "b"]);
        assert_eq!(mattes.materials, ["x", "y"]);
        assert_eq!(mattes.shapes, [[0, 0], [1, 1], [0, 1]]);
        let mut sums = ShapeSums::new();
        for (shape, weight) in [(2, 1.0), (0, 1e-20), (2, -1.0), (2, 1e-20), (1, 0.5)] {
            add(&mut sums, shape, weight);
        }
        let numbers: Vec<u32> = sums.iter().map(|sum| sum.shape).collect();
        assert_eq!(numbers, [0, 1, 2]);
        // In another order of the samples this would be 0.
        assert_eq!(sums[2].weight, 1e-20);
        let objects = mattes.sums(MatteKind::Object, &sums);
        assert_eq!(objects, [(0, 2e-20), (1, 0.5)]);
        let materials = mattes.sums(MatteKind::Material, &sums);
        assert_eq!(materials, [(0, 1e-20), (1, 0.5 + 1e-20)]);
    }
}
