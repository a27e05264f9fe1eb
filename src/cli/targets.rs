//! The files that a command is to write, tried before the work: an hour of rendering must not end
//! at a typing error, and nothing is replaced that was meant to be kept.

use super::Failure;
use crate::image::atomic;
use std::path::{Path, PathBuf};

/// Finds out whether a file can be written: makes and removes one in its directory. What is there
/// is neither opened for reading nor changed.
///
/// # Errors
/// When it cannot be written, or what is there is no regular file, or read-only.
pub fn try_target(path: &Path) -> Result<(), Failure> {
    let name = path.display();
    let directory = |of: &Path| match of.parent() {
        Some(d) if !d.as_os_str().is_empty() => d.to_owned(),
        _ => PathBuf::from("."),
    };
    if path.is_dir() {
        let message = format!("{name} is a directory");
        return Err(Failure::refused(message, "name a file in it"));
    }
    let place = atomic::destination(path).map_err(|e| {
        let missing = !directory(path).is_dir() && !path.is_symlink();
        let help = match missing {
            true => format!("make it with: mkdir -p {}", directory(path).display()),
            false => "choose another name, or move away what is there".to_owned(),
        };
        Failure::refused(format!("{name} cannot be written: {e}"), help)
    })?;
    let directory = directory(&place);
    tempfile::Builder::new()
        .prefix(".twintree-")
        .tempfile_in(&directory)
        .map(drop)
        .map_err(|e| {
            Failure::refused(
                format!("{name} cannot be written: {e}"),
                format!("choose a directory other than {}", directory.display()),
            )
        })
}

/// A file of a command: what it is to the command, and its name.
pub type Named<'a> = (&'a str, &'a Path);

/// The files of a command that are there.
pub fn named<'a>(files: &[(&'a str, Option<&'a Path>)]) -> Vec<Named<'a>> {
    let there = files.iter();
    there
        .filter_map(|&(what, path)| Some((what, path?)))
        .collect()
}

/// Refuses outputs that are one file, and outputs that are an input.
///
/// # Errors
/// When the one would replace the other.
pub fn check_distinct(outputs: &[Named], inputs: &[Named]) -> Result<(), Failure> {
    for (i, (option, path)) in outputs.iter().enumerate() {
        let Some(place) = place(path) else { continue };
        let same = |other: &&Named| self::place(other.1).as_ref() == Some(&place);
        if let Some((other, _)) = outputs[..i].iter().find(same) {
            return Err(Failure::wrong(
                format!(
                    "{} is named twice, by {other} and by {option}",
                    path.display()
                ),
                "give each a file of its own: the one would replace the other",
            ));
        }
        if let Some((what, _)) = inputs.iter().find(same) {
            return Err(Failure::wrong(
                format!(
                    "{} is {what}, and {option} would replace it",
                    path.display()
                ),
                "choose another name for what is written",
            ));
        }
    }
    Ok(())
}

/// Where a file is, whichever way it is named; none where there is no such directory.
fn place(path: &Path) -> Option<PathBuf> {
    let place = atomic::destination(path).unwrap_or_else(|_| path.to_owned());
    if let Ok(there) = place.canonicalize() {
        return Some(there);
    }
    let directory = match place.parent() {
        Some(d) if !d.as_os_str().is_empty() => d,
        _ => Path::new("."),
    };
    Some(directory.canonicalize().ok()?.join(place.file_name()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn files_are_the_same_whichever_way_they_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        std::fs::create_dir(at("sub")).unwrap();
        std::fs::write(at("scene.xml"), "").unwrap();
        std::os::unix::fs::symlink("a.exr", at("b.exr")).unwrap();
        let scene = at("scene.xml");
        let inputs = [("the scene", scene.as_path())];
        let check = |a: &str, b: &str| {
            check_distinct(&[("-o", &at(a)), ("--stats", &at(b))], &inputs)
                .map_err(|e| e.text().unwrap())
        };
        assert_eq!(check("a.exr", "c.exr"), Ok(()));
        for same in ["a.exr", "sub/../a.exr", "./a.exr", "b.exr"] {
            let e = check("a.exr", same).unwrap_err();
            assert!(e.contains("-o") && e.contains("--stats"), "{e}");
        }
        let e = check("a.exr", "sub/../scene.xml").unwrap_err();
        assert!(e.contains("is the scene"), "{e}");
    }
}
