//! Files that are either the old or the new, never half of one.
//!
//! The new content goes to a file of another name in the same directory, is flushed to the disk and
//! only then renamed over the target. Whatever fails before leaves the target as it was and removes
//! the other file. A symbolic link stays, and what it names is replaced. What is no file (a pipe, a
//! device) is never replaced.

use super::ImageError;
use super::passing::Passing;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// Calls `fill` with the name of an empty file beside `target` (and with its extension), then puts
/// that file in the place of `target`. The error of `fill`, or of the disk, names `target`.
pub fn replace(
    target: &Path,
    fill: impl FnOnce(&Path) -> Result<(), String>,
) -> Result<(), ImageError> {
    let place = writable(target)?;
    let make = || {
        let suffix = place.extension().filter(|e| e.len() <= LONGEST_SUFFIX);
        let suffix = suffix.map(|e| format!(".{}", e.to_string_lossy()));
        tempfile::Builder::new()
            .prefix(".twintree-")
            .suffix(&suffix.unwrap_or_default())
            .tempfile_in(directory_of(&place))
            .map(|file| file.into_temp_path())
    };
    put(target, &place, make, fill)
}

/// Longest ending of a name that the passing name shares: readers tell formats by it.
const LONGEST_SUFFIX: usize = 16;

/// Where a file that is written as `target` comes to lie: a symbolic link is followed, for what it
/// names is replaced and not the link. The file need not be there, its directory must.
///
/// # Errors
/// When the system refuses, what is there is no regular file, or it may not be written to. What is
/// wrong is said without the name.
pub fn destination(target: &Path) -> Result<PathBuf, String> {
    let place = followed(target).map_err(|e| e.to_string())?;
    let directory = directory_of(&place);
    if !directory.is_dir() {
        return Err(format!("there is no directory {}", directory.display()));
    }
    match std::fs::metadata(&place) {
        Ok(there) if there.is_dir() => Err("it is a directory".into()),
        Ok(there) if !there.is_file() => {
            Err("it is no regular file, and would be replaced by one".into())
        }
        Ok(there) if there.permissions().readonly() => {
            Err("there is a file of that name that is read-only".into())
        }
        // Neither changes the file, nor the time at which it was changed.
        Ok(_) => match File::options().append(true).open(&place) {
            Ok(_) => Ok(place),
            Err(e) => Err(format!("there is a file of that name: {e}")),
        },
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(place),
        Err(e) => Err(e.to_string()),
    }
}

/// Where a chain of symbolic links ends.
fn followed(target: &Path) -> io::Result<PathBuf> {
    /// As many links as Linux follows.
    const MOST_LINKS: usize = 40;
    let mut place = target.to_owned();
    for _ in 0..MOST_LINKS {
        match std::fs::symlink_metadata(&place) {
            Ok(there) if there.is_symlink() => {}
            _ => return Ok(place),
        }
        // An absolute path replaces the directory of the link.
        place = directory_of(&place).join(std::fs::read_link(&place)?);
    }
    Err(io::Error::other("too many symbolic links"))
}

/// The directory of a file.
fn directory_of(file: &Path) -> &Path {
    match file.parent() {
        Some(d) if !d.as_os_str().is_empty() => d,
        _ => Path::new("."),
    }
}

/// [`destination`], with an error that names the target.
fn writable(target: &Path) -> Result<PathBuf, ImageError> {
    destination(target).map_err(|e| ImageError::new(target, format!("cannot be written: {e}")))
}

/// As [`replace`], for a file that is written again and again by a program that may be killed at
/// it: the new content goes to `<target>.new`, so that a killed writer leaves one file, which the
/// next one takes over. Two programs must not write the same target at once.
pub fn replace_again(
    target: &Path,
    fill: impl FnOnce(&Path) -> Result<(), String>,
) -> Result<(), ImageError> {
    let place = writable(target)?;
    let new = unfinished(&place);
    let make = || {
        // Not followed if it is a link, and empty whatever a killed writer left.
        let _ = std::fs::remove_file(&new);
        let create = File::options().write(true).create_new(true).open(&new);
        create.and_then(|_| TempPath::try_from_path(new))
    };
    put(target, &place, make, fill)
}

/// Takes away a file that [`replace_again`] has written, and what a writer left that was killed.
pub fn remove(target: &Path) {
    let place = followed(target).unwrap_or_else(|_| target.to_owned());
    // Neither need be there.
    let _ = std::fs::remove_file(unfinished(&place));
    let _ = std::fs::remove_file(place);
}

/// Where [`replace_again`] writes before it replaces.
pub fn unfinished(target: &Path) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(".new");
    name.into()
}

/// Makes a file, fills it, makes sure that it is on the disk, and renames it.
fn put(
    target: &Path,
    place: &Path,
    make: impl FnOnce() -> io::Result<TempPath>,
    fill: impl FnOnce(&Path) -> Result<(), String>,
) -> Result<(), ImageError> {
    let error = |what: &str, e: io::Error| ImageError::new(target, format!("{what}: {e}"));
    let (new, _passing) = Passing::make(make).map_err(|e| error("cannot be written", e))?;
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
    allow_as_usual(&new, place).map_err(|e| error("permissions cannot be set", e))?;
    new.persist(place)
        .map_err(|e| error("cannot be renamed into place", e.error))?;
    // The name is safe once the directory is. Not every file system can do that; the pixels are
    // safe.
    let _ = File::open(directory_of(place)).and_then(|d| d.sync_all());
    Ok(())
}

/// Asks the disk why a write failed: libraries say little more than that it did.
fn probe(file: &Path) -> io::Result<()> {
    let mut file = File::options().append(true).open(file)?;
    file.write_all(&vec![0; 1 << 20])?;
    file.sync_all()
}

/// Temporary files are made private. The result gets the permissions of the file that it replaces,
/// or those that a new file would have had.
#[cfg(unix)]
fn allow_as_usual(new: &Path, target: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let permissions = match std::fs::metadata(target) {
        Ok(old) => old.permissions(),
        Err(_) => std::fs::Permissions::from_mode(0o666 & !umask()),
    };
    std::fs::set_permissions(new, permissions)
}

#[cfg(not(unix))]
fn allow_as_usual(_: &Path, _: &Path) -> io::Result<()> {
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

    fn write(target: &Path, text: &str) -> Result<(), ImageError> {
        replace(target, |p| {
            std::fs::write(p, text).map_err(|e| e.to_string())
        })
    }

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

        write(&target, "new").unwrap();
        assert_eq!(std::fs::read_to_string(&target).unwrap(), "new");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_directory_is_named() {
        let e = replace(Path::new("/no/such/place/a.exr"), |_| Ok(())).unwrap_err();
        assert!(e.reason.contains("/no/such/place"), "{e}");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_what_it_names_is_replaced() {
        use std::os::unix::fs::symlink;
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        std::fs::create_dir(at("far")).unwrap();
        // Relative to its own directory, and by way of another link; the first time there is no
        // file yet.
        symlink("far/b.txt", at("middle.txt")).unwrap();
        symlink(at("middle.txt"), at("a.txt")).unwrap();
        for text in ["one", "two"] {
            write(&at("a.txt"), text).unwrap();
            assert_eq!(std::fs::read_to_string(at("far/b.txt")).unwrap(), text);
            let link = std::fs::symlink_metadata(at("a.txt")).unwrap();
            assert!(link.is_symlink());
        }
        symlink("loop.txt", at("loop.txt")).unwrap();
        let e = write(&at("loop.txt"), "three").unwrap_err();
        assert!(e.reason.contains("links"), "{e}");
        replace_again(&at("a.txt"), |p| {
            std::fs::write(p, "four").map_err(|e| e.to_string())
        })
        .unwrap();
        assert_eq!(std::fs::read_to_string(at("far/b.txt")).unwrap(), "four");
        remove(&at("a.txt"));
        assert!(!at("far/b.txt").exists());
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_file_or_is_read_only_is_not_replaced() {
        let dir = tempfile::tempdir().unwrap();
        let socket = dir.path().join("socket.exr");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        let e = write(&socket, "new").unwrap_err();
        assert!(e.reason.contains("no regular file"), "{e}");
        let locked = dir.path().join("locked.exr");
        std::fs::write(&locked, "old").unwrap();
        let mut permissions = std::fs::metadata(&locked).unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(&locked, permissions).unwrap();
        let e = write(&locked, "new").unwrap_err();
        assert!(e.reason.contains("read-only"), "{e}");
        assert_eq!(std::fs::read_to_string(&locked).unwrap(), "old");
        let long = dir.path().join(format!("{}.exr", "x".repeat(260)));
        let e = write(&long, "new").unwrap_err();
        assert!(e.reason.contains("too long"), "{e}");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 2);
    }
}
