//! Input nobody should give: no crash, and the sound part is still found.

use super::worlds::*;
use crate::accel::*;
use crate::math::{Affine3A, Vec3};
use std::sync::Arc;

const DOWN: Ray = Ray {
    org: Vec3::new(0.1, 0.2, 5.0),
    tmin: 0.0,
    dir: Vec3::new(0.0, 0.0, -1.0),
    tmax: f32::INFINITY,
};

/// A sound triangle in z = 0 around the origin, with odd ones around it.
fn with_odd(odd: &[[Vec3; 3]]) -> World {
    let sound = [
        Vec3::new(-3.0, -3.0, 0.0),
        Vec3::new(3.0, -3.0, 0.0),
        Vec3::new(0.0, 3.0, 0.0),
    ];
    let mut positions = sound.to_vec();
    positions.extend(odd.iter().flatten());
    let count = positions.len() as u32 / 3;
    let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    mesh_world(Arc::new(TriangleMesh::new(positions, triangles).unwrap()))
}

#[test]
fn empty_worlds_are_misses() {
    let nothing = World::default();
    let no_triangles = mesh_world(Arc::new(TriangleMesh::default()));
    let mut empty_group = World::default();
    empty_group.groups.push(Vec::new());
    let to_world = Affine3A::IDENTITY;
    empty_group.instances.push(Instance { group: 0, to_world });
    for world in [nothing, no_triangles, empty_group] {
        for tracer in backends(&world, robust(), None) {
            assert_eq!(tracer.intersect(&DOWN), Hit::NONE);
            assert!(!tracer.occluded(&DOWN));
            assert!(tracer.bounds().is_empty());
            tracer.intersect_batch(&[], &mut []);
        }
    }
}

#[test]
fn a_sound_triangle_among_odd_ones_is_found() {
    let nan = Vec3::new(f32::NAN, 0.0, 0.0);
    let infinite = Vec3::new(0.0, f32::INFINITY, 0.0);
    let huge = Vec3::new(1e38, -1e38, 1e38);
    let odd = [
        [nan, Vec3::X, Vec3::Y],
        [Vec3::X, Vec3::Y, infinite],
        [huge, -huge, Vec3::ZERO],
        [Vec3::ONE; 3],
        [Vec3::X, Vec3::X, Vec3::Y],
        [Vec3::X, Vec3::X * 2.0, Vec3::X * 3.0],
    ];
    for tracer in backends(&with_odd(&odd), robust(), None) {
        let hit = tracer.intersect(&DOWN);
        assert_eq!((hit.shape, hit.prim), (7, 0), "{}", tracer.name());
        assert!((hit.t - 5.0).abs() < 1e-5);
    }
}

#[test]
fn many_triangles_in_one_place_are_one_hit() {
    let one = [
        Vec3::new(-1.0, -1.0, 1.0),
        Vec3::new(1.0, -1.0, 1.0),
        Vec3::new(0.0, 1.0, 1.0),
    ];
    for quality in [
        BuildQuality::Fast,
        BuildQuality::Balanced,
        BuildQuality::High,
    ] {
        let settings = BuildSettings {
            quality,
            ..robust()
        };
        for tracer in backends(&with_odd(&vec![one; 100_000]), settings, None) {
            let hit = tracer.intersect(&DOWN);
            assert!((hit.t - 4.0).abs() < 1e-5, "{} {hit:?}", tracer.name());
            assert!(tracer.occluded(&DOWN));
        }
    }
}

#[test]
fn one_triangle_is_a_tree() {
    for tracer in backends(&with_odd(&[]), robust(), None) {
        let hit = tracer.intersect(&DOWN);
        let b = tracer.bounds();
        assert!((hit.t - 5.0).abs() < 1e-5, "{}", tracer.name());
        assert_eq!((b.min.x, b.max.y), (-3.0, 3.0));
    }
}

#[test]
fn rays_that_are_none_are_misses() {
    let world = with_odd(&[]);
    let with = |change: fn(&mut Ray)| {
        let mut ray = DOWN;
        change(&mut ray);
        ray
    };
    let rays = [
        with(|r| r.org.x = f32::NAN),
        with(|r| r.org.y = f32::INFINITY),
        with(|r| r.dir.z = f32::NAN),
        with(|r| r.dir.x = f32::NEG_INFINITY),
        with(|r| r.dir = Vec3::ZERO),
        with(|r| r.org.z = 1e38),
        with(|r| r.org.x = -2e18),
        with(|r| r.tmin = f32::NAN),
        with(|r| r.tmax = f32::NAN),
        with(|r| (r.tmin, r.tmax) = (6.0, 4.0)),
        with(|r| r.tmax = -1.0),
    ];
    for tracer in backends(&world, robust(), None) {
        let mut batch = rays.to_vec();
        batch.push(DOWN);
        let mut hits = vec![Hit::NONE; batch.len()];
        let mut blocked = vec![true; batch.len()];
        tracer.intersect_batch(&batch, &mut hits);
        tracer.occluded_batch(&batch, &mut blocked);
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(hits[i], Hit::NONE, "{} {ray:?}", tracer.name());
            assert!(!blocked[i], "{} {ray:?}", tracer.name());
        }
        assert!(hits[rays.len()].is_some() && blocked[rays.len()]);
    }
}

#[test]
fn instances_that_cannot_stand_are_errors() {
    let broken = |group, to_world| {
        let mut world = World::default();
        world.groups.push(Vec::new());
        world.instances.push(Instance { group, to_world });
        let backend = Backend::default();
        build(world, robust(), None, backend).err().unwrap()
    };
    let flat = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0));
    let missing = broken(3, Affine3A::IDENTITY);
    assert_eq!(
        missing.to_string(),
        "instance 0 names group 3, but there are 1 groups"
    );
    assert_eq!(
        broken(0, flat),
        AccelError::SingularInstance { instance: 0 }
    );
}

/// Embree is told how much memory its trees may take, and ends the build in words when that is not
/// enough.
#[cfg(feature = "embree")]
#[test]
fn a_tree_beyond_its_memory_is_an_error() {
    let sheet = |i: u32| {
        let at = |j: u32| Vec3::new((i + j) as f32, (j % 2) as f32, 1.0);
        [at(0), at(1), at(2)]
    };
    let triangles: Vec<[Vec3; 3]> = (0..100_000).map(sheet).collect();
    let bounded = |memory| {
        let settings = BuildSettings { memory, ..robust() };
        build(with_odd(&triangles), settings, None, Backend::Embree)
    };
    let refused = bounded(4 << 20).err().expect("four megabytes are too few");
    assert!(
        matches!(&refused, AccelError::OutOfMemory { bytes, .. } if *bytes <= 4 << 20),
        "{refused}"
    );
    assert!(refused.to_string().contains("compact tree"), "{refused}");
    // What was refused leaves nothing behind: the next build is as any other.
    let tree = bounded(256 << 20).expect("that is enough");
    assert!(tree.memory_bytes() > 4 << 20 && tree.intersect(&DOWN).is_some());
}
