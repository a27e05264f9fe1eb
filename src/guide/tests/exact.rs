//! Same records, same bits: whatever the threads, the batches, the shards.

use super::synthetic::{Patch, disk_light, unit_box};
use crate::guide::{ModelKind, PathSample, Photon, Settings, Source, Trainer};
use crate::math::{Rgb, Vec3};

fn photons(n: usize, seed: u64) -> Vec<Photon> {
    let mut p = disk_light(Vec3::new(0.3, 0.4, 0.8), 0.1, n, seed);
    // Very different weights, so that an order-dependent sum would show.
    for (i, p) in p.iter_mut().enumerate() {
        p.power *= 10f32.powi((i % 9) as i32 - 4);
    }
    p
}

fn settings(model: ModelKind) -> Settings {
    Settings {
        model,
        source: Source::Both,
        ..unit_box()
    }
}

fn samples(n: usize, seed: u64) -> Vec<PathSample> {
    photons(n, seed)
        .iter()
        .enumerate()
        .map(|(i, p)| PathSample {
            position: p.position,
            direction: p.direction,
            radiance: if i % 3 == 0 { Rgb::ZERO } else { p.power },
            pdf: 0.2,
            distance: p.distance,
            normal: p.normal,
        })
        .collect()
}

fn learn(model: ModelKind) -> Trainer {
    let mut t = Trainer::build(settings(model)).unwrap();
    t.set_surface(&Patch::floor().surface(50_000, 1), 1.0);
    for i in 0..4 {
        t.train(&photons(40_000, i), 40_000);
        t.train_paths(vec![samples(10_000, i)]);
        t.refine();
    }
    t
}

#[test]
fn one_two_and_seven_threads_train_the_same_bits() {
    for model in ModelKind::ALL {
        let train = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| learn(*model).to_bytes())
        };
        let one = train(1);
        assert!(learn(*model).stats().links > 100 || *model == ModelKind::Vmf);
        for threads in [2, 7] {
            assert!(train(threads) == one, "{model:?}, {threads} threads");
        }
    }
}

#[test]
fn cutting_records_into_batches_changes_nothing() {
    for model in ModelKind::ALL {
        let base = learn(*model);
        let p = photons(30_000, 9);
        let mut whole = base.clone();
        whole.train(&p, 30_000);
        let mut cut = base;
        for chunk in p.chunks(777) {
            cut.train(chunk, chunk.len() as u64);
        }
        cut.intakes.batches = whole.intakes.batches;
        assert!(cut.to_bytes() == whole.to_bytes());
    }
}

#[test]
fn a_batch_in_parts_is_the_batch() {
    for model in ModelKind::ALL {
        let base = learn(*model);
        // More than are taken at a time, in parts large and small, some of them empty.
        let s = samples(300_000, 12);
        let mut parts: Vec<&[PathSample]> = s[100_000..].chunks(70_001).collect();
        parts.splice(0..0, s[..100_000].chunks(777));
        parts.insert(5, &[]);
        let mut whole = base.clone();
        whole.train_paths(vec![&s]);
        let mut cut = base;
        cut.train_paths(parts);
        for t in [&mut whole, &mut cut] {
            t.refine_rounds(2);
        }
        assert!(cut.to_bytes() == whole.to_bytes(), "{model:?}");
    }
}

#[test]
fn shards_add_up_to_the_whole_to_the_bit() {
    for model in ModelKind::ALL {
        let base = learn(*model);
        let (p, s) = (photons(30_000, 10), samples(9_000, 3));
        let mut whole = base.clone();
        whole.train(&p, 30_000);
        whole.train_paths(vec![&s]);
        let mut merged = base.clone();
        // Shards arrive in another order and through files.
        for i in [2, 0, 1] {
            let mut shard = base.emptied();
            shard.train(&p[i * 10_000..(i + 1) * 10_000], 10_000);
            shard.train_paths(vec![&s[i * 3_000..(i + 1) * 3_000]]);
            let shard = Trainer::from_bytes(&shard.to_bytes()).unwrap();
            merged.merge(&shard).unwrap();
        }
        merged.intakes.batches = whole.intakes.batches;
        assert!(merged.to_bytes() == whole.to_bytes(), "{model:?}");
        // What is refined afterwards is the same, too.
        merged.refine();
        whole.refine();
        assert!(merged.to_bytes() == whole.to_bytes(), "{model:?}");
    }
}

#[test]
fn fields_that_do_not_belong_together_are_not_merged() {
    let base = learn(ModelKind::Constant);
    let mut other = base.emptied();
    other.settings.scene_hash = 7;
    let error = base.clone().merge(&other).unwrap_err().to_string();
    assert!(error.contains("different scenes"), "{error}");
    let mut other = base.clone();
    other.train(&photons(50_000, 20), 50_000);
    other.refine();
    assert!(base.clone().merge(&other).is_err());
    let vmf = learn(ModelKind::Vmf);
    let mut refitted = vmf.clone();
    refitted.train(&photons(500, 20), 500);
    refitted.settings.min_photons = u32::MAX;
    refitted.refine();
    refitted.settings = vmf.settings.clone();
    let error = vmf.clone().merge(&refitted).unwrap_err().to_string();
    assert!(error.contains("refitted"), "{error}");
}

#[test]
fn unusable_records_are_dropped_and_counted() {
    let good = Photon {
        position: Vec3::splat(0.5),
        direction: Vec3::Z,
        power: Rgb::ONE,
        distance: 1.0,
        normal: Vec3::Z,
    };
    let mut t = Trainer::build(unit_box()).unwrap();
    let bad = [
        Photon {
            position: Vec3::NAN,
            ..good
        },
        Photon {
            power: Rgb::splat(f32::INFINITY),
            ..good
        },
        Photon {
            direction: Vec3::ZERO,
            ..good
        },
        Photon {
            direction: Vec3::NAN,
            ..good
        },
        Photon {
            power: Rgb::ZERO,
            ..good
        },
        Photon {
            distance: f32::NAN,
            normal: Vec3::NAN,
            ..good
        },
        good,
    ];
    t.train(&bad, 7);
    let i = t.intakes();
    assert_eq!(
        (i.dropped_non_finite, i.dropped_direction, i.photons),
        (2, 2, 2)
    );
}
