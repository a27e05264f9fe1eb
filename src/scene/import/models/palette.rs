//! Materials by name, for models that bring none: `clay`, `gold`, `plastic:0.8,0.1,0.1`.

use super::linear;
use super::numbers::numbers;
use crate::bsdf::material::{
    Conductor, Dielectric, Diffuse, Distribution, Principled, RoughConductor, RoughDielectric,
    RoughPlastic, Roughness, white,
};
use crate::bsdf::{Material, MaterialId, Materials};
use crate::math::Rgb;
use crate::medium::{Boundary, Media, Medium};
use crate::scene::import::ior;
use crate::texture::Texture;
use std::str::FromStr;

/// Attribute that holds a mesh's colours.
pub const VERTEX_COLOR: &str = "vertex_color";

/// Names that stand for a way of being painted. Names of conductors (`gold`, `copper`..) come with
/// them.
pub const NAMES: [&str; 8] = [
    "clay", "matte", "plastic", "metal", "mirror", "glass", "frosted", "water",
];
/// Conductors under the names people use, and the symbols they stand for.
const METALS: [(&str, &str); 7] = [
    ("gold", "Au"),
    ("silver", "Ag"),
    ("copper", "Cu"),
    ("aluminium", "Al"),
    ("aluminum", "Al"),
    ("chrome", "Cr"),
    ("tungsten", "W"),
];

/// Those whose colour is no part of what they are.
pub const COLORED: [&str; 4] = ["clay", "matte", "plastic", "metal"];

/// Those that light passes: what they enclose can absorb.
const BODIES: [&str; 3] = ["glass", "frosted", "water"];

/// Roughness of metals and frosted glass, as the width of their facets.
const ALPHA: f32 = 0.15;

/// A material by name, with a colour of its own or the name's.
#[derive(Clone, Debug, PartialEq)]
pub struct Paint {
    name: String,
    color: Option<Rgb>,
    /// The distance inside after which light of the colour is left, instead of tinting what passes
    /// the surface.
    distance: Option<f32>,
}

impl Paint {
    /// What models without a material are made of.
    pub fn clay() -> Self {
        Self {
            name: "clay".into(),
            color: None,
            distance: None,
        }
    }

    /// Whether an image can be its colour: it names none, and is not what it is by its colour.
    pub fn takes_image(&self) -> bool {
        self.color.is_none() && COLORED.contains(&self.name.as_str())
    }

    /// Adds the material. Where the mesh has colours, and the paint names none, they are used by the
    /// materials that have a colour of their own.
    pub fn add(&self, materials: &mut Materials, colors: Option<Texture>) -> MaterialId {
        let color = |default: [f32; 3]| match (self.color, &colors) {
            (Some(color), _) => Texture::Constant(color),
            (None, Some(colors)) => colors.clone(),
            (None, None) => Texture::Constant(Rgb::from(default)),
        };
        let tint = || match (self.color, self.distance) {
            (Some(color), None) => Texture::Constant(color),
            _ => white(),
        };
        let material = match self.name.as_str() {
            "glass" => dielectric(1.5, tint()),
            "water" => dielectric(1.333, tint()),
            "frosted" => Material::RoughDielectric(RoughDielectric {
                eta: 1.5,
                roughness: rough(ALPHA),
                specular_reflectance: white(),
                specular_transmittance: tint(),
            }),
            "mirror" => mirror(tint()),
            "metal" => metallic(color([0.75, 0.75, 0.76])),
            "plastic" => plastic(color([0.25, 0.45, 0.7])),
            "matte" => Material::Diffuse(Diffuse {
                reflectance: color([0.8, 0.8, 0.8]),
            }),
            "clay" => Material::Diffuse(Diffuse {
                reflectance: color([0.62, 0.56, 0.5]),
            }),
            metal => conductor(metal, tint()),
        };
        let opaque = !material.transmits();
        let mut id = materials.push(material);
        if opaque {
            id = materials.push(Material::TwoSided {
                front: id,
                back: id,
            });
        }
        materials.set_name(id, &*self.name);
        id
    }
}

impl Paint {
    /// What a closed body painted so encloses: `None` if nothing.
    pub fn boundary(&self, media: &mut Media) -> Option<Boundary> {
        let (color, distance) = (self.color?, self.distance?);
        let inside = Medium::absorbing(self.name.clone(), color, distance);
        Some(Boundary::in_vacuum(media.push(inside)))
    }
}

impl FromStr for Paint {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, rest) = match text.split_once(':') {
            Some((name, rest)) => (name, Some(rest)),
            None => (text, None),
        };
        let (color, distance) = match rest.map(|rest| (rest, rest.split_once('@'))) {
            None => (None, None),
            Some((_, Some((color, distance)))) if BODIES.contains(&name) => {
                (Some(parse_color(color)?), Some(parse_distance(distance)?))
            }
            Some((_, Some(_))) => {
                let bodies = BODIES.join(", ");
                return Err(format!(
                    "\"{name}\" has no inside: only {bodies} take a distance"
                ));
            }
            Some((color, None)) => (Some(parse_color(color)?), None),
        };
        let known = NAMES.contains(&name) || METALS.iter().any(|m| m.0 == name);
        if !known {
            let metals: Vec<&str> = METALS.iter().map(|m| m.0).collect();
            return Err(format!(
                "there is no material \"{name}\", only {}, {}",
                NAMES.join(", "),
                metals.join(", ")
            ));
        }
        Ok(Self {
            name: name.into(),
            color,
            distance,
        })
    }
}

/// A length.
fn parse_distance(text: &str) -> Result<f32, String> {
    let distance = text
        .parse()
        .ok()
        .filter(|d: &f32| *d > 0.0 && d.is_finite());
    distance.ok_or_else(|| format!("\"{text}\" is no distance: a length above 0 is expected"))
}

/// `0.8,0.2,0.1` (linear) or `#cc3311` (sRGB).
pub(in crate::scene::import) fn parse_color(text: &str) -> Result<Rgb, String> {
    let wrong = || format!("\"{text}\" is no colour: R,G,B from 0 to 1 or #rrggbb is expected");
    if let Some(hex) = text.strip_prefix('#').filter(|h| h.len() == 6) {
        let code = u32::from_str_radix(hex, 16).map_err(|_| wrong())?;
        let part = |shift: u32| (code >> shift & 255) as f32 / 255.0;
        return Ok(linear(Rgb::new(part(16), part(8), part(0))));
    }
    let in_range = |v: &Vec<f64>| v.iter().all(|x| (0.0..=1.0).contains(x));
    match numbers(text).filter(in_range).as_deref() {
        Some(&[r, g, b]) => Ok(Rgb::new(r as f32, g as f32, b as f32)),
        Some(&[grey]) => Ok(Rgb::splat(grey as f32)),
        _ => Err(wrong()),
    }
}

fn rough(alpha: f32) -> Roughness {
    let alpha = Texture::Constant(Rgb::splat(alpha));
    Roughness {
        distribution: Distribution::Ggx,
        alpha_u: alpha.clone(),
        alpha_v: alpha,
    }
}

fn dielectric(eta: f32, specular_transmittance: Texture) -> Material {
    Material::Dielectric(Dielectric {
        eta,
        specular_reflectance: white(),
        specular_transmittance,
    })
}

fn mirror(specular_reflectance: Texture) -> Material {
    Material::Conductor(Conductor {
        eta: Texture::Constant(Rgb::ZERO),
        k: Texture::Constant(Rgb::ONE),
        specular_reflectance,
    })
}

fn conductor(name: &str, specular_reflectance: Texture) -> Material {
    let symbol = METALS.iter().find(|m| m.0 == name).map_or(name, |m| m.1);
    let Some((eta, k)) = ior::conductor(symbol) else {
        return mirror(specular_reflectance);
    };
    Material::RoughConductor(RoughConductor {
        eta: Texture::Constant(eta),
        k: Texture::Constant(k),
        roughness: rough(ALPHA),
        specular_reflectance,
    })
}

fn plastic(diffuse_reflectance: Texture) -> Material {
    Material::RoughPlastic(RoughPlastic {
        eta: 1.5,
        roughness: rough(0.08),
        diffuse_reflectance,
        specular_reflectance: white(),
        nonlinear: false,
    })
}

fn metallic(base_color: Texture) -> Material {
    let roughness = Texture::Constant(Rgb::splat(ALPHA.sqrt()));
    principled(base_color, roughness, Texture::Constant(Rgb::ONE), 1.5)
}

/// The principled model without its extras.
pub(super) fn principled(
    base_color: Texture,
    roughness: Texture,
    metallic: Texture,
    eta: f32,
) -> Material {
    let zero = || Texture::Constant(Rgb::ZERO);
    Material::from(Principled {
        base_color,
        roughness,
        anisotropic: zero(),
        metallic,
        spec_trans: zero(),
        eta,
        spec_tint: zero(),
        sheen: zero(),
        sheen_tint: zero(),
        flatness: zero(),
        clearcoat: zero(),
        clearcoat_gloss: zero(),
        main_specular_sampling_rate: 1.0,
        clearcoat_sampling_rate: 1.0,
        diffuse_reflectance_sampling_rate: 1.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_makes_a_material() {
        for name in NAMES.into_iter().chain(METALS.map(|m| m.0)) {
            let mut materials = Materials::default();
            let paint: Paint = name.parse().unwrap();
            let id = paint.add(&mut materials, None);
            assert_eq!(id as usize, materials.len() - 1, "{name}");
        }
        for (name, symbol) in METALS {
            assert!(ior::conductor(symbol).is_some(), "{name}");
        }
    }

    #[test]
    fn a_colour_of_the_paint_wins_over_that_of_the_mesh() {
        let reflectance = |paint: &str, colored: bool| {
            let mut materials = Materials::default();
            let colors = colored.then(|| Texture::MeshAttribute(VERTEX_COLOR.into()));
            paint.parse::<Paint>().unwrap().add(&mut materials, colors);
            match materials.get(0) {
                Material::Diffuse(Diffuse { reflectance }) => reflectance.clone(),
                other => panic!("{other:?}"),
            }
        };
        let attribute = reflectance("clay", true);
        assert!(matches!(attribute, Texture::MeshAttribute(_)));
        let green = reflectance("clay:0,1,0", true).constant();
        assert_eq!(green, Some(Rgb::new(0.0, 1.0, 0.0)));
        let grey = reflectance("matte:#bcbcbc", false).constant().unwrap();
        assert!(
            (grey - Rgb::splat(0.5029)).abs().max_element() < 1e-3,
            "{grey}"
        );
    }

    #[test]
    fn odd_paints_are_errors() {
        for text in ["", "cheese", "clay:1,2,3", "clay:red", "clay:#12", "clay:"] {
            assert!(text.parse::<Paint>().is_err(), "{text}");
        }
    }
}
