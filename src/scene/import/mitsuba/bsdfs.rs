//! Materials. Those that hold other materials are in [`super::bsdfs_nested`].

use super::importer::Importer;
use super::params::Params;
use super::textures::TOO_LARGE;
use crate::bsdf::material::Diffuse;
use crate::bsdf::{Material, MaterialId};
use crate::math::Rgb;
use crate::scene::import::ImportError;
use crate::texture::Texture;

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
        if !self.default_material.contains(&Some(made.0)) {
            let plugin = &self.document.objects[index].plugin;
            let name = self.name_of(index, plugin);
            self.materials.set_name(made.0, name);
        }
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
        let id = self.materials.push(Diffuse {
            reflectance: Texture::Constant(reflectance),
        });
        let name = if glows { "default.black" } else { "default" };
        self.materials.set_name(id, name);
        self.default_material[usize::from(glows)] = Some(id);
        id
    }

    fn material(&mut self, p: &Params<'a>) -> Result<Material, ImportError> {
        // How to sample is the renderer's decision.
        p.ignore(&["sample_visible", "specular_sampling_weight"]);
        let name = match p.plugin() {
            "lambertian" => "diffuse",
            name => name,
        };
        match Material::read(name, &mut self.asking(p)) {
            Some(made) => made.map_err(|message| p.error(message)),
            None => self.nested_material(p),
        }
    }
}
