//! More photons, better field; until memory ends.

use super::synthetic::{Patch, disk_light, square, unit_box};
use crate::guide::{Field, ModelKind, Settings, Trainer};
use crate::math::warp::concentric_disk;
use crate::math::{Pcg32, Rgb, Vec3};

const LIGHT: Vec3 = Vec3::new(0.4, 0.6, 0.65);
const RADIUS: f32 = 0.1;

/// Irradiance over radiance at a floor point below the disk.
fn irradiance(x: Vec3, rng: &mut Pcg32) -> f64 {
    let n = 256;
    let sum: f64 = (0..n)
        .map(|_| {
            let y = LIGHT + (concentric_disk(square(rng)) * RADIUS).extend(0.0);
            let d = y - x;
            let d2 = d.length_squared();
            f64::from(d.z * d.z / (d2 * d2))
        })
        .sum();
    sum / f64::from(n) * std::f64::consts::PI * f64::from(RADIUS * RADIUS)
}

/// KL divergence from the truth, cos / E(x) on the disk, averaged over where light lands.
fn divergence(field: &Field) -> f64 {
    let mut rng = Pcg32::new(50, 50);
    let held_out = disk_light(LIGHT, RADIUS, 4000, 1_000_000);
    held_out
        .iter()
        .map(|p| {
            let truth = f64::from(p.direction.z) / irradiance(p.position, &mut rng);
            let pdf = field.at(p.position, None, Rgb::ONE).pdf(p.direction);
            (truth / f64::from(pdf)).ln() / 4000.0
        })
        .sum()
}

fn trained(settings: Settings, batches: u32) -> (Trainer, f64) {
    let mut t = Trainer::build(settings).unwrap();
    t.set_surface(&Patch::floor().surface(200_000, 5), 1.0);
    for i in 0..batches {
        // Doubling batches, from 2000.
        let n = 2000usize << i;
        t.train(&disk_light(LIGHT, RADIUS, n, u64::from(i)), n as u64);
        t.refine();
    }
    let d = divergence(&t.freeze());
    (t, d)
}

#[test]
fn divergence_falls_as_photons_grow() {
    for (model, goal) in [(ModelKind::Constant, 0.9), (ModelKind::Vmf, 0.9)] {
        let settings = Settings {
            model,
            ..unit_box()
        };
        let d: Vec<f64> = [2, 4, 6, 8]
            .map(|b| trained(settings.clone(), b).1)
            .to_vec();
        println!("{model:?}: {d:?}");
        assert!(d.windows(2).all(|w| w[1] < w[0] - 0.02), "{model:?}: {d:?}");
        assert!(d[3] < goal, "{model:?}: {d:?}");
    }
}

#[test]
fn memory_ends_refinement_not_training() {
    let settings = Settings {
        memory: 100_000,
        ..unit_box()
    };
    let (small, d) = trained(settings, 8);
    let (large, best) = trained(unit_box(), 8);
    assert!(small.bytes() <= 100_000 && large.bytes() > 300_000);
    println!(
        "capped {d} free {best}: {} {} bytes",
        small.bytes(),
        large.bytes()
    );
    assert!(d > best + 0.05, "{d} {best}");
    let stats = large.stats();
    assert_eq!(stats.link_direction_depths.iter().sum::<u64>(), stats.links);
    assert_eq!(stats.space_depths.iter().sum::<u64>(), stats.space_cells);
    assert_eq!(small.intakes().photons, 2000 * 255);
}
