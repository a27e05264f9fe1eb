//! What has been imported so far of a [`Document`], and what every family of objects needs to
//! import its own.

use super::document::Document;
use super::params::Params;
use super::pending::{PendingShape, Sensor};
use super::role::Role;
use crate::bsdf::{MaterialId, Materials};
use crate::light::{Emitter, EnvironmentImage};
use crate::math::{DAffine3, DVec3};
use crate::medium::{Media, MediumId};
use crate::scene::description::RenderDescription;
use crate::scene::import::told::Told;
use crate::scene::import::{ImportError, ImportOptions, origin};
use crate::texture::Texture;
use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::sync::Arc;

/// What has been imported so far.
pub(super) struct Importer<'a> {
    pub document: &'a Document,
    pub options: &'a ImportOptions,
    pub warnings: Told,
    /// How many objects without an id were called after the same word.
    called: HashMap<String, u32>,
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
    pub media: Media,
    /// Media by the object they were made from.
    pub medium_of: HashMap<usize, MediumId>,
    pub emitters: Vec<Emitter>,
    /// What they are called, by number.
    pub emitter_names: BTreeMap<u32, String>,
    pub shapes: Vec<PendingShape>,
    /// Groups by the object they were made from.
    pub group_of: HashMap<usize, u32>,
    pub instances: Vec<(u32, DAffine3)>,
    pub render: RenderDescription,
    pub sensor: Option<Sensor>,
    /// The point of the file's coordinates that becomes the world's origin.
    pub origin: DVec3,
}

/// Images around the scene, by file and exponent: each is read once, though a scene may be imported
/// again.
pub(super) type Environments = HashMap<(PathBuf, Option<u32>), Arc<EnvironmentImage>>;

/// What objects hold through references is followed this often: what is held twice is held
/// exponentially.
const MOST_NESTED: usize = 5_000_000;

impl<'a> Importer<'a> {
    /// Nothing imported yet. The world's origin is the point `origin` of the document's
    /// coordinates.
    pub fn new(
        document: &'a Document,
        options: &'a ImportOptions,
        origin: DVec3,
        environments: &'a mut Environments,
    ) -> Self {
        Self {
            document,
            options,
            warnings: Told::default(),
            called: HashMap::new(),
            nested: 0,
            materials: Materials::default(),
            material_of: HashMap::new(),
            default_material: [None; 2],
            texture_of: HashMap::new(),
            texture_size: HashMap::new(),
            environments,
            media: Media::default(),
            medium_of: HashMap::new(),
            emitters: Vec::new(),
            emitter_names: BTreeMap::new(),
            shapes: Vec::new(),
            group_of: HashMap::new(),
            instances: Vec::new(),
            render: RenderDescription::default(),
            sensor: None,
            origin,
        }
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

    /// What object `index` is called: its id, or `word` and a number, the first without.
    pub fn name_of(&mut self, index: usize, word: &str) -> String {
        let object = &self.document.objects[index];
        if let Some(id) = &object.id {
            return id.clone();
        }
        let count = self
            .called
            .entry(format!("{} {word}", object.tag))
            .or_default();
        *count += 1;
        match *count {
            1 => word.to_owned(),
            n => format!("{word}.{n}"),
        }
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

    /// Where something stands that the file places by `to_world`: in its group, or in the world.
    pub fn place(&self, to_world: DAffine3, group: Option<u32>) -> DAffine3 {
        match group {
            Some(_) => to_world,
            None => origin::seen_from(self.origin, to_world),
        }
    }

    /// Says that light inside of a body is left out.
    pub fn no_subsurface(&mut self, index: usize) {
        let object = &self.document.objects[index];
        let place = self.document.location(object.at);
        let (tag, plugin) = (&object.tag, &object.plugin);
        self.warnings.tell(format!(
            "{place}: {tag} \"{plugin}\" is left out: the surface does not let light in"
        ));
    }

    /// Ends reading an object: tells of parameters that nothing asked for.
    pub fn done(&mut self, params: &Params) {
        params
            .unused()
            .into_iter()
            .for_each(|w| self.warnings.tell(w));
    }
}
