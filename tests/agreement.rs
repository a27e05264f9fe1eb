//! Agreement with Mitsuba 3 on scenes by others.
//!
//! The scenes and their references are not part of the project. Set `TWINTREE_SHARED_SCENES` to a
//! folder that has, for each scene named below, the scene, `ref_320.exr` (Mitsuba 3, plain path
//! tracing, 320 wide, box filter, depth 12) and `ref_320_stderr.exr` (the standard error of that
//! mean). Without it the tests say so and pass.
//!
//! Means of 8 x 8 blocks are compared by a z-test that counts both images' errors: 99 % of the
//! blocks must lie within the band that holds 99.9 % of equal ones, and the mean of the image must
//! agree within 1 % or 3 standard errors.
//!
//! Scenes with rare, very bright paths (caustics, light through a gap) need many samples before a
//! block's own variance tells the truth about its error; those take minutes and are ignored unless
//! asked for: `cargo test --release --test agreement -- --ignored`.

use exr::prelude::{ReadChannels, ReadLayers, read};
use std::path::{Path, PathBuf};
use std::process::Command;

/// |z| that 99.9 % of normal deviates stay below.
const BAND: f64 = 3.29;
const BLOCK: usize = 8;

/// A picture as planes of channels.
struct Planes {
    width: usize,
    height: usize,
    channels: Vec<(String, Vec<f32>)>,
}

impl Planes {
    fn read(path: &Path) -> Self {
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(path)
            .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let layer = image.layer_data;
        let channels = layer
            .channel_data
            .list
            .iter()
            .map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect()))
            .collect();
        Self {
            width: layer.size.x(),
            height: layer.size.y(),
            channels,
        }
    }

    fn plane(&self, name: &str) -> &[f32] {
        let found = self.channels.iter().find(|(n, _)| n == name);
        &found.unwrap_or_else(|| panic!("no channel {name}")).1
    }
}

/// A scene and how to render it.
struct Case {
    folder: &'static str,
    file: &'static str,
    arguments: &'static [&'static str],
    spp: u32,
    /// Relative tolerance of the image's mean, with the reason where it is not 1 %.
    mean_tolerance: f64,
}

fn render(case: &Case, root: &Path, out: &Path) {
    let spp = case.spp.to_string();
    let status = Command::new(env!("CARGO_BIN_EXE_twintree"))
        .arg("render")
        .arg(root.join(case.folder).join(case.file))
        .arg("-o")
        .arg(out)
        .args([
            "--width",
            "320",
            "--max-depth",
            "12",
            "--rfilter",
            "box",
            "--quiet",
        ])
        .args(["--format", "float", "--aov", "variance", "--spp", &spp])
        .args(case.arguments)
        .status()
        .expect("twintree runs");
    assert!(status.success(), "{}: {status}", case.folder);
}

/// Mean and variance of the mean over one block of one channel.
fn block(
    plane: &[f32],
    variance: impl Fn(usize) -> f64,
    width: usize,
    x0: usize,
    y0: usize,
) -> (f64, f64) {
    let mut sum = (0.0, 0.0);
    for y in y0..y0 + BLOCK {
        for x in x0..x0 + BLOCK {
            let i = y * width + x;
            sum.0 += f64::from(plane[i]);
            sum.1 += variance(i);
        }
    }
    let n = (BLOCK * BLOCK) as f64;
    (sum.0 / n, sum.1 / (n * n))
}

fn check(case: &Case) {
    let Some(root) = std::env::var_os("TWINTREE_SHARED_SCENES").map(PathBuf::from) else {
        println!("skipped: TWINTREE_SHARED_SCENES is not set");
        return;
    };
    let reference = Planes::read(&root.join(case.folder).join("ref_320.exr"));
    let errors = Planes::read(&root.join(case.folder).join("ref_320_stderr.exr"));
    let out = tempfile::tempdir().expect("a temporary folder");
    let out = out.path().join("out.exr");
    render(case, &root, &out);
    let image = Planes::read(&out);
    assert_eq!(
        (image.width, image.height),
        (reference.width, reference.height)
    );

    let (mut blocks, mut inside) = (0, 0);
    let (mut total, mut total_reference, mut total_variance) = (0.0, 0.0, 0.0);
    for channel in ["R", "G", "B"] {
        let ours = image.plane(channel);
        let ours_variance = image.plane(&format!("variance.{channel}"));
        let theirs = reference.plane(channel);
        let their_error = errors.plane(channel);
        for y in (0..image.height - BLOCK + 1).step_by(BLOCK) {
            for x in (0..image.width - BLOCK + 1).step_by(BLOCK) {
                let a = block(ours, |i| f64::from(ours_variance[i]), image.width, x, y);
                let b = block(
                    theirs,
                    |i| f64::from(their_error[i]).powi(2),
                    image.width,
                    x,
                    y,
                );
                // The floor is the rounding of the reference's half floats.
                let floor = (b.0 * 5e-4).powi(2) + 1e-12;
                let z = (a.0 - b.0) / (a.1 + b.1 + floor).sqrt();
                blocks += 1;
                inside += usize::from(z.abs() < BAND);
                total += a.0;
                total_reference += b.0;
                total_variance += a.1 + b.1;
            }
        }
    }
    let share = inside as f64 / blocks as f64;
    let ratio = total / total_reference;
    let error = total_variance.sqrt() / total_reference;
    println!(
        "{}: {:.2} % of blocks agree, mean ratio {ratio:.5} +- {error:.5}",
        case.folder,
        share * 100.0
    );
    assert!(
        share >= 0.99,
        "{}: only {:.2} % of blocks agree",
        case.folder,
        share * 100.0
    );
    let tolerance = case.mean_tolerance.max(3.0 * error);
    assert!(
        (ratio - 1.0).abs() < tolerance,
        "{}: mean ratio {ratio}",
        case.folder
    );
}

#[test]
fn cornell_box_agrees() {
    check(&Case {
        folder: "cbox",
        file: "scene_v3.xml",
        arguments: &[],
        spp: 64,
        mean_tolerance: 0.01,
    });
}

#[test]
#[ignore = "minutes: rare bright paths need many samples before their variance can be trusted"]
fn veach_ajar_agrees() {
    check(&Case {
        folder: "veach-ajar",
        file: "scene.xml",
        arguments: &[],
        spp: 1024,
        mean_tolerance: 0.01,
    });
}

#[test]
#[ignore = "minutes: rare bright paths need many samples before their variance can be trusted"]
fn kitchen_agrees() {
    check(&Case {
        folder: "kitchen",
        file: "scene_v3_env.xml",
        arguments: &[],
        spp: 1024,
        mean_tolerance: 0.01,
    });
}

#[test]
#[ignore = "minutes: rare bright paths need many samples before their variance can be trusted"]
fn torus_agrees() {
    check(&Case {
        folder: "torus",
        file: "scene_v3_env.xml",
        arguments: &[],
        spp: 4096,
        mean_tolerance: 0.01,
    });
}

#[test]
#[ignore = "minutes: rare bright paths need many samples before their variance can be trusted"]
fn pool_agrees() {
    check(&Case {
        folder: "lux-pool",
        file: "scene.xml",
        arguments: &[],
        spp: 1024,
        mean_tolerance: 0.01,
    });
}

#[test]
#[ignore = "minutes: rare bright paths need many samples before their variance can be trusted"]
fn caustics_agree() {
    check(&Case {
        folder: "cbox-caustics",
        file: "scene11_v3_area.xml",
        arguments: &[],
        spp: 1024,
        mean_tolerance: 0.01,
    });
}
