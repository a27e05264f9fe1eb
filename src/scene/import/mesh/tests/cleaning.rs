//! What is repaired, what is refused, and in which words.

use super::*;

#[test]
fn triangles_without_area_are_dropped_and_counted() {
    let text = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 4\nf 1 2 3\nf 1 1 4\nf 2 3 4\n";
    let Loaded { mesh, warnings, .. } = obj(text);
    assert_eq!(mesh.triangles.triangles(), &[[0, 1, 3], [1, 2, 3]]);
    assert_eq!(warnings.len(), 1);
    assert!(
        warnings[0].starts_with("2 triangles without area"),
        "{warnings:?}"
    );
    assert!(warnings[0].contains("triangle 1"), "{warnings:?}");
}

#[test]
fn a_position_that_is_not_finite_is_named() {
    for bad in ["nan", "inf", "1e300"] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 {bad} 0\nf 1 2 3\nf 1 2 4\n");
        let error = obj_error(&text);
        assert!(error.contains("vertex 3"), "{error}");
        assert!(error.contains("not finite"), "{error}");
        let options = MeshOptions {
            lenient: true,
            ..MeshOptions::default()
        };
        let Loaded { mesh, warnings, .. } = read_text(MeshKind::Obj, &text, &options).unwrap();
        assert_eq!(mesh.triangles.triangles().len(), 1);
        assert!(mesh.triangles.positions().iter().all(|p| p.is_finite()));
        assert!(
            warnings[0].starts_with("1 triangles dropped"),
            "{warnings:?}"
        );
    }
}

#[test]
fn unusable_normals_take_the_surface_s() {
    for bad in ["0 0 0", "nan 0 0"] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 1 1\nvn {bad}\nf 1//1 2//2 3//2\n");
        let Loaded { mesh, warnings, .. } = obj(&text);
        let normals = mesh.normals.unwrap();
        assert!(normals[0].distance(Vec3::new(0.0, 0.5, 0.5).normalize()) < 1e-6);
        assert_eq!(normals[1..], [Vec3::Z; 2]);
        assert!(
            warnings[0].starts_with("2 vertices without"),
            "{warnings:?}"
        );
    }
}

#[test]
fn values_that_are_not_finite_become_zero() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty float u\nproperty float v\nproperty float r\nproperty float g\n\
        property float b\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 nan 0 1 1 1\n1 0 0 0 inf 1 1 1\n0 1 0 1 1 -inf 1 1\n3 0 1 2\n";
    let loaded = read_text(MeshKind::Ply, text, &MeshOptions::default()).unwrap();
    let uvs = loaded.mesh.uvs.unwrap();
    assert_eq!(*uvs, [Vec2::ZERO, Vec2::ZERO, Vec2::ONE]);
    assert_eq!(loaded.mesh.attributes.list[0].values[2], Vec3::ZERO);
    assert_eq!(loaded.warnings.len(), 2, "{:?}", loaded.warnings);
}

#[test]
fn text_errors_name_line_and_column() {
    let cases = [
        ("v 0 0 0\nv 1 x 0\n", "mesh.txt:2:5", "`x`"),
        ("v 0 0\n", "mesh.txt:1:6", "end of the line"),
        ("v 0 0 0\nv 1 0 0\nf 1 2\n", "mesh.txt:3:2", "three corners"),
        (
            "v 0 0 0\nv 1 0 0\nf 1 2 3\n",
            "mesh.txt:3:7",
            "the file has 2 positions",
        ),
        ("v 0 0 0\nv 1 0 0\nf 1 0 2\n", "mesh.txt:3:5", "number 0"),
        (
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\n#\nf 1/1 2/1 3/2\n",
            "mesh.txt:6:11",
            "coordinates",
        ),
        ("v 0 0 0\nf 1//1 1//1 1//-1\n", "mesh.txt:2:3", "normals"),
        ("v 0 0 0\nf 1/a 1 1\n", "mesh.txt:2:5", "whole number"),
    ];
    for (text, place, words) in cases {
        let error = obj_error(text);
        assert!(error.starts_with(place), "{text}: {error}");
        assert!(error.contains(words), "{text}: {error}");
    }
}

#[test]
fn empty_files_are_refused_in_words() {
    let options = MeshOptions::default();
    assert!(obj_error("").contains("no triangle"));
    assert!(obj_error("v 0 0 0\n").contains("no triangle"));
    let error = read_text(MeshKind::Ply, "", &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("not a PLY file"), "{error}");
    let error = read_text(MeshKind::Serialized, "", &options).unwrap_err();
    assert!(error.to_string().contains("ends before"), "{error}");
    let missing = load(Path::new("no/such/file.obj"), MeshKind::Obj, &options);
    let error = missing.unwrap_err().to_string();
    assert!(
        error.starts_with("no/such/file.obj: cannot be read"),
        "{error}"
    );
    let lenient = MeshOptions {
        lenient: true,
        ..options
    };
    let loaded = read_text(MeshKind::Obj, "v 0 0 0\n", &lenient).unwrap();
    assert!(loaded.mesh.triangles.triangles().is_empty());
}

#[test]
fn files_load_from_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.PLY");
    std::fs::write(&path, sphere().ply_little()).unwrap();
    let kind = MeshKind::from_path(&path).unwrap();
    let mesh = load(&path, kind, &MeshOptions::default()).unwrap().mesh;
    assert!((area(&mesh) / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.01);
    let empty = folder.path().join("empty.obj");
    std::fs::write(&empty, "").unwrap();
    assert!(load(&empty, MeshKind::Obj, &MeshOptions::default()).is_err());
    assert!(load(folder.path(), MeshKind::Obj, &MeshOptions::default()).is_err());
}

/// `count` times one triangle among `others` that stand apart, each with a colour of its face.
fn crowded(count: usize, others: usize) -> Raw {
    let mut raw = Raw::default();
    for i in 0..others + count {
        let x = if i % 2 == 0 && i / 2 < count {
            0.0
        } else {
            i as f32
        };
        let corners = [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]].map(Vec3::from);
        // The same triangle from any of its corners.
        let start = raw.positions.len() as u32;
        raw.positions.extend(corners);
        let mut triangle = [start, start + 1, start + 2];
        triangle.rotate_left(i % 3);
        raw.triangles.push(triangle);
    }
    raw.attributes.push(MeshAttribute {
        name: "face_n".into(),
        per_face: true,
        values: (0..others + count)
            .map(|i| crate::math::Rgb::splat(i as f32))
            .collect(),
    });
    raw
}

#[test]
fn many_triangles_in_one_place_become_one() {
    let options = MeshOptions::default();
    let clean = |raw| clean::finish(raw, &options).unwrap();
    let loaded = clean(crowded(20_000, 20_000));
    let triangles = loaded.mesh.triangles.triangles();
    assert_eq!(triangles.len(), 20_001);
    assert_eq!(loaded.mesh.attributes.list[0].values.len(), 20_001);
    assert!(
        loaded.warnings[0].starts_with("19999 triangles dropped"),
        "{:?}",
        loaded.warnings
    );
    // One in five hundred shows; two in a mesh of others are left alone, as are both sides of a
    // sheet.
    assert_eq!(
        clean(crowded(100, 50_000)).mesh.triangles.triangles().len(),
        50_001
    );
    assert_eq!(clean(crowded(2, 5_000)).warnings, Vec::<String>::new());
    let mut sheet = crowded(0, 2_000);
    let back: Vec<[u32; 3]> = sheet.triangles.iter().map(|t| [t[0], t[2], t[1]]).collect();
    sheet.triangles.extend(back);
    sheet.attributes.clear();
    assert_eq!(clean(sheet).mesh.triangles.triangles().len(), 4_000);
}
