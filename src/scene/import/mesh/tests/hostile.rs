//! Files that lie, end early, or are noise: an error or a mesh, never a panic, never much memory.

use super::*;
use crate::math::Pcg32;

fn small() -> Model {
    let mut model = sphere();
    model.triangles = model.triangles.split_off(400);
    model.triangles.truncate(40);
    model
}

fn ply_text(head: &str, body: &str) -> String {
    format!("ply\nformat {head}\nend_header\n{body}")
}

#[test]
fn lying_counts_are_refused_before_memory_is_taken() {
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let faces = "property list uchar int vertex_indices";
    for format in [
        "ascii 1.0",
        "binary_little_endian 1.0",
        "binary_big_endian 1.0",
    ] {
        for count in ["9223372036854775", "900000000000000000", "4000000000"] {
            let head = format!("{format}\nelement vertex {count}\n{xyz}element face 1\n{faces}");
            let text = ply_text(&head, "0 0 0\n0 0 1\n");
            let error = read_text(MeshKind::Ply, &text, &MeshOptions::default()).unwrap_err();
            assert!(error.to_string().contains("promised"), "{error}");
            let head = format!("{format}\nelement vertex 0\n{xyz}element face {count}\n{faces}");
            let text = ply_text(&head, "0 0 0\n0 0 1\n");
            let error = read_text(MeshKind::Ply, &text, &MeshOptions::default()).unwrap_err();
            assert!(error.to_string().contains("promised"), "{error}");
        }
    }
    // A list that promises four thousand million items.
    let head = format!(
        "binary_little_endian 1.0\nelement vertex 1\n{xyz}element face 1\nproperty list uint int vertex_index"
    );
    let mut bytes = ply_text(&head, "").into_bytes();
    bytes.extend([0; 12]);
    bytes.extend([255; 4]);
    let error = read(
        &bytes,
        MeshKind::Ply,
        &MeshOptions::default(),
        Path::new("m"),
    )
    .unwrap_err();
    assert!(error.to_string().contains("ends too early"), "{error}");
}

#[test]
fn a_number_of_rows_is_a_whole_number() {
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let faces = "property list uchar int vertex_indices";
    for count in ["1e9", "1.0", "0x1", "1,000", "-1", "one"] {
        for (vertices, triangles) in [(count, "1"), ("3", count)] {
            let head = format!(
                "ascii 1.0\nelement vertex {vertices}\n{xyz}element face {triangles}\n{faces}"
            );
            let text = ply_text(&head, "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
            let error = read_text(MeshKind::Ply, &text, &MeshOptions::default()).unwrap_err();
            let line = if vertices == count { 3 } else { 7 };
            let place = format!("mesh.txt:{line}:");
            assert!(error.to_string().starts_with(&place), "{count}: {error}");
        }
    }
}

/// The time of each grows with the length of the file, not with its square: with it, they would
/// take minutes.
#[test]
fn many_elements_properties_and_odd_polygons_take_time_in_proportion() {
    let start = std::time::Instant::now();
    let triangle = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let faces = "element face 1\nproperty list uchar int vertex_indices";
    let many = 100_000;
    let others: String = (0..many)
        .map(|i| format!("element e{i} 1\nproperty float p\n"))
        .collect();
    let head = format!("ascii 1.0\n{others}{triangle}{faces}");
    let body = "0\n".repeat(many) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let loaded = read_text(
        MeshKind::Ply,
        &ply_text(&head, &body),
        &MeshOptions::default(),
    );
    assert_eq!(corners(&loaded.unwrap().mesh).len(), 1);
    let values: String = (0..many)
        .map(|i| format!("property float a{i}_0\n"))
        .collect();
    let head = format!("ascii 1.0\n{triangle}{values}{faces}");
    let row = |xyz: &str| format!("{xyz}{}\n", " 1".repeat(many));
    let body = ["0 0 0", "1 0 0", "0 1 0"].map(row).concat() + "3 0 1 2\n";
    let loaded = read_text(
        MeshKind::Ply,
        &ply_text(&head, &body),
        &MeshOptions::default(),
    );
    assert_eq!(loaded.unwrap().mesh.attributes.list.len(), many);
    // Stars of 500 corners that cross themselves have no ears to cut.
    let corner = |i: u32| {
        let angle = f64::from(i * 249 % 500) / 500.0 * std::f64::consts::TAU;
        format!("v {} {} 0\n", angle.cos(), angle.sin())
    };
    let star: String = (0..500).map(corner).collect();
    let face: String = (1..=500).map(|i| format!(" {i}")).collect();
    let warnings = obj(&format!("{star}{}", format!("f{face}\n").repeat(200))).warnings;
    assert!(
        warnings[0].starts_with("200 concave polygons"),
        "{warnings:?}"
    );
    let seconds = start.elapsed().as_secs_f64();
    assert!(seconds < 60.0, "{seconds} s");
}

#[test]
fn indices_out_of_range_are_named_with_their_place() {
    let mut model = small();
    model.triangles[7][1] = 1_000_000;
    let bytes = model.ply_little();
    let head = bytes.len() - model.triangles.len() * 13;
    let error = read(
        &bytes,
        MeshKind::Ply,
        &MeshOptions::default(),
        Path::new("m"),
    )
    .unwrap_err();
    let place = format!("m: byte {}: face 7", head + 7 * 13);
    assert!(error.to_string().starts_with(&place), "{error}");
    let bytes = write::serialized(4, &[model.serialized_part(4, false)]);
    let error = read(
        &bytes,
        MeshKind::Serialized,
        &MeshOptions::default(),
        Path::new("m"),
    );
    assert!(error.unwrap_err().to_string().contains("triangle 7"));
    let error = read(
        &model.ply_ascii(),
        MeshKind::Ply,
        &MeshOptions::default(),
        Path::new("m"),
    );
    assert!(error.unwrap_err().to_string().contains("vertex 1000000"));
}

#[test]
fn every_truncation_of_a_binary_file_is_refused() {
    let model = small();
    let options = MeshOptions::default();
    let serialized = model.serialized_part(4, false);
    let ply = model.ply_little();
    for n in (0..ply.len()).step_by(97).chain([ply.len() - 1]) {
        let result = read(&ply[..n], MeshKind::Ply, &options, Path::new("m"));
        assert!(result.is_err(), "{n}");
    }
    // The last bytes of a zlib stream are its checksum: the data may be complete without it.
    for n in (0..serialized.len() - 16).step_by(97) {
        let result = read(
            &serialized[..n],
            MeshKind::Serialized,
            &options,
            Path::new("m"),
        );
        assert!(result.is_err(), "{n}");
    }
}

/// Cuts, changes, repeats and removes bytes.
fn mutate(bytes: &mut Vec<u8>, rng: &mut Pcg32) {
    let at = |rng: &mut Pcg32, len: usize| (rng.next_u32() as usize) % len.max(1);
    for _ in 0..=rng.next_u32() % 4 {
        let i = at(rng, bytes.len());
        match rng.next_u32() % 6 {
            0 => bytes.truncate(i),
            1 if i < bytes.len() => bytes[i] = rng.next_u32() as u8,
            2 if i < bytes.len() => bytes[i] ^= 1 << (rng.next_u32() % 8),
            3 if i < bytes.len() => bytes[i] = b"0123456789-/.e \n"[(rng.next_u32() % 16) as usize],
            4 if i < bytes.len() => {
                let end = (i + at(rng, 40)).min(bytes.len());
                bytes.drain(i..end);
            }
            _ => {
                let end = (i + at(rng, 40)).min(bytes.len());
                let copy = bytes[i..end].to_vec();
                let to = at(rng, bytes.len());
                bytes.splice(to..to, copy);
            }
        }
    }
}

/// What a mesh promises, however it came about.
fn check(mesh: &Mesh) {
    let positions = mesh.triangles.positions();
    assert!(positions.iter().all(|p| p.is_finite()));
    let count = positions.len();
    assert!(
        mesh.triangles
            .triangles()
            .iter()
            .flatten()
            .all(|&i| (i as usize) < count)
    );
    if let Some(normals) = &mesh.normals {
        assert_eq!(normals.len(), count);
        assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
    }
    assert!(mesh.uvs.as_ref().is_none_or(|uvs| uvs.len() == count));
    for attribute in &mesh.attributes.list {
        let expected = if attribute.per_face {
            mesh.triangles.triangles().len()
        } else {
            count
        };
        assert_eq!(attribute.values.len(), expected, "{}", attribute.name);
    }
}

/// Survivors of 2000 mutations of `seed`, made a file by `wrap`.
fn survivors(kind: MeshKind, seed: &[u8], stream: u64, wrap: impl Fn(Vec<u8>) -> Vec<u8>) -> usize {
    let mut rng = Pcg32::new(7, stream);
    let mut survivors = 0;
    for round in 0..2000 {
        let mut bytes = seed.to_vec();
        mutate(&mut bytes, &mut rng);
        let options = MeshOptions {
            lenient: round % 2 == 0,
            max_smooth_angle: (round % 3 == 0).then_some(40.0),
            ..MeshOptions::default()
        };
        if let Ok(loaded) = read(&wrap(bytes), kind, &options, Path::new("m")) {
            check(&loaded.mesh);
            survivors += 1;
        }
    }
    survivors
}

fn mutations(kind: MeshKind, seed: &[u8], stream: u64) {
    let survivors = survivors(kind, seed, stream, |bytes| bytes);
    // Otherwise only the first check of each reader would have been tested.
    assert!(survivors > 20, "{kind:?}: {survivors}");
}

#[test]
fn mutated_obj_never_panics() {
    mutations(MeshKind::Obj, &small().obj(), 1);
    mutations(
        MeshKind::Obj,
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf -3/-1/-1 2/1 3//1 1\n",
        2,
    );
}

#[test]
fn mutated_ply_never_panics() {
    let mut model = small();
    model.positions.truncate(500);
    mutations(MeshKind::Ply, &model.ply_ascii(), 3);
    mutations(MeshKind::Ply, &model.ply_little(), 4);
    mutations(MeshKind::Ply, &model.ply_big_double(), 5);
    let head = "ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        property float q_0\nelement face 2\nproperty list uchar int vertex_index\nproperty float w_0\n\
        element tristrips 1\nproperty list int int vertex_index";
    let body = "0 0 0 1\n1 0 0 1\n0 1 0 1\n1 1 0 1\n4 0 1 3 2 5\n3 0 1 2 6\n4 0 1 2 3\n";
    mutations(MeshKind::Ply, ply_text(head, body).as_bytes(), 6);
}

#[test]
fn mutated_serialized_never_panics() {
    let model = small();
    for version in [3, 4] {
        let part = model.serialized_part(version, version == 3);
        let file = write::serialized(version, &[part]);
        // Almost no change of compressed data leaves it readable.
        survivors(MeshKind::Serialized, &file, version.into(), |bytes| bytes);
        let inner = model.serialized_inner(version, version == 3);
        let survivors = survivors(MeshKind::Serialized, &inner, version.into(), |bytes| {
            write::serialized(version, &[write::deflate(version, &bytes)])
        });
        assert!(survivors > 20, "{survivors}");
    }
}
