//! Attributes of an element, and the value they write.

use super::reader::Reader;
use super::value::{self, Color, Value};
use super::xml::Element;
use super::{names, transform};
use crate::math::DMat4;
use crate::scene::import::{ImportError, named};
use std::collections::HashMap;

/// The attributes each parameter element may have, beside `name`.
const ATTRIBUTES: &[(&str, &[&str])] = &[
    ("point", &["x", "y", "z", "value"]),
    ("vector", &["x", "y", "z", "value"]),
    ("spectrum", &["value", "filename", "intent"]),
    ("rgb", &["value", "intent"]),
    ("srgb", &["value", "intent"]),
    ("blackbody", &["temperature", "scale"]),
    ("transform", &[]),
    ("ref", &["id"]),
];

/// The attributes an element may have; most have a `value`.
fn known_attributes(tag: &str) -> Vec<&'static str> {
    let listed = ATTRIBUTES.iter().find(|(t, _)| *t == tag);
    let mut known = listed.map_or_else(|| vec!["value"], |(_, list)| list.to_vec());
    known.push("name");
    known
}

impl Reader {
    /// An element's attributes with values put in for `$names`.
    pub fn attributes(
        &mut self,
        element: &Element,
    ) -> Result<HashMap<String, String>, ImportError> {
        let mut out = HashMap::with_capacity(element.attributes.len());
        for (name, text) in &element.attributes {
            let substituted = self.defines.substitute(text);
            let text = substituted.map_err(|m| self.document.error(element.at, m))?;
            out.insert(name.clone(), text);
        }
        Ok(out)
    }

    pub fn required<'m>(
        &self,
        element: &Element,
        attributes: &'m HashMap<String, String>,
        name: &str,
    ) -> Result<&'m str, ImportError> {
        attributes.get(name).map(String::as_str).ok_or_else(|| {
            let message = format!("<{}> has no \"{name}\"", element.tag);
            self.document.error(element.at, message)
        })
    }

    pub fn warn_attributes(&mut self, element: &Element, known: &[&str]) {
        let place = self.document.location(element.at);
        for (name, _) in &element.attributes {
            if known.contains(&name.as_str()) {
                continue;
            }
            let hint = named::did_you_mean(name, known.iter().copied());
            let hint = hint.map(|h| format!("; {h}")).unwrap_or_default();
            let warning = format!(
                "{place}: <{}> has no attribute \"{name}\"{hint}",
                element.tag
            );
            self.document.warnings.push(warning);
        }
    }

    pub fn value(
        &mut self,
        element: &Element,
        attributes: &HashMap<String, String>,
    ) -> Result<Value, ImportError> {
        let tag = element.tag.as_str();
        if let Some(intruder) = element.children.first().filter(|_| tag != "transform") {
            let message = format!("<{}> cannot stand inside <{tag}>", intruder.tag);
            return Err(self.document.error(intruder.at, message));
        }
        if names::PARAMETERS.contains(&tag) {
            self.warn_attributes(element, &known_attributes(tag));
        }
        let text = || self.required(element, attributes, "value");
        let get = |name: &str| attributes.get(name).map(String::as_str);
        let value = match tag {
            "boolean" => value::boolean(text()?).map(Value::Boolean),
            "integer" => value::integer(text()?).map(Value::Integer),
            "float" => value::number(text()?).map(Value::Float),
            "string" => Ok(Value::Text(text()?.to_owned())),
            "point" | "vector" => transform::xyz(&get, 0.0).map(Value::Vector),
            "rgb" => value::rgb(text()?, false).map(Value::Color),
            "srgb" => value::rgb(text()?, true).map(Value::Color),
            "blackbody" => black_body(&get).map(Value::Color),
            "spectrum" => return self.spectrum(element, attributes).map(Value::Color),
            "transform" => return self.transform(element).map(Value::Transform),
            "ref" => {
                let id = self.required(element, attributes, "id")?;
                Ok(Value::Reference(id.to_owned()))
            }
            _ => return Err(self.unknown_element(element)),
        };
        value.map_err(|message| self.document.error(element.at, message))
    }

    fn spectrum(
        &self,
        element: &Element,
        attributes: &HashMap<String, String>,
    ) -> Result<Color, ImportError> {
        let error = |message: String| self.document.error(element.at, message);
        let Some(name) = attributes.get("filename") else {
            return value::spectrum(self.required(element, attributes, "value")?).map_err(error);
        };
        let path = self.document.resolve(element.at, name);
        let text = crate::image::regular::read_to_string(&path).map_err(|e| {
            let hint = named::hint_of(&path);
            error(format!(
                "cannot read the spectrum {}: {e}{hint}",
                path.display()
            ))
        })?;
        value::spectrum_file(&text).map_err(|m| error(format!("{}: {m}", path.display())))
    }

    fn transform(&mut self, element: &Element) -> Result<DMat4, ImportError> {
        let mut whole = DMat4::IDENTITY;
        for child in &element.children {
            let attributes = self.attributes(child)?.into_iter().collect();
            let child = Element {
                tag: child.tag.clone(),
                attributes,
                at: child.at,
                children: Vec::new(),
            };
            match transform::step(&child) {
                Ok(step) => whole = step * whole,
                Err(message) => {
                    let error = self.document.error(child.at, message);
                    self.document.faults.add(child.at, error, "it is left out");
                }
            }
        }
        Ok(whole)
    }

    fn unknown_element(&self, element: &Element) -> ImportError {
        let known = names::OBJECTS.iter().map(|(tag, _)| *tag);
        let known = known.chain(names::PARAMETERS.iter().copied());
        let help = match element.tag.as_str() {
            "luminaire" | "camera" => Some(
                "this is Mitsuba 0.3's language: load the scene once in Mitsuba 0.6, which upgrades it"
                    .to_owned(),
            ),
            "animation" => Some("motion is not supported; write a single <transform>".into()),
            tag => named::did_you_mean(tag, known),
        };
        let message = format!("<{}> is not known", element.tag);
        self.document.error_help(element.at, message, help)
    }
}

fn black_body<'e>(attribute: &impl Fn(&str) -> Option<&'e str>) -> Result<Color, String> {
    let kelvin = attribute("temperature").ok_or("a <blackbody> needs a temperature")?;
    let scale = attribute("scale").map_or(Ok(1.0), value::number)?;
    Ok(Color::BlackBody(value::temperature(kelvin)?, scale))
}
