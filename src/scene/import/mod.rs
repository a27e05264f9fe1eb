//! Reading scenes and meshes, one file a format.

use std::path::{Path, PathBuf};

pub mod default_scene;
mod encoding;
mod faults;
pub mod gltf;
mod gzip;
pub mod ior;
pub(crate) mod measured;
pub mod mesh;
pub mod mitsuba;
pub mod models;
mod named;
mod numbers;
mod options;
mod origin;
pub mod parts;
pub mod pbrt;
pub mod spectrum;
mod spectrum_tables;
mod tensor_file;
pub mod told;

pub use options::{ImportOptions, LoadMesh, OpenTexture};

/// A place in a text file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The file.
    pub file: PathBuf,
    /// Line, from 1.
    pub line: u32,
    /// Column, from 1.
    pub column: u32,
}

impl std::fmt::Display for Location {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}:{}", self.file.display(), self.line, self.column)
    }
}

/// Something in a scene or mesh that cannot be used.
///
/// Displayed as `file:line:column: what is wrong` (or `file: what is wrong`), followed by what to
/// do where that is known.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct ImportError {
    /// Where, if a text file has the place.
    pub at: Option<Location>,
    /// The file, if there is no place in it.
    pub file: Option<PathBuf>,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
}

impl ImportError {
    /// A mesh is not there that a scene names.
    fn no_mesh(path: &Path) -> Self {
        let (name, hint) = (path.display(), named::hint_of(path));
        Self {
            at: None,
            file: None,
            message: format!("there is no mesh {name}{hint}"),
            help: Some("restore the file, or go on without it with --lenient".into()),
        }
    }

    /// The same error, of a mesh that a scene asks for at `place`.
    fn asked_for_at(self, place: Location) -> Self {
        if (&self.at, &self.file) == (&None, &None) {
            return Self {
                at: Some(place),
                ..self
            };
        }
        let asked = format!("the mesh is asked for at {place}");
        let help = match self.help {
            Some(help) => format!("{help}\n  {asked}"),
            None => asked,
        };
        Self {
            help: Some(help),
            ..self
        }
    }
}

impl std::fmt::Display for ImportError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (&self.at, &self.file) {
            (Some(at), _) => write!(f, "{at}: ")?,
            (None, Some(file)) => write!(f, "{}: ", file.display())?,
            (None, None) => {}
        }
        f.write_str(&self.message)?;
        self.help
            .as_ref()
            .map_or(Ok(()), |help| write!(f, "\n  help: {help}"))
    }
}
