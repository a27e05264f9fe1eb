//! Asking an object for its parameters.
//!
//! A plugin's reader asks for each parameter by name, once; what it never asked for is what the
//! plugin does not know, and the names it asked for are what a misspelt name is compared with. So
//! the list of a plugin's parameters exists in one place only, the code that uses them.

use super::document::{Document, Object, Property};
use super::value::{Dialect, Value};
use crate::math::{DAffine3, DVec3};
use crate::scene::import::faults::At;
use crate::scene::import::{ImportError, named};
use std::cell::{Cell, RefCell};

/// An object being read.
pub(super) struct Params<'a> {
    document: &'a Document,
    object: &'a Object,
    used: Vec<Cell<bool>>,
    asked: RefCell<Vec<&'static str>>,
}

impl<'a> Params<'a> {
    /// Starts reading object `index`.
    pub fn new(document: &'a Document, index: usize) -> Self {
        let object = &document.objects[index];
        Self {
            document,
            object,
            used: vec![Cell::new(false); object.properties.len()],
            asked: RefCell::new(Vec::new()),
        }
    }

    /// The plugin's name.
    pub fn plugin(&self) -> &'a str {
        &self.object.plugin
    }

    /// Whose file it is.
    pub fn dialect(&self) -> Dialect {
        self.object.dialect
    }

    /// The document that it stands in.
    pub fn document(&self) -> &'a Document {
        self.document
    }

    /// The object's place.
    pub fn at(&self) -> At {
        self.object.at
    }

    /// An error at the object.
    pub fn error(&self, message: impl Into<String>) -> ImportError {
        self.document.error(self.object.at, message)
    }

    /// The parameter `name`; the last one, if it was given twice.
    pub fn find(&self, name: &'static str) -> Option<&'a Property> {
        self.asked.borrow_mut().push(name);
        let mut found = None;
        for (property, used) in self.object.properties.iter().zip(&self.used) {
            if property.name == name {
                used.set(true);
                found = Some(property);
            }
        }
        found
    }

    /// Whether a parameter is given, without asking for it.
    pub fn has(&self, name: &str) -> bool {
        self.object.properties.iter().any(|p| p.name == name)
    }

    /// The first of several names for one thing that is given, or the first name.
    pub fn either(&self, names: &[&'static str]) -> &'static str {
        let given = names.iter().copied().find(|n| self.has(n));
        given.unwrap_or(names.first().copied().unwrap_or(""))
    }

    /// Parameters that mean something to Mitsuba and nothing to this renderer.
    pub fn ignore(&self, names: &[&'static str]) {
        for name in names {
            let _ = self.find(name);
        }
    }

    /// Nested objects made by `tag`, in order, whatever their names.
    pub fn children(&self, tag: &str) -> Vec<(&'a Property, usize)> {
        let mut out = Vec::new();
        for (property, used) in self.object.properties.iter().zip(&self.used) {
            let Value::Object(index) = property.value else {
                continue;
            };
            if self.document.objects[index].tag == tag {
                used.set(true);
                out.push((property, index));
            }
        }
        out
    }

    /// The one nested object made by `tag`, if there is one.
    pub fn child(&self, tag: &str) -> Result<Option<usize>, ImportError> {
        match self.children(tag).as_slice() {
            [] => Ok(None),
            [(_, index)] => Ok(Some(*index)),
            [_, (second, _), ..] => Err(self
                .document
                .error(second.at, format!("a second <{tag}>; only one can be here"))),
        }
    }

    /// The error for a value of the wrong kind.
    pub fn wrong(&self, property: &Property, expected: &str) -> ImportError {
        let message = format!(
            "\"{}\" must be {expected}, not {}",
            property.written,
            property.value.kind()
        );
        self.document.error(property.at, message)
    }

    /// The value of parameter `name` as `read` takes it from what is written. Where that is wrong
    /// it is told, and the parameter counts as not given.
    fn read<T>(
        &self,
        name: &'static str,
        expected: &str,
        read: impl FnOnce(&'a Value) -> Option<T>,
    ) -> Option<T> {
        let property = self.find(name)?;
        if matches!(property.value, Value::Broken) {
            return None;
        }
        let value = read(&property.value);
        if value.is_none() {
            self.fault(property.at, self.wrong(property, expected));
        }
        value
    }

    /// Tells that parameter `name` cannot be used.
    fn refuse(&self, name: &str, message: impl Into<String>) {
        let at = self.place_of(name);
        self.fault(at, self.document.error(at, message));
    }

    /// Tells what is wrong with a parameter, which then has its default.
    pub fn fault(&self, at: At, error: ImportError) {
        self.document.faults.add(at, error, "its default is used");
    }

    /// A number.
    pub fn number(&self, name: &'static str) -> Option<f64> {
        self.read(name, "a <float>", |value| match value {
            Value::Float(v) => Some(*v),
            Value::Integer(v) => Some(*v as f64),
            _ => None,
        })
    }

    /// A number, `default` if it is not given.
    pub fn float(&self, name: &'static str, default: f64) -> f64 {
        self.number(name).unwrap_or(default)
    }

    /// A number in a range.
    pub fn float_in(
        &self,
        name: &'static str,
        default: f64,
        range: std::ops::RangeInclusive<f64>,
    ) -> f64 {
        let v = self.float(name, default);
        if range.contains(&v) {
            return v;
        }
        let (low, high) = (range.start(), range.end());
        let message = if v > *high && *high >= f64::from(f32::MAX) {
            format!("\"{name}\" is {v}; it must be at most {high:e}")
        } else if *high >= f64::from(f32::MAX) {
            format!("\"{name}\" is {v}; it must be at least {low}")
        } else {
            format!("\"{name}\" is {v}; it must be between {low} and {high}")
        };
        self.refuse(name, message);
        default.clamp(*low, *high)
    }

    /// A number above 0.
    pub fn positive(&self, name: &'static str, default: f64) -> f64 {
        let v = self.float(name, default);
        if v > 0.0 {
            return v;
        }
        self.refuse(
            name,
            format!("\"{name}\" is {v}; it must be greater than 0"),
        );
        default
    }

    /// A whole number.
    pub fn integer(&self, name: &'static str) -> Option<i64> {
        self.read(name, "an <integer>", |value| match value {
            Value::Integer(v) => Some(*v),
            Value::Float(v) if v.fract() == 0.0 && v.abs() < 1e15 => Some(*v as i64),
            _ => None,
        })
    }

    /// A whole number that fits `u32` and is at least `least`.
    pub fn count(&self, name: &'static str, default: u32, least: u32) -> u32 {
        let Some(v) = self.integer(name) else {
            return default;
        };
        match u32::try_from(v) {
            Ok(v) if v >= least => v,
            Ok(_) | Err(_) if v < i64::from(least) => {
                self.refuse(
                    name,
                    format!("\"{name}\" is {v}; it must be at least {least}"),
                );
                default
            }
            _ => {
                self.refuse(
                    name,
                    format!("\"{name}\" is {v}; it must be at most {}", u32::MAX),
                );
                default
            }
        }
    }

    /// A yes or no.
    pub fn boolean(&self, name: &'static str, default: bool) -> bool {
        let given = self.read(name, "a <boolean>", |value| match value {
            Value::Boolean(v) => Some(*v),
            _ => None,
        });
        given.unwrap_or(default)
    }

    /// A text.
    pub fn text(&self, name: &'static str) -> Option<&'a str> {
        self.read(name, "a <string>", |value| match value {
            Value::Text(v) => Some(v.as_str()),
            _ => None,
        })
    }

    /// One of a few words, any case; `None` if it is not given.
    pub fn choice<T: Copy>(&self, name: &'static str, choices: &[(&str, T)]) -> Option<T> {
        let word = self.text(name)?;
        let found = choices.iter().find(|(w, _)| w.eq_ignore_ascii_case(word));
        if found.is_none() {
            let list: Vec<_> = choices.iter().map(|(w, _)| *w).collect();
            let list = list.join(", ");
            self.refuse(name, format!("\"{name}\" is \"{word}\"; it can be {list}"));
        }
        found.map(|(_, v)| *v)
    }

    /// A point or vector.
    pub fn vector(&self, name: &'static str) -> Option<DVec3> {
        self.read(name, "a <point> or <vector>", |value| match value {
            Value::Vector(v) => Some(*v),
            _ => None,
        })
    }

    /// A transform without projection; `None` if it is not given.
    pub fn transform(&self, name: &'static str) -> Option<DAffine3> {
        let matrix = self.read(name, "a <transform>", |value| match value {
            Value::Transform(m) => Some(*m),
            _ => None,
        })?;
        match super::transform::affine(matrix) {
            Ok(affine) => Some(affine),
            Err(message) => {
                self.refuse(name, message);
                None
            }
        }
    }

    /// `to_world`, the identity if it is not given.
    pub fn to_world(&self) -> DAffine3 {
        self.transform("to_world").unwrap_or(DAffine3::IDENTITY)
    }

    /// Where a parameter stands, or the object if it does not.
    pub fn place_of(&self, name: &str) -> At {
        let property = self.object.properties.iter().rfind(|p| p.name == name);
        property.map_or(self.object.at, |p| p.at)
    }

    /// A warning for each parameter that nothing asked for.
    pub fn unused(&self) -> Vec<String> {
        let asked = self.asked.borrow();
        let leftover = self.object.properties.iter().zip(&self.used);
        leftover
            .filter(|(p, used)| !used.get() && !matches!(p.value, Value::Broken))
            .map(|(property, _)| self.unused_warning(property, &asked))
            .collect()
    }

    /// Names of the parameters that nothing asked for.
    pub fn unused_names(&self) -> Vec<&'a str> {
        let leftover = self.object.properties.iter().zip(&self.used);
        leftover
            .filter(|(_, used)| !used.get())
            .map(|(property, _)| property.written.as_str())
            .collect()
    }

    fn unused_warning(&self, property: &Property, asked: &[&'static str]) -> String {
        let place = self.document.location(property.at);
        let (tag, plugin) = (&self.object.tag, &self.object.plugin);
        if let Value::Object(index) = property.value {
            let inner = &self.document.objects[index];
            return format!(
                "{place}: {tag} \"{plugin}\" has no use for this {} \"{}\"",
                inner.tag, inner.plugin
            );
        }
        let hint = named::did_you_mean(&property.name, asked.iter().copied())
            .map(|h| format!("; {h}"))
            .unwrap_or_default();
        format!(
            "{place}: {tag} \"{plugin}\" has no parameter \"{}\"{hint}",
            property.written
        )
    }
}
