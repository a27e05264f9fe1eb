//! Images of a report, as PNG data that stands inside the page.

use super::Sweep;
use super::analysis::Findings;
use crate::image::Image;
use crate::image::curve::linear_to_srgb;
use crate::image::metrics::blocks::KnownNoise;
use crate::image::metrics::{Pair, flip, views};
use crate::math::Rgb;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Wider images are made this wide.
const WIDEST: usize = 640;
/// Configurations that are shown at the most.
const SHOWN: usize = 6;
/// Share of the pixels, the worst, that an error is measured without.
const TRIM: f64 = 1e-3;

/// The images of a report.
#[derive(Debug)]
pub struct Pictures {
    /// The reference.
    pub reference: Picture,
    /// Configurations, the first of the plan first.
    pub list: Vec<Picture>,
}

/// An image.
#[derive(Debug)]
pub struct Picture {
    /// The configuration.
    pub name: String,
    /// Size as shown.
    pub size: (usize, usize),
    /// The image, as a data URI.
    pub data: String,
    /// The map of its FLIP errors and their mean; the reference has none.
    pub flip: Option<(String, f64)>,
}

impl Pictures {
    /// Draws the configurations that matter: the first, the unguided, those that are recommended,
    /// the best and the worst. `image` finds the last image of a configuration.
    pub fn of(
        sweep: &Sweep,
        findings: &Findings,
        reference: &Image,
        exposure: f32,
        image: impl Fn(&str) -> Option<Image>,
    ) -> Self {
        let pixels = reference.rgb();
        let width = reference.width as usize;
        let list = names(sweep, findings).into_iter().filter_map(|name| {
            let image = image(&name)?;
            let pair = Pair::new(&image, reference).ok()?;
            let map = flip::hdr(&pair);
            let (data, size) = show(pair.image(), width, exposure);
            let (heat, _) = show(&views::heat(&map), width, 0.0);
            Some(Picture {
                name,
                size,
                data,
                flip: Some((heat, flip::mean(&map))),
            })
        });
        let list = list.collect();
        let (data, size) = show(&pixels, width, exposure);
        let reference = Picture {
            name: "reference".into(),
            size,
            data,
            flip: None,
        };
        Self { reference, list }
    }
}

fn names(sweep: &Sweep, findings: &Findings) -> Vec<String> {
    let by_error =
        |a: &&super::finding::Finding, b: &&super::finding::Finding| a.error.total_cmp(&b.error);
    let all = || findings.configurations.iter();
    let first = sweep.setting.configurations.iter().take(1).map(|c| &c.name);
    let unguided = all().filter(|f| f.name == "guide-none").map(|f| &f.name);
    let extremes = all()
        .min_by(by_error)
        .into_iter()
        .chain(all().max_by(by_error));
    let wanted = first
        .chain(unguided)
        .chain(findings.advice.iter().map(|a| &a.name))
        .chain(extremes.map(|f| &f.name));
    let mut names: Vec<String> = Vec::new();
    for name in wanted {
        if !names.contains(name) && names.len() < SHOWN {
            names.push(name.clone());
        }
    }
    names
}

/// The error that an image has by itself, as its variance layer tells: relMSE without the worst
/// pixels.
pub fn own_error(image: &Image) -> Option<f64> {
    let variances = KnownNoise::of(image)?.variance;
    let colors = image.rgb();
    let relative = colors.iter().zip(&variances).map(|(c, v)| {
        let sum: f32 = (0..3).map(|i| v[i] / (c[i] * c[i] + 0.01)).sum();
        f64::from(sum) / 3.0
    });
    let mut relative: Vec<f64> = relative.filter(|x| x.is_finite()).collect();
    relative.sort_unstable_by(f64::total_cmp);
    let kept = relative.len() - (relative.len() as f64 * TRIM) as usize;
    (kept > 0).then(|| relative[..kept].iter().sum::<f64>() / kept as f64)
}

/// Linear pixels as a data URI, and the size as shown.
fn show(pixels: &[Rgb], width: usize, exposure: f32) -> (String, (usize, usize)) {
    let height = pixels.len() / width.max(1);
    let (pixels, (width, height)) = shrunk(pixels, (width, height));
    let gain = exposure.exp2();
    let codes = pixels.iter().flat_map(|c| {
        let shown = (*c * gain).clamp(Rgb::ZERO, Rgb::ONE).to_array();
        shown.map(|x| (255.0 * linear_to_srgb(x)).round() as u8)
    });
    let codes: Vec<u8> = codes.collect();
    let uri = match png((width as u32, height as u32), &codes) {
        Ok(bytes) => format!("data:image/png;base64,{}", STANDARD.encode(bytes)),
        // Into memory, and as many bytes as the size says: nothing can fail.
        Err(_) => String::new(),
    };
    (uri, (width, height))
}

fn png((width, height): (u32, u32), codes: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(codes)?;
    writer.finish()?;
    Ok(bytes)
}

/// The image at [`WIDEST`] at the most; every pixel is the mean of those that it covers.
fn shrunk(pixels: &[Rgb], (width, height): (usize, usize)) -> (Vec<Rgb>, (usize, usize)) {
    if width <= WIDEST || height == 0 {
        return (pixels.to_vec(), (width, height));
    }
    let rows = (height * WIDEST / width).max(1);
    let of = |i: usize, parts: usize, whole: usize| {
        i * whole / parts..((i + 1) * whole / parts).max(i * whole / parts + 1)
    };
    let mut small = Vec::with_capacity(WIDEST * rows);
    for y in 0..rows {
        for x in 0..WIDEST {
            let (ys, xs) = (of(y, rows, height), of(x, WIDEST, width));
            let count = (ys.len() * xs.len()) as f32;
            let covered = ys.flat_map(|y| &pixels[y * width..][xs.clone()]);
            small.push(covered.copied().sum::<Rgb>() / count);
        }
    }
    (small, (WIDEST, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_images_shrink_and_keep_their_mean() {
        let pixels: Vec<Rgb> = (0..1280 * 2).map(|i| Rgb::splat((i % 7) as f32)).collect();
        let (small, size) = shrunk(&pixels, (1280, 2));
        assert_eq!((size, small.len()), ((640, 1), 640));
        let mean = |p: &[Rgb]| p.iter().map(|c| f64::from(c.x)).sum::<f64>() / p.len() as f64;
        assert!((mean(&small) - mean(&pixels)).abs() < 1e-5);
        assert_eq!(shrunk(&pixels[..6], (3, 2)).1, (3, 2));
    }

    #[test]
    fn pictures_are_png() {
        let (uri, size) = show(&[Rgb::ZERO, Rgb::ONE, Rgb::ZERO, Rgb::ONE], 2, 0.0);
        assert_eq!(size, (2, 2));
        let bytes = STANDARD
            .decode(uri.strip_prefix("data:image/png;base64,").unwrap())
            .unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut codes = vec![0; 12];
        reader.next_frame(&mut codes).unwrap();
        assert_eq!(codes, [0, 0, 0, 255, 255, 255, 0, 0, 0, 255, 255, 255]);
    }
}
