//! How the normals that light is scattered by turn along a surface: what bends a pencil of rays
//! besides their angles.

use super::description::Mesh;
use super::surface::{Form, Surface, Surfaces};
use crate::accel::{AnalyticKind, AnalyticShape, Hit, NO_INSTANCE};
use crate::math::{Affine3A, Mat3, Vec2, Vec3};

/// A normal, and its change for each of two moves of its point.
#[derive(Clone, Copy)]
struct Turning {
    n: Vec3,
    by: [Vec3; 2],
}

impl Turning {
    /// Of a normal that need not be of unit length.
    fn of_unit(n: Vec3, by: [Vec3; 2]) -> Self {
        let length = n.length();
        let n = n / length;
        Self {
            n,
            by: by.map(|turn| turn.reject_from_normalized(n) / length),
        }
    }

    /// Through the inverse transpose of the map whose inverse is given, as normals are carried.
    fn carried(self, inverse: &Affine3A) -> Self {
        let map = Mat3::from(inverse.matrix3).transpose();
        Self::of_unit(map * self.n, self.by.map(|turn| map * turn))
    }
}

impl Surfaces {
    /// The change of the unit normal that [`Surfaces::point`] interpolates at a hit, to first
    /// order, for each of two moves of the point `p` along the surface; world space. Not finite
    /// where a surface has no normal.
    pub fn turns(&self, hit: &Hit, p: Vec3, moves: [Vec3; 2]) -> [Vec3; 2] {
        let surface = &self.list[hit.shape as usize];
        let turning = if hit.instance == NO_INSTANCE {
            surface.turning(hit, p, moves)
        } else {
            let (_, to_group) = &self.instances[hit.instance as usize];
            let moves = moves.map(|m| to_group.transform_vector3(m));
            let local = surface.turning(hit, to_group.transform_point3(p), moves);
            local.map(|turning| turning.carried(to_group))
        };
        turning.map_or([Vec3::ZERO; 2], |turning| turning.by)
    }
}

impl Surface {
    /// In the shape's own space; `None` where it is flat.
    fn turning(&self, hit: &Hit, p: Vec3, moves: [Vec3; 2]) -> Option<Turning> {
        match &self.form {
            Form::Mesh(mesh) => of_mesh(mesh, hit, moves),
            Form::Analytic(shape, flip) => of_exact(shape, *flip, p, moves),
        }
    }
}

/// Normals between the corners' are their mean, made a unit vector again.
fn of_mesh(mesh: &Mesh, hit: &Hit, moves: [Vec3; 2]) -> Option<Turning> {
    let normals = mesh.normals.as_ref()?;
    let corners = mesh.triangles.triangles()[hit.prim as usize];
    let [na, nb, nc] = corners.map(|i| normals[i as usize]);
    let [a, b, c] = mesh.triangles.corners(hit.prim);
    let (e1, e2) = (b - a, c - a);
    let across = e1.cross(e2);
    let per_area = across / across.length_squared();
    let by = moves.map(|m| {
        let (u, v) = (m.cross(e2).dot(per_area), e1.cross(m).dot(per_area));
        (nb - na) * u + (nc - na) * v
    });
    let Vec2 { x: u, y: v } = Vec2::new(hit.u, hit.v);
    Some(Turning::of_unit(na * (1.0 - u - v) + nb * u + nc * v, by))
}

/// The unit sphere's normals are its points, the unit cylinder's are those but for the height.
fn of_exact(shape: &AnalyticShape, flip: bool, p: Vec3, moves: [Vec3; 2]) -> Option<Turning> {
    let around = match shape.kind {
        AnalyticKind::Sphere => Vec3::ONE,
        AnalyticKind::Cylinder => Vec3::new(1.0, 1.0, 0.0),
        AnalyticKind::Disk | AnalyticKind::Rectangle => return None,
    };
    let sign = if flip { -around } else { around };
    let n = shape.to_object.transform_point3(p) * sign;
    let by = moves.map(|m| shape.to_object.transform_vector3(m) * sign);
    Some(Turning::of_unit(n, by).carried(&shape.to_object))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Backend, BuildSettings, Ray, TriangleMesh};
    use crate::bsdf::Materials;
    use crate::bsdf::material::Diffuse;
    use crate::math::Rgb;
    use crate::scene::{Description, Geometry, Scene, Shape};
    use crate::texture::Texture;
    use std::sync::Arc;

    fn scene(geometry: Geometry, instance: Option<Affine3A>) -> Scene {
        let mut materials = Materials::default();
        let material = materials.push(Diffuse {
            reflectance: Texture::Constant(Rgb::ONE),
        });
        let mut description = Description {
            shapes: vec![Shape {
                name: String::new(),
                geometry,
                material,
                emitter: None,
                flip_normals: true,
                group: instance.map(|_| 0),
                boundary: None,
            }],
            materials,
            groups: u32::from(instance.is_some()),
            instances: instance.iter().map(|map| (0, map.as_daffine3())).collect(),
            ..Description::empty()
        };
        Scene::build(&mut description, BuildSettings::default(), Backend::Obvhs).unwrap()
    }

    /// Normals where rays beside each other meet a surface, against what the turns of the middle
    /// one say.
    fn expect_turns(name: &str, scene: &Scene, ray: &Ray) {
        let met = |ray: &Ray| {
            let hit = scene.first_hit(ray);
            let met = scene.surfaces.interaction(ray, &hit, 0.0).expect(name);
            (hit, met.point.p, met.point.frame.n)
        };
        let (hit, p, _) = met(ray);
        for aside in [Vec3::new(1.0, 0.3, -0.2), Vec3::new(-0.4, 0.2, 1.0)] {
            let step = aside.reject_from(ray.dir).normalize() * 5e-3;
            let [(_, p1, n1), (_, p2, n2)] =
                [-step, step].map(|s| met(&Ray::new(ray.org + s, ray.dir)));
            let [turn, _] = scene.surfaces.turns(&hit, p, [p2 - p1, Vec3::ZERO]);
            let error = (turn - (n2 - n1)).length();
            assert!((n2 - n1).length() > 1e-4, "{name}: nothing turns");
            assert!(
                error < 0.01 * (n2 - n1).length(),
                "{name}: {turn} instead of {}",
                n2 - n1
            );
        }
    }

    #[test]
    fn normals_turn_as_neighbours_differ() {
        let turn = glam::Quat::from_euler(glam::EulerRot::XYZ, 0.4, -0.7, 1.1);
        let map =
            Affine3A::from_scale_rotation_translation(Vec3::new(0.8, 1.3, 1.1), turn, Vec3::ZERO);
        let ray = Ray::new(Vec3::new(0.1, 0.15, -5.0), Vec3::Z);
        let corners = [
            Vec3::new(-2.0, -2.0, 0.3),
            Vec3::new(2.0, -1.5, 0.0),
            Vec3::new(0.0, 2.0, -0.4),
        ];
        let mesh = Mesh {
            normals: Some(vec![
                Vec3::new(-0.4, -0.3, -1.0).normalize(),
                Vec3::new(0.5, -0.1, -1.0).normalize(),
                Vec3::new(0.1, 0.4, -1.0).normalize(),
            ]),
            triangles: Arc::new(TriangleMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap()),
            ..Mesh::default()
        };
        let mesh = Geometry::Mesh(Arc::new(mesh));
        let exact = |kind| Geometry::Analytic(AnalyticShape::new(kind, map));
        for (name, geometry) in [
            ("triangle", mesh),
            ("ellipsoid", exact(AnalyticKind::Sphere)),
            ("cylinder", exact(AnalyticKind::Cylinder)),
        ] {
            expect_turns(name, &scene(geometry.clone(), None), &ray);
            let placed =
                Affine3A::from_scale(Vec3::new(1.0, 0.7, 1.2)) * Affine3A::from_rotation_x(0.2);
            expect_turns(
                &format!("{name} in an instance"),
                &scene(geometry, Some(placed)),
                &ray,
            );
        }
    }
}
