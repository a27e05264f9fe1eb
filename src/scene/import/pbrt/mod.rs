//! pbrt's scene files: those of version 4, and of version 3 where the difference is small.
//!
//! ```text
//!  text --tokens--> statement, parameter --source--> scripts (all files, parsed side by side)
//!                                                       |
//!                                        walk: the graphics state, statement by statement
//!                                                       |
//!        shapes, materials, textures, lights, media --> pending shapes --meshes--> Description
//! ```
//!
//! Format and meaning are those of pbrt's documentation (pbrt.org/fileformat-v4) and of the book
//! (Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition).
//!
//! What is wrong is an error with file, line and column, all that is wrong at once; what is odd, or
//! rendered in another way than pbrt does, is a warning in [`Description::warnings`].

mod camera;
mod cloud;
mod coats;
mod color_space;
mod curves;
mod film;
mod finish;
mod graphics;
mod image_lights;
mod images;
mod importer;
mod inline;
mod interfaces;
mod lights;
mod materials;
mod materials_v3;
mod media;
mod meshes;
mod named_spectra;
mod nested;
mod number;
mod parameter;
mod params;
mod pending;
mod power;
mod presets;
mod quadrics;
mod shapes;
mod source;
mod spectra;
mod statement;
mod subdivision;
mod subsurface;
#[cfg(test)]
mod tests;
mod textures;
mod tokens;
mod walk;

use super::{ImportError, ImportOptions, gzip};
use crate::scene::Description;
use source::Source;
use std::path::Path;

/// Loads a scene.
///
/// # Errors
/// Anything in the files that has no meaning: directives, types or names that are unknown, values
/// out of range, files that are missing. With [`ImportOptions::lenient`] only what leaves nothing
/// to go on with.
pub fn load(path: &Path, options: &ImportOptions) -> Result<Description, ImportError> {
    let source = Source::read(path, options)?;
    walk::import(&source, options)
}

/// Whether a file's name says that it is a scene of pbrt: `.pbrt`, or that behind `.gz`.
pub fn is_scene(path: &Path) -> bool {
    let name = gzip::unpacked_name(path);
    name.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("pbrt"))
}
