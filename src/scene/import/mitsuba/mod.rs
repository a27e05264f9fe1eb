//! Mitsuba's scene files: XML of the 0.4 to 0.6 kind and of the 2.x and 3.x kind.
//!
//! ```text
//!  text --xml--> elements --reader--> Document (objects, parameters) --walk--> Description
//!                            |                                           |
//!               defines, transforms, values,            shapes, bsdfs, textures, emitters,
//!               includes, references                    sensors, integrators, meshes
//! ```
//!
//! Both dialects are one language here: names are compared in one spelling (`names`), and where the
//! same words mean different things, each object remembers whose file it stands in.
//!
//! What is wrong is an error with file, line and column, all that is wrong at once (`faults`); what
//! is odd (a parameter nobody knows) is a warning in [`Description::warnings`].

mod attributes;
mod bsdf_parameters;
mod bsdfs;
mod bsdfs_nested;
mod defines;
mod document;
mod emitters;
mod encoding;
mod entities;
mod films;
mod framing;
mod importer;
mod integrators;
mod media;
mod meshes;
mod names;
mod params;
mod pending;
mod phases;
mod reader;
mod references;
mod role;
mod sensors;
mod shapes;
mod sun_position;
mod textures;
mod transform;
mod value;
mod walk;
mod xml;

#[cfg(test)]
mod tests;

use super::{ImportError, ImportOptions};
use crate::scene::Description;
use std::path::Path;

/// Loads a scene.
///
/// # Errors
/// Anything in the file that has no meaning: bad XML, unknown elements, plugins or ids, values out
/// of range, files that are missing. With [`ImportOptions::lenient`] only what leaves nothing to go
/// on with.
pub fn load(path: &Path, options: &ImportOptions) -> Result<Description, ImportError> {
    let document = reader::read(path, &options.defines)?;
    walk::import(&document, options)
}
