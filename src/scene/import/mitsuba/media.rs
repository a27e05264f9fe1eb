//! Participating media.

use super::importer::Importer;
use super::params::Params;
use super::role::Role;
use super::value::Value;
use crate::math::{Affine3A, DAffine3, Rgb};
use crate::medium::grids::{Albedo, Filter, Grid, Heterogeneous, Lookup, Vdb, Vol, Wrap};
use crate::medium::{Boundary, Extinction, Homogeneous, Medium, MediumId, PhaseFunction, VACUUM};
use crate::scene::import::ImportError;
use std::path::Path;

/// Values over space.
enum Volume {
    Constant(Rgb),
    Grid(Grid),
}

impl<'a> Importer<'a> {
    /// The media inside and outside of a shape; `None` if it names neither.
    pub fn boundary(&mut self, p: &Params<'a>) -> Option<Boundary> {
        let media = p.children("medium");
        let mut boundary = Boundary {
            interior: VACUUM,
            exterior: VACUUM,
        };
        for (property, index) in &media {
            let medium = self.medium(*index);
            match property.name.as_str() {
                "interior" => boundary.interior = medium,
                "exterior" => boundary.exterior = medium,
                name => {
                    let message =
                        format!("a shape's medium is \"interior\" or \"exterior\", not \"{name}\"");
                    let error = self.document.error(property.at, message);
                    p.fault(property.at, error);
                }
            }
        }
        (!media.is_empty()).then_some(boundary)
    }

    /// The medium that object `index` describes. The same object gives the same medium.
    pub fn medium(&mut self, index: usize) -> MediumId {
        if let Some(&id) = self.medium_of.get(&index) {
            return id;
        }
        let made = self.make_medium(index);
        let made = made.map(|medium| self.media.push(medium));
        let id = self.or_instead(index, made, "nothing takes its place", |_| VACUUM);
        self.medium_of.insert(index, id);
        id
    }

    fn make_medium(&mut self, index: usize) -> Result<Medium, ImportError> {
        let p = Params::new(self.document, index);
        if !matches!(p.plugin(), "homogeneous" | "heterogeneous") {
            let message = format!(
                "medium \"{}\" is not read: homogeneous and heterogeneous are",
                p.plugin()
            );
            return Err(p.error(message));
        }
        // How to sample is the renderer's decision, and what is the same everywhere has no place.
        p.ignore(&[
            "sample_emitters",
            "has_spectral_extinction",
            "to_world",
            "majorant_resolution_factor",
        ]);
        let extinction = self.extinction(&p)?;
        let phase = match p.child("phase")? {
            Some(phase) => self.phase(phase),
            None => PhaseFunction::isotropic(),
        };
        let name = self.name_of(index, p.plugin());
        self.done(&p);
        Ok(Medium {
            name,
            extinction,
            phase,
        })
    }

    /// Extinction and albedo, by themselves or as coefficients of scattering and absorption.
    fn extinction(&mut self, p: &Params<'a>) -> Result<Extinction, ImportError> {
        let scale = p.float_in("scale", 1.0, 0.0..=f64::from(f32::MAX)) as f32;
        if p.has("material") {
            let message =
                "the presets of \"material\" are not read: give \"sigma_t\" and \"albedo\"";
            return Err(p.error(message));
        }
        if p.has("sigma_a") || p.has("sigma_s") {
            let absorbed = self.coefficient(p, "sigma_a", 0.0)?;
            let scattered = self.coefficient(p, "sigma_s", 0.0)?;
            let sum = absorbed + scattered;
            let share = |c: usize| {
                if sum[c] > 0.0 {
                    scattered[c] / sum[c]
                } else {
                    0.0
                }
            };
            let medium = Homogeneous {
                extinction: (sum * scale).min(Rgb::MAX),
                albedo: Rgb::new(share(0), share(1), share(2)),
            };
            return Ok(medium.into());
        }
        let albedo = self.volume(p, "albedo", Role::Reflectance)?;
        let albedo = albedo.unwrap_or(Volume::Constant(Rgb::splat(0.75)));
        let density = match self.volume(p, "sigma_t", Role::Number)? {
            Some(Volume::Grid(grid)) => {
                let albedo = match albedo {
                    Volume::Constant(albedo) => Albedo::Constant(albedo.clamp(Rgb::ZERO, Rgb::ONE)),
                    Volume::Grid(albedo) => Albedo::Grid(albedo),
                };
                let medium = Heterogeneous::new(grid, scale, albedo);
                return medium
                    .map(Extinction::from)
                    .map_err(|why| p.error(why.to_string()));
            }
            Some(Volume::Constant(density)) => self.checked(p, "sigma_t", density)?,
            None => Rgb::ONE,
        };
        let Volume::Constant(albedo) = albedo else {
            return Err(p.error("an \"albedo\" by place needs a \"sigma_t\" by place"));
        };
        let medium = Homogeneous {
            extinction: (density * scale).min(Rgb::MAX),
            albedo: albedo.clamp(Rgb::ZERO, Rgb::ONE),
        };
        Ok(medium.into())
    }

    /// A coefficient that is the same everywhere.
    fn coefficient(
        &mut self,
        p: &Params<'a>,
        name: &'static str,
        default: f32,
    ) -> Result<Rgb, ImportError> {
        match self.volume(p, name, Role::Number)? {
            None => Ok(Rgb::splat(default)),
            Some(Volume::Constant(value)) => self.checked(p, name, value),
            Some(Volume::Grid(_)) => {
                let message = format!("\"{name}\" by place is not read: \"sigma_t\" is");
                Err(self.document.error(p.place_of(name), message))
            }
        }
    }

    /// A coefficient is a number, and not negative.
    fn checked(&self, p: &Params<'a>, name: &str, value: Rgb) -> Result<Rgb, ImportError> {
        if value.is_finite() && value.min_element() >= 0.0 {
            return Ok(value);
        }
        let message = format!("\"{name}\" must be 0 or more, not {value}");
        Err(self.document.error(p.place_of(name), message))
    }

    /// A colour or a volume.
    fn volume(
        &mut self,
        p: &Params<'a>,
        name: &'static str,
        role: Role,
    ) -> Result<Option<Volume>, ImportError> {
        let Some(property) = p.find(name) else {
            return Ok(None);
        };
        let index = match property.value {
            Value::Object(index) if self.document.objects[index].tag == "volume" => index,
            _ => return Ok(self.color(p, name, role).map(Volume::Constant)),
        };
        let inner = Params::new(self.document, index);
        let volume = match inner.plugin() {
            "constvolume" => self.color(&inner, "value", role).map(Volume::Constant),
            "gridvolume" => Some(Volume::Grid(self.grid_volume(&inner)?)),
            plugin => {
                let message =
                    format!("volume \"{plugin}\" is not read: constvolume and gridvolume are");
                return Err(inner.error(message));
            }
        };
        self.done(&inner);
        Ok(volume)
    }

    /// The grid of a file.
    fn grid_volume(&mut self, p: &Params<'a>) -> Result<Grid, ImportError> {
        // Densities are no colours, and how they are looked up is the renderer's decision.
        p.ignore(&["raw", "accel"]);
        let Some(name) = p.text("filename") else {
            return Err(p.error("a \"gridvolume\" needs a \"filename\""));
        };
        let at = p.place_of("filename");
        let path = self.document.resolve(at, name);
        let filters = [
            ("trilinear", Filter::Trilinear),
            ("nearest", Filter::Nearest),
        ];
        let wraps = [
            ("clamp", Wrap::Clamp),
            ("repeat", Wrap::Repeat),
            ("mirror", Wrap::Mirror),
        ];
        let lookup = Lookup {
            filter: p.choice("filter_type", &filters).unwrap_or_default(),
            wrap: p.choice("wrap_mode", &wraps).unwrap_or_default(),
        };
        let place = self.place(p.to_world(), None);
        let in_bbox = p.boolean("use_grid_bbox", false);
        let grid = match path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("vdb"))
        {
            true => self.vdb(&path, p, (place, in_bbox), lookup),
            false => vol(&path, (place, in_bbox), lookup),
        };
        grid.map_err(|why| self.document.error(at, why))
    }

    /// The grid of an OpenVDB file.
    fn vdb(
        &self,
        path: &Path,
        p: &Params<'a>,
        place: Place,
        lookup: Lookup,
    ) -> Result<Grid, String> {
        let vdb =
            Vdb::read(path, p.text("grid"), self.options.decode).map_err(|e| e.to_string())?;
        let place = placed(place, vdb.bbox_transform);
        Grid::from_vdb(vdb, place, lookup).map_err(|e| e.to_string())
    }
}

/// Where the unit cube lies, and whether the file's own box comes before that.
type Place = (DAffine3, bool);

/// The grid of one of Mitsuba's files.
fn vol(path: &Path, place: Place, lookup: Lookup) -> Result<Grid, String> {
    let vol = Vol::read(path).map_err(|e| e.to_string())?;
    let inside = match place.1 {
        true => vol.bbox_transform().map_err(|e| e.to_string())?,
        false => Affine3A::IDENTITY,
    };
    let inside = DAffine3::from_cols_array(&inside.to_cols_array().map(f64::from));
    Grid::from_vol(vol, placed(place, inside), lookup).map_err(|e| e.to_string())
}

/// From the unit cube to the scene, through the file's box if the scene asks for it.
fn placed((place, in_bbox): Place, bbox: DAffine3) -> Affine3A {
    let place = if in_bbox { place * bbox } else { place };
    Affine3A::from_cols_array(&place.to_cols_array().map(|x| x as f32))
}
