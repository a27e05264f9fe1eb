//! Where Open Image Denoise's library is looked for.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Names of the library; the first is that of every version 2.
const NAMES: [&str; 2] = ["libOpenImageDenoise.so.2", "libOpenImageDenoise.so"];
/// Where it is in a release that was unpacked, in an installation, and in Python's package pyoidn.
const FOLDERS: [&str; 4] = ["", "lib", "oidn/lib", "pyoidn/oidn/lib"];
/// The variable that names it.
pub const VARIABLE: &str = "TWINTREE_OIDN";

/// What a person has named: by an option, or else by the variable.
pub fn named(option: Option<&Path>) -> Option<PathBuf> {
    let variable = || env::var_os(VARIABLE).filter(|value| !value.is_empty());
    let option = option.map(Path::to_owned);
    option.or_else(|| variable().map(PathBuf::from))
}

/// The library that a path stands for: the file itself, or one in the folder, which may be that of
/// a release, of the package pyoidn, of Python's packages, or of a Python environment.
pub fn library_at(path: &Path) -> Option<PathBuf> {
    if path.is_file() {
        return whole(path);
    }
    let folders = FOLDERS.map(|folder| path.join(folder));
    let found = folders.iter().find_map(|folder| library_in(folder));
    found.or_else(|| in_environment(path))
}

/// What to try where nobody has named anything, in order: names for the system's loader, then what
/// Python environments have.
pub fn usual() -> Vec<OsString> {
    let mut list: Vec<OsString> = NAMES.map(OsString::from).to_vec();
    let home = env::var_os("HOME").map(|home| Path::new(&home).join(".local"));
    let environments = ["VIRTUAL_ENV", "CONDA_PREFIX"]
        .into_iter()
        .filter_map(env::var_os)
        .map(PathBuf::from)
        .chain(home)
        .chain([PathBuf::from("/usr/local")]);
    let found = environments.filter_map(|folder| in_environment(&folder));
    list.extend(found.map(OsString::from));
    list
}

/// The library of the package pyoidn in a Python environment.
fn in_environment(environment: &Path) -> Option<PathBuf> {
    let entries = std::fs::read_dir(environment.join("lib")).ok()?;
    let pythons = entries.flatten().map(|entry| entry.path());
    let is_python = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("python3")
    };
    let mut pythons: Vec<PathBuf> = pythons.filter(is_python).collect();
    pythons.sort();
    pythons.iter().rev().find_map(|python| {
        let packages = ["site-packages", "dist-packages"].map(|name| python.join(name));
        packages
            .iter()
            .find_map(|folder| library_in(&folder.join("pyoidn/oidn/lib")))
    })
}

fn library_in(folder: &Path) -> Option<PathBuf> {
    let files = NAMES.map(|name| folder.join(name));
    files
        .iter()
        .find(|file| file.is_file())
        .and_then(|f| whole(f))
}

/// The file without links in its path: the library looks for its other files beside itself. And
/// with a folder in its name: without one the loader would look elsewhere.
fn whole(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_file_a_folder_a_package_and_an_environment_lead_to_the_library() {
        let place = tempfile::tempdir().unwrap();
        let root = place.path().canonicalize().unwrap();
        let packages = root.join("env/lib/python3.11/site-packages");
        let folder = packages.join("pyoidn/oidn/lib");
        fs::create_dir_all(&folder).unwrap();
        fs::create_dir_all(root.join("env/lib/python3.9/site-packages")).unwrap();
        let library = folder.join("libOpenImageDenoise.so.2");
        assert_eq!(library_at(&packages), None);
        fs::write(&library, "").unwrap();
        let package = packages.join("pyoidn");
        let release = package.join("oidn");
        let environment = root.join("env");
        for path in [
            &library,
            &folder,
            &release,
            &package,
            &packages,
            &environment,
        ] {
            assert_eq!(library_at(path).as_ref(), Some(&library), "{path:?}");
        }
        assert_eq!(library_at(&root), None);
        let link = root.join("a.so");
        std::os::unix::fs::symlink(&library, &link).unwrap();
        assert_eq!(library_at(&link), Some(library));
    }
}
