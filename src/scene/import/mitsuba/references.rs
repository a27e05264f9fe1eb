//! `<ref id="...">`: finds what it means, and refuses objects that hold themselves.

use super::document::Document;
use super::names;
use super::value::Value;
use super::xml::At;
use crate::scene::import::ImportError;
use std::collections::HashMap;

/// Replaces every reference by the object it names.
pub(super) fn resolve(
    document: &mut Document,
    ids: &HashMap<String, usize>,
) -> Result<(), ImportError> {
    for o in 0..document.objects.len() {
        for p in 0..document.objects[o].properties.len() {
            let property = &document.objects[o].properties[p];
            let Value::Reference(id) = &property.value else {
                continue;
            };
            let Some(&target) = ids.get(id) else {
                return Err(unknown(document, ids, id, property.at));
            };
            document.objects[o].properties[p].value = Value::Object(target);
        }
    }
    refuse_cycles(document)
}

/// The error for an id that no object has.
pub(super) fn unknown(
    document: &Document,
    ids: &HashMap<String, usize>,
    id: &str,
    at: At,
) -> ImportError {
    // The order of a hash map is not the same twice; messages should be.
    let mut known: Vec<&str> = ids.keys().map(String::as_str).collect();
    known.sort_unstable();
    let help = names::did_you_mean(id, known);
    document.error_help(at, format!("nothing has the id \"{id}\""), help)
}

/// Depth-first search with its own stack: chains of references may be long.
fn refuse_cycles(document: &Document) -> Result<(), ImportError> {
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
                    return Err(document.error(property.at, message));
                }
                Mark::New => {
                    marks[target] = Mark::Open;
                    stack.push((target, 0));
                }
                Mark::Done => {}
            }
        }
    }
    limit_depth(document)
}

/// Objects inside each other, references followed: the importer recurses over them.
const MAX_DEPTH: usize = 200;

/// Refuses chains too long for the importer's recursion. There are no cycles any more, so depths follow
/// from those of the objects inside; an object stands before what is nested in it but may refer to
/// anything, hence the repetition until nothing changes (each pass settles one more level).
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
