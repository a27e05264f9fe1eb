//! Lamps of a given power.
//!
//! pbrt makes a light of every triangle of a mesh, and each gets the whole power that the scene
//! gives: its radiance follows from its own area. Exact shapes get it as a whole.

use super::pending::Glow;
use crate::accel::{AnalyticKind, AnalyticShape};
use crate::math::{DVec3, Rgb, Vec3};
use crate::scene::{Geometry, Mesh};
use crate::texture::{MeshAttribute, Texture};
use std::f64::consts::PI;
use std::sync::Arc;

/// Name of the attribute of faces that makes their powers the same.
const SHARE: &str = "face_radiance_per_power";
/// Steps around a stretched round shape, for its area.
const STEPS: u32 = 256;

/// The radiance of a shape whose triangles, or which as a whole, emits `power`.
pub(super) fn spread(glow: &Glow, power: f32, geometry: &mut Geometry) -> Texture {
    let sides = if glow.both_sides { 2.0 } else { 1.0 };
    let per_area = |area: f64| (f64::from(power) / (sides * PI * area)) as f32;
    match geometry {
        Geometry::Analytic(shape) => {
            let factor = per_area(area(shape));
            glow.radiance.clone().scaled(Rgb::splat(finite(factor)))
        }
        Geometry::Mesh(mesh) => {
            let triangles = mesh.triangles.clone();
            let factors = (0..triangles.triangles().len() as u32).map(|prim| {
                let [a, b, c] = triangles.corners(prim).map(Vec3::as_dvec3);
                finite(per_area(0.5 * (b - a).cross(c - a).length()))
            });
            let values: Vec<Rgb> = factors.map(Rgb::splat).collect();
            *mesh = Arc::new(with_attribute(mesh, values));
            glow.radiance
                .clone()
                .times(Texture::MeshAttribute(SHARE.into()))
        }
    }
}

fn finite(x: f32) -> f32 {
    if x.is_finite() { x } else { 0.0 }
}

/// A mesh with one more attribute of its faces; what is large is shared.
fn with_attribute(mesh: &Mesh, values: Vec<Rgb>) -> Mesh {
    let mut attributes = mesh.attributes.clone();
    attributes.list.push(MeshAttribute {
        name: SHARE.into(),
        per_face: true,
        values,
    });
    Mesh {
        triangles: mesh.triangles.clone(),
        normals: mesh.normals.clone(),
        tangents: mesh.tangents.clone(),
        uvs: mesh.uvs.clone(),
        attributes,
    }
}

/// The area of an exact shape, by fine facets where it is stretched.
fn area(shape: &AnalyticShape) -> f64 {
    let m = &shape.to_world.matrix3;
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(|axis| Vec3::from(axis).as_dvec3());
    match shape.kind {
        AnalyticKind::Rectangle => 4.0 * x.cross(y).length(),
        AnalyticKind::Disk => PI * x.cross(y).length(),
        AnalyticKind::Cylinder => {
            let step = 2.0 * PI / f64::from(STEPS);
            let side = |i: u32| {
                let phi = (f64::from(i) + 0.5) * step;
                let along = y * phi.cos() - x * phi.sin();
                along.cross(z).length() * step
            };
            (0..STEPS).map(side).sum()
        }
        AnalyticKind::Sphere => {
            // The area element of a linear map is the length of its cofactor times the normal.
            let cofactor = [y.cross(z), z.cross(x), x.cross(y)];
            let stretched =
                |n: DVec3| (cofactor[0] * n.x + cofactor[1] * n.y + cofactor[2] * n.z).length();
            let mut sum = 0.0;
            for i in 0..STEPS {
                let cos = (f64::from(i) + 0.5) / f64::from(STEPS) * 2.0 - 1.0;
                let sin = (1.0 - cos * cos).sqrt();
                for j in 0..STEPS {
                    let phi = (f64::from(j) + 0.5) / f64::from(STEPS) * 2.0 * PI;
                    sum += stretched(DVec3::new(sin * phi.cos(), sin * phi.sin(), cos));
                }
            }
            sum * 4.0 * PI / f64::from(STEPS * STEPS)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Affine3A;

    #[test]
    fn areas_are_those_of_the_books() {
        let of = |kind, scale: Vec3| area(&AnalyticShape::new(kind, Affine3A::from_scale(scale)));
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
        near(of(AnalyticKind::Sphere, Vec3::splat(2.0)), 16.0 * PI);
        near(
            of(AnalyticKind::Cylinder, Vec3::new(2.0, 2.0, 3.0)),
            12.0 * PI,
        );
        near(of(AnalyticKind::Disk, Vec3::new(2.0, 3.0, 1.0)), 6.0 * PI);
        near(of(AnalyticKind::Rectangle, Vec3::new(2.0, 3.0, 1.0)), 24.0);
        // A prolate spheroid of semi-axes 1, 1, 2.
        let e = (3.0f64 / 4.0).sqrt();
        let prolate = 2.0 * PI * (1.0 + 2.0 / e * e.asin());
        near(of(AnalyticKind::Sphere, Vec3::new(1.0, 1.0, 2.0)), prolate);
    }
}
