//! Guiding without a renderer: learn where light comes from on a floor below a small lamp, then use
//! the field to estimate the irradiance there with far less noise than uniform sampling.
//!
//! Run with `cargo run --release --example guide_field`.

use twintree::guide::{Photon, Settings, SurfacePoint, Trainer};
use twintree::math::warp::{concentric_disk, cosine_hemisphere, uniform_sphere};
use twintree::math::{Pcg32, Rgb, Vec2, Vec3};

/// The lamp: a disk of radiance 1 that shines downwards.
const LAMP: Vec3 = Vec3::new(0.3, 0.7, 0.8);
const RADIUS: f32 = 0.05;

fn square(rng: &mut Pcg32) -> Vec2 {
    Vec2::new(rng.next_f32(), rng.next_f32())
}

/// Photons from the lamp that land on the floor (the unit square in the plane z = 0).
fn photons(emitted: usize, rng: &mut Pcg32) -> Vec<Photon> {
    // Power of the whole lamp: pi * area * radiance.
    let power = std::f32::consts::PI.powi(2) * RADIUS * RADIUS;
    (0..emitted)
        .filter_map(|_| {
            let from = LAMP + (concentric_disk(square(rng)) * RADIUS).extend(0.0);
            let down = -cosine_hemisphere(square(rng));
            let distance = from.z / -down.z;
            let position = from + down * distance;
            let unit = 0.0..=1.0;
            let inside = unit.contains(&position.x) && unit.contains(&position.y);
            inside.then_some(Photon {
                position,
                direction: -down,
                power: Rgb::splat(power),
                distance,
                normal: Vec3::Z,
            })
        })
        .collect()
}

/// Radiance that arrives at `x` from direction `w`.
fn radiance(x: Vec3, w: Vec3) -> f32 {
    let t = (LAMP.z - x.z) / w.z;
    let hit = x + w * t;
    let on_lamp = w.z > 0.0 && hit.distance_squared(LAMP) <= RADIUS * RADIUS;
    f32::from(u8::from(on_lamp))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut rng = Pcg32::new(1, 1);

    // Build: bounds, and points that say how much surface lies where.
    let settings = Settings::new(Vec3::ZERO, Vec3::ONE);
    let mut trainer = Trainer::build(settings)?;
    let floor: Vec<SurfacePoint> = (0..200_000)
        .map(|_| SurfacePoint {
            position: square(&mut rng).extend(0.0),
            normal: Vec3::Z,
        })
        .collect();
    trainer.set_surface(&floor, 1.0);

    // Train and refine: batches that double.
    for batch in 0..8 {
        let emitted = 4000usize << batch;
        let landed = photons(emitted, &mut rng);
        trainer.train(&landed, emitted as u64);
        trainer.refine_rounds(4);
    }
    let stats = trainer.stats();
    println!(
        "{} links over {} cells of space, {:.1} MB",
        stats.links,
        stats.space_cells,
        stats.training_bytes as f64 / 1e6
    );

    // Sample: irradiance at a point by the field and by uniform directions.
    let field = trainer.freeze();
    let x = Vec3::new(0.6, 0.4, 0.0);
    let local = field.at(x, Some(Vec3::Z), Rgb::ONE);
    let n = 10_000;
    let (mut guided, mut uniform) = (Moments::default(), Moments::default());
    for _ in 0..n {
        let s = local.sample(square(&mut rng), square(&mut rng));
        guided.add(radiance(x, s.direction) * s.direction.z.max(0.0) / s.pdf);
        let w = uniform_sphere(square(&mut rng));
        uniform.add(radiance(x, w) * w.z.max(0.0) * 4.0 * std::f32::consts::PI);
    }
    println!("irradiance, field     {guided}");
    println!("irradiance, uniform   {uniform}");
    println!("irradiance, learned   {:.6}", local.irradiance().x);

    let to_lamp = LAMP - x;
    let d2 = to_lamp.length_squared();
    let truth = std::f32::consts::PI * RADIUS * RADIUS * to_lamp.z.powi(2) / (d2 * d2);
    println!("irradiance, truth     {truth:.6}");
    if (guided.mean() / f64::from(truth) - 1.0).abs() > 0.05 {
        return Err("the guided estimate is off by more than 5 %".into());
    }
    if guided.deviation() * 5.0 > uniform.deviation() {
        return Err("the field does not reduce noise fivefold".into());
    }
    Ok(())
}

/// Mean and standard deviation.
#[derive(Default)]
struct Moments {
    n: f64,
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, x: f32) {
        self.n += 1.0;
        self.sum += f64::from(x);
        self.squares += f64::from(x) * f64::from(x);
    }

    fn mean(&self) -> f64 {
        self.sum / self.n
    }

    fn deviation(&self) -> f64 {
        (self.squares / self.n - self.mean().powi(2))
            .max(0.0)
            .sqrt()
    }
}

impl std::fmt::Display for Moments {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(
            f,
            "{:.6}, standard deviation {:.6}",
            self.mean(),
            self.deviation()
        )
    }
}
