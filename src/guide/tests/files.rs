//! Files: round trips, refusals, and garbage.

use super::synthetic::{disk_light, unit_box};
use crate::guide::habits::CellStates;
use crate::guide::{
    FieldFile, FractionRecord, Fractions, LightChoice, ModelKind, Numbers, Product, SampleRanges,
    Settings, Trainer,
};
use crate::math::{Pcg32, Rgb, Vec2, Vec3};

fn trained(model: ModelKind) -> Trainer {
    let mut t = Trainer::random(Vec3::ZERO, Vec3::ONE, model, Product::Cosine, 4);
    t.set_surface(&super::synthetic::Patch::floor().surface(500, 1), 1.0);
    t.settings.smoothing = 0.3;
    t
}

#[test]
fn a_file_brings_back_the_same_field() {
    let dir = tempfile::tempdir().unwrap();
    for model in ModelKind::ALL {
        let t = trained(*model);
        let path = dir.path().join("field.twf");
        t.save(&path).unwrap();
        let mut back = Trainer::load(&path).unwrap();
        assert_eq!(back.settings(), t.settings());
        assert!(back.to_bytes() == t.to_bytes());
        let (a, b) = (t.freeze(), back.freeze());
        let mut rng = Pcg32::new(1, 2);
        for _ in 0..500 {
            let x = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
            let u = Vec2::new(rng.next_f32(), rng.next_f32());
            let v = Vec2::new(rng.next_f32(), rng.next_f32());
            let sample = |f: &crate::guide::Field| f.at(x, Some(Vec3::Y), Rgb::ONE).sample(u, v);
            assert_eq!(sample(&a), sample(&b));
        }
        // Trained further, both stay the same.
        let mut t = t;
        for t in [&mut t, &mut back] {
            t.train(&disk_light(Vec3::splat(0.7), 0.1, 5000, 3), 5000);
            t.refine();
        }
        assert!(back.to_bytes() == t.to_bytes());
    }
    let missing = Trainer::load(&dir.path().join("none")).unwrap_err();
    assert!(missing.to_string().contains("none"));
}

#[test]
fn damage_is_named() {
    let bytes = trained(ModelKind::Constant).to_bytes();
    let error = |b: &[u8]| Trainer::from_bytes(b).unwrap_err().to_string();
    assert!(error(b"").contains("byte 0"));
    assert!(error(b"P6 3 3 255").contains("not a field"));
    assert!(error(&bytes[..30]).contains("cut off"));
    assert!(error(&bytes[..bytes.len() - 1]).contains("cut off"));
    let mut b = bytes.clone();
    b[8] = 99;
    assert!(error(&b).contains("version 99"));
    let mut b = bytes.clone();
    let last = b.len() - 1;
    b[last] ^= 1;
    assert!(error(&b).contains("checksum"));
}

/// Mutations with the checksum mended, so that they reach the parser: an error or a field that
/// works.
#[test]
fn no_mutation_of_a_file_panics() {
    let mut rng = Pcg32::new(77, 1);
    let mut accepted = 0;
    for model in ModelKind::ALL {
        let mut t = Trainer::build(Settings {
            model: *model,
            ..unit_box()
        })
        .unwrap();
        for seed in 0..2 {
            t.train(&disk_light(Vec3::splat(0.6), 0.2, 1500, seed), 1500);
            t.refine();
        }
        t.set_importance(&super::synthetic::Patch::floor().surface(20, 1), 1);
        let original = t.to_bytes();
        for i in 0..1000 {
            let mut b = original.clone();
            mutate(&mut b, &mut rng, i);
            if i % 4 != 0 {
                mend(&mut b);
            }
            let Ok(mut t) = Trainer::from_bytes(&b) else {
                continue;
            };
            accepted += 1;
            let field = t.freeze();
            let local = field.at(Vec3::splat(0.4), Some(Vec3::Z), Rgb::ONE);
            let s = local.sample(Vec2::splat(0.5), Vec2::splat(0.3));
            assert!(s.direction.is_finite() && s.pdf > 0.0, "{s:?}");
            if i % 10 == 0 {
                t.settings.memory = 1 << 20;
                t.train(&disk_light(Vec3::splat(0.7), 0.1, 50, 3), 50);
                t.refine();
                t.emptied().merge(&t).unwrap();
            }
        }
    }
    assert!(
        accepted > 200,
        "mutations hardly reach the parser: {accepted}"
    );
}

fn mutate(b: &mut Vec<u8>, rng: &mut Pcg32, i: u32) {
    let any = |rng: &mut Pcg32, n: usize| rng.next_u32() as usize % n.max(1);
    // Half of them near the front, where lengths and shapes are.
    let reach = if i % 2 == 0 {
        b.len()
    } else {
        1500.min(b.len())
    };
    for _ in 0..1 + rng.next_u32() % 3 {
        let at = any(rng, reach);
        match rng.next_u32() % 5 {
            0 => b[at] ^= 1 << (rng.next_u32() % 8),
            1 => b[at] = rng.next_u32() as u8,
            2 => b[at] = 0xff,
            3 if at > 24 => b.truncate(at),
            _ => {
                let end = (at + any(rng, 16)).min(b.len());
                b[at.min(end)..end].fill(rng.next_u32() as u8);
            }
        }
        if b.len() < reach {
            return;
        }
    }
}

fn mend(b: &mut [u8]) {
    if b.len() < 24 {
        return;
    }
    let length = (b.len() - 24) as u64;
    b[12..20].copy_from_slice(&length.to_le_bytes());
    let mut crc = flate2::Crc::new();
    crc.update(&b[24..]);
    b[20..24].copy_from_slice(&crc.sum().to_le_bytes());
}

/// A field with a history and with fractions that differ from cell to cell.
fn kept(model: ModelKind) -> FieldFile {
    let trainer = trained(model);
    let field = trainer.freeze();
    let mut fractions = Fractions::new(&field);
    let mut rng = Pcg32::new(8, 9);
    let records: Vec<FractionRecord> = (0..3000u32)
        .map(|i| FractionRecord {
            position: Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()),
            normal: Vec3::Z,
            value: Rgb::ONE,
            pdf: 1.0,
            guide_pdf: 2.0 * rng.next_f32(),
            bsdf_pdf: rng.next_f32(),
            light: rng.next_f32(),
            light_probability: 1.0,
            light_choice: LightChoice::of((i % 5) as u8, (i % 3) as u8),
            reflected: 1.0,
        })
        .collect();
    fractions.update(&field, &records);
    let sample_ranges = SampleRanges {
        recipe: "made up".to_owned(),
        photons: Numbers::new(0..500, 0..500),
        paths: Numbers::new(0..0, 0..0),
        unrefined: false,
    };
    FieldFile::new(trainer, sample_ranges, &field, &fractions)
}

#[test]
fn fractions_and_ledger_come_back_whatever_the_order_of_cells() {
    for model in ModelKind::ALL {
        let file = kept(*model);
        let (field, fractions) = file.freeze();
        let back = FieldFile::from_bytes(&file.to_bytes()).unwrap();
        assert_eq!(back.sample_ranges, file.sample_ranges);
        assert!(back.to_bytes() == file.to_bytes());
        let (other, others) = back.freeze();
        let mut rng = Pcg32::new(1, 1);
        let mut seen = std::collections::HashSet::new();
        let mut known = 0;
        for _ in 0..2000 {
            let x = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
            let of = |f: &crate::guide::Field, s: &Fractions| {
                let cell = f.cell(x, Vec3::Z);
                (s.chances(cell), s.light_factors(cell).copied())
            };
            assert_eq!(of(&field, &fractions), of(&other, &others));
            let (chances, factors) = of(&field, &fractions);
            seen.insert([chances.field, chances.light].map(f32::to_bits));
            known += usize::from(factors.is_some_and(|f| f[0].iter().any(|&f| f < 1.0)));
        }
        assert!(seen.len() > 3, "{model:?}: all the same");
        assert!(known > 1000, "{model:?}: lamps are known at {known} points");
    }
}

#[test]
fn a_file_that_is_cut_anywhere_is_refused_with_the_byte() {
    let bytes = kept(ModelKind::Constant).to_bytes();
    for n in (0..bytes.len()).step_by(64) {
        let error = FieldFile::from_bytes(&bytes[..n]).unwrap_err().to_string();
        assert!(
            error.contains(&format!("cut off at byte {n}")),
            "{n}: {error}"
        );
    }
}

#[test]
fn a_bit_that_flips_anywhere_is_noticed() {
    let mut bytes = kept(ModelKind::Vmf).to_bytes();
    let stride = (bytes.len() / 1500).max(1);
    let places = (0..24).chain((24..bytes.len()).step_by(stride));
    for at in places {
        let bit = 1u8 << (at % 8);
        bytes[at] ^= bit;
        let error = FieldFile::from_bytes(&bytes).unwrap_err().to_string();
        assert!(error.contains("byte"), "{at}: {error}");
        bytes[at] ^= bit;
    }
    assert!(FieldFile::from_bytes(&bytes).is_ok());
}

#[test]
fn fields_with_common_records_are_not_added() {
    let base = kept(ModelKind::Constant);
    let error = base.clone().merge(&base).unwrap_err().to_string();
    assert!(
        error.contains("both contain the photons 0 to 499"),
        "{error}"
    );
    let mut sum = base.clone();
    sum.merge(&base.emptied()).unwrap();
    assert!(sum.sample_ranges.photons == base.sample_ranges.photons);
    assert!(sum.trainer.to_bytes() == base.trainer.to_bytes());
    let mut other = base.emptied();
    other.sample_ranges.recipe = "made otherwise".to_owned();
    let error = base.clone().merge(&other).unwrap_err().to_string();
    assert!(error.contains("made up and made otherwise"), "{error}");
    let mut other = base.emptied();
    other.fractions = CellStates::default();
    let error = base.clone().merge(&other).unwrap_err().to_string();
    assert!(error.contains("fractions"), "{error}");
}
