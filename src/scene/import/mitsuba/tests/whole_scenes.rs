//! Whole scenes: the project's own, and others' where they are at hand.

use super::Asked;
use crate::scene::import::{ImportOptions, mitsuba};
use crate::scene::{Description, Geometry};
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn scenes_in(directory: &Path) -> Vec<PathBuf> {
    let Ok(folders) = std::fs::read_dir(directory) else {
        return Vec::new();
    };
    let files = folders
        .filter_map(|f| std::fs::read_dir(f.ok()?.path()).ok())
        .flat_map(|files| files.filter_map(|f| f.ok().map(|f| f.path())));
    let mut scenes: Vec<PathBuf> = files
        .filter(|p| p.extension().is_some_and(|e| e == "xml"))
        .collect();
    scenes.sort();
    scenes
}

fn load(path: &Path, lenient: bool) -> Description {
    let mut options = ImportOptions::new(Arc::new(Asked::default()));
    options.lenient = lenient;
    mitsuba::load(path, &options).unwrap_or_else(|e| panic!("{e}"))
}

fn shared() -> Option<PathBuf> {
    let directory = std::env::var_os("TWINTREE_SHARED_SCENES").map(PathBuf::from);
    let directory = directory.filter(|d| d.is_dir());
    if directory.is_none() {
        eprintln!("skipped: TWINTREE_SHARED_SCENES names no directory");
    }
    directory
}

fn triangles(description: &Description) -> usize {
    let count = |geometry: &Geometry| match geometry {
        Geometry::Mesh(mesh) => mesh.triangles.triangles().len(),
        Geometry::Exact(_) => 0,
    };
    description.shapes.iter().map(|s| count(&s.geometry)).sum()
}

#[test]
fn the_projects_own_scenes_load_without_a_warning() {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let scenes = scenes_in(&directory);
    assert!(scenes.len() >= 7, "{scenes:?}");
    for scene in scenes {
        let description = load(&scene, false);
        assert_eq!(description.warnings, [""; 0], "{}", scene.display());
        assert!(!description.shapes.is_empty());
        assert!(!description.emitters.is_empty());
    }
}

#[test]
fn others_scenes_load() {
    let Some(directory) = shared() else {
        return;
    };
    for scene in scenes_in(&directory) {
        let start = std::time::Instant::now();
        let d = load(&scene, true);
        eprintln!(
            "{}: {} shapes, {} triangles, {} materials, {} emitters, {:?}",
            scene.display(),
            d.shapes.len(),
            triangles(&d),
            d.materials.len(),
            d.emitters.len(),
            start.elapsed()
        );
        for warning in &d.warnings {
            eprintln!("  {warning}");
        }
    }
}
