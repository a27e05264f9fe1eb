//! S14, S16, S17, S18: the learned field: how deep its trees go, that its links share out space and
//! directions, that it draws what it says, and that nothing it may hold changes an image's mean.

use crate::scenes::*;
use crate::table::Table;
use twintree::accel::Backend;
use twintree::guide::{Field, LocalField, ModelKind, Photon, Settings, Trainer};
use twintree::integrate::guiding::Guide;
use twintree::integrate::training::garbage;
use twintree::math::equal_area::{DirectionCell, direction_code, square_to_sphere};
use twintree::math::warp::uniform_sphere;
use twintree::math::{Pcg32, Rgb, Vec2, Vec3};

fn square(rng: &mut Pcg32) -> Vec2 {
    Vec2::new(rng.next_f32(), rng.next_f32())
}

fn photon(position: Vec3, direction: Vec3) -> Photon {
    Photon {
        position,
        direction,
        power: Rgb::ONE,
        distance: 1.0,
        normal: Vec3::Z,
    }
}

/// Trains on photons at `place`, and says how deep the octree and how large the trees became over
/// what is allowed, and at how many of the photons' own places the field holds no light.
fn pressed(
    settings: &Settings,
    most: usize,
    place: impl Fn(&mut Pcg32) -> Vec3,
) -> (f64, f64, f64) {
    let mut rng = Pcg32::new(12, 1);
    let mut trainer = Trainer::build(settings.clone()).expect("settings");
    let photons: Vec<Photon> = (0..100_000)
        .map(|_| photon(place(&mut rng), uniform_sphere(square(&mut rng))))
        .collect();
    for _ in 0..10 {
        trainer.train(&photons, 100_000);
        trainer.refine_rounds(2);
    }
    let stats = trainer.stats();
    let field = trainer.freeze();
    let dark = photons[..2000].iter().filter(|p| {
        let local = field.at(p.position, None, Rgb::ONE);
        let lit = local.has_light() && local.pdf(p.direction) > 0.0;
        !lit || field.cell(p.position, p.normal) != local.cell()
    });
    let depth = stats.space_depths.len().saturating_sub(1 + most);
    let memory = trainer.bytes() as f64 / settings.memory as f64;
    (depth as f64, memory, dark.count() as f64)
}

#[test]
fn s14_depth() {
    let unit = Settings {
        memory: 4 << 20,
        ..Settings::new(Vec3::ZERO, Vec3::ONE)
    };
    let far = |offset: f32| Settings {
        memory: 4 << 20,
        ..Settings::new(Vec3::splat(offset), Vec3::splat(offset + 10.0))
    };
    let corner = |u: u32| (u % 17) as f32 / 16.0;
    type Place = Box<dyn Fn(&mut Pcg32) -> Vec3>;
    let scattered = |offset: f32| -> Place {
        Box::new(move |r| offset + 10.0 * Vec3::new(r.next_f32(), r.next_f32(), 0.5))
    };
    let list: Vec<(&str, Settings, usize, Place)> = vec![
        (
            "at one point",
            unit.clone(),
            20,
            Box::new(|_| Vec3::splat(0.3)),
        ),
        (
            "on a line of 1e-6",
            unit.clone(),
            20,
            Box::new(|r| Vec3::new(0.3, 0.3, 0.3 + 1e-6 * r.next_f32())),
        ),
        (
            "on corners of cells",
            unit.clone(),
            20,
            Box::new(move |r| {
                Vec3::new(
                    corner(r.next_u32()),
                    corner(r.next_u32()),
                    corner(r.next_u32()),
                )
            }),
        ),
        (
            "outside the bounds",
            unit,
            20,
            Box::new(|r| Vec3::splat(r.next_f32() * 4e9 - 2e9)),
        ),
        // Cells of 64 times the distance between neighbouring numbers, and no smaller.
        ("1e3 away", far(1e3), 12, scattered(1e3)),
        ("1e6 away", far(1e6), 2, scattered(1e6)),
        ("1e9 away", far(1e9), 0, scattered(1e9)),
    ];
    let mut table = Table::default();
    for (what, settings, most, place) in list {
        let (depth, memory, dark) = pressed(&settings, most, place);
        let what = |of: &str| format!("photons {what}: {of}");
        table.hold(
            "S14",
            &what(&format!("levels beyond {most}")),
            "guide",
            0.0,
            depth,
        );
        table.hold(
            "S14",
            &what("memory, of what is allowed"),
            "guide",
            1.0,
            memory,
        );
        table.hold(
            "S14",
            &what("places of photons without light"),
            "guide",
            0.0,
            dark,
        );
    }
}

/// The field of the room, and places in it.
fn places() -> (Guide, Vec<Vec3>) {
    let guide = field_of(&room(Backend::default()));
    let mut rng = Pcg32::new(6, 6);
    let places = (0..50)
        .map(|_| 2.0 * Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) - 1.0)
        .collect();
    (guide, places)
}

#[test]
fn s16_links_share_out_all_directions() {
    let mut table = Table::default();
    let (guide, places) = places();
    let (mut area, mut flux, mut owners): (f64, f64, u32) = (0.0, 0.0, 0);
    let mut rng = Pcg32::new(7, 7);
    for p in places {
        let local = guide.field.at(p, None, Rgb::ONE);
        let links = local.links();
        let share: f64 = links
            .iter()
            .map(|(q, _)| 0.25f64.powi(q.level().into()))
            .sum();
        area = area.max((share - 1.0).abs());
        let sum: f64 = links.iter().map(|(_, f)| f64::from(f.y)).sum();
        flux = flux.max((sum / f64::from(local.irradiance().y.max(1e-30)) - 1.0).abs());
        for _ in 0..64 {
            let code = direction_code(uniform_sphere(square(&mut rng)));
            let of = links.iter().filter(|(q, _)| q.contains(code)).count();
            owners += u32::from(of != 1);
        }
    }
    table.hold(
        "S16",
        "areas of a cell's links: |sum / 4 pi - 1|",
        "guide",
        0.0,
        area,
    );
    table.hold(
        "S16",
        "light of a cell's links: sum over the cell's, relative",
        "guide",
        1e-5,
        flux,
    );
    table.hold(
        "S16",
        "directions that are not in exactly one link",
        "guide",
        0.0,
        owners.into(),
    );
}

/// Integral of the density over a cell of level 3, by a lattice.
fn share(local: &LocalField, cell: DirectionCell) -> f64 {
    const N: u32 = 24;
    let sum: f64 = (0..N * N)
        .map(|i| {
            let u = Vec2::new((i % N) as f32 + 0.5, (i / N) as f32 + 0.5) / N as f32;
            f64::from(local.pdf(cell.direction(u)))
        })
        .sum();
    sum / f64::from(N * N) * f64::from(cell.solid_angle())
}

/// At 50 places, with and without a surface's horizon: the density integrates to 1, nothing is
/// darker than the defensive share, and what is drawn follows it (chi-square over 64 cells of equal
/// area).
#[test]
fn s17_density() {
    const DRAWN: u32 = 20_000;
    let mut table = Table::default();
    let (guide, places) = places();
    let (mut integral, mut least, mut worst): (f64, f32, f64) = (0.0, f32::INFINITY, 0.0);
    let mut rng = Pcg32::new(8, 8);
    for (i, p) in places.iter().enumerate() {
        let normal = (i % 2 == 0).then_some(Vec3::Y);
        let local = guide.field.at(*p, normal, Rgb::ONE);
        let cells: Vec<_> = (0..64u32)
            .map(|i| DirectionCell::containing(i << 26, 3))
            .collect();
        let shares: Vec<f64> = cells.iter().map(|c| share(&local, *c)).collect();
        integral = integral.max((shares.iter().sum::<f64>() - 1.0).abs());
        let mut counts = [0u32; 64];
        for _ in 0..DRAWN {
            let drawn = local.sample(square(&mut rng), square(&mut rng));
            counts[(direction_code(drawn.direction) >> 26) as usize] += 1;
            least = least.min(local.pdf(square_to_sphere(square(&mut rng))));
        }
        let chi: f64 = shares
            .iter()
            .zip(counts)
            .map(|(share, count)| {
                let expected = (share * f64::from(DRAWN)).max(1e-9);
                (f64::from(count) - expected).powi(2) / expected
            })
            .sum();
        // 63 degrees of freedom: mean 63, variance 126 (Wilson and Hilferty make it normal).
        let z = ((chi / 63.0).cbrt() - (1.0 - 2.0 / 567.0)) / (2.0f64 / 567.0).sqrt();
        worst = worst.max(z);
    }
    let floor = 0.01 / (4.0 * std::f32::consts::PI);
    table.hold("S17", "density: |integral - 1|", "guide", 1e-5, integral);
    table.hold(
        "S17",
        "defensive density over the least that is met",
        "guide",
        1.0,
        f64::from(floor / least) - 1e-6,
    );
    table.hold(
        "S17",
        "chi-square of what is drawn at 50 places: the largest, as a normal deviate",
        "guide",
        3.8,
        worst,
    );
}

/// A field of one photon.
fn one_link() -> Guide {
    let settings = Settings::new(Vec3::splat(-1.0), Vec3::splat(1.0));
    let mut trainer = Trainer::build(settings).expect("settings");
    trainer.train(&[photon(Vec3::splat(0.9), Vec3::X)], 1);
    Guide::new(trainer.freeze())
}

/// A field trained on nothing.
fn empty() -> Guide {
    let settings = Settings::new(Vec3::splat(-1.0), Vec3::splat(1.0));
    Guide::new(Trainer::build(settings).expect("settings").freeze())
}

#[test]
fn s18_hostile_fields_keep_the_mean() {
    let mut table = Table::default();
    for (name, backend) in backends() {
        let built = plain_box(0.5, 1.0, backend);
        let (plain, _) = built.render(&seed(1), 512);
        let elsewhere = Field::random(
            Vec3::splat(100.0),
            Vec3::splat(101.0),
            Default::default(),
            3,
        );
        for (what, guide) in [
            ("garbage", garbage(&built.scene, ModelKind::default(), 9)),
            ("elsewhere", Guide::new(elsewhere)),
            ("one photon", one_link()),
            ("empty", empty()),
        ] {
            let (film, _) = built.render_guided(&seed(2), 512, Some(&guide));
            let who = format!("{name}, guided");
            let what = format!("field: {what}: worst of 4 blocks, standard errors");
            table.finite("S18", &what, &who, &film);
            table.hold("S18", &what, &who, 4.0, worst_block(&plain, &film));
        }
    }
}

/// A file with changed bytes is refused, or is a field that guides as any other.
#[test]
fn s18_damaged_files_are_refused_or_harmless() {
    let mut table = Table::default();
    let settings = Settings::new(Vec3::splat(-1.0), Vec3::splat(1.0));
    let mut trainer = Trainer::build(settings).expect("settings");
    let mut rng = Pcg32::new(5, 1);
    let photons: Vec<Photon> = (0..5000)
        .map(|_| {
            photon(
                2.0 * Vec3::new(rng.next_f32(), rng.next_f32(), 0.5) - 1.0,
                uniform_sphere(square(&mut rng)),
            )
        })
        .collect();
    trainer.train(&photons, 5000);
    trainer.refine_rounds(2);
    let whole = trainer.to_bytes();
    let (mut taken, mut bad) = (0u32, 0u32);
    for i in 0..400usize {
        let mut bytes = whole.clone();
        let at = rng.next_u32() as usize % (bytes.len() - 4);
        match i % 3 {
            0 => bytes.truncate(at),
            1 => bytes[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes()),
            _ => bytes[at] ^= 1 << (i % 8),
        }
        match Trainer::from_bytes(&bytes) {
            Err(error) => bad += u32::from(error.to_string().is_empty()),
            Ok(damaged) => {
                taken += u32::from(bytes != whole);
                let local = damaged.freeze();
                let drawn = local
                    .at(Vec3::ZERO, None, Rgb::ONE)
                    .sample(Vec2::splat(0.5), square(&mut rng));
                bad += u32::from(!(drawn.pdf > 0.0 && drawn.direction.is_finite()));
            }
        }
    }
    table.hold(
        "S18",
        "400 damaged field files: those that are not noticed",
        "guide",
        0.0,
        taken.into(),
    );
    table.hold(
        "S18",
        "400 damaged field files: those without a message",
        "guide",
        0.0,
        bad.into(),
    );
}
