//! However a batch is cut, every ray gets the same answer, to the bit.

use super::worlds::*;
use crate::accel::*;
use crate::math::{Pcg32, Vec3};
use std::sync::Arc;

/// A bumpy sphere of `2 n^2` triangles: neighbours share vertices, as in real meshes.
fn bumpy(n: u32) -> Arc<TriangleMesh> {
    let mut positions = Vec::new();
    for i in 0..=n {
        for j in 0..n {
            let theta = std::f32::consts::PI * i as f32 / n as f32;
            let phi = std::f32::consts::TAU * j as f32 / n as f32;
            let r = 1.0 + 0.05 * (9.0 * phi).sin() * (11.0 * theta).sin();
            let (sin, cos) = theta.sin_cos();
            positions.push(r * Vec3::new(sin * phi.cos(), sin * phi.sin(), cos));
        }
    }
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let next = (j + 1) % n;
            let (a, b) = (i * n + j, i * n + next);
            triangles.extend([[a, b, b + n], [a, b + n, a + n]]);
        }
    }
    Arc::new(TriangleMesh::new(positions, triangles).unwrap())
}

fn bits(h: &Hit) -> [u32; 6] {
    [
        h.t.to_bits(),
        h.u.to_bits(),
        h.v.to_bits(),
        h.prim,
        h.shape,
        h.instance,
    ]
}

/// Random cuts, random order, and one by one.
fn check_cuts(world: &World, rays: &[Ray], settings: BuildSettings) {
    for tracer in backends(world, settings, None) {
        let mut whole = vec![Hit::NONE; rays.len()];
        let mut whole_blocked = vec![false; rays.len()];
        tracer.intersect_batch(rays, &mut whole);
        tracer.occluded_batch(rays, &mut whole_blocked);
        let mut rng = Pcg32::new(21, 1);
        let mut order: Vec<usize> = (0..rays.len()).collect();
        for i in (1..order.len()).rev() {
            order.swap(i, rng.next_u32() as usize % (i + 1));
        }
        let shuffled: Vec<Ray> = order.iter().map(|&i| rays[i]).collect();
        let mut start = 0;
        let mut differ = 0;
        while start < rays.len() {
            let end = (start + 1 + rng.next_u32() as usize % 40).min(rays.len());
            let mut hits = vec![Hit::NONE; end - start];
            let mut blocked = vec![false; end - start];
            tracer.intersect_batch(&shuffled[start..end], &mut hits);
            tracer.occluded_batch(&shuffled[start..end], &mut blocked);
            for (k, &i) in order[start..end].iter().enumerate() {
                let same = bits(&hits[k]) == bits(&whole[i]) && blocked[k] == whole_blocked[i];
                differ += usize::from(!same);
            }
            start = end;
        }
        let alone = |i: &usize| {
            bits(&tracer.intersect(&rays[*i])) != bits(&whole[*i])
                || tracer.occluded(&rays[*i]) != whole_blocked[*i]
        };
        let single = (0..rays.len()).filter(alone).count();
        assert_eq!((differ, single), (0, 0), "{} {settings:?}", tracer.name());
    }
}

#[test]
fn a_mesh_answers_alike_however_the_batch_is_cut() {
    let world = mesh_world(bumpy(200));
    let mut rays = rays(30_000, 1.5, 22);
    // Coherent rays take other paths through a packet tracer than scattered ones.
    let mut rng = Pcg32::new(23, 1);
    for _ in 0..30_000 {
        let to = 0.05 * point(&mut rng, 1.0);
        let org = Vec3::new(0.0, -4.0, 0.0);
        rays.push(Ray::new(org, (to - org).normalize()));
    }
    for robust in [true, false] {
        check_cuts(
            &world,
            &rays,
            BuildSettings {
                robust,
                ..super::worlds::robust()
            },
        );
    }
}

#[test]
fn shapes_and_instances_answer_alike_however_the_batch_is_cut() {
    check_cuts(&mixed_world(), &rays(30_000, 3.0, 24), robust());
}
