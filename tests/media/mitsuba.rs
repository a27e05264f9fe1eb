//! Pictures of media beside those of Mitsuba 3, which `tests/vectors/media.py` wrote down.

use exr::prelude::read_first_rgba_layer_from_file;
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use twintree::math::Vec3;
use twintree::medium::grids::Vol;

/// |z| that 99.9 % of normal deviates stay below.
const BAND: f64 = 3.29;
const BLOCK: usize = 8;
/// Renders of each scene: their scatter tells the error.
const SEEDS: usize = 5;

/// Means of blocks of a picture, row by row, by channel.
fn blocks(path: &Path) -> Vec<f64> {
    let image = read_first_rgba_layer_from_file(
        path,
        |size, _| (size.width(), vec![[0.0f32; 3]; size.area()]),
        |(width, pixels), at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y() * *width + at.x()] = [r, g, b];
        },
    );
    let (width, pixels) = image.unwrap().layer_data.channel_data.pixels;
    let height = pixels.len() / width;
    let mut means = Vec::new();
    for (y, x) in (0..height / BLOCK).flat_map(|y| (0..width / BLOCK).map(move |x| (y, x))) {
        let inside = (0..BLOCK * BLOCK).map(|i| {
            let at = (y * BLOCK + i / BLOCK) * width + x * BLOCK + i % BLOCK;
            pixels[at].map(f64::from)
        });
        let sum = inside.fold([0.0; 3], |sum, p| {
            [sum[0] + p[0], sum[1] + p[1], sum[2] + p[2]]
        });
        means.extend(sum.map(|s| s / (BLOCK * BLOCK) as f64));
    }
    means
}

/// Writes a grid beside a scene.
fn write_grid(path: &Path, grid: &Value) {
    let list = |key: &str| grid[key].as_array().unwrap().iter();
    let size: Vec<u32> = list("size").map(|n| n.as_u64().unwrap() as u32).collect();
    let vol = Vol {
        resolution: size.try_into().unwrap(),
        channels: grid["channels"].as_u64().unwrap() as u32,
        bbox: [Vec3::ZERO, Vec3::ONE],
        values: list("values").map(|x| x.as_f64().unwrap() as f32).collect(),
    };
    vol.write(path).unwrap();
}

/// Share of the blocks that agree, and ratio of the means with its error.
fn compare(file: &str, theirs: &Value, more: &[&str]) -> (f64, f64, f64) {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (
        folder.path().join("scene.xml"),
        folder.path().join("out.exr"),
    );
    std::fs::write(&scene, file).unwrap();
    for (name, grid) in theirs["grids"].as_object().into_iter().flatten() {
        write_grid(&folder.path().join(format!("{name}.vol")), grid);
    }
    let renders: Vec<Vec<f64>> = (0..SEEDS)
        .map(|seed| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_twintree"));
            command.arg("render").arg(&scene).arg("-o").arg(&out);
            command.args(["--quiet", "--format", "float", "--spp", "128"]);
            command.args(["--seed", &seed.to_string()]).args(more);
            assert!(command.status().unwrap().success());
            blocks(&out)
        })
        .collect();
    let numbers = |key: &str| {
        theirs[key]
            .as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
    };
    let n = SEEDS as f64;
    let (mut inside, mut count, mut ours_all, mut theirs_all, mut variance_all) =
        (0, 0, 0.0, 0.0, 0.0);
    for (i, (mean, error)) in numbers("means").zip(numbers("errors")).enumerate() {
        let ours = renders.iter().map(|r| r[i]).sum::<f64>() / n;
        let spread = renders.iter().map(|r| (r[i] - ours).powi(2)).sum::<f64>();
        let variance = spread / (n - 1.0) / n + error * error;
        count += 1;
        // Few seeds know their scatter badly: 0.3 % of the mean is the least that counts.
        let floor = (0.003 * mean).powi(2);
        inside += usize::from(((ours - mean).powi(2) / (variance + floor)).sqrt() < BAND);
        ours_all += ours;
        theirs_all += mean;
        variance_all += variance;
    }
    let share = inside as f64 / f64::from(count);
    (
        share,
        ours_all / theirs_all,
        variance_all.sqrt() / theirs_all,
    )
}

/// Scenes that are rendered guided as well.
const GUIDED: [&str; 4] = ["nested", "matt in fog", "cloudy glass", "cloud"];

/// By `tests/vectors/media.py`.
#[test]
fn media_look_as_in_mitsuba() {
    let scenes: Value = serde_json::from_str(include_str!("../vectors/media.json")).unwrap();
    for (name, scene) in scenes.as_object().unwrap() {
        let guided: &[&str] = &["--guide", "double", "--trial", "never"];
        let ways = [&["--guide", "none"], guided];
        for way in ways
            .into_iter()
            .take(1 + usize::from(GUIDED.contains(&&**name)))
        {
            let file = scene["file"].as_str().unwrap();
            let (share, ratio, error) = compare(file, scene, way);
            println!("{name} {way:?}: {share:.3} of blocks, mean {ratio:.4} +- {error:.4}");
            assert!(
                share >= 0.97,
                "{name} {way:?}: only {share} of the blocks agree"
            );
            let allowed = (3.0 * error).max(0.01);
            assert!(
                (ratio - 1.0).abs() < allowed,
                "{name} {way:?}: {ratio} +- {error}"
            );
        }
    }
}
