//! What guiding costs: training a photon, refining, and a query at a field of realistic size.
//!
//! `cargo bench --bench guide`. Figures are a photon, a query or a field, as the name says.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use std::sync::OnceLock;
use twintree::guide::{Field, ModelKind, Photon, Settings, SurfacePoint, Trainer};
use twintree::math::warp::{cosine_hemisphere, uniform_sphere};
use twintree::math::{Pcg32, Rgb, Vec2, Vec3};

fn main() {
    divan::main();
}

const QUERIES: usize = 4096;

fn square(rng: &mut Pcg32) -> Vec2 {
    Vec2::new(rng.next_f32(), rng.next_f32())
}

/// Light from many small lamps on a floor: a field with structure everywhere.
fn photons(n: usize, seed: u64) -> Vec<Photon> {
    let mut rng = Pcg32::new(seed, 5);
    let mut out = Vec::with_capacity(n);
    while out.len() < n {
        let lamp = rng.next_u32() % 16;
        let from = Vec3::new((lamp % 4) as f32, (lamp / 4) as f32, 1.2) * 0.25 + 0.1;
        let w = uniform_sphere(square(&mut rng));
        let t = -from.z / w.z;
        let p = from + w * t;
        if w.z < 0.0 && p.x >= 0.0 && p.y >= 0.0 && p.x < 1.0 && p.y < 1.0 {
            out.push(Photon {
                position: p,
                direction: -w,
                power: Rgb::new(1.0, 0.8, 0.5),
                distance: t,
                normal: Vec3::Z,
            });
        }
    }
    out
}

fn trainer(model: ModelKind) -> Trainer {
    let settings = Settings {
        model,
        ..Settings::new(Vec3::ZERO, Vec3::ONE)
    };
    let mut t = Trainer::build(settings).expect("the default settings are valid");
    let mut rng = Pcg32::new(1, 5);
    let floor: Vec<_> = (0..400_000)
        .map(|_| SurfacePoint {
            position: square(&mut rng).extend(0.0),
            normal: Vec3::Z,
        })
        .collect();
    t.set_surface(&floor, 1.0);
    for i in 0..8 {
        let p = photons(8000 << i, i as u64);
        t.train(&p, p.len() as u64);
        t.refine_rounds(4);
    }
    t
}

fn trained(model: ModelKind) -> &'static (Trainer, Field) {
    static FIELDS: [OnceLock<(Trainer, Field)>; 2] = [OnceLock::new(), OnceLock::new()];
    FIELDS[model as usize % 2].get_or_init(|| {
        let t = trainer(model);
        let f = t.freeze();
        let s = t.stats();
        println!(
            "{model:?}: {} links, {} cells, {:.0} links a cell, {:.1} MB training, {:.1} MB frozen",
            s.links,
            s.space_cells,
            s.links_per_cell,
            s.training_bytes as f64 / 1e6,
            f.bytes() as f64 / 1e6
        );
        (t, f)
    })
}

fn places() -> Vec<(Vec3, Vec3)> {
    let mut rng = Pcg32::new(7, 7);
    (0..QUERIES)
        .map(|_| {
            (
                square(&mut rng).extend(0.0),
                cosine_hemisphere(square(&mut rng)),
            )
        })
        .collect()
}

#[divan::bench(args = [ModelKind::Constant, ModelKind::Vmf])]
fn at(bencher: Bencher, model: ModelKind) {
    let (_, field) = trained(model);
    let places = places();
    bencher.counter(ItemsCount::new(QUERIES)).bench(|| {
        for (x, _) in &places {
            black_box(field.at(*x, Some(Vec3::Z), Rgb::ONE));
        }
    });
}

#[divan::bench(args = [ModelKind::Constant, ModelKind::Vmf])]
fn at_and_sample(bencher: Bencher, model: ModelKind) {
    let (_, field) = trained(model);
    let places = places();
    bencher.counter(ItemsCount::new(QUERIES)).bench(|| {
        let mut rng = Pcg32::new(3, 3);
        for (x, _) in &places {
            let local = field.at(*x, Some(Vec3::Z), Rgb::ONE);
            black_box(local.sample(square(&mut rng), square(&mut rng)));
        }
    });
}

#[divan::bench(args = [ModelKind::Constant, ModelKind::Vmf])]
fn at_and_pdf(bencher: Bencher, model: ModelKind) {
    let (_, field) = trained(model);
    let places = places();
    bencher.counter(ItemsCount::new(QUERIES)).bench(|| {
        for (x, w) in &places {
            black_box(field.at(*x, Some(Vec3::Z), Rgb::ONE).pdf(*w));
        }
    });
}

#[divan::bench(args = [ModelKind::Constant, ModelKind::Vmf], sample_count = 5)]
fn train(bencher: Bencher, model: ModelKind) {
    let (t, _) = trained(model);
    let batch = photons(200_000, 99);
    bencher
        .counter(ItemsCount::new(batch.len()))
        .with_inputs(|| t.clone())
        .bench_refs(|t| t.train(&batch, 200_000));
}

#[divan::bench(sample_count = 5)]
fn freeze(bencher: Bencher) {
    let (t, _) = trained(ModelKind::Constant);
    bencher.bench(|| t.freeze());
}
