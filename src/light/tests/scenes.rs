//! Small sets of lights, and rays against them.

use super::*;
use crate::math::DVec3;

/// The bounds most tests use.
pub const BOUNDS: Bounds = Bounds {
    min: Vec3::splat(-2.0),
    max: Vec3::splat(2.0),
};

/// Lights made of shapes that glow, for rays.
pub struct Setup {
    pub lights: Lights,
    pub shapes: Vec<EmitterShape>,
    /// The shape of each emitter; `None` for those without.
    pub of_emitter: Vec<Option<usize>>,
}

pub fn shape(shape: Shape, flip_normals: bool) -> EmitterShape {
    EmitterShape {
        shape,
        uvs: None,
        attributes: None,
        flip_normals,
    }
}

pub fn exact(kind: AnalyticKind, to_world: Affine3A, flip: bool) -> EmitterShape {
    shape(Shape::Analytic(AnalyticShape::new(kind, to_world)), flip)
}

pub fn mesh(positions: &[Vec3], triangles: &[[u32; 3]]) -> EmitterShape {
    let mesh = TriangleMesh::new(positions.to_vec(), triangles.to_vec()).unwrap();
    shape(Shape::Triangles(Arc::new(mesh)), false)
}

/// Each shape with a radiance of its own, then other emitters.
pub fn setup(shapes: Vec<(EmitterShape, Texture)>, others: Vec<Emitter>) -> Setup {
    let (shapes, textures): (Vec<_>, Vec<_>) = shapes.into_iter().unzip();
    let mut of_emitter: Vec<Option<usize>> = (0..shapes.len()).map(Some).collect();
    let mut emitters: Vec<Emitter> = textures
        .into_iter()
        .enumerate()
        .map(|(i, radiance)| Emitter::Area {
            shape: i as u32,
            radiance,
            both_sides: false,
        })
        .collect();
    of_emitter.extend(others.iter().map(|_| None));
    emitters.extend(others);
    Setup {
        lights: Lights::build(emitters, &shapes, BOUNDS, BOUNDS),
        shapes,
        of_emitter,
    }
}

/// A hit of a shape that glows.
#[derive(Clone, Copy, Debug)]
pub struct Met {
    pub t: f32,
    pub emitter: u32,
    pub prim: u32,
    pub q: Vec3,
    pub ng: Vec3,
}

impl Setup {
    /// Every shape along a ray.
    pub fn crossings(&self, p: Vec3, dir: Vec3) -> Vec<Met> {
        let mut found = Vec::new();
        for (emitter, shape) in self.of_emitter.iter().enumerate() {
            let Some(shape) = shape.map(|s| &self.shapes[s]) else {
                continue;
            };
            let side = if shape.flip_normals { -1.0 } else { 1.0 };
            for (t, prim, n) in hits(&shape.shape, p, dir) {
                if t > 1e-4 {
                    found.push(Met {
                        t,
                        emitter: emitter as u32,
                        prim,
                        q: p + dir * t,
                        ng: n.normalize() * side,
                    });
                }
            }
        }
        found
    }

    /// The closest shape along a ray.
    pub fn meet(&self, p: Vec3, dir: Vec3) -> Option<Met> {
        self.crossings(p, dir)
            .into_iter()
            .min_by(|a, b| a.t.total_cmp(&b.t))
    }

    /// Density of the light sampling in a direction, whatever it is blocked by.
    pub fn pdf(&self, p: Vec3, n: Vec3, dir: Vec3) -> f32 {
        let area = |m: &Met| {
            self.lights
                .pdf_area((p, n), &(), (m.emitter, m.prim), (m.q, m.ng))
        };
        let near: f32 = self.crossings(p, dir).iter().map(area).sum();
        near + self.lights.environment_pdf(p, n, dir).1
    }

    /// Radiance along a ray, for radiances that are constant on each shape.
    pub fn radiance(&self, p: Vec3, dir: Vec3) -> Rgb {
        match self.meet(p, dir) {
            Some(m) => {
                let mut point = SurfacePoint::at_uv(Vec2::ZERO);
                point.ng = m.ng;
                self.lights.emitted(m.emitter, &point, -dir)
            }
            None => self.lights.environment(dir),
        }
    }
}

/// Distances, primitives and outward normals (any length) where a ray crosses a shape.
fn hits(shape: &Shape, p: Vec3, dir: Vec3) -> Vec<(f32, u32, Vec3)> {
    match shape {
        Shape::Triangles(mesh) => (0..mesh.triangles().len() as u32)
            .filter_map(|i| {
                let [a, b, c] = mesh.corners(i);
                let (e, f) = (b - a, c - a);
                let m = Mat3::from_cols(e, f, -dir);
                let x = m.inverse() * (p - a);
                let inside = x.x >= 0.0 && x.y >= 0.0 && x.x + x.y <= 1.0;
                inside.then(|| (x.z, i, e.cross(f)))
            })
            .collect(),
        Shape::Analytic(exact) => {
            // In f64: the tests are after the lights' rounding, not this function's.
            let map = exact.to_world;
            let object = glam::DAffine3::from_cols(
                map.matrix3.x_axis.as_dvec3(),
                map.matrix3.y_axis.as_dvec3(),
                map.matrix3.z_axis.as_dvec3(),
                map.translation.as_dvec3(),
            )
            .inverse();
            let o = object.transform_point3(p.as_dvec3());
            let d = object.transform_vector3(dir.as_dvec3());
            let normals = object.matrix3.transpose();
            let mut found = Vec::new();
            let mut add = |t: f64, n: DVec3| found.push((t as f32, 0, (normals * n).as_vec3()));
            match exact.kind {
                AnalyticKind::Disk | AnalyticKind::Rectangle => {
                    let t = -o.z / d.z;
                    let q = o + d * t;
                    let inside = match exact.kind {
                        AnalyticKind::Disk => q.truncate().length() <= 1.0,
                        _ => q.truncate().abs().max_element() <= 1.0,
                    };
                    if inside {
                        add(t, DVec3::Z);
                    }
                }
                AnalyticKind::Sphere => {
                    for t in roots(d.length_squared(), o.dot(d), o.length_squared() - 1.0) {
                        add(t, o + d * t);
                    }
                }
                AnalyticKind::Cylinder => {
                    let (o2, d2) = (o.truncate(), d.truncate());
                    for t in roots(d2.length_squared(), o2.dot(d2), o2.length_squared() - 1.0) {
                        let q = o + d * t;
                        if (0.0..=1.0).contains(&q.z) {
                            add(t, DVec3::new(q.x, q.y, 0.0));
                        }
                    }
                }
            }
            found
        }
    }
}

/// Roots of `a t^2 + 2 b t + c`.
fn roots(a: f64, b: f64, c: f64) -> Vec<f64> {
    let d = b * b - a * c;
    if d < 0.0 {
        return Vec::new();
    }
    let root = d.sqrt();
    vec![(-b - root) / a, (-b + root) / a]
}

pub fn constant(value: f32) -> Texture {
    Texture::Constant(Rgb::new(value, 0.5 * value, 0.2 * value))
}

/// A map that turns and moves, with these scales.
pub fn placed(scale: Vec3, at: Vec3) -> Affine3A {
    let turn = glam::Quat::from_euler(glam::EulerRot::XYZ, 0.4, -0.7, 1.1);
    Affine3A::from_scale_rotation_translation(scale, turn, at)
}

/// A parallelogram as two triangles.
pub fn quad_mesh(corner: Vec3, a: Vec3, b: Vec3) -> EmitterShape {
    mesh(
        &[corner, corner + a, corner + a + b, corner + b],
        &[[0, 1, 2], [0, 2, 3]],
    )
}

/// Triangles of about this size strewn over a box.
pub fn strewn(count: usize, size: f32, seed: u64) -> EmitterShape {
    let mut rng = Pcg32::new(seed, 9);
    let mut within = |r: f32| Vec3::from([(); 3].map(|()| (rng.next_f32() * 2.0 - 1.0) * r));
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..count as u32 {
        let center = within(2.0);
        positions.extend((0..3).map(|_| center + within(size)));
        triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh(&positions, &triangles)
}
