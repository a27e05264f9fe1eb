//! Materials of OBJ files: Wavefront MTL, with the physically based extension that exporters share.
//!
//! | in the file | here |
//! |---|---|
//! | `Pr`, `Pm`, `Ps`, `Pc`, `Pcr`, `aniso` | roughness, metalness, sheen, coat and anisotropy of `principled` |
//! | `Ks` with `Ns`, `illum` 2 and up | `principled`: facets of width sqrt(2 / (Ns + 2)), reflectance 0.08 Ks |
//! | `illum` 4, 6, 7, 9, with `Tf` or without `d` below 1 | glass of index `Ni`, rough by `Pr` |
//! | `d`, `Tr`, `map_d` | opacity |
//! | `norm`, `map_Bump` that holds normals | normal map |
//! | `Ke`, `map_Ke` | glow |
//! | anything else | diffuse `Kd`, `map_Kd` |
//!
//! Exporters (Blender) write `illum` 6 and 9 for whatever has an alpha below 1: with a `d` below 1
//! these mean opacity and not glass, unless the file says what colour is let through.

mod file;
mod images;
mod library;
mod map;
mod words;

use super::palette::{self, Paint};
use crate::bsdf::material::{
    Dielectric, Diffuse, Distribution, InvalidNormals, RoughDielectric, Roughness, white,
};
use crate::bsdf::{Material, MaterialId};
use crate::math::{Rgb, luminance};
use crate::scene::import::mesh::FaceMaterials;
use crate::scene::import::parts::Parts;
use crate::scene::import::{ImportError, ImportOptions};
use crate::texture::Texture;
use file::Entry;
use images::Use;
use std::path::Path;

/// The materials of an OBJ file, numbered as its faces have them.
#[derive(Debug, Default)]
pub(super) struct Library {
    entries: Vec<Option<Entry>>,
    names: Vec<String>,
}

impl Library {
    /// Reads the libraries that the OBJ file `path` names.
    pub fn read(path: &Path, names: &FaceMaterials, parts: &mut Parts) -> Self {
        Self {
            entries: library::read(path, names, parts),
            names: names.names.clone(),
        }
    }

    /// Makes material `index`, and what it emits; clay where the file says nothing.
    pub fn material(
        &self,
        index: u32,
        colors: Option<Texture>,
        options: &ImportOptions,
        parts: &mut Parts,
    ) -> Result<(MaterialId, Option<Texture>), ImportError> {
        let Some(entry) = self.entries.get(index as usize).and_then(Option::as_ref) else {
            let clay = Paint::clay().add(&mut parts.materials, colors);
            return Ok((clay, None));
        };
        let mut reader = Reader {
            entry,
            name: self.names.get(index as usize).map_or("", String::as_str),
            options,
            parts,
        };
        let material = reader.material(colors)?;
        let name = reader.name;
        if !name.is_empty() {
            reader.parts.materials.set_name(material, name);
        }
        Ok((material, reader.radiance()?))
    }
}

/// Makes a material of an entry.
struct Reader<'a> {
    entry: &'a Entry,
    name: &'a str,
    options: &'a ImportOptions,
    parts: &'a mut Parts,
}

impl Reader<'_> {
    fn warn(&mut self, message: impl std::fmt::Display) {
        let (file, line, name) = (self.entry.file.display(), self.entry.line, self.name);
        let warning = format!("{file}:{line}: material \"{name}\": {message}");
        self.parts.warn(warning);
    }

    /// Warns of images that this kind of material has no place for.
    fn tell_of_images(&mut self, names: &[&str], kind: &str) {
        for name in names {
            if self.entry.map(name).is_some() {
                self.warn(format!("`{name}` is left out, as the material is {kind}"));
            }
        }
    }

    fn material(&mut self, colors: Option<Texture>) -> Result<MaterialId, ImportError> {
        let illum = self.entry.number("illum").unwrap_or(2.0) as i32;
        let dissolve = self.dissolve();
        let lets_light_through = matches!(illum, 4 | 6 | 7 | 9);
        let clear = dissolve >= 1.0 && self.entry.map("map_d").is_none();
        let tint = self.entry.color("tf");
        // Blender writes `Tf` where light is let through, and 2 for `illum` all the same.
        let told = self.is_modern() && clear && tint.is_some_and(|t| t.max_element() > 0.0);
        if told && !lets_light_through {
            self.warn(
                "it is taken as glass, as it has `Tf` besides the physically based statements",
            );
        }
        let is_glass = told || lets_light_through && (clear || tint.is_some());
        let id = if is_glass {
            let names = ["map_kd", "map_pr", "map_pm", "norm", "map_bump"];
            self.tell_of_images(&names, &format!("glass (illum {illum})"));
            let glass = self.glass();
            self.parts.materials.push(glass)
        } else {
            let mut id = self.opaque(illum, colors)?;
            if let Some(normals) = self.normals()? {
                let normals = Material::NormalMap {
                    normals,
                    invalid_normals: InvalidNormals::default(),
                    inner: id,
                };
                id = self.parts.materials.push(normals);
            }
            self.parts.materials.push(Material::TwoSided {
                front: id,
                back: id,
            })
        };
        Ok(match self.opacity(dissolve)? {
            Some(opacity) => self
                .parts
                .materials
                .push(Material::Mask { opacity, inner: id }),
            None => id,
        })
    }

    fn glass(&mut self) -> Material {
        let index = self.entry.number("ni");
        let eta = index.filter(|n| *n > 1.0).unwrap_or(1.5);
        if let Some(index) = index.filter(|n| *n <= 1.0) {
            self.warn(format!(
                "glass of index {index} (`Ni`) would bend no light: 1.5 instead"
            ));
        }
        let tint = self.entry.color("tf").unwrap_or(Rgb::ONE);
        let specular_transmittance = Texture::Constant(tint);
        match self.entry.number("pr").filter(|r| *r > 0.0) {
            None => Material::Dielectric(Dielectric {
                eta,
                specular_reflectance: white(),
                specular_transmittance,
            }),
            Some(roughness) => {
                let alpha = Texture::Constant(Rgb::splat(roughness * roughness));
                Material::RoughDielectric(RoughDielectric {
                    eta,
                    roughness: Roughness {
                        distribution: Distribution::Ggx,
                        alpha_u: alpha.clone(),
                        alpha_v: alpha,
                    },
                    specular_reflectance: white(),
                    specular_transmittance,
                })
            }
        }
    }

    /// The colour of the base.
    fn color(&mut self, colors: Option<Texture>) -> Result<Texture, ImportError> {
        let map = self.map("map_kd", Use::Color)?;
        let factor = self.entry.color("kd").unwrap_or(Rgb::splat(0.8));
        // Exporters write a black Kd beside an image that should be seen as it is.
        let factor = if map.is_some() && factor == Rgb::ZERO {
            Rgb::ONE
        } else {
            factor
        };
        let color = map.map_or(Texture::Constant(factor), |t| t.scaled(factor));
        Ok(match colors {
            Some(colors) => color.times(colors),
            None => color,
        })
    }

    /// Whether it has statements of the physically based extension.
    fn is_modern(&self) -> bool {
        let words = ["pr", "pm", "ps", "pc", "aniso"];
        words.iter().any(|n| self.entry.number(n).is_some())
    }

    fn opaque(&mut self, illum: i32, colors: Option<Texture>) -> Result<MaterialId, ImportError> {
        let color = self.color(colors)?;
        let metal = self.map("map_pm", Use::Number)?;
        let rough = self.map("map_pr", Use::Number)?;
        let model = if self.is_modern() || metal.is_some() || rough.is_some() {
            self.physical(color, rough, metal)
        } else {
            self.phong(illum, color)
        };
        Ok(self.parts.materials.push(model))
    }

    /// The physically based extension.
    fn physical(
        &mut self,
        color: Texture,
        rough: Option<Texture>,
        metal: Option<Texture>,
    ) -> Material {
        let entry = self.entry;
        let of = |map: Option<Texture>, name: &str, alone: f32| {
            let with = map.is_some();
            let factor = entry.number(name).filter(|f| !with || *f > 0.0);
            let factor = Rgb::splat(factor.unwrap_or(if with { 1.0 } else { alone }));
            map.map_or(Texture::Constant(factor), |t| t.scaled(factor))
        };
        let (rough, metal) = (of(rough, "pr", 0.5), of(metal, "pm", 0.0));
        let mut model = palette::principled(color, rough, metal, 1.5);
        if let Material::Principled(p) = &mut model {
            let number = |name| Texture::Constant(Rgb::splat(entry.number(name).unwrap_or(0.0)));
            p.sheen = number("ps");
            p.clearcoat = number("pc");
            let gloss = 1.0 - entry.number("pcr").unwrap_or(0.0);
            p.clearcoat_gloss = Texture::Constant(Rgb::splat(gloss));
            p.anisotropic = number("aniso");
        }
        if entry.number("anisor").is_some_and(|turn| turn != 0.0) {
            self.warn("`anisor`, the turn of the anisotropy, is left out");
        }
        model
    }

    fn phong(&mut self, illum: i32, color: Texture) -> Material {
        let entry = self.entry;
        let specular = entry.color("ks").unwrap_or_default();
        if illum < 2 || specular.max_element() <= 0.0 {
            return Material::Diffuse(Diffuse { reflectance: color });
        }
        if specular.max_element() - specular.min_element() > 0.02 {
            self.warn("the colour of `Ks` is left out, its luminance counts");
        }
        let exponent = entry.number("ns").unwrap_or(10.0);
        // The facets' width of equal breadth; the perceptual roughness is its square root.
        let alpha = (2.0 / (exponent + 2.0)).sqrt();
        let roughness = Texture::Constant(Rgb::splat(alpha.sqrt()));
        let root = (0.08 * luminance(specular)).sqrt();
        let eta = (1.0 + root) / (1.0 - root);
        let metallic = Texture::Constant(Rgb::ZERO);
        palette::principled(color, roughness, metallic, eta)
    }

    /// Opacity as a number.
    fn dissolve(&self) -> f32 {
        let clear = self.entry.number("tr").map(|t| 1.0 - t);
        self.entry.number("d").or(clear).unwrap_or(1.0)
    }

    fn opacity(&mut self, dissolve: f32) -> Result<Option<Texture>, ImportError> {
        let factor = Rgb::splat(dissolve);
        if dissolve <= 0.0 {
            self.warn("it cannot be seen: its opacity (`d`, or 1 - `Tr`) is 0");
        }
        Ok(match self.map("map_d", Use::Opacity)? {
            Some(map) => Some(map.scaled(factor)),
            None if dissolve < 1.0 => Some(Texture::Constant(factor)),
            None => None,
        })
    }

    fn radiance(&mut self) -> Result<Option<Texture>, ImportError> {
        let (factor, has_map) = (self.entry.color("ke"), self.entry.map("map_ke").is_some());
        let factor = factor.unwrap_or(if has_map { Rgb::ONE } else { Rgb::ZERO });
        if factor == Rgb::ZERO {
            if has_map {
                self.warn("`map_Ke` has no effect, as `Ke` is black");
            }
            return Ok(None);
        }
        let map = self.map("map_ke", Use::Color)?;
        Ok(Some(
            map.map_or(Texture::Constant(factor), |t| t.scaled(factor)),
        ))
    }
}
