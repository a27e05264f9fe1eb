//! What came of a render: arrays, statistics, and files of it.

use crate::arrays;
use crate::failure::Fault;
use crate::words::{self, words};
use crate::work;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::PathBuf;
use std::sync::Arc;
use twintree::cli::args::Command;
use twintree::cli::output::{Outputs, check_lossless};
use twintree::image::Image;

/// A picture, as its threads leave it.
pub struct Picture {
    /// The picture and its layers.
    pub image: Image,
    /// Measurements, as JSON.
    pub stats: String,
    /// Brightness of 8-bit formats, in stops.
    pub exposure: f32,
    /// Ctrl-C has ended it.
    pub interrupted: bool,
}

/// What came of a render.
///
/// `render["image"]` is the picture, an array (H, W, 3) of float32: linear sRGB, rows from the top;
/// (H, W, 4) with `alpha=True`. Layers are beside it by their names, such as `render["albedo"]` (H,
/// W, 3) and `render["depth"]` (H, W, 1): `arrays` is a dictionary of all.
#[pyclass(frozen, module = "twintree")]
pub struct Render {
    /// The picture and its layers.
    pub image: Arc<Image>,
    exposure: f32,
    /// Arrays by name: (H, W, C), float32.
    #[pyo3(get)]
    arrays: Py<PyDict>,
    /// Measurements: the keys of the command line's `--stats` file.
    #[pyo3(get)]
    stats: Py<PyAny>,
    /// Whether Ctrl-C has ended it before its limit.
    #[pyo3(get)]
    interrupted: bool,
}

impl Render {
    /// Makes arrays of a picture.
    pub fn new(py: Python<'_>, picture: Picture) -> PyResult<Self> {
        let image = Arc::new(picture.image);
        let arrays = PyDict::new(py);
        for (name, channels) in layers(&image) {
            let (values, shape) = py.detach(|| taken(&image, &channels));
            arrays.set_item(name, arrays::to_python(py, values, &shape)?)?;
        }
        Ok(Self {
            arrays: arrays.unbind(),
            stats: from_json(py, &picture.stats)?,
            exposure: picture.exposure,
            interrupted: picture.interrupted,
            image,
        })
    }
}

/// Layers by name, in the order of the file, with the numbers of their channels. The picture itself
/// has no name there.
fn layers(image: &Image) -> Vec<(String, Vec<usize>)> {
    let mut list: Vec<(String, Vec<usize>)> = Vec::new();
    for (number, channel) in image.channels.iter().enumerate() {
        let name = channel
            .name
            .rsplit_once('.')
            .map_or("image", |(layer, _)| layer);
        match list.iter_mut().find(|(known, _)| known == name) {
            Some((_, channels)) => channels.push(number),
            None => list.push((name.to_owned(), vec![number])),
        }
    }
    list
}

/// The numbers of some channels, with the shape of their array.
fn taken(image: &Image, channels: &[usize]) -> (Vec<f32>, [usize; 3]) {
    let all = image.channels.len();
    let pixels = image.pixels.chunks_exact(all);
    let values = pixels
        .flat_map(|p| channels.iter().map(|c| p[*c]))
        .collect();
    let (height, width) = (image.height as usize, image.width as usize);
    (values, [height, width, channels.len()])
}

/// What JSON says, in Python's own types.
pub fn from_json(py: Python<'_>, json: &str) -> PyResult<Py<PyAny>> {
    let value = py.import("json")?.call_method1("loads", (json,))?;
    Ok(value.unbind())
}

#[pymethods]
impl Render {
    fn __getitem__(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        let found = self.arrays.bind(py).get_item(name)?;
        found.map(Bound::unbind).ok_or_else(|| {
            let names = self.names(py);
            PyKeyError::new_err(format!(
                "there is no layer \"{name}\", only {names}: aovs= asks for more"
            ))
        })
    }

    fn __contains__(&self, py: Python<'_>, name: &str) -> PyResult<bool> {
        self.arrays.bind(py).contains(name)
    }

    /// Writes the picture: the name's end says how (`.exr .hdr .tif .png .jpg`). Keywords are the
    /// command line's: `format="float"` and `compression=` of an EXR, `exposure=` in stops and
    /// `view=` of `.png` and `.jpg`. Raises `ValueError` for a name that tells no format,
    /// `RuntimeError` where the file cannot be written.
    #[pyo3(signature = (path, **settings))]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let keywords = words(settings)?;
        let known = ["format", "compression", "exposure", "view"];
        if let Some(other) = keywords
            .iter()
            .find(|w| !known.iter().any(|k| is_option(w, k)))
        {
            let name = other
                .trim_start_matches("--")
                .split('=')
                .next()
                .unwrap_or("");
            let text = format!(
                "save() has no {}, only {}",
                name.replace('-', "_"),
                known.join(", ")
            );
            return Err(Fault::Type(text).into());
        }
        let Command::Render(args) = words::read("render", &["picture".into()], &keywords)? else {
            return Err(Fault::Runtime("another command was read".into()).into());
        };
        let image = self.image.clone();
        let exposure = args.files.exposure.unwrap_or(self.exposure);
        work::run(py, None, move || {
            let outputs = Outputs::of_images(vec![path])?;
            if image.channels.iter().any(|c| c.name.starts_with("Crypto")) {
                check_lossless(&args.files.exr)?;
            }
            let (exr, view) = (&args.files.exr, &args.files.view.view);
            Ok(outputs.write_images(&image, exr, exposure, view)?)
        })
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let (width, height) = (self.image.width, self.image.height);
        format!(
            "<twintree.Render of {width} x {height} pixels: {}>",
            self.names(py)
        )
    }
}

impl Render {
    fn names(&self, py: Python<'_>) -> String {
        let names: Vec<String> = PyList::new(py, self.arrays.bind(py).keys())
            .and_then(|list| list.extract())
            .unwrap_or_default();
        names.join(", ")
    }
}

/// Whether a word is an option, with a value or without.
fn is_option(word: &str, name: &str) -> bool {
    word.trim_start_matches("--").split('=').next() == Some(name)
}
