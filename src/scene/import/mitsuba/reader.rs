//! From elements to a [`Document`]: follows includes, registers ids, and has references resolved
//! (forward ones too). Single parameters are read in [`super::attributes`].
//!
//! What cannot be read is told and left out, so that all mistakes of a file come to light at once.

use super::defines::Defines;
use super::document::{Document, Object, Property};
use super::value::{Dialect, Value};
use super::xml::{self, Element};
use super::{encoding, names, references};
use crate::image::{foreign, regular};
use crate::scene::import::faults::At;
use crate::scene::import::{ImportError, named};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Files that include each other this deep are taken for a mistake.
const MAX_INCLUDES: usize = 10;
/// Files of a scene: files that include others twice grow exponentially.
const MAX_FILES: usize = 10_000;
/// Objects of a scene, with all includes.
const MAX_OBJECTS: usize = 4_000_000;
/// Parameters of an object that are compared one by one; more are looked up.
const FEW: usize = 16;

/// Reads the scene at `path`.
pub(super) fn read(path: &Path, defines: &[(String, String)]) -> Result<Document, ImportError> {
    let mut reader = Reader {
        document: Document::default(),
        defines: Defines::new(defines),
        ids: HashMap::new(),
        including: Vec::new(),
        names: HashMap::new(),
        overflow: None,
    };
    reader.root(path)?;
    if let Some(error) = reader.overflow {
        return Err(error);
    }
    for name in reader.defines.unused() {
        let warning = format!("-D {name}: the scene has no ${name}");
        reader.document.warnings.push(warning);
    }
    references::resolve(&mut reader.document, &reader.ids)?;
    Ok(reader.document)
}

/// What has been read so far.
pub(super) struct Reader {
    pub document: Document,
    pub defines: Defines,
    /// Objects by id, with aliases.
    pub ids: HashMap<String, usize>,
    /// Files being read, outermost first: they must not include themselves.
    including: Vec<std::path::PathBuf>,
    /// Names of the parameters of objects that have many.
    names: HashMap<usize, HashSet<String>>,
    /// A limit that was passed: nothing more is read.
    overflow: Option<ImportError>,
}

impl Reader {
    fn root(&mut self, path: &Path) -> Result<(), ImportError> {
        let (root, dialect) = self.file(path, None)?;
        if root.tag != "scene" {
            let message = format!("expected a <scene>, found <{}>", root.tag);
            return Err(self.document.error(root.at, message));
        }
        self.object(&root, dialect, None)?;
        self.including.pop();
        Ok(())
    }

    /// Reads a file's elements. `outer` is the dialect of the including file.
    fn file(
        &mut self,
        path: &Path,
        outer: Option<Dialect>,
    ) -> Result<(Element, Dialect), ImportError> {
        let text = text(path)?;
        let index = self.document.files.len();
        self.document.files.push(path.to_owned());
        let canonical = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        self.including.push(canonical);
        let root = xml::parse(&text, index, path)?;
        let dialect = self.dialect(&root, outer)?;
        Ok((root, dialect))
    }

    fn dialect(&self, root: &Element, outer: Option<Dialect>) -> Result<Dialect, ImportError> {
        let Some((_, version)) = root.attributes.iter().find(|(n, _)| n == "version") else {
            return outer.ok_or_else(|| {
                self.document.error_help(
                    root.at,
                    format!("<{}> has no version", root.tag),
                    Some("write version=\"3.0.0\" (or 0.6.0 for a Mitsuba 0.6 scene)".into()),
                )
            });
        };
        let major = version.split('.').next().unwrap_or("").trim();
        match major.parse::<u32>() {
            Ok(0 | 1) => Ok(Dialect::Classic),
            Ok(2..=3) => Ok(Dialect::Modern),
            _ => Err(self.document.error_help(
                root.at,
                format!("version \"{version}\" is not known"),
                Some("0.4 to 0.6 and 2.0 to 3.x are".into()),
            )),
        }
    }

    /// Reads an object element; returns its index. `parent` gets it as a property by the caller.
    fn object(
        &mut self,
        element: &Element,
        dialect: Dialect,
        attributes: Option<HashMap<String, String>>,
    ) -> Result<usize, ImportError> {
        let attributes = match attributes {
            Some(ready) => ready,
            None => self.attributes(element)?,
        };
        let is_scene = element.tag == "scene";
        let plugin = match attributes.get("type") {
            Some(plugin) => plugin.clone(),
            None if is_scene => "scene".into(),
            None => {
                let message = format!("<{}> has no type", element.tag);
                return Err(self.document.error(element.at, message));
            }
        };
        self.warn_attributes(element, &["type", "id", "name", "version"]);
        let index = self.document.objects.len();
        if index >= MAX_OBJECTS {
            return Err(self.overflowed(element.at, format!("{MAX_OBJECTS} objects")));
        }
        self.document.objects.push(Object {
            tag: element.tag.clone(),
            plugin,
            id: attributes.get("id").cloned(),
            at: element.at,
            dialect,
            properties: Vec::new(),
        });
        if let Some(id) = attributes.get("id") {
            if let Err(error) = self.register(id, index, element.at) {
                let instead = "the first one has it";
                self.document.faults.add(element.at, error, instead);
            }
        }
        for child in &element.children {
            self.child(index, child, dialect);
        }
        self.names.remove(&index);
        Ok(index)
    }

    /// The error of a scene that has more than is read of any.
    fn overflowed(&mut self, at: At, what: String) -> ImportError {
        let error = self
            .document
            .error(at, format!("the scene has more than {what}"));
        self.overflow.get_or_insert(error).clone()
    }

    fn register(&mut self, id: &str, index: usize, at: At) -> Result<(), ImportError> {
        let Some(&previous) = self.ids.get(id) else {
            self.ids.insert(id.to_owned(), index);
            return Ok(());
        };
        let first = self.document.location(self.document.objects[previous].at);
        let message = format!("the id \"{id}\" is taken: {first} has it too");
        Err(self.document.error(at, message))
    }

    /// Reads one element inside object `parent`. One that cannot be read is told, and marks its
    /// place.
    fn child(&mut self, parent: usize, element: &Element, dialect: Dialect) {
        if self.overflow.is_some() {
            return;
        }
        if let Err(error) = self.try_child(parent, element, dialect) {
            self.document.fault(element.at, error, "it is left out");
            let name = element.attributes.iter().find(|(n, _)| n == "name");
            let name = name.map_or("", |(_, name)| name);
            self.push(parent, name, element.at, Value::Broken);
        }
    }

    fn try_child(
        &mut self,
        parent: usize,
        element: &Element,
        dialect: Dialect,
    ) -> Result<(), ImportError> {
        let tag = element.tag.as_str();
        let attributes = self.attributes(element)?;
        let plugin_element = names::plugins(tag).is_some() && tag != "scene";
        // `<spectrum type="...">` is an object, a texture without a place.
        if plugin_element || (tag == "spectrum" && attributes.contains_key("type")) {
            let name = attributes.get("name").cloned().unwrap_or_default();
            let index = self.object(element, dialect, Some(attributes))?;
            self.push(parent, &name, element.at, Value::Object(index));
            return Ok(());
        }
        match tag {
            "default" => {
                let name = self.required(element, &attributes, "name")?;
                let value = self.required(element, &attributes, "value")?;
                self.defines.add_default(name, value);
            }
            "include" => self.include(parent, element, &attributes, dialect)?,
            "alias" => {
                let id = self.required(element, &attributes, "id")?;
                let alias = self.required(element, &attributes, "as")?.to_owned();
                let Some(&index) = self.ids.get(id) else {
                    return Err(references::unknown(
                        &self.document,
                        &self.ids,
                        id,
                        element.at,
                    ));
                };
                self.register(&alias, index, element.at)?;
            }
            "path" => {
                let name = self.required(element, &attributes, "value")?;
                let directory = self.document.resolve_directory(element.at, name);
                if !directory.is_dir() {
                    let message = format!("there is no directory {}", directory.display());
                    return Err(self.document.error(element.at, message));
                }
                self.document.search.insert(0, directory);
            }
            _ => {
                let value = self.value(element, &attributes)?;
                let name = attributes.get("name").cloned().unwrap_or_default();
                if name.is_empty() && !matches!(value, Value::Reference(_)) {
                    let message = format!("<{tag}> has no name");
                    return Err(self.document.error(element.at, message));
                }
                self.push(parent, &name, element.at, value);
            }
        }
        Ok(())
    }

    fn push(&mut self, parent: usize, name: &str, at: At, value: Value) {
        let normal = names::normalise(name);
        let twice = !normal.is_empty() && self.is_given(parent, &normal);
        self.document.objects[parent].properties.push(Property {
            name: normal,
            written: name.to_owned(),
            at,
            value,
        });
        if twice {
            let place = self.document.location(at);
            let warning = format!("{place}: \"{name}\" is given twice; the last one counts");
            self.document.warnings.push(warning);
        }
    }

    /// Whether an object has a parameter of that name; if not, it is about to get one. A scene may
    /// have a hundred thousand of them.
    fn is_given(&mut self, parent: usize, name: &str) -> bool {
        let properties = &self.document.objects[parent].properties;
        if properties.len() < FEW {
            return properties.iter().any(|p| p.name == name);
        }
        let names = self.names.entry(parent).or_insert_with(|| {
            let names = properties.iter().map(|p| p.name.clone());
            names.collect()
        });
        !names.insert(name.to_owned())
    }

    fn include(
        &mut self,
        parent: usize,
        element: &Element,
        attributes: &HashMap<String, String>,
        dialect: Dialect,
    ) -> Result<(), ImportError> {
        let name = self.required(element, attributes, "filename")?;
        let path = self.document.resolve(element.at, name);
        let canonical = path.canonicalize().unwrap_or_else(|_| path.clone());
        if self.including.contains(&canonical) {
            let message = format!("{} includes itself", path.display());
            return Err(self.document.error(element.at, message));
        }
        if self.including.len() >= MAX_INCLUDES {
            let message = format!("includes are nested more than {MAX_INCLUDES} deep");
            return Err(self.document.error(element.at, message));
        }
        if !path.exists() {
            let hint = named::hint_of(&path);
            let message = format!("there is no file {} to include{hint}", path.display());
            return Err(self.document.error(element.at, message));
        }
        if self.document.files.len() >= MAX_FILES {
            return Err(self.overflowed(element.at, format!("{MAX_FILES} files")));
        }
        let depth = self.including.len();
        let read = self.file(&path, Some(dialect));
        if let Ok((root, dialect)) = &read {
            let inside = match root.tag.as_str() {
                "scene" => &root.children[..],
                _ => std::slice::from_ref(root),
            };
            for child in inside {
                self.child(parent, child, *dialect);
            }
        }
        self.including.truncate(depth);
        let place = self.document.location(element.at);
        let included = format!("it is included at {place}");
        read.map(|_| ()).map_err(|error| ImportError {
            help: Some(match error.help {
                Some(help) => format!("{help}\n  {included}"),
                None => included,
            }),
            ..error
        })
    }
}

/// The text of the scene file at `path`.
fn text(path: &Path) -> Result<String, ImportError> {
    let plain = |message: String, help: Option<&str>| ImportError {
        at: None,
        file: Some(path.to_owned()),
        message,
        help: help.map(str::to_owned),
    };
    let unreadable = |e: std::io::Error| {
        let hint = named::hint_of(path);
        plain(format!("cannot read it: {e}{hint}"), None)
    };
    let bytes = regular::read(path).map_err(unreadable)?;
    if let Some(foreign) = foreign::of_scene(path, &bytes) {
        let message = format!("is no Mitsuba scene but {}", foreign.what);
        return Err(plain(message, Some(foreign.help)));
    }
    encoding::text(bytes).map_err(|message| plain(message, None))
}
