//! From a [`Document`] to a [`Description`]: walks the scene's objects and hands each to its
//! family.

use super::document::Document;
use super::importer::{Environments, Importer};
use super::params::Params;
use super::value::Value;
use super::{framing, integrators, meshes};
use crate::math::DVec3;
use crate::scene::Description;
use crate::scene::import::{ImportError, ImportOptions, origin};

/// Imports a whole document.
pub(super) fn import(
    document: &Document,
    options: &ImportOptions,
) -> Result<Description, ImportError> {
    let mut environments = Environments::new();
    origin::import_near(&document.faults, options, |origin| {
        import_from(document, options, origin, &mut environments)
    })
}

/// Imports a document with the world's origin at the point `origin` of its coordinates.
fn import_from(
    document: &Document,
    options: &ImportOptions,
    origin: DVec3,
    environments: &mut Environments,
) -> Result<Description, ImportError> {
    let mut importer = Importer::new(document, options, origin, environments);
    for warning in &document.warnings {
        importer.warnings.tell(warning.clone());
    }
    importer.scene()?;
    Ok(importer.finish())
}

impl Importer<'_> {
    fn scene(&mut self) -> Result<(), ImportError> {
        let scene = &self.document.objects[0];
        for property in &scene.properties {
            match property.value {
                Value::Object(index) => self.top_level(index)?,
                Value::Broken => {}
                _ => {
                    let place = self.document.location(property.at);
                    let name = &property.written;
                    self.warnings
                        .tell(format!("{place}: a scene has no parameter \"{name}\""));
                }
            }
        }
        Ok(())
    }

    /// Imports what stands directly in the scene. Materials and textures wait until they are asked
    /// for.
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
                self.warnings
                    .tell(format!("{place}: only the first sensor is used"));
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
            // Shapes and the sensor refer to it.
            "medium" => {}
            "bsdf" | "texture" | "spectrum" => {}
            // What others refer to was only given its name here.
            _ if self.document.is_referred_to(index) => {}
            tag => {
                let place = self.document.location(object.at);
                self.warnings
                    .tell(format!("{place}: a <{tag}> has no meaning here"));
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

    fn finish(mut self) -> Description {
        let pending = std::mem::take(&mut self.shapes);
        let shapes = meshes::load_all(&mut self, pending);
        if shapes.is_empty() && self.emitters.is_empty() {
            self.warnings
                .tell("the scene is empty: it has neither shapes nor lights".into());
        }
        for warning in origin::warnings(&shapes) {
            self.warnings.tell(warning);
        }
        let groups = self.group_of.len() as u32;
        let sensor = match self.sensor.take() {
            Some(sensor) => sensor,
            None => {
                self.warnings
                    .tell("the scene has no sensor: the camera was placed to see all of it".into());
                framing::frame(&shapes, &self.instances)
            }
        };
        let mut render = self.render;
        render.spp = sensor.spp.unwrap_or(render.spp);
        render.sampler = sensor.sampler;
        if render.alpha && !render.hide_emitters {
            self.warnings.tell(
                "the film's \"pixel_format\" has alpha, which images have where emitters are hidden: \
                 give the integrator \"hide_emitters\", or the command line --alpha"
                    .into(),
            );
        }
        Description {
            media: self.media,
            camera_medium: Some(sensor.medium),
            shapes,
            groups,
            instances: self.instances,
            materials: self.materials,
            emitters: self.emitters,
            emitter_names: self.emitter_names,
            camera: sensor.camera,
            film: sensor.film,
            render,
            origin: self.origin,
            warnings: self.warnings.into_list(),
        }
    }
}

/// Whether an emitter is one of shapes.
fn is_of_shapes(plugin: &str) -> bool {
    matches!(plugin, "area" | "directionalarea")
}
