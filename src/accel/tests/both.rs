//! Embree and obvhs along the same ten million rays.
//!
//! Where their answers differ, brute force in `f64` judges both. A tie is a ray for which both are
//! right within rounding: it meets an edge that two triangles share, two surfaces in one place, or
//! the surface that it starts on. Ties are counted and have to be as rare as the mesh says; an
//! answer that is wrong once in ten million rays fails.

use super::brute::crossings;
use super::closest::agree;
use super::worlds::*;
use crate::accel::*;
use crate::math::{Pcg32, Vec3};
use crate::scene::import::mesh::{MeshKind, MeshOptions, buffers};
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;

/// Rays of one piece of work.
const LOT: usize = 50_000;

/// Rays that a test traces, `of` such tests sharing ten millions.
const fn share(of: usize) -> usize {
    10_000_000 / of
}

/// A mesh between -1 and 1.
fn unit(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> World {
    let mut low = Vec3::splat(f32::INFINITY);
    let mut high = -low;
    for &p in &positions {
        (low, high) = (low.min(p), high.max(p));
    }
    let scale = 2.0 / (high - low).max_element();
    let centred = positions
        .iter()
        .map(|&p| (p - 0.5 * (low + high)) * scale)
        .collect();
    mesh_world(Arc::new(TriangleMesh::new(centred, triangles).unwrap()))
}

/// What rounding may decide on a mesh between -1 and 1.
#[derive(Clone, Copy)]
struct Rounding {
    /// Of distances, and of barycentric coordinates at an edge.
    tolerance: f64,
    /// Distance from a ray's start within which obvhs's triangle test takes a crossing for rounding
    /// alone: the longer a triangle for its width, the larger (`distance_error` in `woop.rs`).
    start: f64,
}

/// Of meshes whose triangles are about as wide as long.
const SOUND: Rounding = Rounding {
    tolerance: 1e-5,
    start: 1e-5,
};

/// Of triangles a thousand times as long as wide.
const THIN: Rounding = Rounding {
    tolerance: 1e-3,
    start: 1e-2,
};

/// How many of `count` rays the two answer differently, all of them ties, and how many meet
/// something.
fn ties(world: &World, count: usize, rounding: Rounding) -> (usize, usize) {
    let [embree, obvhs] = &backends(world, robust(), None)[..] else {
        panic!("two ray tracers are compared");
    };
    let lots = (0..count.div_ceil(LOT)).into_par_iter();
    let counts = lots.map(|lot| {
        let rays = rays(LOT, 1.2, lot as u64);
        let mut answers = [vec![Hit::NONE; LOT], vec![Hit::NONE; LOT]];
        embree.intersect_batch(&rays, &mut answers[0]);
        obvhs.intersect_batch(&rays, &mut answers[1]);
        let met = answers[0].iter().filter(|hit| hit.is_some()).count();
        let differ = (0..LOT).filter(|&i| {
            let hits = [&answers[0][i], &answers[1][i]];
            let differ = apart(hits, rounding.tolerance);
            if differ {
                both_right(world, &rays[i], hits, rounding);
            }
            differ
        });
        (differ.count(), met)
    });
    counts.reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
}

/// Whether two answers name other triangles or other distances.
fn apart([a, b]: [&Hit; 2], tolerance: f64) -> bool {
    let far = f64::from((a.t - b.t).abs()) > tolerance * (1.0 + f64::from(a.t));
    a.is_some() != b.is_some() || a.is_some() && ((a.shape, a.prim) != (b.shape, b.prim) || far)
}

fn both_right(world: &World, ray: &Ray, hits: [&Hit; 2], rounding: Rounding) {
    let crossed = crossings(world, ray, rounding.tolerance);
    for (hit, name) in hits.into_iter().zip(["Embree", "obvhs"]) {
        let mut found = crossed.clone();
        found.retain(|c| c.t > rounding.start * c.slope || c.prim == hit.prim);
        if let Err(why) = agree(hit, &found, rounding.tolerance) {
            panic!("{name}, {ray:?}: {why}");
        }
    }
}

/// Traces and says what was found; at most one ray in `rare` that meets something may be a tie.
fn check(name: &str, world: &World, count: usize, rounding: Rounding, rare: usize) {
    let (ties, met) = ties(world, count, rounding);
    println!("{name}: {ties} ties of {met} hits, {count} rays");
    assert!(met > count / 20, "{name}: {met} of {count} rays hit");
    assert!(ties <= met / rare, "{name}: {ties} ties of {met} hits");
}

#[test]
fn both_meet_a_carafe_alike() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/door/carafe.ply");
    let file = buffers(&path, MeshKind::Ply, &MeshOptions::default()).unwrap();
    let world = unit(file.positions, file.triangles);
    check("carafe", &world, share(2), SOUND, 50_000);
}

/// Triangles through one another, from a thousandth to the whole of the scene's size.
#[test]
fn both_meet_triangles_of_all_sizes_alike() {
    let mut rng = Pcg32::new(21, 1);
    let mut positions = Vec::new();
    for i in 0..1000 {
        let center = point(&mut rng, 1.0);
        let size = 10.0_f32.powf(-3.0 * (i as f32 / 1000.0));
        positions.extend([0; 3].map(|_| center + point(&mut rng, size)));
    }
    check(
        "sizes",
        &unit(positions, loose(1000)),
        share(8),
        SOUND,
        5_000,
    );
}

/// Triangles a thousand times as long as wide.
#[test]
fn both_meet_slivers_alike() {
    let mut rng = Pcg32::new(22, 1);
    let mut positions = Vec::new();
    for _ in 0..40_000 {
        let (start, along) = (point(&mut rng, 1.0), direction(&mut rng));
        let aside = along.cross(direction(&mut rng)).normalize() * 1e-3;
        positions.extend([start, start + along, start + along + aside]);
    }
    check(
        "slivers",
        &unit(positions, loose(40_000)),
        share(8),
        THIN,
        1_000,
    );
}

/// A thousand triangles around each of ten vertices, and rays that meet them there.
#[test]
fn both_meet_fans_alike() {
    const BLADES: u32 = 1000;
    let mut rng = Pcg32::new(23, 1);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for _ in 0..10 {
        let first = positions.len() as u32;
        let (tip, axis) = (point(&mut rng, 0.8), direction(&mut rng));
        let (s, t) = axis.any_orthonormal_pair();
        positions.push(tip);
        for i in 0..BLADES {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / BLADES as f32).sin_cos();
            positions.push(tip + 0.2 * axis + 0.7 * (cos * s + sin * t));
            triangles.push([first, first + 1 + i, first + 1 + (i + 1) % BLADES]);
        }
    }
    check("fans", &unit(positions, triangles), share(8), THIN, 500);
}

/// Each triangle twice, once turned over: every hit is a tie of two, and neither is skipped.
#[test]
fn both_meet_doubled_triangles_alike() {
    let once = soup(150, 0.3, 24);
    let corners = (0..150).flat_map(|prim| once.corners(prim));
    let turned = (0..150).flat_map(|prim| {
        let [a, b, c] = once.corners(prim);
        [a, c, b]
    });
    let positions = corners.chain(turned).collect();
    check("doubled", &unit(positions, loose(300)), share(8), SOUND, 1);
}

/// Triangles that share no vertex.
fn loose(count: u32) -> Vec<[u32; 3]> {
    (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()
}
