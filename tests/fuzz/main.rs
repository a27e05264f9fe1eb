//! Hostile input in every test run: bounded, and the same each time. See the readme.

mod mutate;
mod sweep;
mod targets;

use mutate::{Reproduce, mutated};
use std::path::{Path, PathBuf};
use twintree::film::part::{self, Identity, Origin, Record};
use twintree::film::{Extras, Film, Pixel, Shard};
use twintree::guide::{Photon, Settings, Trainer};
use twintree::image::{Image, WriteOptions, write};
use twintree::math::warp::uniform_sphere;
use twintree::math::{Pcg32, Rgb, Vec2, Vec3};

/// The files of a folder of the corpus, by name.
fn corpus(folder: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fuzz/corpus")
        .join(folder);
    let entries = std::fs::read_dir(&path).expect("the corpus is there");
    let mut paths: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
    paths.sort();
    let read = |path: PathBuf| {
        let bytes = std::fs::read(&path).expect("a file");
        (path, bytes)
    };
    paths.into_iter().map(read).collect()
}

/// Tries `rounds` mutations of every file of a folder; some must be accepted, or only the first
/// check of a reader would have been tested.
fn attack(folder: &str, rounds: u64, accepted_at_least: usize, target: impl Fn(Vec<u8>) -> bool) {
    attack_by_ending(folder, rounds, accepted_at_least, |input, _| target(input));
}

/// The same of readers that choose by how the file's name ends.
fn attack_by_ending(
    folder: &str,
    rounds: u64,
    accepted_at_least: usize,
    target: impl Fn(Vec<u8>, &str) -> bool,
) {
    for (stream, (path, seed)) in corpus(folder).into_iter().enumerate() {
        let ending = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or_default();
        let seed_is_taken = target(seed.clone(), ending);
        assert!(seed_is_taken, "{} itself is refused", path.display());
        let mut rng = Pcg32::new(7, stream as u64);
        let mut accepted = 0;
        for round in 0..rounds {
            let input = mutated(&seed, &mut rng);
            let guard = Reproduce::new(folder, &path, round, &input);
            accepted += usize::from(target(input, ending));
            guard.survived();
        }
        println!(
            "{}: {accepted} of {rounds} mutations accepted",
            path.display()
        );
        assert!(
            accepted >= accepted_at_least,
            "{}: {accepted}",
            path.display()
        );
    }
    assert_memory();
}

/// All of this needs little memory: huge counts are refused before anything is allocated for them.
fn assert_memory() {
    let Ok(status) = std::fs::read_to_string("/proc/self/status") else {
        return;
    };
    let peak = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kib = peak.and_then(|p| p.trim().trim_end_matches("kB").trim().parse::<u64>().ok());
    let kib = kib.expect("the peak of memory");
    assert!(kib < 1 << 20, "{kib} KiB were needed");
}

#[test]
fn meshes() {
    attack("mesh", 3000, 0, |input| targets::mesh(&input));
}

#[test]
fn models() {
    attack("gltf", 2000, 100, |input| targets::gltf(&input));
}

#[test]
fn materials_of_models() {
    attack("mtl", 2000, 100, |input| targets::mtl(&input));
}

#[test]
fn scenes() {
    attack("xml", 1000, 1, |input| targets::xml(&input));
}

#[test]
fn pbrt_scenes() {
    attack("pbrt", 2000, 1, |input| targets::pbrt(&input));
}

#[test]
fn fields() {
    attack("field", 2000, 50, |input| {
        targets::field(&input) | targets::field(&targets::mended_field(input))
    });
}

#[test]
fn images() {
    attack("image", 2000, 1, |input| targets::image(&input, "exr"));
}

#[test]
fn pictures() {
    attack_by_ending("picture", 2000, 100, |input, ending| {
        targets::image(&input, ending)
    });
}

#[test]
fn parts() {
    // Almost every byte is sealed: hardly any change is accepted.
    attack("part", 2000, 0, |input| targets::part(&input));
}

/// Writes the binary files of the corpus anew: `cargo test --test fuzz -- --ignored`.
#[test]
#[ignore = "writes the corpus"]
fn write_the_corpus() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus");
    for kind in ["field", "image", "part", "picture"] {
        std::fs::create_dir_all(folder.join(kind)).expect("a folder");
    }
    let settings = Settings {
        max_direction_level: 2,
        max_space_level: 2,
        ..Settings::new(Vec3::ZERO, Vec3::ONE)
    };
    let mut trainer = Trainer::build(settings).expect("settings");
    let mut rng = Pcg32::new(1, 1);
    let mut next = || rng.next_f32();
    let photons: Vec<Photon> = (0..100)
        .map(|_| Photon {
            position: Vec3::new(next(), next(), next()),
            direction: uniform_sphere(Vec2::new(next(), next())),
            power: Rgb::ONE,
            distance: 1.0,
            normal: Vec3::Z,
        })
        .collect();
    trainer.train(&photons, 100);
    trainer
        .save(&folder.join("field/small.field"))
        .expect("written");
    let mut image = Image::new(8, 8, &["R", "G", "B"]);
    image
        .pixels
        .iter_mut()
        .enumerate()
        .for_each(|(i, p)| *p = i as f32);
    let path = folder.join("image/ramp.exr");
    write(&path, &image, &WriteOptions::default()).expect("written");
    image.pixels.iter_mut().for_each(|p| *p /= 192.0);
    for name in ["ramp.hdr", "ramp.jpg", "ramp.png"] {
        let path = folder.join("picture").join(name);
        write(&path, &image, &WriteOptions::default()).expect("written");
    }
    let record = Record {
        identity: Identity {
            scene: 1,
            field: None,
            settings: vec![("spp".into(), "4".into())],
        },
        region: [0, 0, 4, 3],
        frame: None,
        goal: Some(4),
        shard: Shard::ALL,
        extras: Extras::default(),
        origin: Origin::default(),
    };
    let mut film = Film::vacant(record.region);
    film.tiles_mut()[0].pixels = vec![Pixel::default(); 12];
    let path = folder.join("part/small.exr");
    part::write(&path, &record, &film, part::Packing::Small).expect("written");
}
