//! What the facets of a material reflect: `KHR_materials_ior`, `KHR_materials_specular`,
//! `KHR_materials_anisotropy` and `KHR_materials_iridescence`, and the light that the base beneath
//! them lets through, `KHR_materials_diffuse_transmission`.

use super::Importer;
use super::extension::Extension;
use super::schema;
use super::textures::Use;
use crate::bsdf::material::{Anisotropy, DiffuseTransmission, Film, white};
use crate::math::Rgb;
use crate::scene::import::ImportError;
use crate::texture::Texture;
use std::sync::Arc;

/// Thickest film, nanometres: above, no colour is left.
const THICKEST: f32 = 1e5;

/// The relative index with reflectance `f0` at normal incidence.
pub(super) fn ior_of(f0: f32) -> f32 {
    let root = f0.clamp(0.0, 0.98).sqrt();
    (1.0 + root) / (1.0 - root)
}

/// The dielectric part of a material.
pub(super) struct Dielectric {
    pub ior: f32,
    pub specular: Texture,
    pub specular_color: Texture,
}

impl Importer<'_> {
    /// Index and reflectance of the dielectric part.
    pub(super) fn dielectric(
        &mut self,
        material: &schema::Material,
        of: &str,
    ) -> Result<Dielectric, ImportError> {
        let ior = Extension::of(&material.extensions, "KHR_materials_ior");
        let ior = ior.map_or(1.5, |e| e.number("ior", 1.5));
        // 0 stands for "as reflective as can be" in the specification.
        let ior = if ior == 0.0 {
            ior_of(1.0)
        } else {
            self.within(&format!("{of}: ior"), ior, [1.0, 1e3])
        };
        let Some(specular) = Extension::of(&material.extensions, "KHR_materials_specular") else {
            let (specular, specular_color) = (white(), white());
            return Ok(Dielectric {
                ior,
                specular,
                specular_color,
            });
        };
        let factor = specular.number("specularFactor", 1.0);
        let factor = self.fraction(&format!("{of}: specularFactor"), factor);
        let info = specular.texture("specularTexture");
        let color = specular.color("specularColorFactor", Rgb::ONE);
        let color = self.light_color(&format!("{of}: specularColorFactor"), color);
        let colors = specular.texture("specularColorTexture");
        Ok(Dielectric {
            ior,
            specular: self.textured(info.as_ref(), Use::Channel(3), Rgb::splat(factor))?,
            specular_color: self.textured(colors.as_ref(), Use::Color, color)?,
        })
    }

    /// Brushed facets.
    pub(super) fn anisotropy(
        &mut self,
        material: &schema::Material,
        mirrored: bool,
        of: &str,
    ) -> Result<Option<Anisotropy>, ImportError> {
        let found = Extension::of(&material.extensions, "KHR_materials_anisotropy");
        let Some((extension, strength)) = strong(found, "anisotropyStrength") else {
            return Ok(None);
        };
        let map = match extension.texture("anisotropyTexture") {
            Some(info) => self.texture(&info, Use::Vector)?,
            None => None,
        };
        let rotation = extension.number("anisotropyRotation", 0.0);
        Ok(Some(Anisotropy {
            strength: self.fraction(&format!("{of}: anisotropyStrength"), strength),
            rotation: if mirrored { -rotation } else { rotation },
            // Along the tangent.
            map: map.unwrap_or(Texture::Constant(Rgb::new(1.0, 0.5, 1.0))),
            mirrored,
        }))
    }

    /// A thin film.
    pub(super) fn film(
        &mut self,
        material: &schema::Material,
        of: &str,
    ) -> Result<Option<Film>, ImportError> {
        let found = Extension::of(&material.extensions, "KHR_materials_iridescence");
        let Some((extension, factor)) = strong(found, "iridescenceFactor") else {
            return Ok(None);
        };
        let factor = self.fraction(&format!("{of}: iridescenceFactor"), factor);
        let info = extension.texture("iridescenceTexture");
        let strength = self.textured(info.as_ref(), Use::Channel(0), Rgb::splat(factor))?;
        let eta = extension.number("iridescenceIor", 1.3);
        let eta = self.within(&format!("{of}: iridescenceIor"), eta, [1.0, 1e3]);
        let mut nanometres = |key: &str, default: f32| {
            let value = extension.number(key, default);
            self.within(&format!("{of}: {key}"), value, [0.0, THICKEST])
        };
        let least = nanometres("iridescenceThicknessMinimum", 100.0);
        let most = nanometres("iridescenceThicknessMaximum", 400.0);
        let thickness = match extension.texture("iridescenceThicknessTexture") {
            Some(info) => self.texture(&info, Use::Channel(1))?,
            None => None,
        };
        let [scale, offset] = [most - least, least].map(Rgb::splat);
        let thickness = match thickness {
            Some(share) => Texture::Affine(Arc::new((share, scale, offset))),
            None => Texture::Constant(Rgb::splat(most)),
        };
        Ok(Some(Film {
            strength,
            eta,
            thickness,
        }))
    }

    /// Diffuse light that passes the base.
    pub(super) fn diffuse_transmission(
        &mut self,
        material: &schema::Material,
        of: &str,
    ) -> Result<Option<DiffuseTransmission>, ImportError> {
        let name = "KHR_materials_diffuse_transmission";
        let found = Extension::of(&material.extensions, name);
        let Some((extension, factor)) = strong(found, "diffuseTransmissionFactor") else {
            return Ok(None);
        };
        if super::volume::thickness(material) > 0.0 {
            self.warn(format!(
                "{of}: {name} with a volume is taken as that of a thin sheet"
            ));
        }
        let factor = self.fraction(&format!("{of}: diffuseTransmissionFactor"), factor);
        let info = extension.texture("diffuseTransmissionTexture");
        let color = extension.color("diffuseTransmissionColorFactor", Rgb::ONE);
        let color = self.tint(&format!("{of}: diffuseTransmissionColorFactor"), color);
        let colors = extension.texture("diffuseTransmissionColorTexture");
        Ok(Some(DiffuseTransmission {
            share: self.textured(info.as_ref(), Use::Channel(3), Rgb::splat(factor))?,
            color: self.textured(colors.as_ref(), Use::Color, color)?,
        }))
    }

    /// Warns of extensions that a material has and that its model does not know; `why` says what
    /// the model is for.
    pub(super) fn tell_of_reflection(&mut self, material: &schema::Material, why: &str) {
        let of = |name: &str| Extension::of(&material.extensions, name);
        let specular = of("KHR_materials_specular").is_some_and(|s| s.changes_reflectance());
        let strong = |name, key| strong(of(name), key).is_some();
        for (name, there) in [
            ("KHR_materials_specular", specular),
            (
                "KHR_materials_anisotropy",
                strong("KHR_materials_anisotropy", "anisotropyStrength"),
            ),
            (
                "KHR_materials_iridescence",
                strong("KHR_materials_iridescence", "iridescenceFactor"),
            ),
            (
                "KHR_materials_diffuse_transmission",
                strong(
                    "KHR_materials_diffuse_transmission",
                    "diffuseTransmissionFactor",
                ),
            ),
        ] {
            if there {
                self.warn(format!("{why}: its {name} is left out"));
            }
        }
    }
}

/// The extension and its strength, where it has any.
fn strong<'a>(found: Option<Extension<'a>>, key: &str) -> Option<(Extension<'a>, f32)> {
    let extension = found?;
    let strength = extension.number(key, 0.0);
    (strength > 0.0).then_some((extension, strength))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_index_follows_from_its_reflectance() {
        for ior in [1.0f32, 1.33, 1.5, 2.4] {
            let root = (ior - 1.0) / (ior + 1.0);
            assert!((ior_of(root * root) - ior).abs() < 1e-5, "{ior}");
        }
    }
}
