//! Materials. Those that hold other materials are in [`super::bsdfs_nested`].

use super::importer::Importer;
use super::names;
use super::params::Params;
use super::role::Role;
use super::textures::{TOO_LARGE, times};
use super::value::{Dialect, Value};
use crate::bsdf::material::{
    Distribution, Principled, PrincipledThin, Roughness, WardVariant, white,
};
use crate::bsdf::{Material, MaterialId};
use crate::math::Rgb;
use crate::scene::import::{ImportError, ior};
use crate::texture::Texture;

/// The least roughness: a distribution of width 0 is not a function. Mitsuba's bound.
const MIN_ALPHA: f32 = 1e-4;

/// Materials that one may be made of. Sixty that each hold the next one twice would be 2^60.
const MOST_MATERIALS: usize = 128;

impl<'a> Importer<'a> {
    /// The material that object `index` describes. The same object gives the same material.
    pub fn bsdf(&mut self, index: usize) -> MaterialId {
        if let Some(&(id, _)) = self.material_of.get(&index) {
            return id;
        }
        let made = self.make_bsdf(index);
        let instead = "grey takes its place";
        let grey = |importer: &mut Self| (importer.default_bsdf(false), 1);
        let made = self.or_instead(index, made, instead, grey);
        self.material_of.insert(index, made);
        made.0
    }

    /// The material, and how many it is made of.
    fn make_bsdf(&mut self, index: usize) -> Result<(MaterialId, usize), ImportError> {
        let params = Params::new(self.document, index);
        let material = self.material(&params)?;
        self.done(&params);
        let inner = params.children("bsdf");
        let sizes = inner.iter().filter_map(|(_, i)| self.material_of.get(i));
        let size = 1 + sizes.map(|(_, size)| size).sum::<usize>();
        if size > MOST_MATERIALS {
            if size <= TOO_LARGE {
                let error = params.error(format!(
                    "this material is made of more than {MOST_MATERIALS}, one that is referred to twice counted twice"
                ));
                let instead = "grey takes its place";
                self.document.faults.add(params.at(), error, instead);
            }
            return Ok((self.default_bsdf(false), TOO_LARGE));
        }
        Ok((self.materials.push(material), size))
    }

    /// The material of a shape that names none: grey; black if it glows.
    pub fn default_bsdf(&mut self, glows: bool) -> MaterialId {
        if let Some(id) = self.default_material[usize::from(glows)] {
            return id;
        }
        let reflectance = Rgb::splat(if glows { 0.0 } else { 0.5 });
        let id = self.materials.push(Material::Diffuse {
            reflectance: Texture::Constant(reflectance),
        });
        self.default_material[usize::from(glows)] = Some(id);
        id
    }

    fn material(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        // How to sample is the renderer's decision.
        p.ignore(&["sample_visible", "specular_sampling_weight"]);
        match p.plugin() {
            "diffuse" | "lambertian" => {
                let name = p.either(&["reflectance", "diffuse_reflectance"]);
                let reflectance = self.texture(p, name, 0.5, Role::Reflectance);
                Ok(Material::Diffuse { reflectance })
            }
            "roughdiffuse" => self.rough_diffuse(p),
            "dielectric" | "thindielectric" | "roughdielectric" => self.dielectric(p),
            "conductor" | "roughconductor" => self.conductor(p),
            "plastic" | "roughplastic" => self.plastic(p),
            "phong" => self.phong(p),
            "ward" => self.ward(p),
            "principled" => self.principled(p),
            "principledthin" => self.principled_thin(p),
            "difftrans" => {
                let transmittance = self.texture(p, "transmittance", 0.5, Role::Reflectance);
                Ok(Material::DiffuseTransmitter { transmittance })
            }
            "null" => Ok(Material::Null),
            _ => self.nested_material(p),
        }
    }

    fn rough_diffuse(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        let name = p.either(&["reflectance", "diffuse_reflectance"]);
        Ok(Material::RoughDiffuse {
            reflectance: self.texture(p, name, 0.5, Role::Reflectance),
            alpha: self.texture(p, "alpha", 0.2, Role::Number),
            fast_approx: p.boolean("use_fast_approx", false),
        })
    }

    fn dielectric(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        let eta = self.relative_ior(p, "bk7");
        let specular_reflectance = self.specular(p);
        let specular_transmittance =
            self.texture(p, "specular_transmittance", 1.0, Role::Reflectance);
        Ok(match p.plugin() {
            "dielectric" => Material::Dielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
            },
            "thindielectric" => Material::ThinDielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
            },
            _ => Material::RoughDielectric {
                eta,
                roughness: self.roughness(p),
                specular_reflectance,
                specular_transmittance,
            },
        })
    }

    fn conductor(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        let name = p.text("material");
        let by_default = match p.dialect() {
            Dialect::Classic => "cu",
            Dialect::Modern => "none",
        };
        let (eta, k) = ior::conductor(name.unwrap_or(by_default)).unwrap_or_else(|| {
            let name = name.unwrap_or_default();
            let help = names::did_you_mean(name, ior::conductor_names());
            let message = format!("no conductor is called \"{name}\"");
            let at = p.place_of("material");
            p.fault(at, self.document.error_help(at, message, help));
            (Rgb::ZERO, Rgb::ONE)
        });
        let given_eta = self.texture_given(p, "eta", Role::Number);
        let given_k = self.texture_given(p, "k", Role::Number);
        let outside = self.ior(p, "ext_eta", "air");
        // Where "ext_eta" is left out, air is as good as vacuum for a metal: Mitsuba 3 uses 1.
        let outside = if p.has("ext_eta") { outside } else { 1.0 };
        let relative = |t| times(t, Rgb::splat(1.0 / outside));
        let eta = relative(given_eta.unwrap_or(Texture::Constant(eta)));
        let k = relative(given_k.unwrap_or(Texture::Constant(k)));
        let specular_reflectance = self.specular(p);
        if p.plugin() == "conductor" {
            return Ok(Material::Conductor {
                eta,
                k,
                specular_reflectance,
            });
        }
        Ok(Material::RoughConductor {
            eta,
            k,
            roughness: self.roughness(p),
            specular_reflectance,
        })
    }

    fn plastic(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        let eta = self.relative_ior(p, "polypropylene");
        let diffuse_reflectance = self.texture(p, "diffuse_reflectance", 0.5, Role::Reflectance);
        let specular_reflectance = self.specular(p);
        let nonlinear = p.boolean("nonlinear", false);
        if p.plugin() == "plastic" {
            return Ok(Material::Plastic {
                eta,
                diffuse_reflectance,
                specular_reflectance,
                nonlinear,
            });
        }
        Ok(Material::RoughPlastic {
            eta,
            roughness: self.roughness(p),
            diffuse_reflectance,
            specular_reflectance,
            nonlinear,
        })
    }

    fn phong(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        Ok(Material::Phong {
            diffuse_reflectance: self.texture(p, "diffuse_reflectance", 0.5, Role::Reflectance),
            specular_reflectance: self.texture(p, "specular_reflectance", 0.2, Role::Reflectance),
            exponent: self.texture(p, "exponent", 30.0, Role::Number),
        })
    }

    fn ward(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        let variants = [
            ("ward", WardVariant::Ward),
            ("ward-duer", WardVariant::WardDuer),
            ("balanced", WardVariant::Balanced),
        ];
        let (alpha_u, alpha_v) = self.alphas(p);
        Ok(Material::Ward {
            variant: p.choice("variant", &variants).unwrap_or_default(),
            diffuse_reflectance: self.texture(p, "diffuse_reflectance", 0.5, Role::Reflectance),
            specular_reflectance: self.texture(p, "specular_reflectance", 0.2, Role::Reflectance),
            alpha_u,
            alpha_v,
        })
    }

    fn principled(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        let eta = match p.number("eta") {
            Some(_) if p.has("specular") => {
                return Err(p.error("\"eta\" and \"specular\" say the same; give one of them"));
            }
            Some(_) => p.positive("eta", 1.5) as f32,
            None => {
                // Reflectance at normal incidence is 0.08 * specular (Burley 2012).
                let specular = p.float_in("specular", 0.5, 0.0..=1.0);
                (2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0) as f32
            }
        };
        let mut unit = |name, default| self.texture(p, name, default, Role::Reflectance);
        Ok(Material::Principled(Box::new(Principled {
            base_color: unit("base_color", 0.5),
            roughness: unit("roughness", 0.5),
            anisotropic: unit("anisotropic", 0.0),
            metallic: unit("metallic", 0.0),
            spec_trans: unit("spec_trans", 0.0),
            eta,
            spec_tint: unit("spec_tint", 0.0),
            sheen: unit("sheen", 0.0),
            sheen_tint: unit("sheen_tint", 0.0),
            flatness: unit("flatness", 0.0),
            clearcoat: unit("clearcoat", 0.0),
            clearcoat_gloss: unit("clearcoat_gloss", 0.0),
            main_specular_sampling_rate: p.float("main_specular_sampling_rate", 1.0) as f32,
            clearcoat_sampling_rate: p.float("clearcoat_sampling_rate", 1.0) as f32,
            diffuse_reflectance_sampling_rate: p.float("diffuse_reflectance_sampling_rate", 1.0)
                as f32,
        })))
    }

    fn principled_thin(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        p.ignore(&[
            "specular_reflectance_sampling_rate",
            "specular_transmittance_sampling_rate",
            "diffuse_reflectance_sampling_rate",
            "diffuse_transmittance_sampling_rate",
        ]);
        let eta = self.texture(p, "eta", 1.5, Role::Number);
        let diff_trans = self.texture(p, "diff_trans", 0.0, Role::Number);
        let mut unit = |name, default| self.texture(p, name, default, Role::Reflectance);
        Ok(Material::PrincipledThin(Box::new(PrincipledThin {
            base_color: unit("base_color", 0.5),
            roughness: unit("roughness", 0.5),
            anisotropic: unit("anisotropic", 0.0),
            spec_trans: unit("spec_trans", 0.0),
            eta,
            spec_tint: unit("spec_tint", 0.0),
            sheen: unit("sheen", 0.0),
            sheen_tint: unit("sheen_tint", 0.0),
            flatness: unit("flatness", 0.0),
            diff_trans,
        })))
    }
}

/// Parameters that several materials have.
impl<'a> Importer<'a> {
    /// The factor on specular reflection.
    pub fn specular(&mut self, p: &Params<'a>) -> Texture {
        let given = self.texture_given(p, "specular_reflectance", Role::Reflectance);
        given.unwrap_or_else(white)
    }

    /// `int_ior` over `ext_ior`.
    pub fn relative_ior(&mut self, p: &Params<'a>, inside: &'static str) -> f32 {
        self.ior(p, "int_ior", inside) / self.ior(p, "ext_ior", "air")
    }

    /// An index of refraction, as a number or by name.
    fn ior(&mut self, p: &Params<'a>, name: &'static str, default: &'static str) -> f32 {
        let by_default = ior::dielectric(default).unwrap_or(1.0);
        let named = match p.find(name).map(|property| &property.value) {
            Some(Value::Text(text)) => text.as_str(),
            None | Some(Value::Broken) => return by_default,
            Some(_) => return p.positive(name, f64::from(by_default)) as f32,
        };
        ior::dielectric(named).unwrap_or_else(|| {
            let help = names::did_you_mean(named, ior::dielectric_names());
            let message = format!("no material is called \"{named}\"");
            let at = p.place_of(name);
            p.fault(at, self.document.error_help(at, message, help));
            by_default
        })
    }

    /// `distribution` and `alpha`, or `alpha_u` and `alpha_v`.
    pub fn roughness(&mut self, p: &Params<'a>) -> Roughness {
        let distributions = [
            ("beckmann", (Distribution::Beckmann, true)),
            ("ggx", (Distribution::Ggx, true)),
            ("phong", (Distribution::Beckmann, false)),
            ("as", (Distribution::Beckmann, false)),
        ];
        let chosen = p.choice("distribution", &distributions);
        let (distribution, exact) = chosen.unwrap_or((Distribution::Beckmann, true));
        if !exact {
            let place = self.document.location(p.place_of("distribution"));
            self.warn(format!(
                "{place}: this distribution is rendered as \"beckmann\""
            ));
        }
        let (alpha_u, alpha_v) = self.alphas(p);
        Roughness {
            distribution,
            alpha_u,
            alpha_v,
        }
    }

    fn alphas(&mut self, p: &Params<'a>) -> (Texture, Texture) {
        let alpha = self.texture(p, "alpha", 0.1, Role::Number);
        let u = self.texture_given(p, "alpha_u", Role::Number);
        let v = self.texture_given(p, "alpha_v", Role::Number);
        let at_least = |t| match t {
            Texture::Constant(c) => Texture::Constant(c.max(Rgb::splat(MIN_ALPHA))),
            varying => varying,
        };
        (
            at_least(u.unwrap_or_else(|| alpha.clone())),
            at_least(v.unwrap_or(alpha)),
        )
    }
}
