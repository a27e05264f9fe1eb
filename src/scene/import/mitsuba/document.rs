//! A scene file as objects with parameters: substitutions made, includes merged, references
//! resolved.
//!
//! The [`super::reader`] fills it; here is what it holds and how messages about it are made.

use super::value::{Dialect, Value};
use crate::scene::import::faults::At;
use crate::scene::import::faults::Faults;
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
    /// Directories that `<path>` names, the last one first.
    pub search: Vec<PathBuf>,
    /// What was odd.
    pub warnings: Vec<String>,
    /// What was wrong.
    pub faults: Faults,
    /// By object, whether a `<ref>` names it.
    pub referred: Vec<bool>,
}

impl Document {
    /// A place with its file's name.
    pub fn location(&self, at: At) -> Location {
        at.among(&self.files)
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

    /// Notes what is wrong with the object at `at`: at the place in its file that the error names.
    pub fn fault(&self, at: At, error: ImportError, instead: &'static str) {
        let own = error
            .at
            .as_ref()
            .filter(|l| Some(&l.file) == self.files.get(at.file));
        let at = own.map_or(at, |l| At {
            line: l.line,
            column: l.column,
            ..at
        });
        self.faults.add(at, error, instead);
    }

    /// Whether a `<ref>` names object `index`.
    pub fn is_referred_to(&self, index: usize) -> bool {
        self.referred.get(index).copied().unwrap_or(false)
    }

    /// Whether a part of object `index` could not be read: what it lacks then is no mistake of its
    /// own.
    pub fn is_broken(&self, index: usize) -> bool {
        let properties = &self.objects[index].properties;
        properties.iter().any(|p| matches!(p.value, Value::Broken))
    }

    /// The file `name` that something at `at` asks for. As in Mitsuba, what is not absolute is
    /// looked for in the directories that `<path>` names, then beside the main file, also from
    /// within an included one; only then beside the included one itself.
    pub fn resolve(&self, at: At, name: &str) -> PathBuf {
        let given = Path::new(name);
        if given.is_absolute() {
            return given.to_owned();
        }
        let own = self.beside(at.file).join(given);
        let searched = self.search.iter().map(|d| d.join(given));
        let mut candidates = searched.chain([self.beside(0).join(given), own.clone()]);
        candidates
            .find(|p| p.exists())
            .or_else(|| with_slashes(name).map(|n| self.resolve(at, &n)))
            .unwrap_or(own)
    }

    /// The directory `name` of a `<path>` at `at`: beside its own file first, as in Mitsuba.
    pub fn resolve_directory(&self, at: At, name: &str) -> PathBuf {
        let own = self.beside(at.file).join(name);
        if own.is_dir() {
            return own;
        }
        self.resolve(at, name)
    }

    /// The directory of a file of the scene.
    fn beside(&self, file: usize) -> &Path {
        let directory = self.files.get(file).and_then(|f| f.parent());
        directory.unwrap_or(Path::new(""))
    }
}

/// Windows paths in scenes made there.
fn with_slashes(name: &str) -> Option<String> {
    name.contains('\\').then(|| name.replace('\\', "/"))
}
