//! What a spatial leaf learns from records.

use super::Settings;
use super::quadtree::{Quadtree, Sums};
use super::settings::Target;
use crate::guide::PathSample;
use crate::guide::record::weight;
use crate::math::equal_area::sphere_to_square;
use crate::math::{DVec3, Rgb};

/// Records count for no more than so many times a typical one.
const MOST: f32 = 65_536.0;

/// A spatial leaf.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    pub tree: Quadtree,
    /// Records.
    pub count: f64,
    /// Sum of flux per area, in units.
    pub flux: DVec3,
}

/// What a run of records adds to a leaf.
pub(super) struct Added {
    pub sums: Sums,
    pub flux: DVec3,
}

impl Leaf {
    /// Bytes of one without its tree.
    pub const EMPTY: u64 = size_of::<Self>() as u64;

    /// One that has met nothing.
    pub fn new() -> Self {
        Self {
            tree: Quadtree::new(),
            count: 0.0,
            flux: DVec3::ZERO,
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        Self::EMPTY + self.tree.bytes()
    }

    /// What it makes of records, in their order.
    pub fn look<'a>(
        &self,
        records: impl Iterator<Item = &'a PathSample>,
        unit: f32,
        settings: &Settings,
    ) -> Added {
        let mut added = Added {
            sums: self.tree.no_sums(),
            flux: DVec3::ZERO,
        };
        for record in records {
            let cosine = record.normal.dot(record.direction).abs().min(1.0);
            let radiance = record.radiance.max(Rgb::ZERO);
            let per_radiance = 1.0 / (f64::from(unit) * f64::from(record.pdf));
            let flux = radiance.as_dvec3() * (f64::from(cosine) * per_radiance);
            added.flux += flux * (f64::from(MOST) / flux.max_element()).min(1.0);
            let estimate = (f64::from(weight(radiance)) * per_radiance) as f32;
            let estimate = estimate.min(MOST);
            let term = match settings.target {
                Target::Radiance => estimate,
                Target::SecondMoment => (estimate * cosine).powi(2) * record.pdf,
            };
            if term > 0.0 && term < f32::MAX {
                let place = sphere_to_square(record.direction);
                let sums = &mut added.sums;
                self.tree
                    .add(sums, place, term, settings.directional_filter);
            }
        }
        added
    }
}
