//! From a [`Document`] to a [`Description`]: walks the scene's objects and hands each to its family.

use super::document::Document;
use super::params::Params;
use super::shapes::PendingShape;
use super::textures::Role;
use super::value::Value;
use super::{framing, integrators, meshes, origin, sensors};
use crate::bsdf::{MaterialId, Materials};
use crate::light::{Emitter, EnvironmentImage};
use crate::math::{DAffine3, DVec3};
use crate::scene::Description;
use crate::scene::description::RenderDescription;
use crate::scene::import::{ImportError, ImportOptions};
use crate::texture::Texture;
use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;

/// What has been imported so far.
pub(super) struct Importer<'a> {
    pub document: &'a Document,
    pub options: &'a ImportOptions,
    pub warnings: Vec<String>,
    told: HashSet<String>,
    /// Steps through shapes and integrators that hold others.
    nested: usize,
    pub materials: Materials,
    /// By object, its material and how many materials that is made of.
    pub material_of: HashMap<usize, (MaterialId, usize)>,
    /// Materials of shapes that name none: grey, and black for those that glow.
    pub default_material: [Option<MaterialId>; 2],
    /// Textures by the object they were made from, and what for.
    pub texture_of: HashMap<(usize, Role), Texture>,
    /// How many textures they are made of.
    pub texture_size: HashMap<usize, usize>,
    /// Environment maps by what they were read from.
    pub environments: &'a mut Environments,
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

/// Images around the scene, by file and exponent: each is read once, though a scene may be imported
/// again.
pub(super) type Environments = HashMap<(PathBuf, Option<u32>), Arc<EnvironmentImage>>;

/// What objects hold through references is followed this often: what is held twice is held
/// exponentially.
const MOST_NESTED: usize = 5_000_000;

/// Imports a whole document.
pub(super) fn import(
    document: &Document,
    options: &ImportOptions,
) -> Result<Description, ImportError> {
    let mut environments = Environments::new();
    let unread = document.faults.len();
    let mut description = import_from(document, options, DVec3::ZERO, &mut environments)?;
    if let Some(error) = document.faults.error().filter(|_| !options.lenient) {
        return Err(error);
    }
    let mut place = DVec3::ZERO;
    for _ in 0..origin::MOST_MOVES {
        let Some(step) = origin::far_origin(&description, place != DVec3::ZERO) else {
            break;
        };
        place += step;
        document.faults.truncate(unread);
        description = import_from(document, options, place, &mut environments)?;
    }
    description.warnings.extend(document.faults.warnings());
    Ok(description)
}

/// Imports a document with the world's origin at the point `origin` of its coordinates.
fn import_from(
    document: &Document,
    options: &ImportOptions,
    origin: DVec3,
    environments: &mut Environments,
) -> Result<Description, ImportError> {
    let mut importer = Importer {
        document,
        options,
        warnings: Vec::new(),
        told: HashSet::new(),
        nested: 0,
        materials: Materials::default(),
        material_of: HashMap::new(),
        default_material: [None; 2],
        texture_of: HashMap::new(),
        texture_size: HashMap::new(),
        environments,
        emitters: Vec::new(),
        shapes: Vec::new(),
        group_of: HashMap::new(),
        instances: Vec::new(),
        render: RenderDescription::default(),
        sensor: None,
        origin,
    };
    for warning in &document.warnings {
        importer.warn(warning.clone());
    }
    importer.scene()?;
    Ok(importer.finish())
}

impl<'a> Importer<'a> {
    fn scene(&mut self) -> Result<(), ImportError> {
        let scene = &self.document.objects[0];
        for property in &scene.properties {
            match property.value {
                Value::Object(index) => self.top_level(index)?,
                Value::Broken => {}
                _ => {
                    let place = self.document.location(property.at);
                    let name = &property.written;
                    self.warn(format!("{place}: a scene has no parameter \"{name}\""));
                }
            }
        }
        Ok(())
    }

    /// The value, or what takes its place where object `index` is wrong, which is told. What is
    /// wrong only because a part of the object is, is told already.
    pub fn or_instead<T>(
        &mut self,
        index: usize,
        result: Result<T, ImportError>,
        instead: &'static str,
        plain: impl FnOnce(&mut Self) -> T,
    ) -> T {
        result.unwrap_or_else(|error| {
            let at = self.document.objects[index].at;
            let own = error.at.as_ref() == Some(&self.document.location(at));
            if !(own && self.document.is_broken(index)) {
                self.document.fault(at, error, instead);
            }
            plain(self)
        })
    }

    /// Counts a step into something that holds others.
    pub fn step_into(&mut self, index: usize) -> Result<(), ImportError> {
        self.nested += 1;
        if self.nested <= MOST_NESTED {
            return Ok(());
        }
        let message = format!("objects hold others more than {MOST_NESTED} times");
        Err(self
            .document
            .error(self.document.objects[index].at, message))
    }

    /// Imports what stands directly in the scene. Materials and textures wait until they are asked for.
    fn top_level(&mut self, index: usize) -> Result<(), ImportError> {
        let object = &self.document.objects[index];
        match object.tag.as_str() {
            "shape" => self.shape(index, None)?,
            "emitter" if is_of_shapes(&object.plugin) => self.lamp_alone(index),
            "emitter" => {
                let read = self.emitter(index);
                self.or_instead(index, read, "the emitter is left out", |_| ());
            }
            "sensor" if self.sensor.is_some() => {
                let place = self.document.location(object.at);
                self.warn(format!("{place}: only the first sensor is used"));
            }
            "sensor" => {
                let read = self.sensor(index).map(Some);
                let instead = "the camera is placed to see all of the scene";
                self.sensor = self.or_instead(index, read, instead, |_| None);
            }
            "integrator" => {
                let params = Params::new(self.document, index);
                integrators::integrator(self, &params, index)?;
            }
            "medium" => self.no_media(index)?,
            "bsdf" | "texture" | "spectrum" => {}
            // What others refer to was only given its name here.
            _ if self.document.is_referred_to(index) => {}
            tag => {
                let place = self.document.location(object.at);
                self.warn(format!("{place}: a <{tag}> has no meaning here"));
            }
        }
        Ok(())
    }

    /// An area light by itself: shapes that refer to it shine with it.
    fn lamp_alone(&mut self, index: usize) {
        if self.document.is_referred_to(index) {
            return;
        }
        let at = self.document.objects[index].at;
        let message = "an area light belongs inside a <shape>";
        let error = self.document.error(at, message);
        let instead = "the emitter is left out";
        self.document.faults.add(at, error, instead);
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
        if self.told.insert(warning.clone()) {
            self.warnings.push(warning);
        }
    }

    /// Ends reading an object: tells of parameters that nothing asked for.
    pub fn done(&mut self, params: &Params) {
        for warning in params.unused() {
            self.warn(warning);
        }
    }

    fn finish(mut self) -> Description {
        let pending = std::mem::take(&mut self.shapes);
        let shapes = meshes::load_all(&mut self, pending);
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
        Description {
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
        }
    }
}

/// Whether an emitter is one of shapes.
fn is_of_shapes(plugin: &str) -> bool {
    matches!(plugin, "area" | "directionalarea")
}
