//! Names in files: other files, found as they were meant or with a hint at what is there instead, and
//! words that were misspelt.

use std::path::{Path, PathBuf};

/// Entries of a folder that are looked at for a hint.
const MOST_ENTRIES: usize = 1000;

/// The file that `name` stands for, in a file of `folder`: as it is written, without quotes around
/// it, or with backslashes taken as slashes.
pub(super) fn resolve(folder: &Path, name: &str) -> PathBuf {
    let plain = folder.join(name);
    let unquoted = name
        .strip_prefix('"')
        .and_then(|n| n.strip_suffix('"'))
        .unwrap_or(name);
    if plain.exists() || (unquoted == name && !name.contains('\\')) {
        return plain;
    }
    folder.join(unquoted.replace('\\', "/"))
}

/// The file of the same name in `folder` itself, for a missing file that is named by a path of
/// another machine: one that begins with a drive's letter, at the root, or at a server.
pub(super) fn beside(path: &Path, folder: &Path, name: &str) -> Option<PathBuf> {
    let name = name.trim_matches('"');
    let drive = name.as_bytes().get(1) == Some(&b':');
    let elsewhere = drive || name.starts_with(['/', '\\']);
    if path.exists() || !elsewhere {
        return None;
    }
    let last = name.rsplit(['/', '\\']).next()?;
    let found = similar(&folder.join(last))?;
    found.is_file().then_some(found)
}

/// What is said behind the name of a file that is missing: that there is one of the same name in
/// other letters, or one in `folder` itself. Empty where there is neither.
pub(super) fn hint(path: &Path, folder: &Path) -> String {
    if path.exists() {
        return String::new();
    }
    let beside = || {
        let name = path.file_name()?;
        similar(&folder.join(name))
    };
    match similar(path).map(|p| (p, " (capital and small letters count)")) {
        Some((found, why)) => format!("; there is {}{why}", found.display()),
        None => beside().map_or(String::new(), |p| format!("; there is {}", p.display())),
    }
}

/// The same for a file whose own folder is the only one to look into.
pub(super) fn hint_of(path: &Path) -> String {
    hint(path, path.parent().unwrap_or(Path::new("")))
}

/// A file whose path differs from `path` in capital and small letters alone, if in anything.
fn similar(path: &Path) -> Option<PathBuf> {
    if path.exists() || path.as_os_str().is_empty() {
        return Some(path.to_owned());
    }
    let wanted = path.file_name()?.to_str()?.to_lowercase();
    let folder = similar(path.parent()?)?;
    let list = match folder.as_os_str().is_empty() {
        true => std::fs::read_dir("."),
        false => std::fs::read_dir(&folder),
    };
    let same =
        |name: &std::ffi::OsString| name.to_str().map(str::to_lowercase).as_ref() == Some(&wanted);
    let names = list
        .ok()?
        .take(MOST_ENTRIES)
        .flatten()
        .map(|e| e.file_name());
    names.filter(same).min().map(|name| folder.join(name))
}

/// The known name most like `name`, if one is like it at all.
pub(super) fn nearest<'n>(name: &str, known: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let name = name.to_lowercase();
    known
        .into_iter()
        .map(|k| (strsim::jaro_winkler(&name, &k.to_lowercase()), k))
        .filter(|(likeness, _)| *likeness > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, k)| k)
}

/// `did you mean "x"?` for the nearest of the known names.
pub(super) fn did_you_mean<'n>(
    name: &str,
    known: impl IntoIterator<Item = &'n str>,
) -> Option<String> {
    nearest(name, known).map(|n| format!("did you mean \"{n}\"?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_from_windows_and_in_quotes_are_found() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::create_dir(dir.path().join("tex")).unwrap();
        for name in ["tex/a b.png", "odd\\name.png"] {
            std::fs::write(dir.path().join(name), "").unwrap();
        }
        for name in [
            "tex/a b.png",
            "tex\\a b.png",
            "\"tex\\a b.png\"",
            "odd\\name.png",
        ] {
            assert!(resolve(dir.path(), name).is_file(), "{name}");
        }
        assert_eq!(resolve(dir.path(), "no.png"), dir.path().join("no.png"));
    }

    #[test]
    fn paths_of_other_machines_lead_to_the_file_beside() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("Wood.png"), "").unwrap();
        let of = |name: &str| beside(&resolve(dir.path(), name), dir.path(), name);
        let there = Some(dir.path().join("Wood.png"));
        for name in [
            "C:\\Users\\me\\tex\\wood.png",
            "D:/tex/Wood.png",
            "/home/me/Wood.png",
            "\\\\server\\share\\Wood.png",
            "\"C:\\a b\\Wood.png\"",
        ] {
            assert_eq!(of(name), there, "{name}");
        }
        for name in ["tex/Wood.png", "Wood.png", "C:\\stone.png", "C:\\"] {
            assert_eq!(of(name), None, "{name}");
        }
    }

    #[test]
    fn a_hint_names_the_file_of_other_letters_or_beside() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::create_dir(dir.path().join("Tex")).unwrap();
        std::fs::write(dir.path().join("Tex/Wood.PNG"), "").unwrap();
        std::fs::write(dir.path().join("stone.png"), "").unwrap();
        let of = |name: &str| hint(&resolve(dir.path(), name), dir.path());
        assert!(of("tex/wood.png").contains("Tex/Wood.PNG (capital"));
        assert!(of("C:\\me\\stone.png").ends_with("stone.png"));
        assert_eq!(of("absent.png"), "");
        assert_eq!(of("stone.png"), "");
    }

    #[test]
    fn the_nearest_name_is_found_and_strangers_are_not() {
        let known = ["diffuse", "dielectric", "conductor"];
        assert_eq!(nearest("difuse", known), Some("diffuse"));
        assert_eq!(nearest("Conducter", known), Some("conductor"));
        assert_eq!(nearest("zzz", known), None);
    }
}
