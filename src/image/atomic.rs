//! Files that are either the old or the new, never half of one.
//!
//! The new content goes to a file of another name in the same directory, is flushed to the disk and
//! only then renamed over the target. Whatever fails before leaves the target as it was and removes
//! the other file.

use super::ImageError;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// Calls `fill` with the name of an empty file beside `target` (and with its extension), then puts
/// that file in the place of `target`. The error of `fill`, or of the disk, names `target`.
pub fn replace(
    target: &Path,
    fill: impl FnOnce(&Path) -> Result<(), String>,
) -> Result<(), ImageError> {
    let error = |what: &str, e: std::io::Error| ImageError::new(target, format!("{what}: {e}"));
    let directory = directory_of(target)?;
    let suffix = target
        .extension()
        .map(|e| format!(".{}", e.to_string_lossy()))
        .unwrap_or_default();
    let new = tempfile::Builder::new()
        .prefix(".twintree-")
        .suffix(&suffix)
        .tempfile_in(directory)
        .map_err(|e| error("cannot be written", e))?
        .into_temp_path();
    put(target, directory, new, fill)
}

/// The directory of a file, which must be there.
fn directory_of(target: &Path) -> Result<&Path, ImageError> {
    let directory = match target.parent() {
        Some(d) if !d.as_os_str().is_empty() => d,
        _ => Path::new("."),
    };
    if !directory.is_dir() {
        return Err(ImageError::new(
            target,
            format!(
                "cannot be written: there is no directory {}",
                directory.display()
            ),
        ));
    }
    Ok(directory)
}

/// As [`replace`], for a file that is written again and again by a program that may be killed at it: the
/// new content goes to `<target>.new`, so that a killed writer leaves one file, which the next one
/// takes over. Two programs must not write the same target at once.
pub fn replace_again(
    target: &Path,
    fill: impl FnOnce(&Path) -> Result<(), String>,
) -> Result<(), ImageError> {
    let directory = directory_of(target)?;
    let new = unfinished(target);
    let error = |e: std::io::Error| ImageError::new(target, format!("cannot be written: {e}"));
    // Not followed if it is a link, and empty whatever a killed writer left.
    let _ = std::fs::remove_file(&new);
    File::options()
        .write(true)
        .create_new(true)
        .open(&new)
        .map_err(error)?;
    let new = TempPath::try_from_path(new).map_err(error)?;
    put(target, directory, new, fill)
}

/// Where [`replace_again`] writes before it replaces.
pub fn unfinished(target: &Path) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(".new");
    name.into()
}

/// Fills the file, makes sure that it is on the disk, and renames it.
fn put(
    target: &Path,
    directory: &Path,
    new: TempPath,
    fill: impl FnOnce(&Path) -> Result<(), String>,
) -> Result<(), ImageError> {
    let error = |what: &str, e: std::io::Error| ImageError::new(target, format!("{what}: {e}"));
    fill(&new).map_err(|reason| {
        let reason = match probe(&new) {
            Ok(()) => reason,
            Err(e) => format!("{e} ({reason})"),
        };
        ImageError::new(target, format!("cannot be written: {reason}"))
    })?;
    File::open(&new)
        .and_then(|f| f.sync_all())
        .map_err(|e| error("cannot be flushed to the disk", e))?;
    allow_as_usual(&new, target).map_err(|e| error("permissions cannot be set", e))?;
    new.persist(target)
        .map_err(|e| error("cannot be renamed into place", e.error))?;
    // The name is safe once the directory is. Not every file system can do that; the pixels are safe.
    let _ = File::open(directory).and_then(|d| d.sync_all());
    Ok(())
}

/// Asks the disk why a write failed: libraries say little more than that it did.
fn probe(file: &Path) -> std::io::Result<()> {
    let mut file = File::options().append(true).open(file)?;
    file.write_all(&vec![0; 1 << 20])?;
    file.sync_all()
}

/// Temporary files are made private. The result gets the permissions of the file that it replaces, or
/// those that a new file would have had.
#[cfg(unix)]
fn allow_as_usual(new: &Path, target: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let permissions = match std::fs::metadata(target) {
        Ok(old) => old.permissions(),
        Err(_) => std::fs::Permissions::from_mode(0o666 & !umask()),
    };
    std::fs::set_permissions(new, permissions)
}

#[cfg(not(unix))]
fn allow_as_usual(_: &Path, _: &Path) -> std::io::Result<()> {
    Ok(())
}

/// The process's file mode mask. Asking `umask(2)` would change it for a moment, for all threads.
#[cfg(unix)]
fn umask() -> u32 {
    const USUAL: u32 = 0o022;
    let Ok(status) = std::fs::read_to_string("/proc/self/status") else {
        return USUAL;
    };
    status
        .lines()
        .find_map(|l| l.strip_prefix("Umask:"))
        .and_then(|v| u32::from_str_radix(v.trim(), 8).ok())
        .unwrap_or(USUAL)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("a.txt");
        std::fs::write(&target, "old").unwrap();
        let e = replace(&target, |p| {
            std::fs::write(p, "half of the n").unwrap();
            Err("the disk is full".into())
        })
        .unwrap_err();
        assert!(e.reason.contains("the disk is full"), "{e}");
        assert!(e.path.ends_with("a.txt"), "{e}");
        assert_eq!(std::fs::read_to_string(&target).unwrap(), "old");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);

        replace(&target, |p| {
            std::fs::write(p, "new").map_err(|e| e.to_string())
        })
        .unwrap();
        assert_eq!(std::fs::read_to_string(&target).unwrap(), "new");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_directory_is_named() {
        let e = replace(Path::new("/no/such/place/a.exr"), |_| Ok(())).unwrap_err();
        assert!(e.reason.contains("/no/such/place"), "{e}");
    }
}
