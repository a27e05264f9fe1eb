//! What has been imported so far of a [`Source`], and what every family of directives needs.

use super::graphics::{Definition, Graphics, Identity};
use super::nested::{self, Nested};
use super::params::Params;
use super::pending::PendingShape;
use super::source::Source;
use super::statement::{Directive, Plugin};
use crate::bsdf::{MaterialId, Materials};
use crate::light::{Emitter, EnvironmentImage};
use crate::math::{DAffine3, DVec3};
use crate::medium::{Media, MediumId};
use crate::scene::description::RenderDescription;
use crate::scene::import::faults::At;
use crate::scene::import::told::Told;
use crate::scene::import::{ImportError, ImportOptions, origin};
use crate::texture::Texture;
use std::cell::OnceCell;
use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;

/// What a texture's values are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Role {
    /// A factor on scattered light: each channel from 0 to 1.
    Reflectance,
    /// A colour that may be anything: an index of refraction, an absorption.
    Unbounded,
    /// One number: pbrt's `float` textures.
    Number,
}

/// What makes names different: the directive, the name, and whether a texture is of numbers.
type Name<'s> = (Directive, &'s str, bool);

/// The directives that say how to render, the last of each.
#[derive(Default)]
pub(super) struct Setup<'s> {
    pub camera: Option<(Definition<'s>, bool)>,
    pub camera_medium: &'s str,
    pub film: Option<Definition<'s>>,
    pub filter: Option<Definition<'s>>,
    pub sampler: Option<Definition<'s>>,
    pub integrator: Option<Definition<'s>>,
}

/// What has been imported so far.
pub(super) struct Importer<'s> {
    pub source: &'s Source,
    pub options: &'s ImportOptions,
    pub warnings: Told,
    /// How many shapes and lights were called after the same word.
    called: HashMap<String, u32>,
    pub graphics: Graphics<'s>,
    /// What `AttributeBegin` and `ObjectBegin` put aside; whether it was the latter.
    pub stack: Vec<(Graphics<'s>, bool, At)>,
    pub in_world: bool,
    pub setup: Setup<'s>,
    /// What emitters are multiplied by, for the sensor's exposure.
    pub imaging_ratio: f32,
    pub coordinate_systems: HashMap<&'s str, [crate::math::DMat4; 2]>,
    pub named_materials: HashMap<&'s str, Definition<'s>>,
    /// By name, and by whether it is of numbers.
    pub named_textures: HashMap<(&'s str, bool), Definition<'s>>,
    pub named_media: HashMap<&'s str, Definition<'s>>,
    /// The first definition of every name, for what uses one before that.
    first: OnceCell<HashMap<Name<'s>, (At, &'s Plugin)>>,
    pub materials: Materials,
    /// Materials by what they were made of.
    pub material_of: Nested<Identity, MaterialId>,
    /// Materials with the opacity of a shape around them.
    pub masked: HashMap<(MaterialId, String), MaterialId>,
    pub default_material: Option<MaterialId>,
    pub texture_of: Nested<(Identity, Role), Texture>,
    pub environments: &'s Environments,
    pub media: Media,
    pub medium_of: HashMap<Identity, MediumId>,
    /// Clouds so far.
    pub clouds: usize,
    /// Media of materials that scatter inside of shapes.
    pub subsurface_of: HashMap<MaterialId, MediumId>,
    pub emitters: Vec<Emitter>,
    pub emitter_names: BTreeMap<u32, String>,
    pub shapes: Vec<PendingShape<'s>>,
    /// The groups by the names of the objects.
    pub group_of: HashMap<&'s str, u32>,
    pub group: Option<u32>,
    pub groups: u32,
    pub instances: Vec<(u32, DAffine3)>,
    pub render: RenderDescription,
    /// The point of the file's coordinates that becomes the world's origin.
    pub origin: DVec3,
}

/// Images around the scene by what was asked for: each is read once, though a scene may be imported
/// again.
pub(super) type Environments =
    std::cell::RefCell<HashMap<(PathBuf, bool), Result<Arc<EnvironmentImage>, String>>>;

impl<'s> Importer<'s> {
    /// Nothing imported yet. The world's origin is the point `origin` of the file's coordinates.
    pub fn new(
        source: &'s Source,
        options: &'s ImportOptions,
        origin: DVec3,
        environments: &'s Environments,
    ) -> Self {
        Self {
            source,
            options,
            warnings: Told::default(),
            called: HashMap::new(),
            graphics: Graphics::default(),
            stack: Vec::new(),
            in_world: false,
            setup: Setup::default(),
            imaging_ratio: 1.0,
            coordinate_systems: HashMap::new(),
            named_materials: HashMap::new(),
            named_textures: HashMap::new(),
            named_media: HashMap::new(),
            first: OnceCell::new(),
            materials: Materials::default(),
            material_of: Nested::new(nested::MATERIALS),
            masked: HashMap::new(),
            default_material: None,
            texture_of: Nested::new(nested::TEXTURES),
            environments,
            media: Media::default(),
            medium_of: HashMap::new(),
            clouds: 0,
            subsurface_of: HashMap::new(),
            emitters: Vec::new(),
            emitter_names: BTreeMap::new(),
            shapes: Vec::new(),
            group_of: HashMap::new(),
            group: None,
            groups: 0,
            instances: Vec::new(),
            render: RenderDescription::default(),
            origin,
        }
    }

    /// Where something stands that the file places by `to_world`: in its group, or in the world.
    pub fn place(&self, to_world: DAffine3, group: Option<u32>) -> DAffine3 {
        match group {
            Some(_) => to_world,
            None => origin::seen_from(self.origin, to_world),
        }
    }

    /// The current transform, if it is affine and nothing moves; motion and perspective are told.
    pub fn standing(&mut self, at: At, what: &str) -> Result<DAffine3, ImportError> {
        if self.graphics.moves() {
            self.warn_at(
                at,
                &format!(
                    "the motion of this {what} is left out: it stands where it is when the shutter \
                 opens"
                ),
            );
        }
        super::graphics::affine(self.graphics.to_world[0]).ok_or_else(|| {
            let message = "the current transform is no affine map: its last row is not 0 0 0 1";
            self.source.error(at, message)
        })
    }

    /// `word`, or `word` and a number, the first without.
    pub fn name_after(&mut self, word: &str) -> String {
        let count = self.called.entry(word.to_owned()).or_default();
        *count += 1;
        match *count {
            1 => word.to_owned(),
            n => format!("{word}.{n}"),
        }
    }

    /// Adds an emitter that stands in the scene by itself.
    pub fn add_emitter(&mut self, emitter: Emitter, word: &str) {
        let name = self.name_after(word);
        self.emitter_names.insert(self.emitters.len() as u32, name);
        self.emitters.push(emitter);
    }

    /// Remembers something odd at a place. The same thing twice is told once.
    pub fn warn_at(&mut self, at: At, warning: &str) {
        self.warnings
            .tell(format!("{}: {warning}", self.source.location(at)));
    }

    /// The same where a scene may do it a hundred thousand times: only the first place is named.
    pub fn warn_once(&mut self, at: At, warning: &str) {
        if self.warnings.is_new(warning) {
            self.warn_at(at, warning);
        }
    }

    /// Ends reading a plugin: tells of parameters that nothing asked for.
    pub fn done(&mut self, params: &Params) {
        params
            .unused()
            .into_iter()
            .for_each(|w| self.warnings.tell(w));
    }

    /// Tells of parameters that change the picture in pbrt and are left out here.
    pub fn left_out(&mut self, p: &Params, names: &[&'static str], what: &str) {
        for name in names {
            if let Some(given) = p.any(name) {
                self.warn_at(given.at, &format!("\"{name}\" is left out: {what}"));
            }
        }
    }

    /// What is defined only behind its first use.
    pub fn later(&self, directive: Directive, name: &str, numbers: bool) -> Option<Definition<'s>> {
        let first = self.first.get_or_init(|| {
            let mut first = HashMap::new();
            for (at, plugin) in self.source.plugins() {
                let numbers = plugin.class.as_ref().is_some_and(|c| c[0] == "float");
                let key = (plugin.directive, plugin.name.as_str(), numbers);
                first.entry(key).or_insert((at, plugin));
            }
            first
        });
        let (at, plugin) = first.get(&(directive, name, numbers))?;
        Some(Graphics::default().define(plugin, *at))
    }

    /// The graphics state with other attributes.
    pub fn attributes_mut(&mut self) -> &mut super::graphics::Attributes<'s> {
        Rc::make_mut(&mut self.graphics.attributes)
    }
}
