//! Measured materials (Dupuy and Jakob, "An Adaptive Parameterization for Efficient Material
//! Acquisition and Rendering", 2018): tables, and how they scatter.
//!
//! Normals of facets m are drawn from tables of visible normals, one for each direction o of a grid;
//! colours are tabulated over the square of the samples that they are drawn with. With the density
//! of normals D and their projected area sigma,
//!
//! ```text
//!  f(o, i) cos(i) = colour(sample of m) D(m) / (4 sigma(o))
//! ```
//!
//! Conventions are those of Mitsuba's `measured`: an elevation is u^2 pi/2, an azimuth
//! (2u - 1) pi, that of m is counted from o where the material is isotropic.

use crate::math::piecewise_linear::{Between, Knots, PiecewiseLinear, Size, Tables};
use crate::math::{Rgb, Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI, TAU};
use std::fmt::{self, Debug, Formatter};
use std::sync::{Mutex, PoisonError};
use xxhash_rust::xxh3::Xxh3;

/// Where the mapping from the square to normals is singular, its density is bounded so.
const MIN_JACOBIAN: f32 = 1e-6;

/// What a file holds, as it stands there: rows are azimuths, columns elevations of normals.
#[derive(Clone, Debug, Default)]
pub struct MeasuredTables {
    /// Azimuths of directions, in radians, increasing. One or two stand for an isotropic material.
    pub azimuths: Vec<f32>,
    /// Elevations of directions, in radians, increasing.
    pub elevations: Vec<f32>,
    /// Density of normals, and columns and rows of the table.
    pub normals: (Size, Vec<f32>),
    /// Projected area of the facets.
    pub areas: (Size, Vec<f32>),
    /// Densities of visible normals by azimuth and elevation.
    pub visible: (Size, Vec<f32>),
    /// Densities of samples by azimuth and elevation, so that bright ones are drawn often.
    pub luminance: (Size, Vec<f32>),
    /// Colours by azimuth and elevation.
    pub colors: (Size, Vec<Rgb>),
    /// Whether colours are relative to D / (4 sigma).
    pub relative: bool,
}

/// Tables that are ready to scatter.
pub struct MeasuredBrdf {
    knots: Knots,
    isotropic: bool,
    /// How often the azimuths have to be repeated for a full turn: 2 turned, 4 mirrored.
    symmetry: u32,
    normals: Tables<f32>,
    areas: Tables<f32>,
    visible: PiecewiseLinear,
    luminance: PiecewiseLinear,
    colors: Tables<Rgb>,
    relative: bool,
    albedo: Rgb,
    roughness: f32,
    digest: u128,
}

/// All that were made. A lobe is plain numbers and may outlive its scene: what it refers to is kept
/// until the program ends, once for each file.
static MADE: Mutex<Vec<&MeasuredBrdf>> = Mutex::new(Vec::new());

impl MeasuredBrdf {
    /// Checks tables and prepares them; the same tables give the same material.
    ///
    /// # Errors
    /// Says what is wrong with the tables.
    pub fn new(tables: MeasuredTables) -> Result<&'static Self, String> {
        let digest = tables.digest();
        let known = |list: &[&'static Self]| list.iter().copied().find(|m| m.digest == digest);
        if let Some(known) = known(&MADE.lock().unwrap_or_else(PoisonError::into_inner)) {
            return Ok(known);
        }
        let made = Self::of(tables, digest)?;
        let mut list = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(known(&list).unwrap_or_else(|| {
            let made: &'static Self = Box::leak(Box::new(made));
            list.push(made);
            made
        }))
    }

    fn of(tables: MeasuredTables, digest: u128) -> Result<Self, String> {
        tables.check()?;
        let empty = |what: &str| format!("a table of \"{what}\" is 0 everywhere");
        let roughness = tables.roughness();
        let turn = tables.azimuths.last().unwrap_or(&0.0) - tables.azimuths.first().unwrap_or(&0.0);
        let isotropic = tables.azimuths.len() <= 2;
        let knots = Knots::new([tables.azimuths, tables.elevations]);
        let (size, visible) = tables.visible;
        let visible = PiecewiseLinear::new(size, visible).ok_or_else(|| empty("vndf"))?;
        let (size, luminance) = tables.luminance;
        let luminance = PiecewiseLinear::new(size, luminance).ok_or_else(|| empty("luminance"))?;
        let mut made = Self {
            knots: knots.ok_or("\"phi_i\" and \"theta_i\" must be lists of increasing angles")?,
            isotropic,
            symmetry: if isotropic {
                1
            } else {
                (TAU / turn).round() as u32
            },
            normals: Tables::new(tables.normals.0, tables.normals.1),
            areas: Tables::new(tables.areas.0, tables.areas.1),
            visible,
            luminance,
            colors: Tables::new(tables.colors.0, tables.colors.1),
            relative: tables.relative,
            albedo: Rgb::ZERO,
            roughness,
            digest,
        };
        made.albedo = made.reflected();
        Ok(made)
    }

    /// Whether it depends on where the tangent points.
    pub(super) fn is_anisotropic(&self) -> bool {
        !self.isotropic
    }

    /// The part of light along the normal that is reflected.
    pub(super) fn albedo(&self) -> Rgb {
        self.albedo
    }

    /// Width of GGX facets that are as dense where they are densest.
    pub(super) fn roughness(&self) -> f32 {
        self.roughness
    }

    /// `f |cos theta_i|` and the density of [`MeasuredBrdf::sample`], for directions above the
    /// surface.
    pub(super) fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let turned = self.turned(wo);
        let (wo, m) = (turned * wo, (turned * (wo + wi)).normalize());
        let (between, azimuth) = self.around(wo);
        let m_azimuth = m.y.atan2(m.x) - if self.isotropic { azimuth } else { 0.0 };
        let place = Vec2::new(from_elevation(elevation(m)), from_azimuth(m_azimuth));
        let (sample, visible) = self.visible.invert(place, &between);
        let pdf = visible * self.luminance.density(sample, &between) / jacobian(place.x, m, wo);
        let mut value = self.colors.eval(sample, &between).max(Rgb::ZERO);
        if self.relative {
            let of_o = Vec2::new(from_elevation(elevation(wo)), from_azimuth(azimuth));
            let area = self.areas.eval(of_o, &Between::ONLY);
            value *= self.normals.eval(place, &Between::ONLY) / (4.0 * area);
        }
        if value.is_finite() && pdf.is_finite() && pdf > 0.0 {
            (value, pdf)
        } else {
            (Rgb::ZERO, 0.0)
        }
    }

    /// Draws a direction for one above the surface; it may lie below.
    pub(super) fn sample(&self, wo: Vec3, u: Vec2) -> Vec3 {
        let turned = self.turned(wo);
        let wo = turned * wo;
        let (between, azimuth) = self.around(wo);
        let (sample, _) = self.luminance.sample(u, &between);
        let (place, _) = self.visible.sample(sample, &between);
        let phi = (2.0 * place.y - 1.0) * PI + if self.isotropic { azimuth } else { 0.0 };
        let (sin_theta, cos_theta) = (place.x * place.x * (0.5 * PI)).sin_cos();
        let (sin_phi, cos_phi) = phi.sin_cos();
        let m = Vec3::new(cos_phi * sin_theta, sin_phi * sin_theta, cos_theta);
        turned * (m * (2.0 * m.dot(wo)) - wo)
    }

    /// Signs that take a direction to where the azimuths of the tables are.
    fn turned(&self, wo: Vec3) -> Vec3 {
        let to_negative = |x: f32| -(1f32.copysign(x));
        match self.symmetry {
            0 | 1 => Vec3::ONE,
            4 => Vec3::new(to_negative(wo.x), to_negative(wo.y), 1.0),
            _ => Vec3::new(to_negative(wo.y), to_negative(wo.y), 1.0),
        }
    }

    /// The tables around a direction, and its azimuth.
    fn around(&self, wo: Vec3) -> (Between, f32) {
        let azimuth = wo.y.atan2(wo.x);
        (self.knots.around([azimuth, elevation(wo)]), azimuth)
    }

    /// The mean weight of samples from the normal.
    fn reflected(&self) -> Rgb {
        const SIDE: usize = 32;
        let weight = |i: usize| {
            let u = Vec2::new((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5) / SIDE as f32;
            let wi = self.sample(Vec3::Z, u);
            let (value, pdf) = self.eval_pdf(Vec3::Z, wi);
            if wi.z > 0.0 && pdf > 0.0 {
                value / pdf
            } else {
                Rgb::ZERO
            }
        };
        let sum: Rgb = (0..SIDE * SIDE).map(weight).sum();
        (sum / (SIDE * SIDE) as f32).clamp(Rgb::ZERO, Rgb::ONE)
    }
}

/// The fingerprint of a scene is made of this.
impl Debug for MeasuredBrdf {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "MeasuredBrdf({:032x})", self.digest)
    }
}

impl MeasuredTables {
    fn digest(&self) -> u128 {
        let mut hash = Xxh3::new();
        let mut add = |size: &[usize], values: &[f32]| {
            hash.update(format!("{size:?}").as_bytes());
            hash.update(bytemuck::cast_slice(values));
        };
        add(&[self.azimuths.len()], &self.azimuths);
        add(
            &[self.elevations.len(), usize::from(self.relative)],
            &self.elevations,
        );
        for (size, values) in [&self.normals, &self.areas, &self.visible, &self.luminance] {
            add(size, values);
        }
        let colors: Vec<f32> = self.colors.1.iter().flat_map(|c| c.to_array()).collect();
        add(&self.colors.0, &colors);
        hash.digest128()
    }

    /// That tables have the sizes that they need, and values that can be used.
    fn check(&self) -> Result<(), String> {
        let pairs = self.azimuths.len() * self.elevations.len();
        let single = [("ndf", &self.normals), ("sigma", &self.areas)];
        let many = [("vndf", &self.visible), ("luminance", &self.luminance)];
        let counted = single.map(|table| (1, table)).into_iter();
        for (count, (name, (size, values))) in counted.chain(many.map(|table| (pairs, table))) {
            checked_size(name, *size, values.len(), count)?;
            let unusable = |v: &&f32| !(v.is_finite() && **v >= 0.0);
            if let Some(value) = values.iter().find(unusable) {
                return Err(format!(
                    "\"{name}\" holds {value}: it must be finite and not negative"
                ));
            }
        }
        let (size, colors) = &self.colors;
        checked_size("colours", *size, colors.len(), pairs)?;
        if colors.iter().any(|c| !c.is_finite()) {
            return Err("a colour is not finite".into());
        }
        let angles = self.azimuths.iter().chain(&self.elevations);
        match angles.into_iter().all(|a| a.abs() <= 2.0 * TAU) {
            true => Ok(()),
            false => Err("an angle of \"phi_i\" or \"theta_i\" is no angle in radians".into()),
        }
    }

    /// GGX facets of width alpha have a density of 1 / (pi alpha^2) along the normal, if their
    /// projected area is 1. The table's scale is arbitrary: its own projected area tells it.
    fn roughness(&self) -> f32 {
        let ([columns, rows], values) = &self.normals;
        let mut area = 0.0;
        for (i, value) in values.iter().enumerate() {
            let (row, u) = (i / columns, (i % columns) as f32 / (columns - 1) as f32);
            let theta = u * u * (0.5 * PI);
            // The trapezoidal rule; both ends of a row weigh nothing.
            let weight = if row % (rows - 1) == 0 { 0.5 } else { 1.0 };
            area += weight * value * 2.0 * PI * PI * u * theta.sin() * theta.cos();
        }
        area /= ((columns - 1) * (rows - 1)) as f32;
        let densest = values.iter().fold(0.0, |most: f32, v| most.max(*v));
        let alpha = (area / (PI * densest)).sqrt();
        if alpha.is_finite() {
            alpha.clamp(1e-3, 1.0)
        } else {
            1.0
        }
    }
}

fn checked_size(
    name: &str,
    [columns, rows]: Size,
    has: usize,
    tables: usize,
) -> Result<(), String> {
    if columns < 2 || rows < 2 {
        return Err(format!(
            "\"{name}\" has {columns} x {rows} values; at least 2 x 2 are needed"
        ));
    }
    match columns
        .checked_mul(rows)
        .and_then(|n| n.checked_mul(tables))
    {
        Some(needs) if needs == has => Ok(()),
        _ => Err(format!(
            "\"{name}\" has {has} values, not {tables} tables of {columns} x {rows}"
        )),
    }
}

/// The angle to the normal, without loss of digits near it.
fn elevation(w: Vec3) -> f32 {
    2.0 * (0.5 * (w - Vec3::Z).length()).min(1.0).asin()
}

fn from_elevation(theta: f32) -> f32 {
    (theta * (2.0 * FRAC_1_PI)).sqrt()
}

fn from_azimuth(phi: f32) -> f32 {
    let turns = (phi + PI) / TAU;
    turns - turns.floor()
}

/// From densities over the square to those over directions: a solid angle of normals over the
/// square's area, and one of directions over that.
fn jacobian(u: f32, m: Vec3, wo: Vec3) -> f32 {
    let sin_theta = m.x.hypot(m.y);
    (2.0 * PI * PI * u * sin_theta).max(MIN_JACOBIAN) * 4.0 * m.dot(wo)
}
