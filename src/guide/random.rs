//! Fields full of garbage. A renderer that is right draws the same mean with any of them: the
//! strongest test that sampling and density agree.

use super::field::Field;
use super::links::Split;
use super::model::ModelKind;
use super::record::Photon;
use super::settings::{Product, Settings};
use super::train::Trainer;
use crate::math::warp::uniform_sphere;
use crate::math::{Pcg32, Vec2, Vec3};

impl Field {
    /// A field over the box `min`..`max` that knows nothing of any scene: random splits, random
    /// fluxes over six decades, black links, sharp lobes.
    pub fn random(min: Vec3, max: Vec3, model: ModelKind, seed: u64) -> Self {
        Trainer::random(min, max, model, Product::Cosine, seed).freeze()
    }
}

impl Trainer {
    /// The trainer behind [`Field::random`], with a choice of what normals do.
    pub fn random(min: Vec3, max: Vec3, model: ModelKind, product: Product, seed: u64) -> Self {
        let finite = |v: Vec3| if v.is_finite() { v } else { Vec3::ZERO };
        let (min, max) = (finite(min), finite(max));
        let settings = Settings {
            model,
            product,
            seed,
            smoothing: 0.1,
            ..Settings::new(min.min(max), min.max(max))
        };
        // Only the bounds could be refused, and they are mended above.
        let mut trainer = match Trainer::build(settings) {
            Ok(t) => t,
            Err(_) => return Self::random(Vec3::ZERO, Vec3::ONE, model, product, seed),
        };
        let mut rng = Pcg32::new(seed, 0x6a4b);
        for _ in 0..6 {
            trainer.train(&random_photons(&mut rng, min, max), 500);
            trainer.refine();
            for _ in 0..40 {
                let link = rng.next_u32() % trainer.product.links.len() as u32;
                random_split(&mut trainer, link, rng.next_u32() & 1 == 0);
            }
        }
        trainer.train(&random_photons(&mut rng, min, max), 500);
        trainer
    }
}

fn random_split(t: &mut Trainer, link: u32, in_space: bool) {
    let l = t.product.links[link as usize];
    let level = t.space.nodes[l.r as usize].level;
    if in_space && level < t.space.grid.max_level.min(6) {
        t.split(link, Split::Space);
    } else if t.traits.splits_directions && l.q.level() < t.settings.max_direction_level.min(6) {
        t.split(link, Split::Direction);
    }
}

fn random_photons(rng: &mut Pcg32, min: Vec3, max: Vec3) -> Vec<Photon> {
    let mut u = || rng.next_f32();
    (0..500)
        .map(|_| {
            let position = min + (max - min) * Vec3::new(u(), u(), u());
            let colour = Vec3::new(u(), u() * u(), u());
            Photon {
                position,
                direction: uniform_sphere(Vec2::new(u() * u(), u())),
                power: colour * 10f32.powf(u() * 6.0 - 3.0),
                distance: if u() < 0.3 { f32::INFINITY } else { u() },
                normal: uniform_sphere(Vec2::new(u(), u())),
            }
        })
        .collect()
}
