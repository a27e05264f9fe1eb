//! Participating media.

use super::importer::{Importer, Role};
use super::parameter::Kind;
use super::params::Params;
use super::statement::Directive;
use super::subsurface::homogeneous;
use super::{graphics, presets};
use crate::math::{DAffine3, DVec3, Rgb};
use crate::medium::grids::{Albedo, Filter, Grid, Heterogeneous, Lookup, Wrap};
use crate::medium::{Extinction, Homogeneous, Medium, MediumId, PhaseLobe, VACUUM};
use crate::scene::import::faults::At;
use crate::scene::import::named;
use std::sync::Arc;

/// The kinds of media that are read.
pub(super) const MEDIA: &[&str] = &["homogeneous", "uniformgrid", "rgbgrid", "cloud"];

impl<'s> Importer<'s> {
    /// The medium of that name; nothing for an empty one.
    pub fn medium_named(&mut self, name: &str, at: At) -> MediumId {
        if name.is_empty() {
            return VACUUM;
        }
        let known = self.named_media.get(name).cloned();
        let later = || self.later(Directive::MakeNamedMedium, name, false);
        let Some(definition) = known.or_else(later) else {
            let known = self.named_media.keys().copied();
            let help = named::did_you_mean(name, known).map_or(String::new(), |h| format!("; {h}"));
            let message = format!("there is no medium \"{name}\"{help}");
            self.source.fault(at, message, "nothing takes its place");
            return VACUUM;
        };
        let key = definition.identity();
        if let Some(&id) = self.medium_of.get(&key) {
            return id;
        }
        let p = Params::new(self.source, &definition);
        let id = match self.medium(&p) {
            Ok(medium) => self.media.push(medium),
            Err(message) => {
                self.source
                    .fault(p.at(), message, "nothing takes its place");
                VACUUM
            }
        };
        self.medium_of.insert(key, id);
        id
    }

    fn medium(&mut self, p: &Params<'_, 's>) -> Result<Medium, String> {
        let kind = p.text("type").ok_or("a medium needs a \"type\"")?;
        let extinction = match kind {
            "homogeneous" => {
                let (sigma_a, sigma_s) = self.coefficients(p)?;
                let scale = p.float_in("scale", 1.0, 0.0..=1e30) as f32;
                homogeneous(sigma_a * scale, sigma_s * scale).into()
            }
            "uniformgrid" => self.uniform_grid(p)?,
            "rgbgrid" => self.rgb_grid(p)?,
            "cloud" => self.cloud(p)?,
            other => {
                return Err(format!(
                    "the medium \"{other}\" is not read: {} are",
                    MEDIA.join(", ")
                ));
            }
        };
        self.left_out(
            p,
            &[
                "Le",
                "Lescale",
                "temperature",
                "temperaturescale",
                "temperatureoffset",
                "temperaturecutoff",
            ],
            "media do not glow here",
        );
        let g = p.float_in("g", 0.0, -1.0..=1.0) as f32;
        self.done(p);
        Ok(Medium {
            name: p.definition.plugin.name.clone(),
            extinction,
            phase: PhaseLobe::henyey_greenstein(g).into(),
        })
    }

    /// Absorption and scattering: of a substance by name, or as they are given.
    pub fn coefficients(&mut self, p: &Params<'_, 's>) -> Result<(Rgb, Rgb), String> {
        if let Some(name) = p.text("preset").filter(|name| !name.is_empty()) {
            return presets::coefficients(name);
        }
        let mut one = |name| {
            let given = self.mean_given(p, name, Role::Unbounded);
            given.unwrap_or(Rgb::ONE)
        };
        Ok((one("sigma_a"), one("sigma_s")))
    }

    /// From the unit cube to the box between the corners `p0` and `p1`.
    fn to_box(&self, p: &Params<'_, 's>) -> Result<DAffine3, String> {
        let from = p.triple("p0", DVec3::ZERO);
        let size = p.triple("p1", DVec3::ONE) - from;
        let local = DAffine3::from_translation(from) * DAffine3::from_scale(size);
        let to_world = p
            .definition
            .affine()
            .ok_or("its transform is no affine map")?;
        Ok(self.place(to_world * local, None))
    }

    /// Values in so many voxels between the corners `p0` and `p1`.
    fn grid(
        &self,
        p: &Params<'_, 's>,
        resolution: [u32; 3],
        channels: u32,
        values: Vec<f32>,
        wrap: Wrap,
    ) -> Result<Grid, String> {
        let place = graphics::single(self.to_box(p)?);
        let filter = Filter::Trilinear;
        let lookup = Lookup { filter, wrap };
        Grid::new(resolution, channels, Arc::new(values), place, lookup)
            .map_err(|why| why.to_string())
    }

    /// One density for each voxel, times coefficients.
    fn uniform_grid(&mut self, p: &Params<'_, 's>) -> Result<Extinction, String> {
        let density = p
            .floats("density", &[Kind::Float])
            .ok_or("a uniformgrid needs a \"density\"")?;
        let (sigma_a, sigma_s) = self.coefficients(p)?;
        let scale = p.float_in("scale", 1.0, 0.0..=1e30) as f32;
        let medium = homogeneous(sigma_a, sigma_s);
        // pbrt has nothing beyond a grid.
        self.of_density(p, resolution(p), density, &medium, scale, Wrap::Zero)
    }

    /// A medium whose extinction is `density` times that of `medium` and a factor; `wrap` says what
    /// lies beyond the voxels.
    pub fn of_density(
        &self,
        p: &Params<'_, 's>,
        resolution: [u32; 3],
        density: &[f32],
        medium: &Homogeneous,
        scale: f32,
        wrap: Wrap,
    ) -> Result<Extinction, String> {
        let Rgb { x, y, z } = medium.extinction;
        let (channels, values) = match x == y && y == z {
            true => (1, density.iter().map(|d| d * x).collect()),
            false => {
                let colors = density.iter().flat_map(|d| [d * x, d * y, d * z]);
                (3, colors.collect())
            }
        };
        let grid = self.grid(p, resolution, channels, values, wrap)?;
        let made = Heterogeneous::new(grid, scale, Albedo::Constant(medium.albedo));
        made.map(Extinction::from).map_err(|why| why.to_string())
    }

    /// Coefficients for each voxel, as colours.
    fn rgb_grid(&mut self, p: &Params<'_, 's>) -> Result<Extinction, String> {
        let given = ["sigma_a", "sigma_s"].map(|name| p.floats(name, &[Kind::Rgb]));
        let count = match given {
            [None, None] => return Err("an rgbgrid needs \"sigma_a\" or \"sigma_s\"".into()),
            [a, s] => a.map_or(0, <[f32]>::len).max(s.map_or(0, <[f32]>::len)),
        };
        let space = p.definition.color_space;
        let list = |given: Option<&[f32]>| -> Vec<f32> {
            let Some(list) = given else {
                return vec![1.0; count];
            };
            let colors = list.chunks_exact(3);
            let linear =
                colors.flat_map(|c| space.factor(Rgb::from_slice(c)).max(Rgb::ZERO).to_array());
            linear.collect()
        };
        let [absorbed, scattered] = given.map(list);
        if absorbed.len() != scattered.len() {
            return Err("\"sigma_a\" and \"sigma_s\" are of different sizes".into());
        }
        let sum: Vec<f32> = absorbed
            .iter()
            .zip(&scattered)
            .map(|(a, s)| a + s)
            .collect();
        let share = |(sum, s): (&f32, &f32)| if *sum > 0.0 { (s / sum).min(1.0) } else { 0.0 };
        let albedo = sum.iter().zip(&scattered).map(share).collect();
        let scale = p.float_in("scale", 1.0, 0.0..=1e30) as f32;
        let resolution = resolution(p);
        let density = self.grid(p, resolution, 3, sum, Wrap::Zero)?;
        let albedo = self.grid(p, resolution, 3, albedo, Wrap::Clamp)?;
        let made = Heterogeneous::new(density, scale, Albedo::Grid(albedo));
        made.map(Extinction::from).map_err(|why| why.to_string())
    }
}

/// Voxels along the axes.
fn resolution(p: &Params) -> [u32; 3] {
    ["nx", "ny", "nz"].map(|name| p.count(name, 1))
}
