//! Tests of the mesh readers, against meshes written here.

mod cleaning;
mod files;
mod formats;
mod hostile;
mod shading;
mod write;

use super::*;
use write::Model;

fn read_text(kind: MeshKind, text: &str, options: &MeshOptions) -> Result<Loaded, ImportError> {
    read(text.as_bytes(), kind, options, Path::new("mesh.txt"))
}

fn obj(text: &str) -> Loaded {
    let loaded = read_text(MeshKind::Obj, text, &MeshOptions::default());
    loaded.unwrap_or_else(|e| panic!("{e}"))
}

fn obj_error(text: &str) -> String {
    let loaded = read_text(MeshKind::Obj, text, &MeshOptions::default());
    loaded.err().map(|e| e.to_string()).unwrap_or_default()
}

/// The corners of all triangles: equal for equal surfaces, however their vertices are numbered.
fn corners(mesh: &Mesh) -> Vec<[Vec3; 3]> {
    let count = mesh.triangles.triangles().len() as u32;
    (0..count).map(|i| mesh.triangles.corners(i)).collect()
}

/// A vertex value at the corners of all triangles.
fn at_corners<T: Copy>(mesh: &Mesh, values: &[T]) -> Vec<[T; 3]> {
    let triangles = mesh.triangles.triangles().iter();
    triangles.map(|t| t.map(|i| values[i as usize])).collect()
}

fn area(mesh: &Mesh) -> f64 {
    let triangles = mesh.triangles.triangles().iter();
    let twice = triangles.map(|t| normals::cross(mesh.triangles.positions(), t).length());
    twice.sum::<f64>() / 2.0
}

/// A sphere of unit radius with normals, texture coordinates and colours.
fn sphere() -> Model {
    let (rings, sides) = (24, 48);
    let mut model = Model::default();
    for ring in 0..=rings {
        for side in 0..=sides {
            let v = ring as f64 / rings as f64;
            let u = side as f64 / sides as f64;
            let (theta, phi) = (v * std::f64::consts::PI, u * std::f64::consts::TAU);
            let p = DVec3::new(
                theta.sin() * phi.cos(),
                theta.sin() * phi.sin(),
                theta.cos(),
            );
            model.positions.push(p.as_vec3());
            model.normals.push(p.as_vec3());
            model.uvs.push(Vec2::new(u as f32, v as f32));
            model.colors.push(Vec3::new(u as f32, v as f32, 0.25));
        }
    }
    for ring in 0..rings {
        for side in 0..sides {
            let a = ring * (sides + 1) + side;
            let b = a + sides + 1;
            model.triangles.push([a, b, b + 1]);
            model.triangles.push([a, b + 1, a + 1]);
        }
    }
    model
}
