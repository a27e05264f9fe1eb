//! The area measure: links of different levels of R must be comparable.

use super::synthetic::{Patch, disk_light, integral, point_light, square, unit_box};
use crate::guide::links::Split;
use crate::guide::{ModelKind, Photon, Settings, SurfacePoint, Target, Trainer};
use crate::math::equal_area::DirectionCell;
use crate::math::warp::cosine_hemisphere;
use crate::math::{Frame, Pcg32, Rgb, Vec2, Vec3};
use std::f64::consts::PI;

fn slanted() -> Patch {
    Patch {
        origin: Vec3::new(0.1, 0.1, 0.2),
        a: Vec3::new(0.8, 0.0, 0.3),
        b: Vec3::new(0.0, 0.8, 0.1),
    }
}

/// Splits some links three levels deep in space: paths then hold links of many levels.
fn mix_levels(trainer: &mut Trainer, seed: u64) {
    let mut rng = Pcg32::new(seed, 3);
    for _ in 0..60 {
        let link = rng.next_u32() % trainer.product.links.len() as u32;
        let l = trainer.product.links[link as usize];
        if trainer.space.nodes[l.r as usize].level < 3 {
            trainer.split(link, Split::Space);
        }
    }
}

/// Integral over a direction cell of cosine (for radiance 1).
fn cosine_in(cell: DirectionCell, n: Vec3, power: i32) -> f64 {
    let k = 16;
    let sum: f64 = (0..k * k)
        .map(|i| {
            let u = Vec2::new((i % k) as f32 + 0.5, (i / k) as f32 + 0.5) / k as f32;
            let cos = n.dot(cell.direction(u));
            if cos > 0.0 {
                f64::from(cos).powi(power)
            } else {
                0.0
            }
        })
        .sum();
    sum / f64::from(k * k) * f64::from(cell.solid_angle())
}

/// Mean relative L1 error of the links' F against the truth over points of the patch.
fn error_on_mixed_levels(target: Target, split_first: bool) -> f64 {
    let patch = slanted();
    let settings = Settings {
        target,
        ..unit_box()
    };
    let mut trainer = Trainer::build(settings).unwrap();
    trainer.set_surface(&patch.surface(400_000, 1), patch.area());
    if split_first {
        mix_levels(&mut trainer, 5);
    }
    let photons = patch.constant_light(1_000_000, 2);
    trainer.train(&photons[..500_000], 500_000);
    if !split_first {
        // Estimates must also be right when flux was counted before the split.
        mix_levels(&mut trainer, 5);
    }
    trainer.train(&photons[500_000..], 500_000);
    let field = trainer.freeze();
    let mut rng = Pcg32::new(9, 9);
    let (power, truth) = match target {
        Target::Flux => (1, PI),
        Target::Radiance => (0, 2.0 * PI),
    };
    let mut error = 0.0;
    let mut most_levels = 0;
    for _ in 0..100 {
        let x = patch.point(square(&mut rng));
        let local = field.at(x, None, Rgb::ONE);
        error += (f64::from(local.irradiance().x) / truth - 1.0).abs() / 100.0;
        let wrong: f64 = local
            .links()
            .iter()
            .map(|(q, f)| (f64::from(f.x) - cosine_in(*q, patch.normal(), power)).abs())
            .sum();
        error += wrong / truth / 100.0;
        let key = trainer.space.grid.key(x, Vec3::Z);
        let mut levels: Vec<u8> = (0..16u32)
            .map(|g| {
                let l = trainer.product.find(&trainer.space.grid, key, g << 28);
                trainer.space.nodes[trainer.product.links[l as usize].r as usize].level
            })
            .collect();
        levels.sort_unstable();
        levels.dedup();
        most_levels = most_levels.max(levels.len());
    }
    assert!(most_levels >= 3, "the tree is not mixed: {most_levels}");
    error
}

#[test]
fn constant_light_on_a_slanted_plane_is_constant_across_levels() {
    for split_first in [true, false] {
        let flux = error_on_mixed_levels(Target::Flux, split_first);
        assert!(flux < 0.06, "flux, split first {split_first}: {flux}");
        let radiance = error_on_mixed_levels(Target::Radiance, split_first);
        // Clamping the cosine costs 2.6 % of the fluence.
        assert!(
            radiance < 0.10,
            "radiance, split first {split_first}: {radiance}"
        );
    }
}

#[test]
fn paths_and_photons_estimate_the_same_flux() {
    use crate::guide::{PathSample, Source};
    let patch = slanted();
    let mut rng = Pcg32::new(4, 2);
    let samples: Vec<PathSample> = (0..400_000)
        .map(|_| {
            // Vertices as unevenly spread as cameras leave them.
            let u = square(&mut rng);
            let local = cosine_hemisphere(square(&mut rng));
            PathSample {
                position: patch.point(Vec2::new(u.x * u.x, u.y)),
                direction: Frame::new(patch.normal()).to_world(local),
                radiance: Rgb::ONE,
                pdf: local.z / std::f32::consts::PI,
                distance: 1.0,
                normal: patch.normal(),
            }
        })
        .collect();
    for source in [Source::Photons, Source::Paths, Source::Both] {
        let settings = Settings {
            source,
            ..unit_box()
        };
        let mut trainer = Trainer::build(settings).unwrap();
        trainer.set_surface(&patch.surface(400_000, 1), patch.area());
        mix_levels(&mut trainer, 6);
        trainer.train(&patch.constant_light(400_000, 3), 400_000);
        trainer.train_paths(vec![&samples]);
        mix_levels(&mut trainer, 7);
        let field = trainer.freeze();
        let mean: f64 = (0..200)
            .map(|_| {
                let x = patch.point(square(&mut rng));
                f64::from(field.at(x, None, Rgb::ONE).irradiance().y)
            })
            .sum::<f64>()
            / 200.0;
        assert!((mean / PI - 1.0).abs() < 0.03, "{source:?}: {mean}");
    }
}

/// A floor lit from straight above and a wall lit from the side, meeting in one cell.
#[test]
fn a_split_by_normals_keeps_the_sides_of_a_corner_apart() {
    let mut rng = Pcg32::new(6, 6);
    let mut photons = Vec::new();
    let mut points = Vec::new();
    for i in 0..40_000 {
        let u = square(&mut rng) * 0.01;
        let (position, normal) = if i % 2 == 0 {
            (Vec3::new(u.x, u.y, 0.0), Vec3::Z)
        } else {
            (Vec3::new(0.0, u.x, u.y), Vec3::X)
        };
        points.push(SurfacePoint { position, normal });
        photons.push(Photon {
            position,
            direction: normal,
            power: Rgb::ONE,
            distance: 1.0,
            normal,
        });
    }
    let density = |normal_split: bool| {
        let settings = Settings {
            normal_split,
            max_space_level: 0,
            ..unit_box()
        };
        let mut trainer = Trainer::build(settings).unwrap();
        trainer.set_surface(&points, 2e-4);
        trainer.train(&photons, 40_000);
        trainer.refine();
        let field = trainer.freeze();
        let local = field.at(Vec3::splat(0.005), Some(Vec3::Z), Rgb::ONE);
        (local.pdf(Vec3::Z), local.pdf(Vec3::X))
    };
    let (up, side) = density(true);
    assert!(up > 50.0 * side, "{up} {side}");
    let (up, side) = density(false);
    assert!(up < 5.0 * side, "{up} {side}");
}

#[test]
fn light_does_not_leak_through_a_thin_wall_split_by_normals() {
    let mut rng = Pcg32::new(7, 6);
    let side = |normal: Vec3, u: Vec2| SurfacePoint {
        position: Vec3::new(0.5, u.x, u.y),
        normal,
    };
    let points: Vec<_> = (0..100_000)
        .map(|i| {
            side(
                if i % 2 == 0 { Vec3::X } else { -Vec3::X },
                square(&mut rng),
            )
        })
        .collect();
    let photons: Vec<_> = (0..100_000)
        .map(|_| Photon {
            position: side(Vec3::X, square(&mut rng)).position,
            direction: Frame::new(Vec3::X).to_world(cosine_hemisphere(square(&mut rng))),
            power: Rgb::splat(std::f32::consts::PI),
            distance: 1.0,
            normal: Vec3::X,
        })
        .collect();
    for normal_split in [true, false] {
        let settings = Settings {
            normal_split,
            ..unit_box()
        };
        let mut trainer = Trainer::build(settings).unwrap();
        trainer.set_surface(&points, 2.0);
        trainer.train(&photons, 100_000);
        trainer.refine();
        let field = trainer.freeze();
        let at = |n: Vec3| {
            let local = field.at(Vec3::new(0.5, 0.5, 0.5), Some(n), Rgb::ONE);
            f64::from(local.irradiance().x)
        };
        let (lit, dark) = (at(Vec3::X), at(-Vec3::X));
        if normal_split {
            assert!(
                (lit / PI - 1.0).abs() < 0.05 && dark < 0.01 * lit,
                "{lit} {dark}"
            );
        } else {
            assert!((lit - dark).abs() < 1e-6 * lit, "{lit} {dark}");
        }
    }
}

#[test]
fn a_point_light_at_a_surface_is_found() {
    for model in ModelKind::ALL {
        let light = Vec3::new(0.5, 0.5, 0.251);
        let settings = Settings {
            model: *model,
            memory: 8 << 20,
            ..unit_box()
        };
        let mut trainer = Trainer::build(settings).unwrap();
        let floor = Patch::floor();
        trainer.set_surface(&floor.surface(200_000, 1), floor.area());
        for i in 0..10 {
            trainer.train(&point_light(light, 50_000, i), 50_000);
            trainer.refine();
        }
        assert!(trainer.bytes() <= 8 << 20);
        let field = trainer.freeze();
        let mut gain = 0.0;
        let tests = point_light(light, 2000, 99);
        for p in &tests {
            let local = field.at(p.position, Some(p.normal), Rgb::ONE);
            let pdf = local.pdf(p.direction);
            assert!(pdf.is_finite());
            gain += f64::from(pdf * 2.0 * std::f32::consts::PI).ln() / 2000.0;
        }
        // Against uniform on the hemisphere, in nats.
        assert!(gain > 1.5, "{model:?}: {gain}");
        let local = field.at(light, None, Rgb::ONE);
        let n = if *model == ModelKind::Vmf {
            1 << 18
        } else {
            1 << 21
        };
        let total = integral(n, |w| local.pdf(w));
        assert!((total - 1.0).abs() < 2e-3, "{total}");
    }
}

#[test]
fn parallax_follows_the_light_from_within_one_cell() {
    let light = Vec3::new(0.5, 0.5, 0.6);
    let settings = Settings {
        model: ModelKind::Vmf,
        max_space_level: 0,
        ..unit_box()
    };
    let mut trainer = Trainer::build(settings).unwrap();
    for i in 0..12 {
        trainer.train(&disk_light(light, 0.02, 20_000, i), 20_000);
        trainer.refine();
    }
    let field = trainer.freeze();
    for x in [Vec3::new(0.2, 0.3, 0.25), Vec3::new(0.9, 0.6, 0.25)] {
        let toward = (light - x).normalize();
        // A single lobe without parallax would have to cover a hemisphere: density below 1.
        let pdf = field.at(x, None, Rgb::ONE).pdf(toward);
        assert!(pdf > 3.0, "{x:?}: {pdf}");
    }
}

/// A wall of light from +x beside a fog with light from +z: neither knows of the other, and the
/// fluence in the fog is its flux over the cross-section.
#[test]
fn a_medium_is_apart_from_the_surfaces_inside() {
    let mut rng = Pcg32::new(3, 8);
    let mut on_wall = Vec::new();
    let mut in_fog = Vec::new();
    let mut photons = Vec::new();
    for _ in 0..100_000 {
        let p = square(&mut rng);
        let wall = Vec3::new(0.5, p.x, p.y);
        let fog = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
        on_wall.push(SurfacePoint {
            position: wall,
            normal: Vec3::X,
        });
        in_fog.push(fog);
        for (position, direction, normal) in [(wall, Vec3::X, Vec3::X), (fog, Vec3::Z, Vec3::ZERO)]
        {
            photons.push(Photon {
                position,
                direction,
                power: Rgb::ONE,
                distance: 1.0,
                normal,
            });
        }
    }
    for model in ModelKind::ALL {
        let settings = Settings {
            normal_split: true,
            media: true,
            model: *model,
            ..unit_box()
        };
        let mut trainer = Trainer::build(settings).unwrap();
        trainer.set_surface(&on_wall, 1.0);
        // Extinction 4 in the unit box.
        trainer.set_media(&in_fog, 4.0);
        trainer.train(&photons, 100_000);
        trainer.refine_rounds(4);
        let file = trainer.freeze();
        let at = |side: Vec3| file.at_side(Vec3::splat(0.5), side, None, Rgb::ONE);
        let (wall, fog) = (at(Vec3::X), at(Vec3::ZERO));
        for (what, local, flux, w) in [("wall", wall, 1.0, Vec3::X), ("fog", fog, 0.25, Vec3::Z)] {
            let found = local.irradiance().x;
            assert!(
                (found / flux - 1.0).abs() < 0.06,
                "{what} {model:?}: {found}"
            );
            let other = Vec3::new(w.z, 0.0, w.x);
            let (here, there) = (local.pdf(w), local.pdf(other));
            assert!(here > 50.0 * there, "{what} {model:?}: {here} and {there}");
        }
    }
}
