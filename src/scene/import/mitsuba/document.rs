//! A scene file as objects with parameters: substitutions made, includes merged, references resolved.
//!
//! The [`super::reader`] fills it; here is what it holds and how messages about it are made.

use super::value::{Dialect, Value};
use super::xml::At;
use crate::scene::import::{ImportError, Location};
use std::path::{Path, PathBuf};

/// A parameter of an object, or an object nested in it.
#[derive(Clone, Debug)]
pub(super) struct Property {
    /// Name in the one spelling of [`super::names::normalise`]; empty for anonymous objects.
    pub name: String,
    /// Name as written.
    pub written: String,
    /// Its place.
    pub at: At,
    /// Its value.
    pub value: Value,
}

/// A plugin with its parameters.
#[derive(Debug)]
pub(super) struct Object {
    /// The element, such as `bsdf`.
    pub tag: String,
    /// The plugin, such as `diffuse`.
    pub plugin: String,
    /// Its id.
    pub id: Option<String>,
    /// Its place.
    pub at: At,
    /// Whose file it is.
    pub dialect: Dialect,
    /// Parameters and nested objects, in the file's order.
    pub properties: Vec<Property>,
}

/// All objects of a scene. The first is the scene itself.
#[derive(Debug, Default)]
pub(super) struct Document {
    /// The objects.
    pub objects: Vec<Object>,
    /// The files that places refer to.
    pub files: Vec<PathBuf>,
    /// Directories to look for files in, besides the one of the file that asks.
    pub search: Vec<PathBuf>,
    /// What was odd.
    pub warnings: Vec<String>,
}

impl Document {
    /// A place with its file's name.
    pub fn location(&self, at: At) -> Location {
        Location {
            file: self.files.get(at.file).cloned().unwrap_or_default(),
            line: at.line,
            column: at.column,
        }
    }

    /// An error at a place.
    pub fn error(&self, at: At, message: impl Into<String>) -> ImportError {
        ImportError {
            at: Some(self.location(at)),
            file: None,
            message: message.into(),
            help: None,
        }
    }

    /// An error at a place, with what to do about it.
    pub fn error_help(
        &self,
        at: At,
        message: impl Into<String>,
        help: Option<String>,
    ) -> ImportError {
        ImportError {
            help,
            ..self.error(at, message)
        }
    }

    /// The file `name` that something at `at` asks for: as it is if absolute, else beside the asking file,
    /// else in the search directories. Where nothing exists, the first candidate.
    pub fn resolve(&self, at: At, name: &str) -> PathBuf {
        let given = Path::new(name);
        if given.is_absolute() {
            return given.to_owned();
        }
        let own = self.files.get(at.file).and_then(|f| f.parent());
        let own = own.unwrap_or(Path::new("")).join(given);
        if own.exists() {
            return own;
        }
        let elsewhere = self.search.iter().map(|d| d.join(given));
        elsewhere
            .into_iter()
            .find(|p| p.exists())
            .or_else(|| with_slashes(name).map(|n| self.resolve(at, &n)))
            .unwrap_or(own)
    }
}

/// Windows paths in scenes made there.
fn with_slashes(name: &str) -> Option<String> {
    name.contains('\\').then(|| name.replace('\\', "/"))
}
