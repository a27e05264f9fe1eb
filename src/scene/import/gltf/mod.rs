//! glTF 2.0: `.gltf` with files beside it, and `.glb`.
//!
//! ```text
//!  file --container--> Document, buffers --nodes--> placements --primitive--> meshes --+
//!                          |                                                           v
//!                          +------ materials, layers, textures ------------------> Parts
//! ```
//!
//! A mesh that stands in several places becomes a group with instances, unless it glows.
//! Coordinates are kept: glTF is right-handed with +y up, as scenes are here. Row 0 of an image
//! lies at v = 0 in both. What is not supported is told in a warning, once each; an extension that
//! the file requires and that is not known is an error.

mod accessor;
mod bounds;
mod coat;
mod container;
mod draco;
mod extension;
mod glossiness;
mod images;
mod ktx2;
mod layers;
mod lights;
mod materials;
mod meshopt;
mod nodes;
mod place;
mod pose;
mod primitive;
mod reflection;
mod schema;
mod skin;
#[cfg(test)]
mod tests;
mod textures;
mod variants;
mod volume;

pub use pose::Moment;

use super::parts::Parts;
use super::{ImportError, ImportOptions};
use crate::bsdf::MaterialId;
use crate::math::DAffine3;
use crate::medium::{Boundary, MediumId};
use accessor::Accessors;
use container::Container;
use images::Images;
use materials::{Finish, Variant};
use schema::Document;
use std::collections::HashMap;
use std::path::Path;

/// What is shown of files that hold more than one look.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Show {
    /// The name of a variant (`KHR_materials_variants`); `None` is the file's default materials.
    pub variant: Option<String>,
    /// A moment of an animation; `None` is the file's own pose.
    pub moment: Option<Moment>,
}

/// How a file is added.
#[derive(Clone, Debug, Default)]
pub struct GltfOptions {
    /// Placement of the whole file.
    pub to_world: DAffine3,
    /// A material that takes the place of all the file's own.
    pub material: Option<MaterialId>,
    /// The media on the sides of what has that material.
    pub boundary: Option<Boundary>,
    /// What is shown.
    pub show: Show,
}

/// Adds what is in the file `path` to `parts`.
///
/// # Errors
/// When the file or one that it names cannot be read or makes no sense; textures that are missing
/// are forgiven if [`ImportOptions::lenient`] is set.
pub fn load(
    path: &Path,
    gltf: &GltfOptions,
    options: &ImportOptions,
    parts: &mut Parts,
) -> Result<(), ImportError> {
    let mut container = Container::open(path, options.decode)?;
    container.unpacked = draco::unpack(&container)?;
    let told = match &gltf.show.moment {
        Some(moment) => pose::strike(&mut container, moment)?,
        None if container.document.animations.is_empty() => Vec::new(),
        None => vec!["the file's own pose is shown; --at SECONDS shows its animation".into()],
    };
    let variant = &gltf.show.variant;
    let find = |name: &String| variants::find(&container.document, name, path);
    let variant = variant.as_ref().map(find).transpose()?;
    let mut importer = Importer {
        container: &container,
        options,
        variant,
        only_material: gltf.material.map(|material| (material, gltf.boundary)),
        parts,
        images: Images::default(),
        finishes: HashMap::new(),
        media: HashMap::new(),
    };
    importer.check_extensions()?;
    told.into_iter().for_each(|warning| importer.warn(warning));
    importer.tell_of_variants();
    let accessors = Accessors {
        container: &container,
    };
    let scene = importer.scene();
    let document = &container.document;
    let standing = nodes::walk(document, scene, accessors, &gltf.to_world, path)?;
    for &(camera, node) in &standing.cameras {
        importer.camera(camera, node, &standing.to_world[node])?;
    }
    for &(light, node) in &standing.lights {
        importer.light(light, &standing.to_world[node])?;
    }
    importer.place(&standing, accessors)
}

/// Adds a file to parts.
struct Importer<'a> {
    container: &'a Container,
    options: &'a ImportOptions,
    /// The number of the variant that is shown.
    variant: Option<usize>,
    only_material: Option<(MaterialId, Option<Boundary>)>,
    parts: &'a mut Parts,
    images: Images,
    finishes: HashMap<Variant, Finish>,
    /// Media by number of the material that encloses them.
    media: HashMap<usize, MediumId>,
}

impl<'a> Importer<'a> {
    fn document(&self) -> &'a Document {
        &self.container.document
    }

    fn path(&self) -> &'a Path {
        &self.container.path
    }

    fn warn(&mut self, warning: impl std::fmt::Display) {
        let place = self.path().display();
        self.parts.warn(format!("{place}: {warning}"));
    }

    fn check_extensions(&mut self) -> Result<(), ImportError> {
        let document = self.document();
        let unknown = |name: &&String| !extension::KNOWN.contains(&name.as_str());
        let required: Vec<&str> = document
            .extensions_required
            .iter()
            .filter(unknown)
            .map(String::as_str)
            .collect();
        if !required.is_empty() {
            let message = format!("requires {}, which cannot be read", required.join(", "));
            let help = "export it without that extension";
            return Err(hint(self.path(), message, help));
        }
        for name in document.extensions_used.iter().filter(unknown) {
            self.warn(format!("{name} is not supported and left out"));
        }
        Ok(())
    }

    /// The scene that is shown; `None` shows all nodes, where the file has no scenes.
    fn scene(&mut self) -> Option<usize> {
        let (count, asked) = (self.document().scenes.len(), self.document().scene);
        let last = count.checked_sub(1)?;
        let shown = asked.unwrap_or(0);
        if shown > last {
            self.warn(format!(
                "scene {shown} is asked for, and the last is scene {last}: scene 0 is shown"
            ));
            return Some(0);
        }
        if count > 1 {
            self.warn(format!(
                "scene {shown} of {count} is shown, without the others"
            ));
        }
        Some(shown)
    }
}

/// An error about the file `path`.
fn error(path: &Path, message: impl Into<String>) -> ImportError {
    ImportError {
        at: None,
        file: Some(path.to_owned()),
        message: message.into(),
        help: None,
    }
}

/// An error about the file `path`, with what to do about it.
fn hint(path: &Path, message: impl Into<String>, help: &str) -> ImportError {
    ImportError {
        help: Some(help.to_owned()),
        ..error(path, message)
    }
}
