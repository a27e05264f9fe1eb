//! Parameters, asked for by name.

use super::graphics::Definition;
use super::parameter::{Kind, Parameter, Values};
use super::source::Source;
use crate::math::DVec3;
use crate::scene::import::faults::At;
use crate::scene::import::named;
use std::cell::RefCell;

/// The parameters of a plugin, its own before those of `Attribute` directives. It remembers what
/// was asked for.
pub(super) struct Params<'i, 's> {
    pub source: &'s Source,
    pub definition: &'i Definition<'s>,
    asked: RefCell<Vec<&'static str>>,
}

impl<'i, 's> Params<'i, 's> {
    pub fn new(source: &'s Source, definition: &'i Definition<'s>) -> Self {
        Self {
            source,
            definition,
            asked: RefCell::default(),
        }
    }

    /// What kind it is, such as `sphere`.
    pub fn name(&self) -> &'s str {
        let plugin = self.definition.plugin;
        plugin
            .class
            .as_ref()
            .map_or(&plugin.name, |class| &class[1])
    }

    pub fn at(&self) -> At {
        self.definition.at
    }

    /// The parameter of that name and of one of those kinds; of another kind, it is an error.
    pub fn find(&self, name: &'static str, kinds: &[Kind]) -> Option<&'s Parameter> {
        let found = self.any(name)?;
        if kinds.contains(&found.kind) {
            return Some(found);
        }
        let message = format!(
            "\"{name}\" cannot be of this type ({})",
            found.values.described()
        );
        self.source
            .fault(found.at, message, "the default takes its place");
        None
    }

    /// The parameter of that name.
    pub fn any(&self, name: &'static str) -> Option<&'s Parameter> {
        if !self.asked.borrow().contains(&name) {
            self.asked.borrow_mut().push(name);
        }
        let own = &self.definition.plugin.parameters;
        let mut matching = own.iter().filter(|p| *p.name == *name);
        let inherited = || self.definition.inherited().iter().copied();
        let found = matching.next();
        // A second of the same name is told by `unused`.
        matching.for_each(Parameter::set_used);
        let found = found.or_else(|| inherited().find(|p| *p.name == *name))?;
        found.set_used();
        Some(found)
    }

    /// Whether it is given.
    pub fn has(&self, name: &'static str) -> bool {
        self.any(name).is_some()
    }

    /// Where it is given, or the plugin's place.
    pub fn place_of(&self, name: &'static str) -> At {
        self.any(name).map_or(self.at(), |p| p.at)
    }

    /// Parameters that mean something to pbrt and nothing to this renderer.
    pub fn ignore(&self, names: &[&'static str]) {
        for name in names {
            let _ = self.any(name);
        }
    }

    /// Notes that a parameter is wrong.
    pub fn wrong(&self, name: &'static str, message: impl Into<String>) {
        let at = self.place_of(name);
        self.source
            .fault(at, message, "the default takes its place");
    }

    fn one<T: Copy>(&self, parameter: &Parameter, list: &[T]) -> Option<T> {
        if let &[value] = list {
            return Some(value);
        }
        let (name, count) = (&parameter.name, list.len());
        let message = format!("\"{name}\" is one value, not {count}");
        let instead = "the default takes its place";
        self.source.fault(parameter.at, message, instead);
        None
    }

    /// A number, if it is given.
    pub fn float_given(&self, name: &'static str) -> Option<f64> {
        let found = self.find(name, &[Kind::Float, Kind::Integer])?;
        match &found.values {
            Values::Floats(list) => self.one(found, list).map(f64::from),
            Values::Integers(list) => self.one(found, list).map(f64::from),
            _ => None,
        }
    }

    pub fn float(&self, name: &'static str, default: f64) -> f64 {
        self.float_given(name).unwrap_or(default)
    }

    /// A number in a range.
    pub fn float_in(
        &self,
        name: &'static str,
        default: f64,
        range: std::ops::RangeInclusive<f64>,
    ) -> f64 {
        let value = self.float(name, default);
        if range.contains(&value) {
            return value;
        }
        let (low, high) = (range.start(), range.end());
        self.wrong(
            name,
            format!("\"{name}\" is {value}; it must be from {low} to {high}"),
        );
        default
    }

    /// A number above 0.
    pub fn positive(&self, name: &'static str, default: f64) -> f64 {
        let value = self.float(name, default);
        if value > 0.0 {
            return value;
        }
        self.wrong(name, format!("\"{name}\" is {value}; it must be above 0"));
        default
    }

    /// A whole number, if it is given.
    pub fn integer_given(&self, name: &'static str) -> Option<i32> {
        let found = self.find(name, &[Kind::Integer])?;
        match &found.values {
            Values::Integers(list) => self.one(found, list),
            _ => None,
        }
    }

    /// A whole number from 1 on.
    pub fn count(&self, name: &'static str, default: u32) -> u32 {
        match self.integer_given(name) {
            None => default,
            Some(n) if n > 0 => n.unsigned_abs(),
            Some(n) => {
                self.wrong(name, format!("\"{name}\" is {n}; it must be at least 1"));
                default
            }
        }
    }

    pub fn boolean(&self, name: &'static str, default: bool) -> bool {
        let Some(found) = self.find(name, &[Kind::Bool]) else {
            return default;
        };
        match &found.values {
            Values::Bools(list) => self.one(found, list).unwrap_or(default),
            _ => default,
        }
    }

    /// A text, if it is given.
    pub fn text(&self, name: &'static str) -> Option<&'s str> {
        let found = self.find(name, &[Kind::Text])?;
        self.only_text(found)
    }

    /// The one text of a parameter.
    pub fn only_text(&self, parameter: &'s Parameter) -> Option<&'s str> {
        let Values::Texts(list) = &parameter.values else {
            return None;
        };
        let texts: Vec<&str> = list.iter().map(String::as_str).collect();
        self.one(parameter, &texts)
    }

    /// One of a few words; another is an error.
    pub fn choice<T: Copy>(&self, name: &'static str, words: &[(&str, T)]) -> Option<T> {
        let text = self.text(name)?;
        let found = words.iter().find(|(word, _)| *word == text);
        if found.is_none() {
            let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            let message = format!("\"{name}\" is \"{text}\"; it can be {}", known.join(", "));
            self.wrong(name, message);
        }
        found.map(|(_, value)| *value)
    }

    /// Numbers of these kinds, if there are any.
    pub fn floats(&self, name: &'static str, kinds: &[Kind]) -> Option<&'s [f32]> {
        match &self.find(name, kinds)?.values {
            Values::Floats(list) if !list.is_empty() => Some(list),
            _ => None,
        }
    }

    /// Whole numbers, if there are any.
    pub fn integers(&self, name: &'static str) -> Option<&'s [i32]> {
        match &self.find(name, &[Kind::Integer])?.values {
            Values::Integers(list) if !list.is_empty() => Some(list),
            _ => None,
        }
    }

    /// A point or a vector.
    pub fn triple(&self, name: &'static str, default: DVec3) -> DVec3 {
        match self.floats(name, &[Kind::Triple]) {
            Some(&[x, y, z]) => DVec3::new(x.into(), y.into(), z.into()),
            None => default,
            Some(other) => {
                let count = other.len();
                self.wrong(name, format!("\"{name}\" is three numbers, not {count}"));
                default
            }
        }
    }

    /// Names of own parameters that nothing asked for, each as a warning.
    pub fn unused(&self) -> Vec<String> {
        let own = &self.definition.plugin.parameters;
        let again = |i: usize| own[..i].iter().any(|p| p.name == own[i].name);
        let twice = (0..own.len()).filter(|i| again(*i)).map(|i| {
            let place = self.source.location(own[i].at);
            format!(
                "{place}: \"{}\" is given twice; the first counts",
                own[i].name
            )
        });
        let unused = own.iter().filter(|p| !p.is_used());
        let asked = self.asked.borrow();
        let (word, name) = (self.definition.plugin.directive.word(), self.name());
        unused
            .map(|p| {
                let place = self.source.location(p.at);
                let hint = named::did_you_mean(&p.name, asked.iter().copied());
                let hint = hint.map_or(String::new(), |h| format!("; {h}"));
                format!(
                    "{place}: {word} \"{name}\" has no parameter \"{}\"{hint}",
                    p.name
                )
            })
            .chain(twice)
            .collect()
    }
}
