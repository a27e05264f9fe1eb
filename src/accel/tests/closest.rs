//! Closest hits and shadow rays against brute force.

use super::brute::{Candidate, crossings};
use super::worlds::*;
use crate::accel::*;
use crate::math::{Pcg32, Vec3};

/// Compares a hit with brute force. Rounding may decide otherwise only where the ray meets an edge,
/// or where two crossings are closer together than `tolerance`.
pub fn agree(hit: &Hit, found: &[Candidate], tolerance: f64) -> Result<(), String> {
    let clear = |c: &&Candidate| c.margin > tolerance;
    if !hit.is_some() {
        return match found.iter().find(clear) {
            Some(missed) => Err(format!("missed {missed:?}")),
            None => Ok(()),
        };
    }
    let near = |c: &Candidate, t: f64| (c.t - t).abs() <= tolerance * c.slope * (1.0 + t.abs());
    let same = found.iter().find(|c| {
        c.shape == hit.shape
            && c.prim == hit.prim
            && c.instance == hit.instance
            && near(c, f64::from(hit.t))
    });
    let Some(same) = same else {
        return Err(format!("{hit:?} is not among {found:?}"));
    };
    if let Some(nearer) = found
        .iter()
        .filter(clear)
        .find(|c| !near(c, same.t) && !near(same, c.t) && c.t < same.t)
    {
        return Err(format!("{hit:?} is behind {nearer:?}"));
    }
    let wrapped = |d: f64| d.abs().min((1.0 - d.abs()).abs());
    let du = wrapped(same.u - f64::from(hit.u));
    let dv = wrapped(same.v - f64::from(hit.v));
    if du.max(dv) > 100.0 * tolerance * same.slope {
        return Err(format!("{hit:?} has other coordinates than {same:?}"));
    }
    Ok(())
}

/// Every ray through every backend, one by one and as a batch, against brute force.
fn check_world(world: &World, rays: &[Ray], tolerance: f64) {
    let found: Vec<_> = rays
        .iter()
        .map(|r| crossings(world, r, tolerance))
        .collect();
    for tracer in backends(world, robust(), None) {
        let mut hits = vec![Hit::NONE; rays.len()];
        let mut blocked = vec![false; rays.len()];
        tracer.intersect_batch(rays, &mut hits);
        tracer.occluded_batch(rays, &mut blocked);
        let (mut met, mut grazed) = (0, 0);
        for (i, ray) in rays.iter().enumerate() {
            if let Err(why) = agree(&hits[i], &found[i], tolerance) {
                panic!("{}: ray {i} {ray:?}: {why}", tracer.name());
            }
            met += usize::from(hits[i].is_some());
            grazed += usize::from(blocked[i] != hits[i].is_some());
        }
        assert!(
            met > rays.len() / 20 && met < rays.len(),
            "{met} hits say little"
        );
        assert!(
            grazed <= rays.len() / 10_000,
            "{}: {grazed} shadow rays disagree",
            tracer.name()
        );
    }
}

#[test]
fn triangles_are_met_as_brute_force_meets_them() {
    let world = mesh_world(soup(300, 0.3, 1));
    check_world(&world, &rays(100_000, 1.5, 2), 2e-6);
}

/// Cameras without perspective and suns overhead trace such rays; a zero's sign tells nothing.
#[test]
fn rays_along_an_axis_are_met_whatever_sign_their_zeros_have() {
    let mut rng = Pcg32::new(6, 1);
    let rays: Vec<_> = (0..24_000)
        .map(|i| {
            let sign = |bit: usize| if i >> bit & 1 == 0 { 1.0 } else { -1.0 };
            let mut dir = Vec3::new(0.0 * sign(0), 0.0 * sign(1), 0.0 * sign(2));
            dir[i / 8 % 3] = sign(i / 8 % 3);
            Ray::new(point(&mut rng, 1.5), dir)
        })
        .collect();
    check_world(&mesh_world(soup(300, 0.3, 5)), &rays, 2e-6);
    check_world(&mixed_world(), &rays, 2e-5);
}

#[test]
fn ray_bounds_are_kept() {
    let world = mesh_world(soup(300, 0.3, 3));
    let mut rays = rays(20_000, 1.5, 4);
    for (i, ray) in rays.iter_mut().enumerate() {
        ray.tmin = 0.1 * (i % 7) as f32;
        ray.tmax = ray.tmin + 0.2 * (i % 5) as f32;
    }
    check_world(&world, &rays, 2e-6);
}

#[test]
fn shapes_and_instances_are_met_as_brute_force_meets_them() {
    check_world(&mixed_world(), &rays(100_000, 3.0, 11), 2e-5);
}

#[test]
fn every_quality_finds_the_same() {
    let world = mixed_world();
    let rays = rays(20_000, 3.0, 12);
    let trace = |settings| {
        backends(&world, settings, None)
            .into_iter()
            .map(|tracer| {
                let mut hits = vec![Hit::NONE; rays.len()];
                tracer.intersect_batch(&rays, &mut hits);
                (tracer.name(), tracer.memory_bytes(), hits)
            })
            .collect::<Vec<_>>()
    };
    let reference = trace(robust());
    for quality in [BuildQuality::Fast, BuildQuality::High] {
        for compact in [false, true] {
            let settings = BuildSettings {
                quality,
                compact,
                ..robust()
            };
            for ((name, bytes, hits), reference) in trace(settings).iter().zip(&reference) {
                assert!(*bytes > 0, "{name} holds nothing");
                let other = |(a, b): (&Hit, &Hit)| a.shape != b.shape || a.prim != b.prim;
                let differ = hits.iter().zip(&reference.2).filter(|&p| other(p)).count();
                assert!(differ <= 4, "{name} {settings:?}: {differ} hits differ");
            }
        }
    }
}

#[test]
fn bounds_hold_every_hit() {
    let world = mixed_world();
    let rays = rays(20_000, 3.0, 13);
    for tracer in backends(&world, robust(), None) {
        let b = tracer.bounds();
        for ray in &rays {
            let hit = tracer.intersect(ray);
            let p = ray.at(hit.t);
            let inside = p.cmpge(b.min - 1e-4).all() && p.cmple(b.max + 1e-4).all();
            assert!(!hit.is_some() || inside, "{p} is outside {b:?}");
        }
    }
}
