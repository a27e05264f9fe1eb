//! Do two renders of one scene agree within their noise?
//!
//! ```sh
//! twintree render scene.xml -o a.exr --seed 1 --rfilter box --format float --aov variance
//! twintree render scene.xml -o b.exr --seed 2 --rfilter box --format float --aov variance
//! cargo run --release --example z_test -- a.exr b.exr
//! ```
//!
//! Each EXR carries the variance of every pixel's mean. With a box filter and different seeds all
//! pixels are independent, so the difference of two means over a block, divided by the root of its
//! variance, is a standard normal deviate: 99.9 % of the blocks must lie within 3.29 (99 % are
//! asked for, as a pixel's variance is itself an estimate), and the mean of the whole image, which
//! has the smallest error of all, within 4 standard errors. Exit code 0: they agree, 1: they do
//! not, 2: they cannot be compared.

use std::path::Path;
use std::process::ExitCode;
use twintree::image::{self, Image};

/// |z| that 99.9 % of normal deviates stay below.
const BAND: f64 = 3.29;
/// Share of blocks that must stay below it.
const SHARE: f64 = 0.99;
/// |z| allowed to the mean of the image: one pair of equal images in 16 000 is further apart.
const MEAN_BAND: f64 = 4.0;
/// Side of a block in pixels.
const BLOCK: u32 = 8;

/// Sum of pixels and the variance of that sum.
#[derive(Clone, Copy, Default)]
struct Sum {
    value: f64,
    variance: f64,
}

impl Sum {
    fn add(&mut self, other: Self) {
        self.value += other.value;
        self.variance += other.variance;
    }

    /// Difference in standard errors.
    fn z(self, other: Self) -> f64 {
        let error = (self.variance + other.variance).sqrt();
        // Pixels that see nothing have no variance; they agree where they are equal.
        (self.value - other.value) / error.max(1e-9)
    }
}

/// What comparing two images came to.
#[derive(Default)]
struct Agreement {
    blocks: u32,
    inside: u32,
    /// Mean over all pixels of each image, one after the other for R, G and B.
    mean_z: Vec<f64>,
    ratio: Vec<f64>,
}

/// A block of one channel.
fn block(image: &Image, channel: [usize; 2], x0: u32, y0: u32) -> Sum {
    let mut sum = Sum::default();
    for y in y0..image.height.min(y0 + BLOCK) {
        for x in x0..image.width.min(x0 + BLOCK) {
            let pixel = image.pixel(x, y);
            sum.add(Sum {
                value: f64::from(pixel[channel[0]]),
                variance: f64::from(pixel[channel[1]]),
            });
        }
    }
    sum
}

/// Where a channel and its variance are.
fn planes(image: &Image, name: &str) -> Result<[usize; 2], String> {
    let find = |name: &str| {
        let lacks = || format!("there is no channel {name}: render with --aov variance");
        image.channel(name).ok_or_else(lacks)
    };
    Ok([find(name)?, find(&format!("variance.{name}"))?])
}

fn compare(a: &Image, b: &Image) -> Result<Agreement, String> {
    if (a.width, a.height) != (b.width, b.height) {
        return Err("the images differ in size".to_string());
    }
    if a.pixels.iter().chain(&b.pixels).any(|v| !v.is_finite()) {
        return Err("a number is not finite".to_string());
    }
    let mut agreement = Agreement::default();
    for name in ["R", "G", "B"] {
        let (in_a, in_b) = (planes(a, name)?, planes(b, name)?);
        let (mut all_a, mut all_b) = (Sum::default(), Sum::default());
        for y in (0..a.height).step_by(BLOCK as usize) {
            for x in (0..a.width).step_by(BLOCK as usize) {
                let (one, other) = (block(a, in_a, x, y), block(b, in_b, x, y));
                agreement.blocks += 1;
                agreement.inside += u32::from(one.z(other).abs() < BAND);
                all_a.add(one);
                all_b.add(other);
            }
        }
        if all_a.variance <= 0.0 || all_b.variance <= 0.0 {
            return Err(format!("channel {name} has no variance"));
        }
        agreement.mean_z.push(all_a.z(all_b));
        agreement.ratio.push(all_a.value / all_b.value);
    }
    Ok(agreement)
}

fn run(a: &str, b: &str) -> Result<bool, String> {
    let read = |path: &str| image::read(Path::new(path)).map_err(|e| e.to_string());
    let agreement = compare(&read(a)?, &read(b)?)?;
    let share = f64::from(agreement.inside) / f64::from(agreement.blocks);
    println!("{:.2} % of blocks within {BAND} sigma", share * 100.0);
    for (name, (z, ratio)) in ["R", "G", "B"]
        .iter()
        .zip(agreement.mean_z.iter().zip(&agreement.ratio))
    {
        println!("{name}: ratio of means {ratio:.5}, {z:+.2} sigma");
    }
    Ok(share >= SHARE && agreement.mean_z.iter().all(|z| z.abs() < MEAN_BAND))
}

fn main() -> ExitCode {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let [a, b] = files.as_slice() else {
        eprintln!("usage: z_test a.exr b.exr");
        return ExitCode::from(2);
    };
    match run(a, b) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => {
            println!("the images differ by more than their noise");
            ExitCode::from(1)
        }
        Err(reason) => {
            eprintln!("{a}, {b}: {reason}");
            ExitCode::from(2)
        }
    }
}
