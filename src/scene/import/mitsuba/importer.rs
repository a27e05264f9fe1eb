//! From a [`Document`] to a [`Description`]: walks the scene's objects and hands each to its family.

use super::document::Document;
use super::names;
use super::params::Params;
use super::shapes::PendingShape;
use super::value::Value;
use super::{framing, integrators, meshes, origin, sensors};
use crate::bsdf::{MaterialId, Materials};
use crate::light::Emitter;
use crate::math::{DAffine3, DVec3};
use crate::scene::Description;
use crate::scene::description::RenderDescription;
use crate::scene::import::{ImportError, ImportOptions};
use crate::texture::Texture;
use std::collections::HashMap;

/// What has been imported so far.
pub(super) struct Importer<'a> {
    pub document: &'a Document,
    pub options: &'a ImportOptions,
    pub warnings: Vec<String>,
    pub materials: Materials,
    /// By object, its material and how many materials that is made of.
    pub material_of: HashMap<usize, (MaterialId, usize)>,
    /// Materials of shapes that name none: grey, and black for those that glow.
    pub default_material: [Option<MaterialId>; 2],
    /// Textures by the object they were made from, and whether they are colours of light.
    pub texture_of: HashMap<(usize, bool), Texture>,
    pub emitters: Vec<Emitter>,
    pub shapes: Vec<PendingShape>,
    /// Groups by the object they were made from.
    pub group_of: HashMap<usize, u32>,
    pub instances: Vec<(u32, DAffine3)>,
    pub render: RenderDescription,
    pub sensor: Option<sensors::Sensor>,
    /// The point of the file's coordinates that becomes the world's origin.
    origin: DVec3,
}

/// Imports a whole document.
pub(super) fn import(
    document: &Document,
    options: &ImportOptions,
) -> Result<Description, ImportError> {
    refuse_unknown_plugins(document)?;
    let mut description = import_from(document, options, DVec3::ZERO)?;
    let mut place = DVec3::ZERO;
    for _ in 0..origin::MOST_MOVES {
        let Some(step) = origin::far_origin(&description, place != DVec3::ZERO) else {
            break;
        };
        place += step;
        description = import_from(document, options, place)?;
    }
    Ok(description)
}

/// Imports a document with the world's origin at the point `origin` of its coordinates.
fn import_from(
    document: &Document,
    options: &ImportOptions,
    origin: DVec3,
) -> Result<Description, ImportError> {
    let mut importer = Importer {
        document,
        options,
        warnings: document.warnings.clone(),
        materials: Materials::default(),
        material_of: HashMap::new(),
        default_material: [None; 2],
        texture_of: HashMap::new(),
        emitters: Vec::new(),
        shapes: Vec::new(),
        group_of: HashMap::new(),
        instances: Vec::new(),
        render: RenderDescription::default(),
        sensor: None,
        origin,
    };
    importer.scene()?;
    importer.finish()
}

/// Every plugin must be known, used or not: a misspelt one would otherwise go unnoticed.
fn refuse_unknown_plugins(document: &Document) -> Result<(), ImportError> {
    for object in &document.objects {
        let tag = if object.tag == "spectrum" {
            "texture"
        } else {
            &object.tag
        };
        let known = names::plugins(tag).unwrap_or_default();
        if known.is_empty() || known.contains(&object.plugin.as_str()) {
            continue;
        }
        let help = names::did_you_mean(&object.plugin, known.iter().copied());
        let help = help.unwrap_or_else(|| format!("known are {}", known.join(", ")));
        let message = format!("{} \"{}\" is not known", object.tag, object.plugin);
        return Err(document.error_help(object.at, message, Some(help)));
    }
    Ok(())
}

impl<'a> Importer<'a> {
    fn scene(&mut self) -> Result<(), ImportError> {
        let scene = &self.document.objects[0];
        for property in &scene.properties {
            let Value::Object(index) = property.value else {
                let place = self.document.location(property.at);
                let name = &property.written;
                self.warn(format!("{place}: a scene has no parameter \"{name}\""));
                continue;
            };
            self.top_level(index)?;
        }
        Ok(())
    }

    /// Imports what stands directly in the scene. Materials and textures wait until they are asked for.
    fn top_level(&mut self, index: usize) -> Result<(), ImportError> {
        match self.document.objects[index].tag.as_str() {
            "shape" => self.shape(index, None),
            "emitter" => self.emitter(index),
            "sensor" if self.sensor.is_some() => {
                let place = self.document.location(self.document.objects[index].at);
                self.warn(format!("{place}: only the first sensor is used"));
                Ok(())
            }
            "sensor" => {
                self.sensor = Some(self.sensor(index)?);
                Ok(())
            }
            "integrator" => {
                let params = Params::new(self.document, index);
                integrators::integrator(self, &params)
            }
            "medium" => self.no_media(index),
            "bsdf" | "texture" | "spectrum" => Ok(()),
            tag => {
                let place = self.document.location(self.document.objects[index].at);
                self.warn(format!("{place}: a <{tag}> has no meaning here"));
                Ok(())
            }
        }
    }

    /// Where something stands that the file places by `to_world`: in its group, or in the world.
    pub fn place(&self, to_world: DAffine3, group: Option<u32>) -> DAffine3 {
        match group {
            Some(_) => to_world,
            None => origin::seen_from(self.origin, to_world),
        }
    }

    /// Says that a medium is left out.
    pub fn no_media(&mut self, index: usize) -> Result<(), ImportError> {
        let object = &self.document.objects[index];
        let place = self.document.location(object.at);
        let (tag, plugin) = (&object.tag, &object.plugin);
        self.warn(format!(
            "{place}: {tag} \"{plugin}\" is left out: light travels in straight lines between surfaces here"
        ));
        Ok(())
    }

    /// Remembers something odd. The same thing twice is told once.
    pub fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// Ends reading an object: tells of parameters that nothing asked for.
    pub fn done(&mut self, params: &Params) {
        for warning in params.unused() {
            self.warn(warning);
        }
    }

    fn finish(mut self) -> Result<Description, ImportError> {
        let pending = std::mem::take(&mut self.shapes);
        let shapes = meshes::load_all(&mut self, pending)?;
        if shapes.is_empty() && self.emitters.is_empty() {
            self.warn("the scene is empty: it has neither shapes nor lights".into());
        }
        for warning in origin::warnings(&shapes) {
            self.warn(warning);
        }
        let groups = self.group_of.len() as u32;
        let sensor = match self.sensor.take() {
            Some(sensor) => sensor,
            None => {
                self.warn("the scene has no sensor: the camera was placed to see all of it".into());
                framing::frame(&shapes, &self.instances)
            }
        };
        let mut render = self.render;
        render.spp = sensor.spp.unwrap_or(render.spp);
        render.sampler = sensor.sampler;
        Ok(Description {
            shapes,
            groups,
            instances: self.instances,
            materials: self.materials,
            emitters: self.emitters,
            camera: sensor.camera,
            film: sensor.film,
            render,
            origin: self.origin,
            warnings: self.warnings,
        })
    }
}
