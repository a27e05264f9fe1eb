//! Normals: given, computed, with creases, turned around.

use super::*;

fn without_normals() -> Vec<u8> {
    let mut model = sphere();
    model.normals.clear();
    model.uvs.clear();
    model.colors.clear();
    // The seam and the poles have vertices at equal positions: one of each is kept.
    let first = |p: Vec3| {
        let near = |q: &Vec3| q.distance(p) < 1e-4;
        model.positions.iter().position(near).unwrap() as u32
    };
    let welded: Vec<u32> = model.positions.iter().map(|&p| first(p)).collect();
    for t in &mut model.triangles {
        *t = t.map(|i| welded[i as usize]);
    }
    model.ply_little()
}

fn ply(bytes: &[u8], options: &MeshOptions) -> Mesh {
    let loaded = read(bytes, MeshKind::Ply, options, Path::new("mesh"));
    loaded.unwrap_or_else(|e| panic!("{e}")).mesh
}

#[test]
fn smooth_normals_of_a_sphere_point_outwards() {
    let mesh = ply(&without_normals(), &MeshOptions::default());
    let normals = mesh.normals.as_ref().unwrap();
    for &i in mesh.triangles.triangles().iter().flatten() {
        let p = mesh.triangles.positions()[i as usize];
        // Angle weights leave an error of second order in the size of the faces (0.13).
        assert!(normals[i as usize].distance(p) < 0.006, "{p}");
        assert!((normals[i as usize].length() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn angle_weights_do_not_see_how_a_cube_was_cut() {
    let mesh = obj(CUBE).mesh;
    let third = (1.0f32 / 3.0).sqrt();
    for (p, n) in mesh.triangles.positions().iter().zip(mesh.normals.unwrap()) {
        assert!(n.distance(*p * third) < 1e-6, "{p} {n}");
    }
}

const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

#[test]
fn tiny_and_huge_meshes_have_normals() {
    for scale in [1e-15, 1e-9, 1.0, 1e9, 1e15] {
        let options = MeshOptions {
            to_world: DAffine3::from_scale(DVec3::splat(scale)),
            ..MeshOptions::default()
        };
        let mesh = read_text(MeshKind::Obj, CUBE, &options).unwrap().mesh;
        for (p, n) in mesh.triangles.positions().iter().zip(mesh.normals.unwrap()) {
            assert!(n.distance(p.normalize()) < 1e-5, "{scale} {p} {n}");
        }
    }
}

#[test]
fn a_cube_keeps_its_edges_below_the_smooth_angle() {
    for (degrees, vertices) in [(30.0, 24), (89.0, 24), (90.0, 8), (120.0, 8)] {
        let options = MeshOptions {
            max_smooth_angle: Some(degrees),
            ..MeshOptions::default()
        };
        let mesh = read_text(MeshKind::Obj, CUBE, &options).unwrap().mesh;
        assert_eq!(mesh.triangles.positions().len(), vertices, "{degrees}");
        let normals = mesh.normals.as_ref().unwrap();
        for (prim, corners) in at_corners(&mesh, normals).iter().enumerate() {
            let triangle = &mesh.triangles.triangles()[prim];
            let ng = normals::cross(mesh.triangles.positions(), triangle).normalize();
            for n in corners {
                let cosine = n.as_dvec3().dot(ng);
                let expected = if vertices == 24 {
                    1.0
                } else {
                    (1.0f64 / 3.0).sqrt()
                };
                assert!((cosine - expected).abs() < 1e-6, "{degrees} {cosine}");
            }
        }
    }
}

#[test]
fn creases_see_the_surface_and_not_the_seams_of_the_file() {
    // The same cube, every face with vertices and texture coordinates of its own.
    let mut split = String::new();
    let welded = obj(CUBE).mesh;
    for (i, corner) in corners(&welded).iter().flatten().enumerate() {
        split += &format!("v {} {} {}\nvt {i} 0\n", corner.x, corner.y, corner.z);
    }
    for i in (1..=36).step_by(3) {
        split += &format!("f {i}/{i} {0}/{0} {1}/{1}\n", i + 1, i + 2);
    }
    let options = MeshOptions {
        max_smooth_angle: Some(100.0),
        ..MeshOptions::default()
    };
    let mesh = read_text(MeshKind::Obj, &split, &options).unwrap().mesh;
    let normals = mesh.normals.as_ref().unwrap();
    for (p, n) in mesh.triangles.positions().iter().zip(normals) {
        assert!(n.distance(p.normalize()) < 1e-6);
    }
    let uvs = mesh.uvs.as_ref().unwrap();
    let given: Vec<f32> = at_corners(&mesh, uvs)
        .iter()
        .flatten()
        .map(|uv| uv.x)
        .collect();
    assert_eq!(given, (0..36).map(|i| i as f32).collect::<Vec<_>>());
}

#[test]
fn flat_shading_has_no_normals() {
    let options = MeshOptions {
        face_normals: true,
        ..MeshOptions::default()
    };
    assert!(ply(&sphere().ply_little(), &options).normals.is_none());
    assert!(ply(&without_normals(), &options).normals.is_none());
}

#[test]
fn flipping_turns_winding_and_normals_together() {
    let options = MeshOptions {
        flip_normals: true,
        ..MeshOptions::default()
    };
    for bytes in [sphere().ply_little(), without_normals()] {
        let mesh = ply(&bytes, &options);
        let normals = mesh.normals.as_ref().unwrap();
        for (t, corners) in mesh
            .triangles
            .triangles()
            .iter()
            .zip(at_corners(&mesh, normals))
        {
            let positions = mesh.triangles.positions();
            let ng = normals::cross(positions, t);
            assert!(ng.dot(positions[t[0] as usize].as_dvec3()) < 0.0);
            assert!(corners.iter().all(|n| ng.dot(n.as_dvec3()) > 0.0));
        }
    }
}

/// Normals of the file stay on their side, computed ones and the order of corners follow what was
/// the front before.
#[test]
fn a_mirror_turns_nothing_inside_out() {
    let options = MeshOptions {
        to_world: DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
        ..MeshOptions::default()
    };
    let given = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0.6 0 0.8\nf 1//1 2//2 3//1\n";
    let mesh = read_text(MeshKind::Obj, given, &options).unwrap().mesh;
    assert_eq!(front(&mesh), Vec3::Z);
    let normals = mesh.normals.unwrap();
    assert_eq!(normals[0], Vec3::Z);
    assert!(normals[1].distance(Vec3::new(-0.6, 0.0, 0.8)) < 1e-6);
    let bare = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for face_normals in [false, true] {
        let options = MeshOptions {
            face_normals,
            ..options.clone()
        };
        let mesh = read_text(MeshKind::Obj, bare, &options).unwrap().mesh;
        assert_eq!(front(&mesh), Vec3::Z);
        assert!(mesh.normals.is_none_or(|n| n == [Vec3::Z; 3]));
    }
}

/// Twice the area of the first triangle along its geometric normal.
fn front(mesh: &Mesh) -> Vec3 {
    let triangle = &mesh.triangles.triangles()[0];
    normals::cross(mesh.triangles.positions(), triangle).as_vec3()
}

/// Normals of the file decide, also where only one corner has any; asked for flat faces, the order
/// of corners does.
#[test]
fn given_normals_turn_the_corners() {
    let against = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 -1\nf 1//1 2//1 3//1\n";
    assert_eq!(front(&obj(against).mesh), -Vec3::Z);
    let one = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 -1\nf 1//1 2 3\n";
    let mesh = obj(one).mesh;
    assert_eq!(front(&mesh), -Vec3::Z);
    assert_eq!(mesh.normals.unwrap(), [-Vec3::Z; 3]);
    let flat = MeshOptions {
        face_normals: true,
        ..MeshOptions::default()
    };
    let mesh = read_text(MeshKind::Obj, against, &flat).unwrap().mesh;
    assert_eq!(front(&mesh), Vec3::Z);
}
