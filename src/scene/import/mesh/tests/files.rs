//! Meshes in files: the project's own, and those by others where they are at hand
//! (`TWINTREE_SHARED_SCENES` names their folder).

use super::*;
use std::path::PathBuf;

fn folder(name: &str) -> Option<PathBuf> {
    let folder = PathBuf::from(std::env::var_os("TWINTREE_SHARED_SCENES")?).join(name);
    folder.is_dir().then_some(folder)
}

#[test]
fn meshes_written_by_mitsuba_load() {
    let Some(torus) = folder("torus/meshes") else {
        eprintln!("skipped: TWINTREE_SHARED_SCENES has no torus");
        return;
    };
    let mut triangles = 0;
    let mut index = 0;
    loop {
        let options = MeshOptions {
            shape_index: index,
            ..MeshOptions::default()
        };
        match load(
            &torus.join("meshes.serialized"),
            MeshKind::Serialized,
            &options,
        ) {
            Ok(loaded) => triangles += loaded.mesh.triangles.triangles().len(),
            Err(e) => {
                assert!(e.message.contains("out of range"), "{e}");
                break;
            }
        }
        index += 1;
    }
    assert!(index > 1 && triangles > 20_000, "{index} {triangles}");
}

#[test]
fn the_kitchen_loads_without_an_error() {
    let Some(kitchen) = folder("kitchen/models") else {
        eprintln!("skipped: TWINTREE_SHARED_SCENES has no kitchen");
        return;
    };
    let mut triangles = 0;
    let mut files: Vec<_> = std::fs::read_dir(kitchen)
        .unwrap()
        .map(|f| f.unwrap().path())
        .collect();
    files.sort();
    for path in &files {
        let loaded = load(path, MeshKind::Obj, &MeshOptions::default());
        let loaded = loaded.unwrap_or_else(|e| panic!("{e}"));
        triangles += loaded.mesh.triangles.triangles().len();
    }
    assert!(triangles > 1_000_000, "{triangles}");
}

#[test]
fn the_project_s_own_meshes_need_no_repair() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut count = 0;
    for scene in std::fs::read_dir(scenes)
        .unwrap()
        .map(|s| s.unwrap().path())
    {
        let Ok(files) = std::fs::read_dir(&scene) else {
            continue;
        };
        for path in files.map(|f| f.unwrap().path()) {
            let Some(kind) = MeshKind::from_path(&path) else {
                continue;
            };
            let loaded = load(&path, kind, &MeshOptions::default());
            let Loaded { mesh, warnings, .. } = loaded.unwrap_or_else(|e| panic!("{e}"));
            assert!(warnings.is_empty(), "{}: {warnings:?}", path.display());
            assert!(area(&mesh) > 0.0);
            count += 1;
        }
    }
    assert!(count >= 20, "{count}");
}
