//! Materials of OBJ files: Wavefront MTL, with the physically based extension that exporters share.
//!
//! | in the file | here |
//! |---|---|
//! | `Pr`, `Pm` | roughness and metalness of `principled` |
//! | `Ks` with `Ns`, `illum` 2 and up | `principled`: facets of width sqrt(2 / (Ns + 2)), reflectance 0.08 Ks |
//! | `illum` 4, 6, 7, 9 | glass of index `Ni` |
//! | `d`, `Tr`, `map_d` | opacity |
//! | `Ke`, `map_Ke` | glow |
//! | anything else | diffuse `Kd`, `map_Kd` |

use super::mtl_file::{self, Entry, Map};
use super::palette::{self, Paint};
use crate::bsdf::material::Turning;
use crate::bsdf::{Material, MaterialId};
use crate::image::file::ImageFile;
use crate::math::{Rgb, luminance};
use crate::scene::import::mesh::FaceMaterials;
use crate::scene::import::parts::Parts;
use crate::scene::import::{ImportError, ImportOptions};
use crate::texture::{BitmapSettings, Filter, Texture, UvTransform, Wrap};
use glam::{Affine2, Mat2};
use std::path::{Path, PathBuf};

/// The materials of an OBJ file, numbered as its faces have them.
#[derive(Debug, Default)]
pub(super) struct Library {
    file: PathBuf,
    entries: Vec<Option<Entry>>,
}

impl Library {
    /// Reads the libraries that the OBJ file `path` names. One that is missing is a warning: the model
    /// can be seen without.
    pub fn read(path: &Path, names: &FaceMaterials, parts: &mut Parts) -> Self {
        let folder = path.parent().unwrap_or(Path::new("."));
        let mut known = std::collections::HashMap::new();
        let mut file = path.to_owned();
        for library in &names.libraries {
            let at = folder.join(library);
            match std::fs::read(&at) {
                Ok(bytes) => {
                    known.extend(mtl_file::parse(&String::from_utf8_lossy(&bytes)));
                    file = at;
                }
                Err(e) => parts.warn(format!(
                    "{}: the materials in {} cannot be read: {e}",
                    path.display(),
                    at.display()
                )),
            }
        }
        let mut entries = Vec::new();
        for name in &names.names {
            let entry = known.get(name).cloned();
            if entry.is_none() && !names.libraries.is_empty() && !name.is_empty() {
                let path = path.display();
                parts.warn(format!(
                    "{path}: there is no material \"{name}\": clay instead"
                ));
            }
            entries.push(entry);
        }
        Self { file, entries }
    }

    fn entry(&self, index: u32) -> Option<Entry> {
        self.entries.get(index as usize)?.clone()
    }

    /// Whether material `index` emits light.
    pub fn glows(&self, index: u32) -> bool {
        let entry = self.entries.get(index as usize).and_then(Option::as_ref);
        let glow = entry.and_then(|e| e.color("ke"));
        glow.is_some_and(|c| c.max_element() > 0.0)
    }

    /// What material `index` emits.
    pub fn radiance(
        &self,
        index: u32,
        options: &ImportOptions,
        parts: &mut Parts,
    ) -> Result<Option<Texture>, ImportError> {
        let Some(entry) = self.entry(index).filter(|_| self.glows(index)) else {
            return Ok(None);
        };
        let factor = entry.color("ke").unwrap_or_default().max(Rgb::ZERO);
        let map = self.map(entry.map("map_ke"), (false, false), options, parts)?;
        Ok(Some(
            map.map_or(Texture::Constant(factor), |t| t.scaled(factor)),
        ))
    }

    /// Makes material `index`; clay where the file says nothing.
    pub fn material(
        &mut self,
        index: u32,
        colored: bool,
        options: &ImportOptions,
        parts: &mut Parts,
    ) -> Result<MaterialId, ImportError> {
        let Some(entry) = self.entry(index) else {
            return Ok(Paint::clay().add(&mut parts.materials, colored));
        };
        let illum = entry.number("illum").unwrap_or(2.0) as i32;
        let mut id = if matches!(illum, 4 | 6 | 7 | 9) {
            parts.materials.push(glass(&entry))
        } else {
            let model = self.opaque(&entry, illum, colored, options, parts)?;
            let mut id = parts.materials.push(model);
            let normals = self.map(entry.map("norm"), (true, false), options, parts)?;
            if let Some(normals) = normals {
                id = parts.materials.push(Material::NormalMap {
                    normals,
                    turning: Turning::default(),
                    inner: id,
                });
            }
            parts.materials.push(Material::TwoSided {
                front: id,
                back: id,
            })
        };
        if ["bump", "map_bump"].iter().any(|m| entry.map(m).is_some()) {
            let file = self.file.display();
            parts.warn(format!(
                "{file}: bump maps are left out, their height has no unit"
            ));
        }
        if let Some(opacity) = self.opacity(&entry, options, parts)? {
            id = parts.materials.push(Material::Mask { opacity, inner: id });
        }
        Ok(id)
    }

    fn opaque(
        &self,
        entry: &Entry,
        illum: i32,
        colored: bool,
        options: &ImportOptions,
        parts: &mut Parts,
    ) -> Result<Material, ImportError> {
        let map = self.map(entry.map("map_kd"), (false, false), options, parts)?;
        let factor = entry.color("kd").unwrap_or(Rgb::splat(0.8));
        // Exporters write a black Kd beside an image that should be seen as it is.
        let factor = if map.is_some() && factor == Rgb::ZERO {
            Rgb::ONE
        } else {
            factor
        };
        let mut color = map.map_or(Texture::Constant(factor), |t| t.scaled(factor));
        if colored {
            color = color.times(Texture::MeshAttribute(palette::VERTEX_COLOR.into()));
        }
        let metal = self.map(entry.map("map_pm"), (true, false), options, parts)?;
        let rough = self.map(entry.map("map_pr"), (true, false), options, parts)?;
        let is_modern = entry.number("pr").or(entry.number("pm")).is_some();
        if is_modern || metal.is_some() || rough.is_some() {
            let of = |map: Option<Texture>, name: &str, alone: f32| {
                let with = map.is_some();
                let factor = entry.number(name).filter(|f| !with || *f > 0.0);
                let factor = Rgb::splat(factor.unwrap_or(if with { 1.0 } else { alone }));
                map.map_or(Texture::Constant(factor), |t| t.scaled(factor))
            };
            let metallic = of(metal, "pm", 0.0);
            return Ok(palette::principled(
                color,
                of(rough, "pr", 0.5),
                metallic,
                1.5,
            ));
        }
        let specular = luminance(entry.color("ks").unwrap_or_default());
        if illum < 2 || specular <= 0.0 {
            return Ok(Material::Diffuse { reflectance: color });
        }
        let exponent = entry.number("ns").unwrap_or(10.0).max(0.0);
        // The facets' width of equal breadth; the perceptual roughness is its square root.
        let alpha = (2.0 / (exponent + 2.0)).sqrt();
        let roughness = Texture::Constant(Rgb::splat(alpha.sqrt()));
        let root = (0.08 * specular.min(1.0)).sqrt();
        let eta = (1.0 + root) / (1.0 - root);
        let metallic = Texture::Constant(Rgb::ZERO);
        Ok(palette::principled(color, roughness, metallic, eta))
    }

    fn opacity(
        &self,
        entry: &Entry,
        options: &ImportOptions,
        parts: &mut Parts,
    ) -> Result<Option<Texture>, ImportError> {
        let map = self.map(entry.map("map_d"), (true, true), options, parts)?;
        let clear = entry.number("tr").map(|t| 1.0 - t);
        let d = entry.number("d").or(clear).unwrap_or(1.0).clamp(0.0, 1.0);
        Ok(match map {
            Some(map) => Some(map.scaled(Rgb::splat(d))),
            None if d < 1.0 => Some(Texture::Constant(Rgb::splat(d))),
            None => None,
        })
    }

    /// Opens an image, as numbers (`raw`) and of its opacity alone (`alpha`); `None` where there is none or a missing one is forgiven.
    fn map(
        &self,
        map: Option<&Map>,
        (raw, alpha): (bool, bool),
        options: &ImportOptions,
        parts: &mut Parts,
    ) -> Result<Option<Texture>, ImportError> {
        let Some(map) = map else {
            return Ok(None);
        };
        let folder = self.file.parent().unwrap_or(Path::new("."));
        let path = folder.join(&map.file);
        let channel = alpha.then(|| alpha_of(&path)).flatten();
        let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
        let opened = options.textures.open(BitmapSettings {
            path,
            raw,
            gamma: None,
            filter: Filter::Linear,
            wrap_u: wrap,
            wrap_v: wrap,
            to_uv: UvTransform(Affine2 {
                matrix2: Mat2::from_diagonal(map.scale),
                translation: map.offset,
            }),
            channel: channel.map(str::to_owned),
        });
        match opened {
            Ok(texture) => Ok(Some(texture)),
            Err(e) if options.lenient => {
                parts.warn(format!("a texture is left out: {e}"));
                Ok(None)
            }
            Err(e) => Err(ImportError {
                at: None,
                file: Some(self.file.clone()),
                message: format!("the texture {} cannot be used: {}", e.path, e.reason),
                help: Some("restore the file, or go on without it with --lenient".into()),
            }),
        }
    }
}

/// The channel that holds an image's opacity, if there is one; other images hold it in their grey.
fn alpha_of(path: &Path) -> Option<&'static str> {
    let file = ImageFile::open(path).ok()?;
    let channels = file.header().channels.len();
    matches!(channels, 2 | 4).then_some("a")
}

fn glass(entry: &Entry) -> Material {
    let eta = entry.number("ni").filter(|n| *n > 1.0).unwrap_or(1.5);
    let tint = entry.color("tf").unwrap_or(Rgb::ONE);
    Material::Dielectric {
        eta,
        specular_reflectance: crate::bsdf::material::white(),
        specular_transmittance: Texture::Constant(tint.clamp(Rgb::ZERO, Rgb::ONE)),
    }
}
