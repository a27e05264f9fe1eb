//! The end of an import: what waited for it, and what says how to render.

use super::importer::Importer;
use super::meshes;
use super::params::Params;
use crate::camera::CameraDescription;
use crate::film::FilmDescription;
use crate::film::filter::Filter;
use crate::scene::Description;
use crate::scene::description::SamplerKind;
use crate::scene::import::faults::At;
use crate::scene::import::{ImportError, origin};

/// The main file's beginning.
const START: At = At {
    file: 0,
    line: 1,
    column: 1,
};

impl Importer<'_> {
    /// Makes a description of all that was imported.
    pub fn finish(mut self) -> Result<Description, ImportError> {
        for (_, object, at) in std::mem::take(&mut self.stack) {
            let word = if object {
                "ObjectBegin"
            } else {
                "AttributeBegin"
            };
            self.warn_at(at, &format!("this \"{word}\" has no end"));
        }
        let pending = std::mem::take(&mut self.shapes);
        let shapes = meshes::make_all(&mut self, pending);
        if shapes.is_empty() && self.emitters.is_empty() {
            self.warnings
                .tell("the scene is empty: it has neither shapes nor lights".into());
        }
        for warning in origin::warnings(&shapes) {
            self.warnings.tell(warning);
        }
        let (camera, film) = self.picture();
        let (sampler, spp) = self.sampled();
        let integrator = self.setup.integrator.clone();
        let integrator = integrator.as_ref().map(|d| Params::new(self.source, d));
        self.integrator(integrator.as_ref());
        self.render.sampler = sampler;
        self.render.spp = spp;
        let at = self
            .setup
            .camera
            .as_ref()
            .map_or(START, |(camera, _)| camera.at);
        let camera_medium = self.medium_named(self.setup.camera_medium, at);
        Ok(Description {
            shapes,
            groups: self.groups,
            instances: self.instances,
            materials: self.materials,
            emitters: self.emitters,
            emitter_names: self.emitter_names,
            media: self.media,
            camera_medium: Some(camera_medium),
            camera,
            film,
            render: self.render,
            origin: self.origin,
            warnings: self.warnings.into_list(),
        })
    }

    /// The camera and its film. Where one is wrong, that is told and pbrt's default takes its
    /// place.
    fn picture(&mut self) -> (CameraDescription, FilmDescription) {
        let setup = [self.setup.filter.clone(), self.setup.film.clone()];
        let [filter, film] = setup;
        let (filter_at, film_at) = (filter.as_ref().map(|d| d.at), film.as_ref().map(|d| d.at));
        let p = filter.as_ref().map(|d| Params::new(self.source, d));
        let filter = self.filter(p.as_ref());
        let filter = self.or_default(filter, filter_at, Filter::Gaussian { stddev: 0.5 });
        let p = film.as_ref().map(|d| Params::new(self.source, d));
        let made = self.film(p.as_ref(), filter);
        let film = match made {
            Ok(film) => film,
            Err(message) => {
                let at = film_at.unwrap_or(START);
                self.source
                    .fault(at, message, "the default takes its place");
                // Without parameters there is nothing that could be wrong.
                self.film(None, filter)
                    .unwrap_or_else(|_| unreachable!("a film without parameters"))
            }
        };
        let aspect = f64::from(film.width) / f64::from(film.height);
        let camera = self.setup.camera.clone();
        if let Some((camera, true)) = &camera {
            self.warn_at(
                camera.at,
                "the motion of the camera is left out: it stands where it is \
                when the shutter opens",
            );
        }
        let camera = camera.map(|(definition, _)| definition);
        let p = camera.as_ref().map(|d| Params::new(self.source, d));
        let made = self.camera(p.as_ref(), aspect);
        let camera = made.unwrap_or_else(|message| {
            let at = camera.as_ref().map_or(START, |c| c.at);
            self.source
                .fault(at, message, "the default takes its place");
            self.camera(None, aspect)
                .unwrap_or_else(|_| unreachable!("a camera without parameters"))
        });
        (camera, film)
    }

    fn sampled(&mut self) -> (SamplerKind, u32) {
        let definition = self.setup.sampler.clone();
        let at = definition.as_ref().map(|d| d.at);
        let p = definition.as_ref().map(|d| Params::new(self.source, d));
        let made = self.sampler(p.as_ref());
        self.or_default(made, at, (SamplerKind::Sobol, 16))
    }

    fn or_default<T>(&self, made: Result<T, String>, at: Option<At>, default: T) -> T {
        made.unwrap_or_else(|message| {
            self.source
                .fault(at.unwrap_or(START), message, "the default takes its place");
            default
        })
    }
}
