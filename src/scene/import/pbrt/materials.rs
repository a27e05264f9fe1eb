//! Materials by kind. What has a rough or a smooth form is in [`super::interfaces`], what v3 calls
//! by other names in [`super::materials_v3`].
//!
//! ```text
//!  Mask (the shape's alpha) > TwoSided > BumpMap, NormalMap > the model
//! ```
//!
//! pbrt's opaque models reflect on both sides.

use super::graphics::{Chosen, Definition};
use super::images;
use super::importer::{Importer, Role};
use super::interfaces::Made;
use super::parameter::{Kind, Values};
use super::params::Params;
use super::statement::Directive;
use crate::bsdf::material::{Diffuse, DiffuseTransmitter, InvalidNormals, Measured, Null};
use crate::bsdf::{Material, MaterialId};
use crate::math::Rgb;
use crate::scene::import::faults::At;
use crate::scene::import::{measured, named};
use crate::texture::{BitmapSettings, Filter, Texture, Wrap};
use glam::Affine2;

/// The kinds of materials of v4 that are read.
pub(super) const MATERIALS: &[&str] = &[
    "diffuse",
    "coateddiffuse",
    "coatedconductor",
    "conductor",
    "dielectric",
    "thindielectric",
    "diffusetransmission",
    "mix",
    "interface",
    "measured",
    "hair",
    "subsurface",
];

impl<'s> Importer<'s> {
    /// The material that shapes get now.
    pub fn current_material(&mut self) -> MaterialId {
        match self.graphics.material.clone() {
            Chosen::Default => self.grey(),
            Chosen::Own(definition) => self.material_of(&definition),
            Chosen::Named(name, at) => self.material_named(name, at),
        }
    }

    /// pbrt's default: a diffuse reflectance of a half.
    pub fn grey(&mut self) -> MaterialId {
        if let Some(id) = self.default_material {
            return id;
        }
        let diffuse = self.materials.push(Diffuse {
            reflectance: Texture::Constant(Rgb::splat(0.5)),
        });
        let id = self.two_sided(diffuse);
        self.materials.set_name(id, "default");
        self.default_material = Some(id);
        id
    }

    fn two_sided(&mut self, inner: MaterialId) -> MaterialId {
        self.materials.push(Material::TwoSided {
            front: inner,
            back: inner,
        })
    }

    /// The material of that name, wherever it is defined.
    pub fn material_named(&mut self, name: &str, at: At) -> MaterialId {
        let known = self.named_materials.get(name).cloned();
        let later = || self.later(Directive::MakeNamedMaterial, name, false);
        let Some(definition) = known.or_else(later) else {
            let known = self.named_materials.keys().copied();
            let help = named::did_you_mean(name, known);
            let help = help.map_or(String::new(), |h| format!("; {h}"));
            let message = format!("there is no material \"{name}\"{help}");
            self.source.fault(at, message, "grey takes its place");
            return self.grey();
        };
        self.material_of(&definition)
    }

    /// The material of a definition. The same definition gives the same material.
    fn material_of(&mut self, definition: &Definition<'s>) -> MaterialId {
        let key = definition.identity();
        if let Some(id) = self.material_of.known(&key) {
            return id;
        }
        let begun = self.material_of.begin();
        let made = match &begun.too_deep {
            Ok(()) => self.make_material(definition),
            Err(message) => Err(message.clone()),
        };
        let made = made.and_then(|id| self.material_of.bounded().map(|()| id));
        let is_whole = made.is_ok();
        let id = made.unwrap_or_else(|message| {
            self.source
                .fault(definition.at, message, "grey takes its place");
            self.grey()
        });
        self.material_of.end(&begun, key, &id, is_whole);
        id
    }

    fn make_material(&mut self, definition: &Definition<'s>) -> Result<MaterialId, String> {
        let p = &Params::new(self.source, definition);
        let kind = match definition.plugin.directive {
            Directive::MakeNamedMaterial => {
                p.text("type").ok_or("a named material needs a \"type\"")?
            }
            _ => p.name(),
        };
        let made = self.model(p, kind)?;
        let id = self.laid_around(p, made)?;
        let name = match definition.plugin.directive {
            Directive::MakeNamedMaterial => definition.plugin.name.clone(),
            _ => self.name_after(if kind.is_empty() { "none" } else { kind }),
        };
        if Some(id) != self.default_material {
            self.materials.set_name(id, name);
        }
        self.done(p);
        Ok(id)
    }

    /// A model with what turns its normals, and the same on both sides if it is opaque.
    fn laid_around(&mut self, p: &Params<'_, 's>, made: Made) -> Result<MaterialId, String> {
        let (material, opaque) = match made {
            Made::Opaque(material) => (material, true),
            Made::Clear(material) => (material, false),
            Made::Whole(material) => return Ok(self.materials.push(material)),
        };
        let mut id = self.materials.push(material);
        let subsurface = self.subsurface_of.remove(&super::subsurface::PENDING);
        // v3 calls it bumpmap.
        let displacement = if p.has("bumpmap") {
            "bumpmap"
        } else {
            "displacement"
        };
        if let Some(displacement) = self.texture_given(p, displacement, Role::Number) {
            id = self.materials.push(Material::BumpMap {
                displacement,
                scale: 1.0,
                invalid_normals: InvalidNormals::default(),
                inner: id,
            });
        } else if let Some(path) = self.file_given(p, "normalmap") {
            let settings = BitmapSettings {
                path,
                raw: true,
                gamma: None,
                filter: Filter::Linear,
                wrap_u: Wrap::Repeat,
                wrap_v: Wrap::Repeat,
                to_uv: images::flipped(Affine2::IDENTITY),
                channel: None,
            };
            let normals = self.open(settings, p.place_of("normalmap"))?;
            id = self.materials.push(Material::NormalMap {
                normals,
                invalid_normals: InvalidNormals::default(),
                inner: id,
            });
        }
        if opaque {
            id = self.two_sided(id);
        }
        if let Some(medium) = subsurface {
            self.subsurface_of.insert(id, medium);
        }
        Ok(id)
    }

    fn model(&mut self, p: &Params<'_, 's>, kind: &str) -> Result<Made, String> {
        Ok(match kind {
            "diffuse" => Made::Opaque(self.diffuse(p, "reflectance", 0.5)),
            "coateddiffuse" => Made::Opaque(self.coated_diffuse(p)),
            "coatedconductor" => Made::Opaque(self.coated_conductor(p)?),
            "conductor" => Made::Opaque(self.conductor(p)?),
            "dielectric" => Made::Clear(self.dielectric(p)),
            "thindielectric" => Made::Clear(self.thin_dielectric(p)),
            "diffusetransmission" => Made::Clear(self.diffuse_transmission(p)),
            "mix" => Made::Whole(self.mix(p)?),
            "" | "none" | "interface" => Made::Whole(Null.into()),
            "subsurface" => Made::Clear(self.subsurface(p)?),
            "hair" => Made::Opaque(self.hair(p)),
            "measured" => {
                let path = self.file_given(p, "filename");
                let path = path.ok_or("a measured material needs a \"filename\"")?;
                let brdf = measured::read(&path)?;
                Made::Opaque(Measured { brdf }.into())
            }
            other => match self.model_v3(p, other)? {
                Some(made) => made,
                None => {
                    let known = MATERIALS
                        .iter()
                        .chain(super::materials_v3::MATERIALS)
                        .copied();
                    let help = named::did_you_mean(other, known);
                    let help = help.map_or(String::new(), |h| format!("; {h}"));
                    return Err(format!(
                        "there is no material of the kind \"{other}\"{help}"
                    ));
                }
            },
        })
    }

    /// A diffuse reflectance.
    pub fn diffuse(&mut self, p: &Params<'_, 's>, name: &'static str, default: f32) -> Material {
        let reflectance = self.texture(p, name, Role::Reflectance, default);
        Diffuse { reflectance }.into()
    }

    /// Diffuse reflection and transmission at once: each half of a blend, twice as bright.
    fn diffuse_transmission(&mut self, p: &Params<'_, 's>) -> Material {
        let scale = p.float("scale", 1.0) as f32;
        let mut twice = |name| {
            let texture = self.texture(p, name, Role::Reflectance, 0.25);
            texture.scaled(Rgb::splat(2.0 * scale))
        };
        let (reflectance, transmittance) = (twice("reflectance"), twice("transmittance"));
        self.reflects_and_transmits(reflectance, transmittance)
    }

    /// A blend of diffuse reflection and diffuse transmission, half of each.
    pub fn reflects_and_transmits(
        &mut self,
        reflectance: Texture,
        transmittance: Texture,
    ) -> Material {
        let reflects = self.materials.push(Diffuse { reflectance });
        let first = self.two_sided(reflects);
        let second = self.materials.push(DiffuseTransmitter { transmittance });
        Material::Blend {
            weight: Texture::Constant(Rgb::splat(0.5)),
            first,
            second,
        }
    }

    fn mix(&mut self, p: &Params<'_, 's>) -> Result<Material, String> {
        let amount = match p.any("amount").map(|given| given.kind) {
            // v3's amount is a colour.
            Some(Kind::Rgb | Kind::Spectrum) => {
                let amount = self.mean_given(p, "amount", Role::Unbounded);
                let amount = amount.map_or(0.5, crate::math::luminance);
                Texture::Constant(Rgb::splat(amount))
            }
            _ => self.texture(p, "amount", Role::Number, 0.5),
        };
        let named = |importer: &mut Self, name: &str| importer.material_named(name, p.at());
        if let Some(given) = p.find("materials", &[Kind::Text]) {
            let Values::Texts(names) = &given.values else {
                return Err("\"materials\" are two names".into());
            };
            let [first, second] = names.as_slice() else {
                return Err(format!("\"materials\" are two names, not {}", names.len()));
            };
            return Ok(Material::Blend {
                weight: amount,
                first: named(self, first),
                second: named(self, second),
            });
        }
        // v3, where the amount is that of the first.
        let names = ["namedmaterial1", "namedmaterial2"].map(|name| p.text(name));
        let [Some(first), Some(second)] = names else {
            return Err("a mix needs \"materials\", two names".into());
        };
        Ok(Material::Blend {
            weight: amount,
            first: named(self, second),
            second: named(self, first),
        })
    }
}
