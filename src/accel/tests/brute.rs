//! The reference: every ray against everything, in `f64`.

use crate::accel::*;
use crate::math::{DAffine3, DVec3};

/// Candidates of one ray: (distance, geometry id, prim, instance, smallest barycentric coordinate).
///
/// A test that compares with a backend forgives a candidate whose `margin` is within rounding of an
/// edge.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    pub t: f64,
    pub u: f64,
    pub v: f64,
    pub shape: u32,
    pub prim: u32,
    pub instance: u32,
    pub margin: f64,
    /// How much a rounding of the vertices moves `t`: 1 over the cosine at which a triangle is met.
    pub slope: f64,
}

/// Everything `ray` crosses between its bounds, nearest first. `slack` widens each triangle by so
/// much in barycentric coordinates.
pub fn crossings(world: &World, ray: &Ray, slack: f64) -> Vec<Candidate> {
    let mut found = Vec::new();
    let mut add = |geometry: &Geometry, ray: &Ray64, instance: u32| {
        cross_geometry(geometry, ray, instance, slack, &mut found);
    };
    let straight = Ray64::new(ray);
    for geometry in &world.geometries {
        add(geometry, &straight, NO_INSTANCE);
    }
    for (index, instance) in world.instances.iter().enumerate() {
        let inverse = widen(&instance.to_world).inverse();
        let moved = Ray64 {
            org: inverse.transform_point3(straight.org),
            dir: inverse.transform_vector3(straight.dir),
            ..straight
        };
        for geometry in &world.groups[instance.group as usize] {
            add(geometry, &moved, index as u32);
        }
    }
    found.sort_by(|a, b| a.t.total_cmp(&b.t));
    found
}

#[derive(Clone, Copy)]
struct Ray64 {
    org: DVec3,
    dir: DVec3,
    tmin: f64,
    tmax: f64,
}

impl Ray64 {
    fn new(ray: &Ray) -> Self {
        Self {
            org: ray.org.as_dvec3(),
            dir: ray.dir.as_dvec3(),
            tmin: f64::from(ray.tmin),
            tmax: f64::from(ray.tmax),
        }
    }
}

fn widen(map: &Affine3A) -> DAffine3 {
    DAffine3::from_cols_array(&map.to_cols_array().map(f64::from))
}

fn cross_geometry(
    geometry: &Geometry,
    ray: &Ray64,
    instance: u32,
    slack: f64,
    found: &mut Vec<Candidate>,
) {
    let mut push = |prim: u32, (t, u, v, margin, slope): (f64, f64, f64, f64, f64)| {
        if t >= ray.tmin && t <= ray.tmax {
            found.push(Candidate {
                t,
                u,
                v,
                shape: geometry.id,
                prim,
                instance,
                margin,
                slope,
            });
        }
    };
    match &geometry.shape {
        Shape::Triangles(mesh) => {
            for prim in 0..mesh.triangles().len() as u32 {
                let corners = mesh.corners(prim).map(|c| c.as_dvec3());
                if let Some(hit) = triangle(ray, corners, slack) {
                    push(prim, hit);
                }
            }
        }
        Shape::Analytic(shape) => {
            for (t, u, v, margin) in exact(shape, ray) {
                push(0, (t, u, v, margin, 1.0));
            }
        }
    }
}

/// Moeller and Trumbore in `f64`.
fn triangle(ray: &Ray64, [a, b, c]: [DVec3; 3], slack: f64) -> Option<(f64, f64, f64, f64, f64)> {
    let (e1, e2) = (b - a, c - a);
    let p = ray.dir.cross(e2);
    let det = e1.dot(p);
    if det == 0.0 {
        return None;
    }
    let s = ray.org - a;
    let u = s.dot(p) / det;
    let q = s.cross(e1);
    let v = ray.dir.dot(q) / det;
    let margin = u.min(v).min(1.0 - u - v);
    let slope = e1.cross(e2).length() * ray.dir.length() / det.abs();
    (margin >= -slack).then(|| (e2.dot(q) / det, u, v, margin, slope))
}

/// Both crossings of an exact shape, by the textbook's formulas in the shape's own space.
fn exact(shape: &AnalyticShape, ray: &Ray64) -> Vec<(f64, f64, f64, f64)> {
    let inverse = widen(&shape.to_world).inverse();
    let o = inverse.transform_point3(ray.org);
    let d = inverse.transform_vector3(ray.dir);
    let angle = |p: DVec3| (p.y.atan2(p.x) / std::f64::consts::TAU).rem_euclid(1.0);
    let quadratic = |a: f64, b: f64, c: f64| {
        let root = (b * b - a * c).sqrt();
        [(-b - root) / a, (-b + root) / a]
    };
    let roots = match shape.kind {
        AnalyticKind::Sphere => quadratic(d.dot(d), o.dot(d), o.dot(o) - 1.0),
        AnalyticKind::Cylinder => quadratic(
            d.x * d.x + d.y * d.y,
            o.x * d.x + o.y * d.y,
            o.x * o.x + o.y * o.y - 1.0,
        ),
        _ => [-o.z / d.z, f64::NAN],
    };
    let at = |t: f64| {
        let p = o + d * t;
        match shape.kind {
            AnalyticKind::Sphere => (
                t,
                angle(p),
                p.z.clamp(-1.0, 1.0).acos() / std::f64::consts::PI,
                1.0,
            ),
            AnalyticKind::Cylinder => (t, angle(p), p.z, p.z.min(1.0 - p.z)),
            AnalyticKind::Disk => {
                let r = p.truncate().length();
                (t, r, angle(p), 1.0 - r)
            }
            AnalyticKind::Rectangle => (
                t,
                0.5 * (p.x + 1.0),
                0.5 * (p.y + 1.0),
                1.0 - p.x.abs().max(p.y.abs()),
            ),
        }
    };
    roots
        .into_iter()
        .filter(|t| t.is_finite())
        .map(at)
        .filter(|h| h.3 >= 0.0)
        .collect()
}
