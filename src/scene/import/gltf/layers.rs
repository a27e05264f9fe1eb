//! The body of a material and the coat around it: transmission, sheen, clear coat, reflectance.

use super::Importer;
use super::extension::Extension;
use super::materials::{Core, Metal};
use super::schema;
use super::textures::{Use, uv_set};
use super::volume;
use crate::bsdf::material::{
    Distribution, MetallicRoughness, Principled, PrincipledThin, Roughness, white,
};
use crate::bsdf::{Material, MaterialId};
use crate::math::{Rgb, luminance};
use crate::scene::import::ImportError;
use crate::texture::Texture;

/// Index of refraction of clear coats: KHR_materials_clearcoat fixes it.
const COAT_IOR: f32 = 1.5;
/// Narrowest facets of a rough coat; smoother ones are taken as smooth.
const SMOOTH: f32 = 1e-3;

fn number(value: f32) -> Texture {
    Texture::Constant(Rgb::splat(value))
}

/// Reflectance at normal incidence of an interface of relative index `ior`.
fn f0_of(ior: f32) -> f32 {
    let r = (ior - 1.0) / (ior + 1.0);
    r * r
}

/// The relative index with reflectance `f0` at normal incidence.
fn ior_of(f0: f32) -> f32 {
    let root = f0.clamp(0.0, 0.98).sqrt();
    (1.0 + root) / (1.0 - root)
}

impl Importer<'_> {
    /// Reflectance and index of the dielectric part (`KHR_materials_ior`,
    /// `KHR_materials_specular`).
    pub(super) fn dielectric(&mut self, material: &schema::Material, of: &str) -> (f32, f32) {
        let ior = Extension::of(&material.extensions, "KHR_materials_ior");
        let ior = ior.map_or(1.5, |e| e.number("ior", 1.5));
        // 0 stands for "as reflective as can be" in the specification.
        let ior = if ior == 0.0 {
            ior_of(1.0)
        } else {
            self.within(&format!("{of}: ior"), ior, [1.0, 1e3])
        };
        let Some(specular) = Extension::of(&material.extensions, "KHR_materials_specular") else {
            return (f0_of(ior), ior);
        };
        let color = specular.color("specularColorFactor", Rgb::ONE);
        if color.max_element() - color.min_element() > 1e-3 {
            self.warn("colours of KHR_materials_specular are replaced by their luminance");
        }
        for key in ["specularTexture", "specularColorTexture"] {
            if specular.texture(key).is_some() {
                self.warn(format!("\"{key}\" of KHR_materials_specular is left out"));
            }
        }
        let factor = specular.number("specularFactor", 1.0);
        let factor = self.fraction(&format!("{of}: specularFactor"), factor);
        let factor = factor * luminance(color.max(Rgb::ZERO));
        ((f0_of(ior) * factor).min(1.0), ior)
    }

    /// The model inside, and whether light passes through it.
    pub(super) fn body(
        &mut self,
        material: &schema::Material,
        core: Core,
        of: &str,
    ) -> Result<(MaterialId, bool), ImportError> {
        let sheen = self.sheen(material);
        let extension = Extension::of(&material.extensions, "KHR_materials_transmission");
        let factor = extension.map_or(0.0, |e| e.number("transmissionFactor", 0.0));
        let factor = self.fraction(&format!("{of}: transmissionFactor"), factor);
        let Some(extension) = extension.filter(|_| factor > 0.0) else {
            let eta = ior_of(core.f0);
            // Sheen is known to `principled` alone.
            let opaque = match sheen {
                0.0 => metallic_roughness(&core, eta),
                _ => principled(&core, number(0.0), eta, sheen),
            };
            let base = self.push(opaque);
            return Ok((self.beside_metal(base, &core), false));
        };
        let info = extension.texture("transmissionTexture");
        let share = self.textured(info.as_ref(), Use::Channel(0), Rgb::splat(factor))?;
        if volume::thickness(material) > 0.0 {
            let body = principled(&core, share, core.ior, sheen);
            return Ok((self.push(body), true));
        }
        let thin = self.push(thin(&core, share, sheen));
        let metallic = core.metallic.clone();
        if metallic.constant() == Some(Rgb::ZERO) {
            return Ok((thin, true));
        }
        let metal = principled(&core, number(0.0), core.ior, sheen);
        let metal = self.push(metal);
        let metal = self.push(Material::TwoSided {
            front: metal,
            back: metal,
        });
        let blend = Material::Blend {
            weight: metallic,
            first: thin,
            second: metal,
        };
        Ok((self.push(blend), true))
    }

    /// `base`, of which a metal takes its share.
    fn beside_metal(&mut self, base: MaterialId, core: &Core) -> MaterialId {
        let Some(Metal { share, color }) = &core.metal else {
            return base;
        };
        let metal = self.push(MetallicRoughness {
            base_color: color.clone(),
            metallic: number(1.0),
            roughness: core.roughness.clone(),
            eta: 1.5,
        });
        if share.constant() == Some(Rgb::ONE) {
            return metal;
        }
        self.push(Material::Blend {
            weight: share.clone(),
            first: base,
            second: metal,
        })
    }

    /// Strength of the sheen.
    fn sheen(&mut self, material: &schema::Material) -> f32 {
        let Some(sheen) = Extension::of(&material.extensions, "KHR_materials_sheen") else {
            return 0.0;
        };
        let color = sheen.color("sheenColorFactor", Rgb::ZERO);
        if color.max_element() > 0.0 {
            self.warn("KHR_materials_sheen: the strength alone is used, as Burley's sheen");
        }
        luminance(color).clamp(0.0, 1.0)
    }

    /// `inner` under the clear coat, if there is one.
    pub(super) fn coated(
        &mut self,
        material: &schema::Material,
        inner: MaterialId,
        of: &str,
    ) -> Result<MaterialId, ImportError> {
        let coat = Extension::of(&material.extensions, "KHR_materials_clearcoat");
        let factor = coat.map_or(0.0, |c| c.number("clearcoatFactor", 0.0));
        let factor = self.fraction(&format!("{of}: clearcoatFactor"), factor);
        let Some(coat) = coat.filter(|_| factor > 0.0) else {
            return Ok(inner);
        };
        let roughness = coat.number("clearcoatRoughnessFactor", 0.0);
        let mut roughness = self.fraction(&format!("{of}: clearcoatRoughnessFactor"), roughness);
        if let Some(info) = coat.texture("clearcoatRoughnessTexture") {
            self.warn("textures of a clear coat's roughness are replaced by their mean");
            let mean = self
                .textured(Some(&info), Use::Channel(1), Rgb::ONE)?
                .mean();
            roughness *= luminance(mean);
        }
        if coat.texture("clearcoatNormalTexture").is_some() {
            self.warn("normal maps of clear coats are left out: the coat follows the base's");
        }
        let coated = self.push(coating(roughness * roughness, inner));
        let info = coat.texture("clearcoatTexture");
        let weight = self.textured(info.as_ref(), Use::Channel(0), Rgb::splat(factor))?;
        if weight.constant() == Some(Rgb::ONE) {
            return Ok(coated);
        }
        Ok(self.push(Material::Blend {
            weight,
            first: inner,
            second: coated,
        }))
    }

    /// Warns of what a material asks for and does not get.
    pub(super) fn tell_what_is_left_out(&mut self, material: &schema::Material) {
        let unlit = Extension::of(&material.extensions, "KHR_materials_unlit").is_some();
        if unlit {
            self.warn("KHR_materials_unlit: the surface is lit as a diffuse one");
        }
        let set = super::materials::coordinates(material);
        let others = super::materials::all_textures(material);
        if others.iter().any(|info| uv_set(info) != set) {
            let name = material.name.as_deref().unwrap_or("without a name");
            self.warn(format!(
                "material {name}: its textures use different texture coordinates; all take TEXCOORD_{set}"
            ));
        }
    }
}

fn coating(alpha: f32, inner: MaterialId) -> Material {
    let (sigma_a, specular_reflectance) = (number(0.0), white());
    if alpha < SMOOTH {
        return Material::Coating {
            eta: COAT_IOR,
            thickness: 0.0,
            sigma_a,
            specular_reflectance,
            inner,
        };
    }
    Material::RoughCoating {
        eta: COAT_IOR,
        roughness: Roughness {
            distribution: Distribution::Ggx,
            alpha_u: number(alpha),
            alpha_v: number(alpha),
        },
        thickness: 0.0,
        sigma_a,
        specular_reflectance,
        inner,
    }
}

fn metallic_roughness(core: &Core, eta: f32) -> Material {
    Material::from(MetallicRoughness {
        base_color: core.color.clone(),
        metallic: core.metallic.clone(),
        roughness: core.roughness.clone(),
        eta,
    })
}

fn principled(core: &Core, spec_trans: Texture, eta: f32, sheen: f32) -> Material {
    Material::from(Principled {
        base_color: core.color.clone(),
        roughness: core.roughness.clone(),
        anisotropic: number(0.0),
        metallic: core.metallic.clone(),
        spec_trans,
        eta,
        spec_tint: number(0.0),
        sheen: number(sheen),
        sheen_tint: number(0.0),
        flatness: number(0.0),
        clearcoat: number(0.0),
        clearcoat_gloss: number(0.0),
        main_specular_sampling_rate: 1.0,
        clearcoat_sampling_rate: 1.0,
        diffuse_reflectance_sampling_rate: 1.0,
    })
}

fn thin(core: &Core, spec_trans: Texture, sheen: f32) -> Material {
    Material::from(PrincipledThin {
        base_color: core.color.clone(),
        roughness: core.roughness.clone(),
        anisotropic: number(0.0),
        spec_trans,
        eta: number(core.ior),
        spec_tint: number(0.0),
        sheen: number(sheen),
        sheen_tint: number(0.0),
        flatness: number(0.0),
        diff_trans: number(0.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflectance_and_index_are_two_words_for_one_thing() {
        assert!((f0_of(1.5) - 0.04).abs() < 1e-7);
        for ior in [1.0, 1.33, 1.5, 2.4] {
            assert!((ior_of(f0_of(ior)) - ior).abs() < 1e-5, "{ior}");
        }
    }
}
