//! `KHR_materials_variants`: the materials of one of several finishes.

use super::schema::{Document, Primitive};
use super::{Importer, error, hint};
use crate::scene::import::ImportError;
use serde_json::Value;
use std::path::Path;

const NAME: &str = "KHR_materials_variants";

/// The names of a file's variants, in its order.
fn names(document: &Document) -> Vec<&str> {
    let list = document
        .extensions
        .get(NAME)
        .and_then(|e| e.get("variants"));
    let list = list
        .and_then(Value::as_array)
        .map_or(&[][..], Vec::as_slice);
    list.iter()
        .map(|v| v.get("name").and_then(Value::as_str).unwrap_or_default())
        .collect()
}

/// The number of the variant of that name, in any case if there is no other.
pub(super) fn find(document: &Document, name: &str, path: &Path) -> Result<usize, ImportError> {
    let names = names(document);
    let exact = names.iter().position(|n| *n == name);
    let similar = || names.iter().position(|n| n.eq_ignore_ascii_case(name));
    if let Some(found) = exact.or_else(similar) {
        return Ok(found);
    }
    let message = format!("has no variant \"{name}\"");
    if names.is_empty() {
        return Err(error(path, message + ", and no others"));
    }
    let quoted: Vec<String> = names.iter().map(|n| format!("\"{n}\"")).collect();
    let help = format!("its variants are {}", quoted.join(", "));
    Err(hint(path, message, &help))
}

impl Importer<'_> {
    /// The number of a primitive's material, in the variant that is shown.
    pub(super) fn material_of(&self, primitive: &Primitive) -> Option<usize> {
        let mapped = || {
            let variant = self.variant? as u64;
            let mappings = primitive.extensions.get(NAME)?.get("mappings")?;
            let holds = |m: &&Value| {
                let list = m.get("variants").and_then(Value::as_array);
                list.is_some_and(|l| l.iter().any(|v| v.as_u64() == Some(variant)))
            };
            let mapping = mappings.as_array()?.iter().find(holds)?;
            usize::try_from(mapping.get("material")?.as_u64()?).ok()
        };
        mapped().or(primitive.material)
    }

    /// Says that there are variants where none was asked for.
    pub(super) fn tell_of_variants(&mut self) {
        let names = names(self.document()).join(", ");
        if self.variant.is_none() && !names.is_empty() {
            self.warn(format!(
                "the default materials are shown; --variant shows one of: {names}"
            ));
        }
    }
}
