//! Denoised renders of the project's scenes against converged ones, by a real Open Image Denoise:
//! the one that `TWINTREE_OIDN`, the system or Python's environment has. Without it the test says
//! that it is skipped, and passes.

use std::path::{Path, PathBuf};
use std::process::Command;
use twintree::image::denoise::{Denoiser, NOISY};
use twintree::image::metrics::{Pair, errors::Errors};
use twintree::image::{Image, read};
use twintree::math::Rgb;

/// Scenes that have noise, and samples a pixel of their references: what is left of the noise there
/// counts with what the denoiser leaves, and is to be far below a third.
const SCENES: [(&str, u32); 5] = [
    ("cornell", 512),
    ("door", 128),
    ("pool", 128),
    ("caustic", 128),
    ("materials", 256),
];
/// What may be left of the error.
const MOST: f64 = 1.0 / 3.0;

fn render(scene: &str, out: &Path, words: &str) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = format!("scenes/{scene}/{scene}.xml");
    let status = Command::new(assert_cmd::cargo::cargo_bin!("twintree"))
        .current_dir(root)
        .args(["render", &file, "--quiet", "--guide", "double"])
        .args(["--width", "200", "--format", "float", "-o"])
        .arg(out)
        .args(words.split_whitespace())
        .status();
    assert!(status.unwrap().success(), "{scene} {words}");
}

fn picture(image: &Image, names: [&str; 3]) -> Image {
    let channels = names.map(|name| image.channel(name).expect(name));
    let pixels: Vec<Rgb> = image
        .pixels
        .chunks_exact(image.channels.len())
        .map(|pixel| Rgb::from(channels.map(|c| pixel[c])))
        .collect();
    Image::from_rgb(image.width, image.height, &pixels)
}

fn error(image: &Image, reference: &Image) -> f64 {
    Errors::of(&Pair::new(image, reference).unwrap()).rel_mse
}

#[test]
fn at_most_a_third_of_the_error_is_left_and_every_number_is_finite() {
    if let Err(why) = Denoiser::find(None) {
        eprintln!("skipped: {why}");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| -> PathBuf { folder.path().join(name) };
    let mut worse = Vec::new();
    for (scene, samples) in SCENES {
        render(scene, &path("a.exr"), "--spp 16 --seed 1 --denoise");
        let words = format!("--spp {samples} --seed 2");
        render(scene, &path("r.exr"), &words);
        let (image, reference) = (read(&path("a.exr")).unwrap(), read(&path("r.exr")).unwrap());
        assert!(image.pixels.iter().all(|x| x.is_finite()), "{scene}");
        let noisy = error(&picture(&image, NOISY), &reference);
        let denoised = error(&picture(&image, ["R", "G", "B"]), &reference);
        let ratio = denoised / noisy;
        println!("{scene}: relMSE {noisy:.5} noisy, {denoised:.5} denoised, {ratio:.3} of it");
        if ratio > MOST {
            worse.push(scene);
        }
    }
    assert!(worse.is_empty(), "more than a third is left: {worse:?}");
}
