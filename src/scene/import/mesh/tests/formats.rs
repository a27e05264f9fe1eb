//! Every format gives the same mesh, and each its own rules.

use super::*;

fn loaded(kind: MeshKind, bytes: &[u8], options: &MeshOptions) -> Loaded {
    read(bytes, kind, options, Path::new("mesh")).unwrap_or_else(|e| panic!("{kind:?}: {e}"))
}

fn all_files(model: &Model) -> Vec<(MeshKind, Vec<u8>)> {
    let parts = [false, true].map(|double| model.serialized_part(4, double));
    let old = model.serialized_part(3, false);
    vec![
        (MeshKind::Obj, model.obj()),
        (MeshKind::Ply, model.ply_ascii()),
        (MeshKind::Ply, model.ply_little()),
        (MeshKind::Ply, model.ply_big_double()),
        (MeshKind::Serialized, write::serialized(4, &parts)),
        (MeshKind::Serialized, write::serialized(3, &[old])),
    ]
}

#[test]
fn all_formats_give_the_same_mesh() {
    let model = sphere();
    let options = MeshOptions {
        to_world: DAffine3::from_scale_rotation_translation(
            DVec3::new(1.0, 2.0, 0.5),
            glam::DQuat::from_rotation_x(0.3),
            DVec3::new(10.0, -3.0, 0.1),
        ),
        flip_tex_coords: true,
        ..MeshOptions::default()
    };
    let inverse = options.to_world.matrix3.inverse().transpose();
    // The two poles have triangles without area: one of each pair of a quadrilateral.
    let triangles = model.triangles.len() - 2 * 48;
    for (kind, bytes) in all_files(&model) {
        let Loaded { mesh, warnings, .. } = loaded(kind, &bytes, &options);
        assert_eq!(warnings.len(), 1, "{kind:?}: {warnings:?}");
        assert!(warnings[0].starts_with("96 triangles without area"));
        assert_eq!(mesh.triangles.triangles().len(), triangles);
        let normals = mesh.normals.as_ref().unwrap();
        let uvs = mesh.uvs.as_ref().unwrap();
        let colors = &mesh.attributes.list[0];
        assert_eq!(colors.name, "vertex_color");
        for (i, &p) in mesh.triangles.positions().iter().enumerate() {
            let there = options
                .to_world
                .transform_point3(model.positions[i].as_dvec3());
            assert_eq!(p, there.as_vec3(), "{kind:?}");
            let n = (inverse * model.normals[i].as_dvec3())
                .normalize()
                .as_vec3();
            assert!(n.distance(normals[i]) < 1e-6, "{kind:?}");
            let uv = model.uvs[i];
            assert_eq!(uvs[i], Vec2::new(uv.x, (1.0 - f64::from(uv.y)) as f32));
            assert_eq!(colors.values[i], model.colors[i]);
        }
    }
}

#[test]
fn a_serialized_file_holds_several_meshes() {
    let (small, large) = (tetrahedron(), sphere());
    for version in [3, 4] {
        let parts = [&large, &small].map(|m| m.serialized_part(version, true));
        let bytes = write::serialized(version, &parts);
        let second = MeshOptions {
            shape_index: 1,
            ..MeshOptions::default()
        };
        let mesh = loaded(MeshKind::Serialized, &bytes, &second).mesh;
        assert_eq!(mesh.triangles.positions(), &small.positions[..]);
        let third = MeshOptions {
            shape_index: 2,
            ..MeshOptions::default()
        };
        let error = read(&bytes, MeshKind::Serialized, &third, Path::new("m")).unwrap_err();
        assert!(
            error.to_string().contains("the file has 2 meshes"),
            "{error}"
        );
    }
}

fn tetrahedron() -> Model {
    Model {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        ..Model::default()
    }
}

#[test]
fn obj_streams_with_different_indices_become_one() {
    let mesh = obj(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 2\nvn 0 3 0\n\
         f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/1/2\n",
    )
    .mesh;
    assert_eq!(mesh.triangles.triangles(), &[[0, 1, 2], [0, 2, 3]]);
    let normals = mesh.normals.unwrap();
    assert_eq!(normals, [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Y]);
    assert_eq!(mesh.uvs.unwrap()[3], Vec2::ZERO);
}

#[test]
fn obj_counts_back_from_the_line_with_negative_indices() {
    let text = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\n";
    let mesh = obj(text).mesh;
    assert_eq!(corners(&mesh), [[Vec3::ZERO, Vec3::X, Vec3::Y]]);
}

#[test]
fn obj_blocks_agree_with_one_block() {
    // More than a block of 1 MiB, with negative indices that reach into the block before.
    let mut text = String::new();
    let count = 40_000;
    for i in 0..count {
        let y = f64::from(i) / 64.0;
        text += &format!("v {i} {y} 0 # a comment to fill the block\n");
        if i >= 2 {
            text += if i % 2 == 0 {
                "f -3 -1 -2\n"
            } else {
                "f -3 -2 -1\n"
            };
            text += &format!("v {i} {y} 1\nf {0} {1} -1\n", 2 * i - 1, 2 * i - 3);
        }
    }
    assert!(text.len() > 2 << 20);
    let mesh = obj(&text).mesh;
    for t in mesh.triangles.triangles() {
        let xs = t.map(|i| mesh.triangles.positions()[i as usize].x);
        let spread = xs.iter().fold(f32::NEG_INFINITY, |a, &b| a.max(b))
            - xs.iter().fold(f32::INFINITY, |a, &b| a.min(b));
        assert!(spread <= 3.0, "{xs:?}");
    }
    assert_eq!(mesh.triangles.positions().len(), 2 * count as usize - 2);
}

#[test]
fn obj_reads_what_exporters_write() {
    let text = "mtllib a.mtl\r\nv 0 0 0 1.0\r\nv\t1 0 0\r\nv 1 1 \\\r\n 0\r\nv 0 1 0\r\n\
                vt 0.5\r\ng a b\r\ns off\r\nusemtl x\r\n  f 1/1 2/1 3/1 4/1   # quad\r\nl 1 2\r\n";
    let Loaded { mesh, warnings, .. } = obj(text);
    assert_eq!(warnings, ["1 statements of lines and points are left out"]);
    assert_eq!(mesh.triangles.triangles(), &[[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.uvs.unwrap()[0], Vec2::new(0.5, 0.0));
    assert!(mesh.attributes.list.is_empty());
}

#[test]
fn obj_colours_are_an_attribute() {
    let text = "v 0 0 0\nv 1 0 0 0.1 0.2 0.3\nv 0 1 0 1 2 3\nf 1 2 3\n";
    let list = obj(text).mesh.attributes.list;
    assert_eq!(list[0].name, "vertex_color");
    let expected = [
        Vec3::ONE,
        Vec3::new(0.1, 0.2, 0.3),
        Vec3::new(1.0, 2.0, 3.0),
    ];
    assert_eq!(list[0].values, expected);
}

#[test]
fn numbers_are_the_closest() {
    let words = [
        "0",
        "-0.0",
        "1",
        "+2.5",
        "1e3",
        "1E-3",
        "0.1",
        "123456789.123456789",
        "1e22",
        "1e23",
        "9007199254740993",
        "3.4028235e38",
        "1e-45",
        "0.30000000000000004",
        ".5",
        "5.",
        "-1.7976931348623157e308",
        "4.9e-324",
        "inf",
        "000000000000000000000000001.5",
    ];
    for word in words {
        let text = format!("{word} ");
        let read = text::Cursor::new(text.as_bytes(), 0).number().unwrap();
        let expected: f64 = word.parse().unwrap();
        assert_eq!(read.to_bits(), expected.to_bits(), "{word}");
    }
    for word in ["", "x", "1x", "--1", "1e", ".", "1,5", "0x10"] {
        let text = format!("{word} ");
        assert!(
            text::Cursor::new(text.as_bytes(), 0).number().is_err(),
            "{word}"
        );
    }
}

#[test]
fn ply_reads_any_types_and_skips_the_rest() {
    let mut bytes = b"ply\r\nformat binary_big_endian 1.0\r\nobj_info x\r\n\
        element camera 2\r\nproperty list short double trail\r\nproperty uchar id\r\n\
        element vertex 5\r\nproperty uchar quality\r\nproperty double x\r\nproperty float y\r\n\
        property short z\r\nproperty uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\n\
        element face 2\r\nproperty list uint ushort vertex_index\r\nproperty float w_0\r\n\
        property list uchar float texcoord\r\nend_header\r\n"
        .to_vec();
    for trail in [vec![1.0f64, 2.0], vec![]] {
        bytes.extend((trail.len() as i16).to_be_bytes());
        bytes.extend(trail.iter().flat_map(|t| t.to_be_bytes()));
        bytes.push(7);
    }
    for (x, y, z) in [
        (0.0f64, 0.0f32, 0i16),
        (2.0, 0.0, 0),
        (2.0, 2.0, 0),
        (0.0, 2.0, 0),
        (1.0, 3.0, 0),
    ] {
        bytes.push(9);
        bytes.extend(x.to_be_bytes());
        bytes.extend(y.to_be_bytes());
        bytes.extend(z.to_be_bytes());
        bytes.extend([255, 51, 0]);
    }
    for (face, w) in [(vec![0u16, 1, 2, 4, 3], 0.25f32), (vec![0, 2, 1], 0.5)] {
        bytes.extend((face.len() as u32).to_be_bytes());
        bytes.extend(face.iter().flat_map(|i| i.to_be_bytes()));
        bytes.extend(w.to_be_bytes());
        bytes.extend([1, 0, 0, 0, 0]);
    }
    let mesh = loaded(MeshKind::Ply, &bytes, &MeshOptions::default()).mesh;
    assert_eq!(mesh.triangles.triangles().len(), 4);
    assert!((area(&mesh) - 7.0).abs() < 1e-12);
    let list = &mesh.attributes.list;
    assert_eq!(list[0].name, "vertex_color");
    assert!((list[0].values[0] - Vec3::new(1.0, 0.2, 0.0)).length() < 1e-6);
    assert_eq!((list[1].name.as_str(), list[1].per_face), ("face_w", true));
    let grey = [0.25, 0.25, 0.25, 0.5].map(Vec3::splat);
    assert_eq!(list[1].values, grey);
}

#[test]
fn ply_strips_turn_every_other_triangle() {
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
        property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 0 1 2\n";
    let mesh = read_text(MeshKind::Ply, text, &MeshOptions::default())
        .unwrap()
        .mesh;
    let up = |t: &[u32; 3]| normals::cross(mesh.triangles.positions(), t).z > 0.0;
    assert_eq!(mesh.triangles.triangles().len(), 4);
    assert!(mesh.triangles.triangles().iter().all(up));
}

#[test]
fn polygons_keep_their_area() {
    // An L, a star and a dart: concave, so that the fan around the first corner would fold over.
    let polygons: [&[(f64, f64)]; 3] = [
        &[
            (1.0, 1.0),
            (1.0, 2.0),
            (0.0, 2.0),
            (0.0, 0.0),
            (2.0, 0.0),
            (2.0, 1.0),
        ],
        &[
            (1.0, 0.0),
            (0.2, 0.2),
            (0.0, 1.0),
            (-0.2, 0.2),
            (-1.0, 0.0),
            (-0.2, -0.2),
            (0.0, -1.0),
            (0.2, -0.2),
        ],
        &[(1.0, 0.0), (-1.0, 1.0), (0.0, 0.0), (-1.0, -1.0)],
    ];
    for polygon in polygons {
        for first in 0..polygon.len() {
            let ring: Vec<_> = polygon
                .iter()
                .cycle()
                .skip(first)
                .take(polygon.len())
                .collect();
            let mut text = String::new();
            let mut twice = 0.0;
            for (i, (x, y)) in ring.iter().enumerate() {
                let next = ring[(i + 1) % ring.len()];
                twice += x * next.1 - y * next.0;
                text += &format!("v {x} {y} {}\n", 0.5 * x);
            }
            text += "f";
            (1..=ring.len()).for_each(|i| text += &format!(" {i}"));
            let mesh = obj(&text).mesh;
            let expected = twice / 2.0 * 1.25f64.sqrt();
            assert!((area(&mesh) - expected).abs() < 1e-6, "{text}");
            let up = |t: &[u32; 3]| normals::cross(mesh.triangles.positions(), t).z > 0.0;
            assert!(mesh.triangles.triangles().iter().all(up));
        }
    }
}

#[test]
fn long_concave_polygons_are_cut_without_a_word() {
    // A comb, and a strip that winds itself up: few corners of it are ears at any time.
    let comb = |i: usize| (i as f64, if i % 2 == 0 { 1.0 } else { 50.0 });
    let mut comb: Vec<_> = (0..400).map(comb).collect();
    comb.extend([(400.0, 0.0), (0.0, 0.0)]);
    comb.reverse();
    let turn = |i: usize, r: f64| {
        let angle = i as f64 * 0.25;
        let r = r + i as f64 * 0.1;
        (r * angle.cos(), r * angle.sin())
    };
    let outer = (0..240).map(|i| turn(i, 2.0));
    let inner = (0..240).rev().map(|i| turn(i, 1.0));
    let spiral: Vec<_> = outer.chain(inner).collect();
    for polygon in [comb, spiral] {
        let mut text = String::new();
        let mut twice = 0.0;
        for (i, (x, y)) in polygon.iter().enumerate() {
            let next = polygon[(i + 1) % polygon.len()];
            twice += x * next.1 - y * next.0;
            text += &format!("v {x} {y} 0\n");
        }
        text += "f";
        (1..=polygon.len()).for_each(|i| text += &format!(" {i}"));
        let loaded = obj(&text);
        assert_eq!(loaded.warnings, Vec::<String>::new());
        let error = area(&loaded.mesh) / (twice / 2.0).abs() - 1.0;
        assert!(error.abs() < 1e-5, "{error}");
    }
}

#[test]
fn a_byte_order_mark_and_lines_of_other_systems_change_nothing() {
    let plain = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    let expected = corners(&obj(plain).mesh);
    for odd in [
        format!("\u{feff}{plain}"),
        format!("\u{feff}{}", plain.replace('\n', "\r\n")),
        plain.replace('\n', "\r"),
        // A line is continued with or without blanks around the backslash.
        plain.replace("f 1 2 3 4", "f 1 2\\\n 3 4"),
        plain.replace("f 1 2 3 4", "f 1 2\\\r\n3\\ \n4"),
        plain.replace("v 1 1 0", "v 1\\\n1\\\n0"),
        plain.replace("f 1 2 3 4", "f 1// 2//\\\n 3// 4//"),
    ] {
        let loaded = obj(&odd);
        assert_eq!(corners(&loaded.mesh), expected, "{odd:?}");
        assert_eq!(loaded.warnings, Vec::<String>::new(), "{odd:?}");
    }
    let model = tetrahedron();
    let text = String::from_utf8(model.ply_ascii()).unwrap();
    let same = |bytes: &[u8]| {
        let mesh = loaded(MeshKind::Ply, bytes, &MeshOptions::default()).mesh;
        assert_eq!(mesh.triangles.positions(), &model.positions[..]);
    };
    same(format!("\u{feff}{text}").as_bytes());
    same(text.replace('\n', "\r\n").as_bytes());
    same(text.replace('\n', "\r").as_bytes());
    let mut marked = "\u{feff}".as_bytes().to_vec();
    marked.extend(model.ply_little());
    same(&marked);
    let wide: Vec<u8> = plain.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let wide = [&[0xff, 0xfe], wide.as_slice()].concat();
    for kind in [MeshKind::Obj, MeshKind::Ply] {
        let error = read(&wide, kind, &MeshOptions::default(), Path::new("m")).unwrap_err();
        assert!(error.to_string().contains("UTF-16"), "{error}");
    }
}

#[test]
fn what_an_obj_file_holds_beside_faces_is_counted() {
    let triangle = "o a\ng b\ns off\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(obj(triangle).warnings, Vec::<String>::new());
    let more = "l 1 2\np 1\ncurv 0 1 1 2\nvertex 1 2 3\nfo 1 2 3\n";
    let warnings = obj(&format!("{triangle}{more}")).warnings;
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert!(warnings[0].starts_with("2 statements of lines"));
    assert!(warnings[1].starts_with("1 statements of free-form"));
    assert!(
        warnings[2].contains("the first is line 11 (`vertex`)"),
        "{warnings:?}"
    );
}
