//! Masked geometry: the right share passes, and everybody agrees on which rays.

use super::worlds::*;
use crate::accel::*;
use crate::math::{Affine3A, Pcg32, Vec3};
use std::sync::Arc;

/// The same opacity everywhere.
struct Constant(f32);

impl Opacity for Constant {
    fn opacity(&self, _: &Hit) -> f32 {
        self.0
    }
}

/// Opaque for one instance, invisible otherwise; and only if the hit is complete.
struct OneInstance;

impl Opacity for OneInstance {
    fn opacity(&self, hit: &Hit) -> f32 {
        let complete = hit.shape == 5 && hit.prim < 2 && hit.u >= 0.0 && hit.v >= 0.0;
        f32::from(u8::from(complete && hit.instance == 1 && hit.t > 0.5))
    }
}

fn quad() -> Shape {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
    let mesh = TriangleMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    Shape::Triangles(Arc::new(mesh))
}

fn masked(shape: Shape) -> Geometry {
    Geometry {
        id: 5,
        shape,
        masked: true,
    }
}

/// Rays straight down onto `[-1, 1]^2` from z = 1.
fn rain(count: usize) -> Vec<Ray> {
    let mut rng = Pcg32::new(31, 1);
    (0..count)
        .map(|_| {
            let p = point(&mut rng, 0.7);
            let to = point(&mut rng, 0.05).with_z(-1.0);
            Ray::new(p.with_z(1.0), to.normalize())
        })
        .collect()
}

#[test]
fn opacity_is_the_share_that_stops() {
    let rectangle = Shape::Analytic(AnalyticShape::new(
        AnalyticKind::Rectangle,
        Affine3A::IDENTITY,
    ));
    let rays = rain(100_000);
    for shape in [quad(), rectangle] {
        for alpha in [0.0, 0.3, 1.0] {
            let opacity: Arc<dyn Opacity> = Arc::new(Constant(alpha));
            for placed in [false, true] {
                let geometry = masked(shape.clone());
                let mut world = World::default();
                if placed {
                    world.groups.push(vec![geometry]);
                    let to_world = Affine3A::from_scale(Vec3::splat(1.5));
                    world.instances.push(Instance { group: 0, to_world });
                } else {
                    world.geometries.push(geometry);
                }
                share_stops(&world, &rays, &opacity, alpha);
            }
        }
    }
}

fn share_stops(world: &World, rays: &[Ray], opacity: &Arc<dyn Opacity>, alpha: f32) {
    let mut answers = Vec::new();
    for tracer in backends(world, robust(), Some(opacity)) {
        let mut hits = vec![Hit::NONE; rays.len()];
        let mut blocked = vec![false; rays.len()];
        tracer.intersect_batch(rays, &mut hits);
        tracer.occluded_batch(rays, &mut blocked);
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(hits[i].is_some(), blocked[i]);
            assert_eq!(tracer.intersect(ray), hits[i]);
            assert_eq!(tracer.occluded(ray), blocked[i]);
        }
        let n = rays.len() as f64;
        let share = blocked.iter().filter(|&&b| b).count() as f64 / n;
        let alpha = f64::from(alpha);
        // Four standard deviations.
        let bound = 4.0 * (alpha * (1.0 - alpha) / n).sqrt() + 1e-9;
        assert!(
            (share - alpha).abs() <= bound,
            "{}: {share} of {alpha}",
            tracer.name()
        );
        answers.push(blocked);
    }
    assert!(
        answers.windows(2).all(|pair| pair[0] == pair[1]),
        "the backends differ"
    );
}

/// Two sheets at opacity one half stop three quarters: the sheets decide independently.
#[test]
fn layers_decide_for_themselves() {
    let mut world = World::default();
    for (id, z) in [(5, 0.0), (6, -0.5)] {
        let map = Affine3A::from_translation(Vec3::new(0.0, 0.0, z))
            * Affine3A::from_scale(Vec3::splat(2.0));
        let shape = Shape::Analytic(AnalyticShape::new(AnalyticKind::Rectangle, map));
        world.geometries.push(Geometry {
            id,
            shape,
            masked: true,
        });
    }
    let opacity: Arc<dyn Opacity> = Arc::new(Constant(0.5));
    share_stops(&world, &rain(100_000), &opacity, 0.75);
}

/// Both walls of a round shape decide: half of the light is left by each of them, and a ray from
/// within meets one.
#[test]
fn both_walls_of_round_shapes_decide() {
    let wide = Affine3A::from_translation(Vec3::new(0.0, 0.0, -1.5))
        * Affine3A::from_scale(Vec3::splat(1.9));
    // Along x.
    let lying = Affine3A::from_translation(Vec3::new(-3.0, 0.0, -0.7))
        * Affine3A::from_rotation_y(std::f32::consts::FRAC_PI_2)
        * Affine3A::from_scale(Vec3::new(1.2, 1.2, 6.0));
    let around = Affine3A::from_scale(Vec3::new(4.0, 3.0, 3.0));
    let opacity: Arc<dyn Opacity> = Arc::new(Constant(0.5));
    let rays = rain(100_000);
    for (kind, map, stopped) in [
        (AnalyticKind::Sphere, wide, 0.75),
        (AnalyticKind::Cylinder, lying, 0.75),
        (AnalyticKind::Sphere, around, 0.5),
    ] {
        let geometry = masked(Shape::Analytic(AnalyticShape::new(kind, map)));
        let mut world = World::default();
        world.geometries.push(geometry.clone());
        share_stops(&world, &rays, &opacity, stopped);
        let mut world = World::default();
        world.groups.push(vec![geometry]);
        let to_world = Affine3A::from_rotation_z(0.1);
        world.instances.push(Instance { group: 0, to_world });
        share_stops(&world, &rays, &opacity, stopped);
    }
}

#[test]
fn opacity_is_asked_about_the_complete_hit() {
    let mut world = World::default();
    world.groups.push(vec![masked(quad())]);
    for z in [0.0, -0.5, -1.0] {
        let to_world = Affine3A::from_translation(Vec3::new(0.0, 0.0, z));
        world.instances.push(Instance { group: 0, to_world });
    }
    let opacity: Arc<dyn Opacity> = Arc::new(OneInstance);
    for tracer in backends(&world, robust(), Some(&opacity)) {
        for ray in rain(1000) {
            let hit = tracer.intersect(&ray);
            assert_eq!((hit.shape, hit.instance), (5, 1), "{}", tracer.name());
            assert!((ray.at(hit.t).z + 0.5).abs() < 1e-5);
        }
    }
}

/// Without an answer about opacity, masked geometry is opaque.
#[test]
fn masks_without_opacity_are_solid() {
    let mut world = World::default();
    world.geometries.push(masked(quad()));
    for tracer in backends(&world, robust(), None) {
        assert!(rain(1000).iter().all(|ray| tracer.occluded(ray)));
    }
}
