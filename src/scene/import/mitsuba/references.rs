//! `<ref id="...">`: finds what it means, and refuses objects that hold themselves.

use super::document::{Document, Object};
use super::names;
use super::value::Value;
use crate::scene::import::faults::At;
use crate::scene::import::{ImportError, named};
use std::collections::HashMap;

/// Unknown names that are compared with all known ones.
const MOST_HINTS: usize = 100;

/// Replaces every reference by the object it names. What cannot be is told and marked as broken,
/// and so is whatever names an object of a plugin that nobody knows.
pub(super) fn resolve(
    document: &mut Document,
    ids: &HashMap<String, usize>,
) -> Result<(), ImportError> {
    document.referred = vec![false; document.objects.len()];
    for o in 0..document.objects.len() {
        for p in 0..document.objects[o].properties.len() {
            let property = &document.objects[o].properties[p];
            let Value::Reference(id) = &property.value else {
                continue;
            };
            let value = match ids.get(id) {
                Some(&target) => {
                    document.referred[target] = true;
                    Value::Object(target)
                }
                None => {
                    let error = unknown(document, ids, id, property.at);
                    document.faults.add(property.at, error, "it is left out");
                    Value::Broken
                }
            };
            document.objects[o].properties[p].value = value;
        }
    }
    refuse_unknown_plugins(document);
    refuse_cycles(document);
    limit_depth(document)
}

/// Every plugin must be known, used or not: a misspelt one would otherwise go unnoticed.
fn refuse_unknown_plugins(document: &mut Document) {
    let is_unknown = |object: &Object| {
        let known = known_plugins(object);
        !known.is_empty() && !known.contains(&object.plugin.as_str())
    };
    let unknown: Vec<bool> = document.objects.iter().map(is_unknown).collect();
    for object in document.objects.iter().zip(&unknown) {
        let (object, true) = object else { continue };
        let known = known_plugins(object);
        let help = named::did_you_mean(&object.plugin, known.iter().copied());
        let help = help.unwrap_or_else(|| format!("known are {}", known.join(", ")));
        let message = format!("{} \"{}\" is not known", object.tag, object.plugin);
        let error = document.error_help(object.at, message, Some(help));
        let instead = match object.tag.as_str() {
            "bsdf" => "grey takes its place",
            "film" | "rfilter" | "sampler" => "the default takes its place",
            "sensor" => "the camera is placed to see all of the scene",
            _ => "it is left out",
        };
        document.faults.add(object.at, error, instead);
    }
    for object in &mut document.objects {
        for property in &mut object.properties {
            if matches!(property.value, Value::Object(target) if unknown[target]) {
                property.value = Value::Broken;
            }
        }
    }
}

/// The plugins known for an object's element; empty if any is taken.
fn known_plugins(object: &Object) -> &'static [&'static str] {
    let tag = match object.tag.as_str() {
        "spectrum" => "texture",
        tag => tag,
    };
    names::plugins(tag).unwrap_or_default()
}

/// The error for an id that no object has.
pub(super) fn unknown(
    document: &Document,
    ids: &HashMap<String, usize>,
    id: &str,
    at: At,
) -> ImportError {
    // A hint costs a comparison with every id: a file full of mistakes gets some.
    if document.faults.len() > MOST_HINTS {
        return document.error(at, format!("nothing has the id \"{id}\""));
    }
    // The order of a hash map is not the same twice; messages should be.
    let mut known: Vec<&str> = ids.keys().map(String::as_str).collect();
    known.sort_unstable();
    let help = named::did_you_mean(id, known);
    document.error_help(at, format!("nothing has the id \"{id}\""), help)
}

/// Depth-first search with its own stack: chains of references may be long. What would close a
/// circle is told and marked as broken.
fn refuse_cycles(document: &mut Document) {
    #[derive(Clone, Copy, PartialEq)]
    enum Mark {
        New,
        Open,
        Done,
    }
    let mut marks = vec![Mark::New; document.objects.len()];
    for start in 0..document.objects.len() {
        if marks[start] != Mark::New {
            continue;
        }
        marks[start] = Mark::Open;
        let mut stack = vec![(start, 0)];
        while let Some((object, next)) = stack.pop() {
            let Some(property) = document.objects[object].properties.get(next) else {
                marks[object] = Mark::Done;
                continue;
            };
            stack.push((object, next + 1));
            let Value::Object(target) = property.value else {
                continue;
            };
            match marks[target] {
                Mark::Open => {
                    let id = document.objects[target].id.as_deref().unwrap_or("?");
                    let message = format!("\"{id}\" holds itself through this reference");
                    let error = document.error(property.at, message);
                    document.faults.add(property.at, error, "it is left out");
                    document.objects[object].properties[next].value = Value::Broken;
                }
                Mark::New => {
                    marks[target] = Mark::Open;
                    stack.push((target, 0));
                }
                Mark::Done => {}
            }
        }
    }
}

/// Objects inside each other, references followed: the importer recurses over them.
const MAX_DEPTH: usize = 200;

/// Refuses chains too long for the importer's recursion. There are no cycles any more, so depths
/// follow from those of the objects inside; an object stands before what is nested in it but may
/// refer to anything, hence the repetition until nothing changes (each pass settles one more
/// level).
fn limit_depth(document: &Document) -> Result<(), ImportError> {
    let mut depth = vec![0usize; document.objects.len()];
    for _ in 0..=MAX_DEPTH {
        let mut changed = false;
        for (i, object) in document.objects.iter().enumerate().rev() {
            let inside = object.properties.iter().filter_map(|p| match p.value {
                Value::Object(target) => Some(depth[target] + 1),
                _ => None,
            });
            let deepest = inside.max().unwrap_or(0);
            changed |= deepest != depth[i];
            depth[i] = deepest;
            if deepest > MAX_DEPTH {
                let message = format!("objects are nested more than {MAX_DEPTH} deep");
                return Err(document.error(object.at, message));
            }
        }
        if !changed {
            break;
        }
    }
    Ok(())
}
