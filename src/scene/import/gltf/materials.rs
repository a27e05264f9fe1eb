//! Materials: metallic-roughness and its extensions, and what is laid around it.
//!
//! ```text
//!  Mask (alpha) > TwoSided > NormalMap > Blend (clear coat) > metallic-roughness
//!                                                           > principled (sheen, glass), principledthin
//!                                                           > black, and emission (unlit)
//! ```
//!
//! All models take the square of a perceptual roughness as the width of GGX facets, and 0.04 as the
//! reflectance of a dielectric of index 1.5. Nothing is culled: opaque surfaces are the same from
//! both sides, as light that bounces needs it. What glows does so on the front alone unless it is
//! `doubleSided`. A transmitting surface without `KHR_materials_volume` is thin.

use super::extension::Extension;
use super::primitive::{ALPHA, COLOR};
use super::schema::{self, TextureInfo};
use super::textures::{Use, uv_set};
use super::{Importer, error};
use crate::bsdf::material::Diffuse;
use crate::bsdf::{Material, MaterialId};
use crate::math::Rgb;
use crate::scene::import::ImportError;
use crate::texture::Texture;
use std::sync::Arc;

/// What makes two uses of one material different.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Variant {
    /// The file's material; `None` is the default one.
    pub index: Option<usize>,
    /// The mesh has vertex colours.
    pub colored: bool,
    /// Vertex colours come with opacity.
    pub alpha: bool,
    /// The texture is laid on back to front.
    pub mirrored: bool,
}

/// A material in use.
#[derive(Clone, Debug)]
pub(super) struct Finish {
    pub material: MaterialId,
    /// Radiance of what glows.
    pub emission: Option<Texture>,
    /// Whether it glows on both sides.
    pub both_sides: bool,
    /// What glows is meant to light something.
    pub is_lamp: bool,
}

/// The parameters that both workflows come down to.
pub(super) struct Core {
    pub color: Texture,
    pub alpha: Texture,
    pub roughness: Texture,
    pub metallic: Texture,
    /// The index of refraction.
    pub ior: f32,
    /// Factor on the reflectance of the dielectric part, and on that at normal incidence alone.
    pub specular: Texture,
    pub specular_color: Texture,
    /// A metal of a colour of its own beside all that.
    pub metal: Option<Metal>,
}

/// A metal that takes a share of a surface.
pub(super) struct Metal {
    pub share: Texture,
    pub color: Texture,
}

/// The textures of the extensions, in the order in which they say which coordinates are read.
const TEXTURES: [(&str, &[&str]); 8] = [
    (
        "KHR_materials_pbrSpecularGlossiness",
        &["diffuseTexture", "specularGlossinessTexture"],
    ),
    ("KHR_materials_transmission", &["transmissionTexture"]),
    (
        "KHR_materials_clearcoat",
        &[
            "clearcoatTexture",
            "clearcoatRoughnessTexture",
            "clearcoatNormalTexture",
        ],
    ),
    (
        "KHR_materials_specular",
        &["specularTexture", "specularColorTexture"],
    ),
    (
        "KHR_materials_sheen",
        &["sheenColorTexture", "sheenRoughnessTexture"],
    ),
    ("KHR_materials_anisotropy", &["anisotropyTexture"]),
    (
        "KHR_materials_iridescence",
        &["iridescenceTexture", "iridescenceThicknessTexture"],
    ),
    (
        "KHR_materials_diffuse_transmission",
        &[
            "diffuseTransmissionTexture",
            "diffuseTransmissionColorTexture",
        ],
    ),
];

/// How messages call a material.
pub(super) fn name_of(material: &schema::Material, index: Option<usize>) -> String {
    match (&material.name, index) {
        (Some(name), _) => format!("material \"{name}\""),
        (None, Some(index)) => format!("material {index}"),
        (None, None) => "the default material".into(),
    }
}

/// Whether the material emits light.
pub(super) fn glows(material: &schema::Material) -> bool {
    let factor = material.emissive_factor.unwrap_or_default();
    is_unlit(material) || factor.iter().any(|f| *f > 0.0)
}

/// Whether the material shows its colour whatever falls on it (`KHR_materials_unlit`).
pub(super) fn is_unlit(material: &schema::Material) -> bool {
    Extension::of(&material.extensions, "KHR_materials_unlit").is_some()
}

/// Whether a material that emits light is a lamp: brighter than the white that factors reach by
/// themselves.
fn is_lamp(material: &schema::Material) -> bool {
    let name = "KHR_materials_emissive_strength";
    let strength = Extension::of(&material.extensions, name);
    let strength = strength.map_or(1.0, |e| e.number("emissiveStrength", 1.0));
    let factor = Rgb::from(material.emissive_factor.unwrap_or_default());
    !is_unlit(material) && factor.max_element() * strength > 1.0
}

/// Whether the material depends on where the texture's axes point.
pub(super) fn follows_tangents(material: &schema::Material) -> bool {
    let brushed = Extension::of(&material.extensions, "KHR_materials_anisotropy");
    let coat = Extension::of(&material.extensions, "KHR_materials_clearcoat");
    let coat = coat.and_then(|c| c.texture("clearcoatNormalTexture"));
    material.normal_texture.is_some() || brushed.is_some() || coat.is_some()
}

/// The texture coordinates that a material reads: those of its colour, or of its first texture.
pub(super) fn coordinates(material: &schema::Material) -> usize {
    all_textures(material).first().map_or(0, uv_set)
}

/// Every texture of a material, its colour first; occlusion is not used.
pub(super) fn all_textures(material: &schema::Material) -> Vec<TextureInfo> {
    let mut list = Vec::new();
    if let Some(pbr) = &material.pbr_metallic_roughness {
        list.extend(pbr.base_color_texture.clone());
        list.extend(pbr.metallic_roughness_texture.clone());
    }
    list.extend(material.normal_texture.clone());
    list.extend(material.emissive_texture.clone());
    for (name, keys) in TEXTURES {
        let extension = Extension::of(&material.extensions, name);
        list.extend(keys.iter().filter_map(|key| extension?.texture(key)));
    }
    list
}

impl Importer<'_> {
    /// The material of a primitive.
    pub(super) fn material(&mut self, variant: Variant) -> Result<Finish, ImportError> {
        if let Some(done) = self.finishes.get(&variant) {
            return Ok(done.clone());
        }
        let container = self.container;
        let plain = schema::Material::default();
        let material = match variant.index {
            None => &plain,
            Some(index) => container
                .document
                .materials
                .get(index)
                .ok_or_else(|| error(self.path(), format!("there is no material {index}")))?,
        };
        self.tell_what_is_left_out(material);
        let of = name_of(material, variant.index);
        let core = self.core(material, variant, &of)?;
        let unlit = is_unlit(material);
        let emission = match unlit {
            true => Some(core.color.clone()),
            false => self.emission(material, &of)?,
        };
        let id = match self.only_material {
            Some((id, _)) => id,
            None => self.surface(material, variant, core, &of)?,
        };
        if self.only_material.is_none() {
            let name = match (&material.name, variant.index) {
                (Some(name), _) => name.clone(),
                (None, Some(index)) => format!("material.{index}"),
                (None, None) => "default".into(),
            };
            self.parts.materials.set_name(id, name);
        }
        // What is half there sends half of the light: coverage counts for all that a surface does.
        let opacity = self.parts.materials.opacity_texture(id);
        let finish = Finish {
            material: id,
            emission: emission.map(|e| e.times(opacity)),
            // Nothing is culled.
            both_sides: material.double_sided || unlit,
            is_lamp: is_lamp(material),
        };
        self.finishes.insert(variant, finish.clone());
        Ok(finish)
    }

    fn surface(
        &mut self,
        material: &schema::Material,
        variant: Variant,
        core: Core,
        of: &str,
    ) -> Result<MaterialId, ImportError> {
        let alpha = core.alpha.clone();
        let (mut id, transmits) = if is_unlit(material) {
            // What is seen is its emission.
            let reflectance = Texture::Constant(Rgb::ZERO);
            (self.push(Diffuse { reflectance }), false)
        } else {
            let (base, transmits) = self.body(material, core, variant, of)?;
            (
                self.layered(material, base, variant.mirrored, of)?,
                transmits,
            )
        };
        if !transmits {
            id = self.push(Material::TwoSided {
                front: id,
                back: id,
            });
        }
        let opacity = match material.alpha_mode.as_deref() {
            Some("BLEND") => alpha,
            Some("MASK") => {
                let cutoff = material.alpha_cutoff.unwrap_or(0.5);
                Texture::Threshold(Arc::new((alpha, cutoff)))
            }
            None | Some("OPAQUE") => return Ok(id),
            Some(other) => {
                self.warn(format!(
                    "{of}: alphaMode \"{other}\" is none of OPAQUE, MASK, BLEND: taken as OPAQUE"
                ));
                return Ok(id);
            }
        };
        if opacity.constant() == Some(Rgb::ONE) {
            return Ok(id);
        }
        Ok(self.push(Material::Mask { opacity, inner: id }))
    }

    pub(super) fn push(&mut self, material: impl Into<Material>) -> MaterialId {
        self.parts.materials.push(material)
    }

    fn emission(
        &mut self,
        material: &schema::Material,
        of: &str,
    ) -> Result<Option<Texture>, ImportError> {
        if !glows(material) {
            return Ok(None);
        }
        let name = "KHR_materials_emissive_strength";
        let strength = Extension::of(&material.extensions, name);
        let strength = strength.map_or(1.0, |e| e.number("emissiveStrength", 1.0));
        let factor = Rgb::from(material.emissive_factor.unwrap_or_default());
        let factor = self.light_color(&format!("{of}: emissiveFactor"), factor);
        if factor.max_element() > 1.0 {
            self.warn(format!(
                "{of}: emissiveFactor is {factor}, above 1, and taken as it is"
            ));
        }
        let strength = self.within(&format!("{of}: emissiveStrength"), strength, [0.0, 1e18]);
        let factor = factor * strength;
        let info = material.emissive_texture.as_ref();
        let radiance = self.textured(info, Use::Color, factor)?;
        Ok((radiance.mean().max_element() > 0.0).then_some(radiance))
    }

    /// The parameters of either workflow.
    fn core(
        &mut self,
        material: &schema::Material,
        variant: Variant,
        of: &str,
    ) -> Result<Core, ImportError> {
        let gloss = "KHR_materials_pbrSpecularGlossiness";
        let mut core = match Extension::of(&material.extensions, gloss) {
            Some(gloss) => self.specular_glossiness(gloss, of)?,
            None => self.metallic_roughness(material, of)?,
        };
        if variant.colored {
            core.color = core.color.times(Texture::MeshAttribute(COLOR.into()));
        }
        if variant.alpha {
            core.alpha = core.alpha.times(Texture::MeshAttribute(ALPHA.into()));
        }
        Ok(core)
    }

    fn metallic_roughness(
        &mut self,
        material: &schema::Material,
        of: &str,
    ) -> Result<Core, ImportError> {
        let plain = schema::Pbr::default();
        let pbr = material.pbr_metallic_roughness.as_ref().unwrap_or(&plain);
        let [r, g, b, a] = pbr.base_color_factor.unwrap_or([1.0; 4]);
        let color = pbr.base_color_texture.as_ref();
        let surface = pbr.metallic_roughness_texture.as_ref();
        let base = self.tint(&format!("{of}: baseColorFactor"), Rgb::new(r, g, b));
        let a = self.fraction(&format!("{of}: opacity"), a);
        let metallic = pbr.metallic_factor.unwrap_or(1.0);
        let metallic = self.fraction(&format!("{of}: metallicFactor"), metallic);
        let roughness = pbr.roughness_factor.unwrap_or(1.0);
        let roughness = self.fraction(&format!("{of}: roughnessFactor"), roughness);
        let (metallic, roughness) = (Rgb::splat(metallic), Rgb::splat(roughness));
        let dielectric = self.dielectric(material, of)?;
        Ok(Core {
            color: self.textured(color, Use::Color, base)?,
            alpha: self.opacity(material, color, a)?,
            roughness: self.textured(surface, Use::Channel(1), roughness)?,
            metallic: self.textured(surface, Use::Channel(2), metallic)?,
            ior: dielectric.ior,
            specular: dielectric.specular,
            specular_color: dielectric.specular_color,
            metal: None,
        })
    }

    /// Opacity, read only where it matters: many opaque images carry a useless alpha channel.
    fn opacity(
        &mut self,
        material: &schema::Material,
        color: Option<&TextureInfo>,
        factor: f32,
    ) -> Result<Texture, ImportError> {
        match material.alpha_mode.as_deref() {
            Some("BLEND" | "MASK") => self.textured(color, Use::Channel(3), Rgb::splat(factor)),
            _ => Ok(Texture::Constant(Rgb::ONE)),
        }
    }
}
