//! `KHR_materials_pbrSpecularGlossiness`: a diffuse colour under facets of any colour.
//!
//! The extension's reflectance at normal incidence is the specular colour s, and the diffuse part
//! is `diffuse (1 - max s)`. Here that is a share w of metal over a dielectric of reflectance d, at
//! most 0.04: with `w = (max s - d) / (1 - d)` the diffuse part is what the dielectric leaves, and
//! the metal's colour `(s - (1 - w) d) / w` makes the sum s.

use super::extension::Extension;
use super::materials::{Core, Metal};
use super::reflection::ior_of;
use super::schema::TextureInfo;
use super::textures::Use;
use super::{Importer, error};
use crate::bsdf::material::white;
use crate::image::{self, Image};
use crate::math::Rgb;
use crate::scene::import::ImportError;
use crate::texture::Texture;
use std::sync::Arc;

/// Reflectance of common dielectrics: what is above it is metal.
const DIELECTRIC: f32 = 0.04;

/// Reflectance of the dielectric below facets of which the brightest channel is at most `largest`.
fn base(largest: f32) -> f32 {
    largest.min(DIELECTRIC)
}

/// The share of metal and its colour where the facets reflect `specular` and the dielectric `base`.
fn metal(specular: Rgb, base: f32) -> (f32, Rgb) {
    let share = ((specular.max_element() - base) / (1.0 - base)).clamp(0.0, 1.0);
    if share <= 0.0 {
        return (0.0, Rgb::ONE);
    }
    let color = (specular - Rgb::splat((1.0 - share) * base)) / share;
    (share, color.clamp(Rgb::ZERO, Rgb::ONE))
}

impl Importer<'_> {
    /// The parameters of the archived workflow.
    pub(super) fn specular_glossiness(
        &mut self,
        gloss: Extension,
        of: &str,
    ) -> Result<Core, ImportError> {
        let diffuse = gloss.texture("diffuseTexture");
        let factor = gloss.color("diffuseFactor", Rgb::ONE);
        let factor = self.tint(&format!("{of}: diffuseFactor"), factor);
        let alpha = self.fraction(&format!("{of}: opacity"), gloss.alpha("diffuseFactor"));
        let specular = gloss.color("specularFactor", Rgb::ONE);
        let specular = self.tint(&format!("{of}: specularFactor"), specular);
        let glossiness = gloss.number("glossinessFactor", 1.0);
        let glossiness = self.fraction(&format!("{of}: glossinessFactor"), glossiness);
        let info = gloss.texture("specularGlossinessTexture");
        let info = info.as_ref();
        let gloss = self.textured(info, Use::Channel(3), Rgb::splat(glossiness))?;
        let roughness = match gloss.constant() {
            Some(gloss) => Texture::Constant(Rgb::ONE - gloss),
            None => Texture::Affine(Arc::new((gloss, -Rgb::ONE, Rgb::ONE))),
        };
        let (f0, metal) = self.facets(specular, info)?;
        Ok(Core {
            color: self.textured(diffuse.as_ref(), Use::Color, factor)?,
            alpha: self.textured(diffuse.as_ref(), Use::Channel(3), Rgb::splat(alpha))?,
            roughness,
            metallic: Texture::Constant(Rgb::ZERO),
            ior: ior_of(f0),
            specular: white(),
            specular_color: white(),
            metal,
        })
    }

    /// The dielectric's reflectance and the metal beside it.
    fn facets(
        &mut self,
        factor: Rgb,
        info: Option<&TextureInfo>,
    ) -> Result<(f32, Option<Metal>), ImportError> {
        let image = match info.map(|i| (i, self.texture_file(i))) {
            Some((info, Ok(path))) => Some((info, path)),
            Some((_, Err(error))) if !self.options.lenient => return Err(error),
            // What is missing was told when its glossiness was asked for.
            Some((_, Err(_))) | None => None,
        };
        let Some((info, path)) = image else {
            let f0 = base(factor.max_element());
            let (share, color) = metal(factor, f0);
            let metal = Metal {
                share: Texture::Constant(Rgb::splat(share)),
                color: Texture::Constant(color),
            };
            return Ok((f0, (share > 0.0).then_some(metal)));
        };
        let fail = |e: image::ImageError| error(&self.container.path, e.to_string());
        let picture = image::read_linear(&path).map_err(fail)?;
        let texels = specular_texels(&picture, factor);
        let largest = texels.iter().map(|s| s.max_element()).fold(0.0, f32::max);
        let f0 = base(largest);
        let (shares, colors): (Vec<f32>, Vec<Rgb>) = texels.iter().map(|s| metal(*s, f0)).unzip();
        if shares.iter().all(|s| *s <= 0.0) {
            return Ok((f0, None));
        }
        let size = (picture.width, picture.height);
        let shares: Vec<Rgb> = shares.into_iter().map(Rgb::splat).collect();
        let share = self.made(info, factor, ("share", size, &shares))?;
        let color = self.made(info, factor, ("color", size, &colors))?;
        Ok((f0, Some(Metal { share, color })))
    }
}

/// The colours of the facets at each texel.
fn specular_texels(picture: &Image, factor: Rgb) -> Vec<Rgb> {
    let names: Vec<&str> = picture.channels.iter().map(|c| c.name.as_str()).collect();
    // Grey images answer for all colours.
    let [r, g, b] = match names.len() {
        0..3 => [0; 3],
        _ => image::color_channels(&names),
    };
    let texels = picture.pixels.chunks_exact(names.len().max(1));
    texels
        .map(|t| Rgb::new(t[r], t[g], t[b]).clamp(Rgb::ZERO, Rgb::ONE) * factor)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metal_and_dielectric_together_reflect_what_the_file_says() {
        for specular in [
            Rgb::new(1.0, 0.77, 0.34),
            Rgb::new(0.5, 0.3, 0.05),
            Rgb::splat(0.2),
            Rgb::splat(0.04),
            Rgb::splat(0.01),
            Rgb::new(0.03, 0.02, 0.02),
            Rgb::ONE,
        ] {
            let f0 = base(specular.max_element());
            let (share, color) = metal(specular, f0);
            let sum = color * share + Rgb::splat((1.0 - share) * f0);
            // Below the dielectric's own reflectance colours are lost: a hundredth at most.
            let error = (sum - specular).abs().max_element();
            assert!(
                error < 1e-6 || specular.max_element() < 0.04 && error < 0.011,
                "{specular} {sum}"
            );
            // The diffuse part: what the dielectric's share leaves.
            let left = (1.0 - share) * (1.0 - f0);
            assert!(
                (left - (1.0 - specular.max_element())).abs() < 1e-6,
                "{specular}"
            );
        }
    }
}
