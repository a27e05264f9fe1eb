//! How records become exact integers: checked, clamped, and in multiples of a unit.

use super::record::{Deposit, PathSample, Photon, TABLE_QUANTA, weight};
use super::settings::{Settings, Target};
use super::space::Grid;
use crate::math::equal_area::{direction_code, unit};
use crate::math::rng::{hash64, unit_f32};
use crate::math::sum::SumUnit;
use crate::math::{Rgb, Vec3};

/// Why a record was not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dropped {
    NonFinite,
    BadDirection,
    Dark,
}

/// Cosines below this would make single records at grazing angles dominate the radiance target
/// (2.6 % bias of a density, against a third less spread than with 1e-2).
const MIN_COSINE: f32 = 0.05;

/// Checks and quantises records against one grid and unit.
pub(crate) struct Intake<'a> {
    pub settings: &'a Settings,
    pub grid: &'a Grid,
    pub unit: SumUnit,
}

impl Intake<'_> {
    pub fn photon(&self, p: &Photon) -> Result<Deposit, Dropped> {
        let scale = match self.settings.target {
            Target::Flux => 1.0,
            Target::Radiance => 1.0 / cosine(p.normal, p.direction).clamp(MIN_COSINE, 1.0),
        };
        self.deposit(
            p.position,
            p.direction,
            p.power * scale,
            p.distance,
            p.normal,
        )
    }

    pub fn path(&self, s: &PathSample) -> Result<Deposit, Dropped> {
        if s.pdf.is_nan() || s.pdf <= 0.0 {
            return Err(Dropped::NonFinite);
        }
        let cosine = match self.settings.target {
            Target::Flux => cosine(s.normal, s.direction),
            Target::Radiance => 1.0,
        };
        let value = s.radiance * (cosine / s.pdf);
        self.deposit(s.position, s.direction, value, s.distance, s.normal)
    }

    fn deposit(
        &self,
        position: Vec3,
        direction: Vec3,
        value: Rgb,
        distance: f32,
        normal: Vec3,
    ) -> Result<Deposit, Dropped> {
        if !(position.is_finite() && value.is_finite()) {
            return Err(Dropped::NonFinite);
        }
        let direction = unit(direction).ok_or(Dropped::BadDirection)?;
        let value = value.max(Vec3::ZERO);
        let unit_value = self.unit.value() as f32;
        let largest = value.max_element();
        if largest <= 0.0 {
            return Err(Dropped::Dark);
        }
        let limit = self.settings.clamp * unit_value;
        let value = if largest > limit {
            value * (limit / largest)
        } else {
            value
        };
        let units = (weight(value) / unit_value).min(65_536.0);
        Ok(Deposit {
            position,
            direction,
            distance: if distance > 0.0 { distance } else { 0.0 },
            key: self.grid.key(position, normal),
            code: direction_code(direction),
            value,
            units,
            table: dither(units * TABLE_QUANTA, position, direction),
        })
    }
}

/// How much a surface of this normal sees of light from a direction; 1 in a medium.
fn cosine(normal: Vec3, direction: Vec3) -> f32 {
    match normal == Vec3::ZERO {
        true => 1.0,
        false => normal.dot(direction).abs(),
    }
}

/// Rounds up or down by chance that depends on the record alone, so that the mean is kept and the
/// order of records does not matter.
fn dither(x: f32, p: Vec3, w: Vec3) -> u32 {
    let bits = |a: f32, b: f32| (u64::from(a.to_bits()) << 32) | u64::from(b.to_bits());
    let h = hash64(bits(w.x, w.y) ^ bits(p.x, p.y).rotate_left(17) ^ u64::from(p.z.to_bits()));
    (x + unit_f32((h >> 32) as u32)).floor() as u32
}

/// The unit for a batch: a power of two at its median positive weight. The median, unlike the mean,
/// is not moved by one firefly.
pub(crate) fn batch_unit(values: impl Iterator<Item = Rgb>) -> Option<SumUnit> {
    let mut w: Vec<f32> = values
        .map(weight)
        .filter(|w| *w > 0.0 && w.is_finite())
        .collect();
    if w.is_empty() {
        return None;
    }
    let middle = w.len() / 2;
    let (_, median, _) = w.select_nth_unstable_by(middle, f32::total_cmp);
    Some(SumUnit::near(*median))
}
