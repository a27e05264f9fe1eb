//! Materials that hold other materials.

use super::importer::Importer;
use super::params::Params;
use super::role::Role;
use super::value;
use crate::bsdf::material::{InvalidNormals, Parameters};
use crate::bsdf::{Material, MaterialId};
use crate::scene::import::ImportError;
use crate::texture::Texture;

impl<'a> Importer<'a> {
    /// The materials from `mask` to `clearcoat`.
    pub fn nested_material(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        match p.plugin() {
            "mask" => Ok(Material::Mask {
                opacity: self.texture(p, "opacity", 0.5, Role::Reflectance),
                inner: self.inner(p)?,
            }),
            "twosided" => self.two_sided(p),
            "bumpmap" => self.bump_map(p),
            "normalmap" => self.normal_map(p),
            "blendbsdf" => self.blend(p),
            "mixturebsdf" => self.mixture(p),
            "coating" | "roughcoating" => self.coating(p),
            // glTF's varnish, which Mitsuba has not.
            "clearcoat" => Ok(Material::ClearCoat {
                weight: self.texture(p, "weight", 1.0, Role::Reflectance),
                roughness: self.texture(p, "roughness", 0.0, Role::Reflectance),
                inner: self.inner(p)?,
            }),
            // glTF's fibres, likewise.
            "sheen" => Ok(Material::Sheen {
                color: self.texture(p, "color", 0.5, Role::Reflectance),
                roughness: self.texture(p, "roughness", 0.3, Role::Reflectance),
                inner: self.inner(p)?,
            }),
            other => Err(p.error(format!("bsdf \"{other}\" is not supported"))),
        }
    }

    /// All nested materials, in order.
    fn inners(&mut self, p: &Params<'a>) -> Vec<MaterialId> {
        let children = p.children("bsdf");
        children
            .iter()
            .map(|(_, index)| self.bsdf(*index))
            .collect()
    }

    /// The one nested material.
    fn inner(&mut self, p: &Params<'a>) -> Result<MaterialId, ImportError> {
        match p.child("bsdf")? {
            Some(index) => Ok(self.bsdf(index)),
            None => Err(p.error(format!("\"{}\" needs a <bsdf> inside", p.plugin()))),
        }
    }

    fn two_sided(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        let inner = self.inners(p);
        let (front, back) = match *inner.as_slice() {
            [both] => (both, both),
            [front, back] => (front, back),
            _ => return Err(p.error("\"twosided\" needs one or two <bsdf>s inside")),
        };
        let transmits = |id| self.materials.any(id, &Material::transmits);
        if transmits(front) || transmits(back) {
            return Err(self.document.error_help(
                p.at(),
                "\"twosided\" is for materials that light cannot pass through",
                Some("use the inner material without \"twosided\"".into()),
            ));
        }
        Ok(Material::TwoSided { front, back })
    }

    /// The parameter `name`, be it a texture, a spectrum or a colour; or the nested texture,
    /// whatever its name.
    fn nested_texture(
        &mut self,
        p: &Params<'a>,
        name: &'static str,
    ) -> Result<Texture, ImportError> {
        if let Some(texture) = self.texture_given(p, name, Role::Number) {
            return Ok(texture);
        }
        match p.child("texture")?.or(p.child("spectrum")?) {
            Some(index) => Ok(self.texture_object(index, Role::Number)),
            None => Err(p.error(format!("\"{}\" needs a <texture> inside", p.plugin()))),
        }
    }

    /// What is done about normals that are turned too far.
    fn invalid_normals(&self, p: &Params<'a>) -> InvalidNormals {
        let default = InvalidNormals::default();
        InvalidNormals {
            flip: p.boolean("flip_invalid_normals", default.flip),
            shadow: p.boolean("use_shadowing_function", default.shadow),
        }
    }

    fn bump_map(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        Ok(Material::BumpMap {
            displacement: self.nested_texture(p, "displacement")?,
            scale: p.float("scale", 1.0) as f32,
            invalid_normals: self.invalid_normals(p),
            inner: self.inner(p)?,
        })
    }

    fn normal_map(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        Ok(Material::NormalMap {
            normals: self.nested_texture(p, "normalmap")?,
            invalid_normals: self.invalid_normals(p),
            inner: self.inner(p)?,
        })
    }

    fn blend(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        let weight = match self.texture_given(p, "weight", Role::Reflectance) {
            Some(weight) => weight,
            // The texture may be anonymous.
            None => self.nested_texture(p, "weight")?,
        };
        match *self.inners(p).as_slice() {
            [first, second] => Ok(Material::Blend {
                weight,
                first,
                second,
            }),
            _ => Err(p.error("\"blendbsdf\" needs two <bsdf>s inside")),
        }
    }

    fn mixture(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        let text = p.text("weights").unwrap_or_default();
        let at = p.place_of("weights");
        let mut weights = value::numbers(text).map_err(|m| self.document.error(at, m))?;
        let inner = self.inners(p);
        if weights.len() != inner.len() || weights.is_empty() {
            let (w, b) = (weights.len(), inner.len());
            let message = format!("\"mixturebsdf\" has {w} weights for {b} <bsdf>s");
            return Err(p.error(message));
        }
        if weights.iter().any(|w| *w < 0.0) {
            return Err(self.document.error(at, "weights cannot be negative"));
        }
        let sum: f64 = weights.iter().sum();
        // A little above 1 comes from writing decimals; Mitsuba scales whatever is above 1.
        if sum > 1.0 {
            weights.iter_mut().for_each(|w| *w /= sum);
        }
        if sum > 1.001 {
            let place = self.document.location(at);
            self.warnings.tell(format!(
                "{place}: the weights add up to {sum}; they were scaled to 1"
            ));
        }
        let weights = weights.iter().map(|w| *w as f32);
        Ok(Material::Mixture {
            parts: weights.zip(inner).collect(),
        })
    }

    fn coating(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        let eta = self.asking(p).relative_ior("bk7");
        let thickness = p.float_in("thickness", 1.0, 0.0..=f64::from(f32::MAX)) as f32;
        let sigma_a = self.texture(p, "sigma_a", 0.0, Role::Number);
        let specular_reflectance = self.texture(p, "specular_reflectance", 1.0, Role::Reflectance);
        if p.plugin() == "coating" {
            return Ok(Material::Coating {
                eta,
                thickness,
                sigma_a,
                specular_reflectance,
                inner: self.inner(p)?,
            });
        }
        Ok(Material::RoughCoating {
            eta,
            roughness: self.asking(p).roughness(),
            thickness,
            sigma_a,
            specular_reflectance,
            inner: self.inner(p)?,
        })
    }
}
