//! The records a field learns from, and how they become exact integers.

use super::settings::{Settings, Target};
use super::space::Grid;
use crate::math::equal_area::{direction_code, unit};
use crate::math::rng::{hash64, unit_f32};
use crate::math::sum::SumUnit;
use crate::math::{Rgb, Vec3};

/// Light that landed on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// Where it landed.
    pub position: Vec3,
    /// Unit direction towards where the light came from.
    pub direction: Vec3,
    /// Its power in watts, not divided by the number of emitted photons.
    pub power: Rgb,
    /// Distance to where the light left a surface or emitter; infinite for environments.
    pub distance: f32,
    /// Unit shading normal where it landed (either orientation).
    pub normal: Vec3,
}

/// An estimate of incident radiance at a vertex of a camera path. Vertices that saw no light must be
/// passed too, with radiance 0: they are part of the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSample {
    /// The vertex.
    pub position: Vec3,
    /// Unit direction that was sampled from it.
    pub direction: Vec3,
    /// Estimated incident radiance from that direction, W m^-2 sr^-1.
    pub radiance: Rgb,
    /// Solid-angle density with which the direction was sampled.
    pub pdf: f32,
    /// Distance to the next vertex along the direction.
    pub distance: f32,
    /// Unit shading normal at the vertex.
    pub normal: Vec3,
}

/// A point on a surface: spread uniformly by area to measure A(r), or where a camera path met a
/// surface to mark what the image needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point.
    pub position: Vec3,
    /// Unit normal there; only used when R is split by normals.
    pub normal: Vec3,
}

/// Where a record came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// A photon: its flux counts per area.
    Photon = 0,
    /// A camera path: its estimate counts per vertex.
    Path = 1,
}

/// Why a record was not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dropped {
    NonFinite,
    BadDirection,
    Dark,
}

/// Quanta a unit in the table of sub-fluxes.
pub(crate) const TABLE_QUANTA: f32 = 16.0;

/// A record ready to be added up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deposit {
    pub position: Vec3,
    pub direction: Vec3,
    pub distance: f32,
    pub key: u64,
    pub code: u32,
    /// The target quantity, clamped, in its own unit.
    pub value: Rgb,
    /// Selection weight in units, at most 2^16.
    pub units: f32,
    /// The same in quanta of the sub-flux table, dithered so that light records are not lost.
    pub table: u32,
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
            Target::Radiance => 1.0 / p.normal.dot(p.direction).abs().clamp(MIN_COSINE, 1.0),
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
            Target::Flux => s.normal.dot(s.direction).abs(),
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

/// The scalar that decides about splits: the mean of the channels, as errors are measured on RGB.
#[inline]
pub(crate) fn weight(c: Rgb) -> f32 {
    (c.x + c.y + c.z) * (1.0 / 3.0)
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
