//! Asking an object for its parameters.
//!
//! A plugin's reader asks for each parameter by name, once; what it never asked for is what the plugin
//! does not know, and the names it asked for are what a misspelt name is compared with. So the list of a
//! plugin's parameters exists in one place only, the code that uses them.

use super::document::{Document, Object, Property};
use super::names;
use super::value::{Dialect, Value};
use super::xml::At;
use crate::math::{DAffine3, DVec3};
use crate::scene::import::ImportError;
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

    /// A number.
    pub fn number(&self, name: &'static str) -> Result<Option<f64>, ImportError> {
        let Some(property) = self.find(name) else {
            return Ok(None);
        };
        match &property.value {
            Value::Float(v) => Ok(Some(*v)),
            Value::Integer(v) => Ok(Some(*v as f64)),
            _ => Err(self.wrong(property, "a <float>")),
        }
    }

    /// A number, `default` if it is not given.
    pub fn float(&self, name: &'static str, default: f64) -> Result<f64, ImportError> {
        Ok(self.number(name)?.unwrap_or(default))
    }

    /// A number in a range.
    pub fn float_in(
        &self,
        name: &'static str,
        default: f64,
        range: std::ops::RangeInclusive<f64>,
    ) -> Result<f64, ImportError> {
        let v = self.float(name, default)?;
        if range.contains(&v) {
            return Ok(v);
        }
        let (low, high) = (range.start(), range.end());
        let message = if v > *high && *high >= f64::from(f32::MAX) {
            format!("\"{name}\" is {v}; it must be at most {high:e}")
        } else if *high >= f64::from(f32::MAX) {
            format!("\"{name}\" is {v}; it must be at least {low}")
        } else {
            format!("\"{name}\" is {v}; it must be between {low} and {high}")
        };
        Err(self.document.error(self.place_of(name), message))
    }

    /// A number above 0.
    pub fn positive(&self, name: &'static str, default: f64) -> Result<f64, ImportError> {
        let v = self.float(name, default)?;
        if v > 0.0 {
            return Ok(v);
        }
        let message = format!("\"{name}\" is {v}; it must be greater than 0");
        Err(self.document.error(self.place_of(name), message))
    }

    /// A whole number.
    pub fn integer(&self, name: &'static str) -> Result<Option<i64>, ImportError> {
        let Some(property) = self.find(name) else {
            return Ok(None);
        };
        match &property.value {
            Value::Integer(v) => Ok(Some(*v)),
            Value::Float(v) if v.fract() == 0.0 && v.abs() < 1e15 => Ok(Some(*v as i64)),
            _ => Err(self.wrong(property, "an <integer>")),
        }
    }

    /// A whole number that fits `u32` and is at least `least`.
    pub fn count(&self, name: &'static str, default: u32, least: u32) -> Result<u32, ImportError> {
        let Some(v) = self.integer(name)? else {
            return Ok(default);
        };
        match u32::try_from(v) {
            Ok(v) if v >= least => Ok(v),
            _ => {
                let message = match v > i64::from(u32::MAX) {
                    true => format!("\"{name}\" is {v}; it must be at most {}", u32::MAX),
                    false => format!("\"{name}\" is {v}; it must be at least {least}"),
                };
                Err(self.document.error(self.place_of(name), message))
            }
        }
    }

    /// A yes or no.
    pub fn boolean(&self, name: &'static str, default: bool) -> Result<bool, ImportError> {
        match self.find(name) {
            None => Ok(default),
            Some(property) => match &property.value {
                Value::Boolean(v) => Ok(*v),
                _ => Err(self.wrong(property, "a <boolean>")),
            },
        }
    }

    /// A text.
    pub fn text(&self, name: &'static str) -> Result<Option<&'a str>, ImportError> {
        match self.find(name) {
            None => Ok(None),
            Some(property) => match &property.value {
                Value::Text(v) => Ok(Some(v)),
                _ => Err(self.wrong(property, "a <string>")),
            },
        }
    }

    /// One of a few words, any case; `None` if it is not given.
    pub fn choice<T: Copy>(
        &self,
        name: &'static str,
        choices: &[(&str, T)],
    ) -> Result<Option<T>, ImportError> {
        let Some(word) = self.text(name)? else {
            return Ok(None);
        };
        let found = choices.iter().find(|(w, _)| w.eq_ignore_ascii_case(word));
        found.map(|(_, v)| Some(*v)).ok_or_else(|| {
            let list: Vec<_> = choices.iter().map(|(w, _)| *w).collect();
            let message = format!("\"{name}\" is \"{word}\"; it can be {}", list.join(", "));
            self.document.error(self.place_of(name), message)
        })
    }

    /// A point or vector.
    pub fn vector(&self, name: &'static str) -> Result<Option<DVec3>, ImportError> {
        match self.find(name) {
            None => Ok(None),
            Some(property) => match &property.value {
                Value::Vector(v) => Ok(Some(*v)),
                _ => Err(self.wrong(property, "a <point> or <vector>")),
            },
        }
    }

    /// A transform without projection; `None` if it is not given.
    pub fn transform(&self, name: &'static str) -> Result<Option<DAffine3>, ImportError> {
        match self.find(name) {
            None => Ok(None),
            Some(property) => match &property.value {
                Value::Transform(m) => super::transform::affine(*m)
                    .map(Some)
                    .map_err(|message| self.document.error(property.at, message)),
                _ => Err(self.wrong(property, "a <transform>")),
            },
        }
    }

    /// `to_world`, the identity if it is not given.
    pub fn to_world(&self) -> Result<DAffine3, ImportError> {
        Ok(self.transform("to_world")?.unwrap_or(DAffine3::IDENTITY))
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
            .filter(|(_, used)| !used.get())
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
        let hint = names::did_you_mean(&property.name, asked.iter().copied())
            .map(|h| format!("; {h}"))
            .unwrap_or_default();
        format!(
            "{place}: {tag} \"{plugin}\" has no parameter \"{}\"{hint}",
            property.written
        )
    }
}
