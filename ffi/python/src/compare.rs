//! `twintree.compare`: how far an image is from a reference.

use crate::arrays::{self, floats};
use crate::failure::Fault;
use crate::picture::{Render, from_json};
use crate::words::{self, words};
use crate::work;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use twintree::cli::args::Command;
use twintree::cli::compare::args::CompareArgs;
use twintree::cli::compare::{measure, z_test};
use twintree::image::curve::srgb_to_linear;
use twintree::image::metrics::{Pair, views};
use twintree::image::windows::same_part;
use twintree::image::{self, Image, PixelType};
use twintree::math::Rgb;

/// Where an image comes from.
enum Source {
    File(PathBuf),
    Image(Arc<Image>, bool),
}

impl Source {
    fn of(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(render) = value.cast::<Render>() {
            return Ok(Self::Image(render.get().image.clone(), false));
        }
        let text = value.extract::<PathBuf>();
        if let Ok(path) = text {
            return Ok(Self::File(path));
        }
        let (image, shown) = from_array(name, value)?;
        Ok(Self::Image(Arc::new(image), shown))
    }

    /// The image in linear light, and whether it was made for a screen.
    fn read(&self) -> Result<(Arc<Image>, bool), Fault> {
        match self {
            Self::Image(image, shown) => Ok((image.clone(), *shown)),
            Self::File(path) => {
                let wrong = |e: image::ImageError| Fault::Value(e.to_string());
                let file = image::file::ImageFile::open(path).map_err(wrong)?;
                let shown = matches!(file.header().pixel_type, PixelType::U8 | PixelType::U16);
                let image = image::read_linear(path).map_err(wrong)?;
                Ok((Arc::new(image), shown))
            }
        }
    }
}

/// An array (H, W), (H, W, 1), (H, W, 3) or (H, W, 4) as an image; numbers of 8 bits have the sRGB
/// curve.
fn from_array(name: &str, value: &Bound<'_, PyAny>) -> PyResult<(Image, bool)> {
    let shown = value.getattr("dtype").and_then(|d| d.getattr("name"));
    let shown = shown
        .and_then(|n| n.extract::<String>())
        .is_ok_and(|n| n == "uint8");
    let array = floats(name, value)?;
    let (height, width, channels) = match array.shape.as_slice() {
        [h, w] => (*h, *w, 1),
        [h, w, c @ (1 | 3 | 4)] => (*h, *w, *c),
        _ => {
            let shape = array.shape_text();
            let text = format!(
                "{name}: expected the shape (H, W, 3), (H, W, 4), (H, W, 1) or (H, W), not {shape}"
            );
            return Err(Fault::Value(text).into());
        }
    };
    let (Ok(w), Ok(h)) = (u32::try_from(width), u32::try_from(height)) else {
        return Err(Fault::Value(format!("{name}: {width} x {height} pixels are too many")).into());
    };
    let curve = |x: f32| if shown { srgb_to_linear(x / 255.0) } else { x };
    let pixel = |p: &[f32]| match p {
        [r, g, b, ..] => Rgb::new(curve(*r), curve(*g), curve(*b)),
        _ => Rgb::splat(curve(p[0])),
    };
    let pixels: Vec<Rgb> = array.values.chunks_exact(channels).map(pixel).collect();
    Ok((Image::from_rgb(w, h, &pixels), shown))
}

/// The numbers as JSON, and the maps.
struct Outcome {
    json: String,
    shape: [usize; 2],
    flip: Vec<f32>,
    difference: Vec<Rgb>,
}

fn compared(image: &Source, reference: &Source, args: &CompareArgs) -> Result<Outcome, Fault> {
    let (reference, shown) = reference.read()?;
    let (image, _) = image.read()?;
    let wrong = |e: &dyn std::fmt::Display| {
        Fault::Value(format!(
            "they cannot be compared: {e}\n  help: both must be of one size"
        ))
    };
    let (image, reference) = same_part(&image, &reference).map_err(|e| wrong(&e))?;
    let pair = Pair::new(&image, &reference).map_err(|e| wrong(&e))?;
    let kind = if shown { "ldr" } else { "hdr" };
    let (mut errors, flip) = measure(Path::new("image"), &pair, args, kind);
    errors.z = z_test(&pair, &image, &reference);
    let json = serde_json::to_string(&errors).map_err(|e| Fault::Runtime(e.to_string()))?;
    Ok(Outcome {
        json,
        shape: [pair.height(), pair.width()],
        difference: views::difference(&pair),
        flip,
    })
}

/// How far `image` is from `reference`: each an array (H, W, 3) of linear light, or of 8 bits with
/// the sRGB curve, a `Render`, or the name of a file.
///
/// Returns the numbers of `twintree compare`: "l1", "mse", "rmse", "relmse", "relmse_trimmed",
/// "relmse_4x4", "relmse_16x16", "ssim", "psnr", "flip", "mean_ratio", "mean_ratio_rgb",
/// "fireflies", "not_finite", and "z", whether noise explains the difference, where both have the
/// layer "variance"; and "maps": "flip" (H, W), from 0 to 1, and "difference" (H, W, 3), red where
/// the image is too bright, blue where too dark.
///
/// `exposure` in stops and `data_range` are those of the command line.
#[pyfunction]
#[pyo3(signature = (image, reference, **settings))]
pub fn compare(
    py: Python<'_>,
    image: &Bound<'_, PyAny>,
    reference: &Bound<'_, PyAny>,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<Py<PyAny>> {
    crate::messages::listen();
    let mut keywords = words(settings)?;
    let other = [
        "reference",
        "json",
        "output",
        "max-relmse",
        "max-rmse",
        "max-flip",
        "min-ssim",
    ];
    words::refuse(&keywords, &other, "exposure and data_range are")?;
    keywords.push("--reference=reference".into());
    let Command::Compare(args) = words::read("compare", &["image".into()], &keywords)? else {
        return Err(Fault::Runtime("another command was read".into()).into());
    };
    let image = Source::of("image", image)?;
    let reference = Source::of("reference", reference)?;
    let Outcome {
        json,
        shape,
        flip,
        difference,
    } = work::run(py, None, move || compared(&image, &reference, &args))?;
    let [height, width] = shape;
    let numbers = from_json(py, &json)?.into_bound(py).cast_into::<PyDict>()?;
    numbers.del_item("image")?;
    let maps = PyDict::new(py);
    maps.set_item("flip", arrays::to_python(py, flip, &shape)?)?;
    let difference = arrays::flat(&difference);
    maps.set_item(
        "difference",
        arrays::to_python(py, difference, &[height, width, 3])?,
    )?;
    numbers.set_item("maps", maps)?;
    Ok(numbers.into_any().unbind())
}
