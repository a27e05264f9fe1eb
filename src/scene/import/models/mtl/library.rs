//! From the names in an OBJ file to its materials: which MTL files, and which of their entries.

use super::file::{self, Entry};
use crate::image::regular;
use crate::scene::import::mesh::FaceMaterials;
use crate::scene::import::named;
use crate::scene::import::parts::Parts;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The entries of the materials that the OBJ file `path` names, in the order of their numbers. A
/// library that is missing is a warning: the model can be seen without.
pub(super) fn read(path: &Path, names: &FaceMaterials, parts: &mut Parts) -> Vec<Option<Entry>> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut known = HashMap::new();
    for at in names.libraries.iter().flat_map(|l| files(folder, l)) {
        match regular::read(&at) {
            Ok(bytes) => {
                let library = file::parse(&bytes, &at);
                library.warnings.into_iter().for_each(|w| parts.warn(w));
                known.extend(library.entries);
            }
            Err(e) => parts.warn(format!(
                "{}: the materials in {} cannot be read: {e}{}",
                path.display(),
                at.display(),
                named::hint(&at, folder)
            )),
        }
    }
    if names.libraries.is_empty() && names.names.iter().any(|n| !n.is_empty()) {
        let own = path.with_extension("mtl");
        let beside = match own.exists() {
            true => format!(" ({} is there)", own.display()),
            false => String::new(),
        };
        let path = path.display();
        parts.warn(format!(
            "{path}: materials are named (usemtl), but no file that defines them (mtllib){beside}: clay instead"
        ));
    }
    let entry = |name: &String| {
        let entry = known.get(name).cloned();
        if entry.is_none() && !names.libraries.is_empty() && !name.is_empty() {
            let path = path.display();
            parts.warn(format!(
                "{path}: there is no material \"{name}\": clay instead"
            ));
        }
        entry
    };
    names.names.iter().map(entry).collect()
}

/// The files that stand behind `mtllib`: one whose name may have blanks in it, or several.
fn files(folder: &Path, names: &str) -> Vec<PathBuf> {
    let whole = named::resolve(folder, names);
    if whole.exists() {
        return vec![whole];
    }
    let mut list = Vec::new();
    let mut rest = names.trim();
    // A name ends with `.mtl`, or with the line.
    while let Some(end) = end_of_name(rest) {
        list.push(named::resolve(folder, &rest[..end]));
        rest = rest[end..].trim_start();
    }
    if !rest.is_empty() {
        list.push(named::resolve(folder, rest));
    }
    list
}

fn end_of_name(names: &str) -> Option<usize> {
    let lower = names.to_ascii_lowercase();
    let ends = lower.match_indices(".mtl").map(|(at, m)| at + m.len());
    ends.into_iter().find(|&end| {
        let behind = lower[end..].chars().next();
        behind.is_none_or(char::is_whitespace)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_may_name_several_files_and_a_name_may_have_blanks() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("a b.mtl c.mtl"), "").unwrap();
        let of = |names: &str| -> Vec<String> {
            let name = |p: PathBuf| p.strip_prefix(dir.path()).unwrap().display().to_string();
            files(dir.path(), names).into_iter().map(name).collect()
        };
        assert_eq!(of("a.mtl b.MTL"), ["a.mtl", "b.MTL"]);
        assert_eq!(of("my own.mtl other.mtl"), ["my own.mtl", "other.mtl"]);
        assert_eq!(of("a b.mtl c.mtl"), ["a b.mtl c.mtl"]);
        assert_eq!(of("tex\\a.mtl"), ["tex/a.mtl"]);
        assert_eq!(of("materials"), ["materials"]);
        assert_eq!(of("a.mtlx"), ["a.mtlx"]);
    }
}
