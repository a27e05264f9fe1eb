//! From a [`Source`] to a [`Description`]: applies the statements one after the other.

use super::color_space::COLOR_SPACES;
use super::graphics::{Chosen, TARGETS};
use super::importer::{Environments, Importer};
use super::params::Params;
use super::source::Source;
use super::statement::{Directive, Plugin, Statement, What};
use crate::math::{DMat4, DVec3};
use crate::scene::Description;
use crate::scene::import::faults::At;
use crate::scene::import::{ImportError, ImportOptions, named, origin};

/// Files inside of files.
const DEEPEST: usize = 64;
/// `AttributeBegin` inside of others.
const MOST_NESTED: usize = 10_000;
/// Options of pbrt, none of which changes what is rendered here.
pub(super) const OPTIONS: &[&str] = &[
    "disablepixeljitter",
    "disabletexturefiltering",
    "disablewavelengthjitter",
    "displacementedgescale",
    "msereferenceimage",
    "msereferenceout",
    "rendercoordsys",
    "seed",
    "forcediffuse",
    "pixelstats",
    "wavefront",
];

/// Imports a whole scene.
pub(super) fn import(source: &Source, options: &ImportOptions) -> Result<Description, ImportError> {
    let environments = Environments::default();
    origin::import_near(&source.faults, options, |origin| {
        import_from(source, options, origin, &environments)
    })
}

/// Imports a scene with the world's origin at the point `origin` of its coordinates.
fn import_from(
    source: &Source,
    options: &ImportOptions,
    origin: DVec3,
    environments: &Environments,
) -> Result<Description, ImportError> {
    let mut importer = Importer::new(source, options, origin, environments);
    let mut walk = Walk {
        importer: &mut importer,
        open: Vec::new(),
        text: 0,
        real: source.scripts.iter().map(|s| s.bytes).sum(),
    };
    walk.script(0)?;
    importer.finish()
}

/// A walk over files.
struct Walk<'w, 's> {
    importer: &'w mut Importer<'s>,
    /// The files that are being applied, the main one first.
    open: Vec<usize>,
    /// Bytes of all files applied, those that are applied again counted again.
    text: u64,
    /// Bytes of all files, each once.
    real: u64,
}

impl<'s> Walk<'_, 's> {
    fn script(&mut self, file: usize) -> Result<(), ImportError> {
        let source = self.importer.source;
        let script = &source.scripts[file];
        self.open.push(file);
        self.text = self.text.saturating_add(script.bytes.max(1));
        for statement in &script.statements {
            match &statement.what {
                What::Include(name) => self.file(file, statement.at, name)?,
                What::Import(name) => {
                    let before = self.importer.graphics.clone();
                    let depth = self.importer.stack.len();
                    self.file(file, statement.at, name)?;
                    self.importer.stack.truncate(depth);
                    self.importer.graphics = before;
                }
                _ => self.importer.statement(statement),
            }
        }
        self.open.pop();
        Ok(())
    }

    /// Applies the file that the directive at `at` of the file number `by` names.
    fn file(&mut self, by: usize, at: At, name: &str) -> Result<(), ImportError> {
        let source = self.importer.source;
        let Some(&file) = source.scripts[by].named.get(name) else {
            source.fault(at, "the scene has too many files", "it is left out");
            return Ok(());
        };
        if self.open.contains(&file) {
            source.fault(at, format!("\"{name}\" includes itself"), "it is left out");
            return Ok(());
        }
        if self.open.len() >= DEEPEST {
            let message = format!("files are included more than {DEEPEST} deep");
            source.fault(at, message, "it is left out");
            return Ok(());
        }
        // What small files grow to by being included again and again.
        let limit = self.importer.options.decode;
        let what = "the scene with all that it includes";
        limit
            .check(what, self.text, self.real)
            .map_err(|m| source.error(at, m))?;
        self.script(file)
    }
}

impl<'s> Importer<'s> {
    fn statement(&mut self, statement: &'s Statement) {
        let at = statement.at;
        match &statement.what {
            What::Set(to) => self.graphics.change(|_| **to),
            What::Concat(by) => self.graphics.change(|m| m * **by),
            What::CoordinateSystem(name) => {
                self.coordinate_systems.insert(name, self.graphics.to_world);
            }
            What::CoordSysTransform(name) => match self.coordinate_systems.get(name.as_str()) {
                Some(known) => self.graphics.to_world = *known,
                None => {
                    let known = self.coordinate_systems.keys().copied();
                    let help = named::did_you_mean(name, known)
                        .map_or(String::new(), |h| format!("; {h}"));
                    let message = format!("there is no coordinate system \"{name}\"{help}");
                    self.source.fault(at, message, "the transform stays");
                }
            },
            What::ActiveTransform(active) => self.graphics.active = *active,
            What::TransformTimes => {}
            What::Begin => self.begin(false, at),
            What::End => self.end(false, at),
            What::ReverseOrientation => self.graphics.reverse ^= true,
            What::WorldBegin => self.world(at),
            What::WorldEnd => {}
            What::ObjectBegin(name) => self.object(name, at),
            What::ObjectEnd => self.end(true, at),
            What::ObjectInstance(name) => self.instance(name, at),
            What::NamedMaterial(name) => self.graphics.material = Chosen::Named(name, at),
            What::MediumInterface(names) => {
                self.graphics.media = [&names[0], &names[1]];
            }
            What::ColorSpace(name) => {
                match COLOR_SPACES
                    .iter()
                    .find(|(known, _)| known.eq_ignore_ascii_case(name))
                {
                    Some((_, space)) => self.graphics.color_space = *space,
                    None => {
                        let known: Vec<&str> = COLOR_SPACES.iter().map(|c| c.0).collect();
                        let message = format!(
                            "there is no colour space \"{name}\": {} are known",
                            known.join(", ")
                        );
                        self.source.fault(at, message, "it stays as it is");
                    }
                }
            }
            What::Option(option) => self.option(option, at),
            What::Plugin(plugin) => self.plugin(plugin, at),
            // Files are the walk's.
            What::Include(_) | What::Import(_) => {}
        }
    }

    fn begin(&mut self, object: bool, at: At) {
        if self.stack.len() >= MOST_NESTED {
            let message = format!("attributes are nested more than {MOST_NESTED} deep");
            self.source.fault(at, message, "it is left out");
            return;
        }
        self.stack.push((self.graphics.clone(), object, at));
    }

    fn end(&mut self, object: bool, at: At) {
        match self.stack.last() {
            Some((_, begun, _)) if *begun == object => {
                if let Some((graphics, ..)) = self.stack.pop() {
                    self.graphics = graphics;
                }
                if object {
                    self.group = None;
                }
            }
            _ => {
                let word = if object {
                    "ObjectBegin"
                } else {
                    "AttributeBegin"
                };
                let message = format!("nothing was begun by \"{word}\" that could end here");
                self.source.fault(at, message, "it is left out");
            }
        }
    }

    fn world(&mut self, at: At) {
        if self.in_world {
            self.warn_at(at, "the world has begun already");
        }
        self.in_world = true;
        self.imaging_ratio = self.exposure();
        self.graphics.to_world = [DMat4::IDENTITY; 2];
        self.graphics.active = [true; 2];
        self.coordinate_systems
            .insert("world", self.graphics.to_world);
    }

    fn object(&mut self, name: &'s str, at: At) {
        if self.group.is_some() {
            self.source.fault(
                at,
                "an object cannot stand inside of another",
                "it is left out",
            );
            return self.begin(true, at);
        }
        self.begin(true, at);
        if self.group_of.contains_key(name) {
            let message = format!("the object \"{name}\" was defined before");
            self.source
                .fault(at, message, "the later one takes its place");
        }
        self.group_of.insert(name, self.groups);
        self.group = Some(self.groups);
        self.groups += 1;
    }

    fn instance(&mut self, name: &str, at: At) {
        if self.group.is_some() {
            self.source.fault(
                at,
                "an instance cannot stand inside of an object",
                "it is left out",
            );
            return;
        }
        let Some(&group) = self.group_of.get(name) else {
            let known = self.group_of.keys().copied();
            let help = named::did_you_mean(name, known).map_or(String::new(), |h| format!("; {h}"));
            let message = format!("there is no object \"{name}\"{help}");
            self.source.fault(at, message, "the instance is left out");
            return;
        };
        match self.standing(at, "instance") {
            Ok(to_world) if to_world.matrix3.determinant() == 0.0 => {
                self.warn_at(at, "this instance is flattened to nothing and is left out");
            }
            Ok(to_world) => self.instances.push((group, self.place(to_world, None))),
            Err(error) => self.source.fault_of(at, error, "the instance is left out"),
        }
    }

    fn option(&mut self, [name, value]: &[String; 2], at: At) {
        let plain: String = name.chars().filter(char::is_ascii_alphanumeric).collect();
        let plain = plain.to_lowercase();
        let is_off = matches!(value.as_str(), "false");
        match OPTIONS.contains(&plain.as_str()) {
            true if matches!(plain.as_str(), "forcediffuse" | "disabletexturefiltering")
                && !is_off =>
            {
                self.warn_at(at, &format!("option \"{name}\" is left out"));
            }
            true => {}
            false => {
                let help = named::did_you_mean(&plain, OPTIONS.iter().copied());
                let help = help.map_or(String::new(), |h| format!("; {h}"));
                self.warn_at(at, &format!("there is no option \"{name}\"{help}"));
            }
        }
    }

    fn plugin(&mut self, plugin: &'s Plugin, at: At) {
        let belongs_before = matches!(
            plugin.directive,
            Directive::Camera
                | Directive::Film
                | Directive::Integrator
                | Directive::PixelFilter
                | Directive::Sampler
                | Directive::Accelerator
        );
        let stands_before = !self.in_world;
        let is_world = matches!(
            plugin.directive,
            Directive::Shape | Directive::LightSource | Directive::AreaLightSource
        );
        if belongs_before && !stands_before {
            let message = format!(
                "\"{}\" belongs before \"WorldBegin\"",
                plugin.directive.word()
            );
            self.source.fault(at, message, "it is left out");
            return;
        }
        if is_world && stands_before {
            let message = format!(
                "\"{}\" belongs behind \"WorldBegin\"",
                plugin.directive.word()
            );
            self.source.fault(at, message, "it is left out");
            return;
        }
        let definition = self.graphics.define(plugin, at);
        match plugin.directive {
            Directive::Accelerator => {}
            Directive::AreaLightSource => {
                let off = matches!(plugin.name.as_str(), "" | "none");
                self.graphics.area_light = (!off).then_some(definition);
            }
            Directive::Attribute => self.attribute(plugin, at),
            Directive::Camera => {
                let from_camera = definition.transform.inverse();
                self.coordinate_systems.insert("camera", [from_camera; 2]);
                self.setup.camera_medium = self.graphics.media[1];
                self.setup.camera = Some((definition, self.graphics.moves()));
            }
            Directive::Film => self.setup.film = Some(definition),
            Directive::Integrator => self.setup.integrator = Some(definition),
            Directive::PixelFilter => self.setup.filter = Some(definition),
            Directive::Sampler => self.setup.sampler = Some(definition),
            Directive::LightSource => {
                let p = Params::new(self.source, &definition);
                if let Err(error) = self.light_source(&p) {
                    self.source.fault_of(at, error, "the light is left out");
                }
            }
            Directive::MakeNamedMaterial => {
                self.named_materials.insert(&plugin.name, definition);
            }
            Directive::MakeNamedMedium => {
                self.named_media.insert(&plugin.name, definition);
            }
            Directive::Material => self.graphics.material = Chosen::Own(definition),
            Directive::Shape => {
                let p = Params::new(self.source, &definition);
                if let Err(error) = self.shape(&p) {
                    self.source.fault_of(at, error, "the shape is left out");
                }
            }
            Directive::Texture => self.define_texture(plugin, definition),
        }
    }

    fn define_texture(&mut self, plugin: &'s Plugin, definition: super::graphics::Definition<'s>) {
        let Some([class, _]) = &plugin.class else {
            return;
        };
        if !matches!(class.as_str(), "float" | "spectrum" | "color") {
            let message = format!("a texture is of \"float\" or \"spectrum\", not of \"{class}\"");
            self.source.fault(definition.at, message, "it is left out");
            return;
        }
        self.named_textures
            .insert((&plugin.name, class == "float"), definition);
    }

    fn attribute(&mut self, plugin: &'s Plugin, at: At) {
        match self.attributes_mut().target(&plugin.name) {
            Some(list) => list.extend(&plugin.parameters),
            None => {
                let name = &plugin.name;
                let message = format!(
                    "\"Attribute\" is for {}, not for \"{name}\"",
                    TARGETS.join(", ")
                );
                self.source.fault(at, message, "it is left out");
            }
        }
    }
}
