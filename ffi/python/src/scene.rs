//! Scenes: from files, from arrays, or from both.

use crate::additions::{self, Addition, OfVertices};
use crate::failure::Fault;
use crate::state::{Ready, State};
use crate::words::{scene_words, words};
use crate::work;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};
use twintree::cli::input::Input;
use twintree::cli::load::Picture;
use twintree::cli::ray_args::RayArgs;
use twintree::report::totals::triangles;

/// A scene: shapes, materials, lights and a camera.
///
/// `Scene(**options)` is empty: `add_mesh` and `add_light` fill it, and a camera frames what is
/// there. `twintree.load(path)` reads one from files. The options are those of the command line for
/// models: `camera="orbit:30,20"` or `camera=(x, y, z)`, `look_at=(x, y, z)`, `fov=35`,
/// `sky="studio"`, `envmap=`, `ground=`, `material=`, `up="y"`.
///
/// Scenes may be used from many threads at once.
#[pyclass(frozen, module = "twintree")]
pub struct Scene {
    state: Mutex<State>,
}

impl Scene {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The scene built for a render, from what was built before where that serves. Called without
    /// Python's lock.
    pub fn ready(&self, picture: Picture, rays: &RayArgs) -> Result<Ready, Fault> {
        self.state().ready(picture, rays)
    }

    /// The names of its files, for the command line's parser.
    pub fn files(&self) -> Vec<OsString> {
        self.state().args.files.clone()
    }

    fn change(&self, py: Python<'_>, change: impl FnOnce(&mut State) + Send) {
        py.detach(|| {
            let mut state = self.state();
            change(&mut state);
            state.forget();
        });
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (**options))]
    fn new(options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        crate::messages::listen();
        let state = Mutex::new(State::new(Vec::new(), words(options)?)?);
        Ok(Self { state })
    }

    /// Changes options: of models and arrays, `camera=`, `sky=` and the like; of a scene file,
    /// values of its `$names`. Others stay as they were.
    #[pyo3(signature = (**options))]
    fn set(&self, py: Python<'_>, options: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let (files, old, is_file) = py.detach(|| {
            let state = self.state();
            let files = match &*state.input {
                Input::Models(sources) if sources.is_empty() => Vec::new(),
                _ => state.args.files.clone(),
            };
            let is_file = matches!(&*state.input, Input::Scene(_));
            (files, state.keywords.clone(), is_file)
        });
        let new = match is_file {
            true => scene_words(options)?,
            false => words(options)?,
        };
        let name = |word: &String| {
            let mut parts = word.splitn(3, '=');
            let option = parts.next().map(str::to_owned);
            // Of values for $names there are many.
            (
                option.clone(),
                parts
                    .next()
                    .filter(|_| option.as_deref() == Some("--define"))
                    .map(str::to_owned),
            )
        };
        let names: Vec<_> = new.iter().map(name).collect();
        let kept = old.into_iter().filter(|word| !names.contains(&name(word)));
        let mut fresh = State::new(files, kept.chain(new).collect())?;
        self.change(py, |state| {
            fresh.additions = std::mem::take(&mut state.additions);
            *state = fresh;
        });
        Ok(())
    }

    /// Adds a mesh: `vertices` (N, 3), in the scene's units; `faces` (M, 3), numbers of vertices,
    /// the front counter-clockwise; `normals` (N, 3) or none; `material` as on the command line
    /// ("clay", "gold", "plastic:0.8,0.1,0.1"); `texture`, the name of an image file, is the colour
    /// of a material that names none ("clay", "matte", "plastic", "metal"), and `uvs` (N, 2) say
    /// where it lies: (0, 0) is its lower left corner, (1, 1) its upper right one, and beyond it
    /// repeats; `emission`, radiance in W m^-2 sr^-1, a number or red, green, blue, makes it a lamp
    /// that shines from its front; `smooth` computes normals where none are given. Returns what was
    /// repaired, in words.
    #[pyo3(signature = (vertices, faces, *, material = "clay", texture = None, uvs = None, normals = None, emission = None, name = None, smooth = false))]
    #[allow(clippy::too_many_arguments)]
    fn add_mesh(
        &self,
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        material: &str,
        texture: Option<PathBuf>,
        uvs: Option<&Bound<'_, PyAny>>,
        normals: Option<&Bound<'_, PyAny>>,
        emission: Option<&Bound<'_, PyAny>>,
        name: Option<String>,
        smooth: bool,
    ) -> PyResult<Vec<String>> {
        let paint = additions::paint(material, texture.as_deref(), uvs.is_some())?;
        let emission = emission
            .map(|e| additions::color("emission", e))
            .transpose()?;
        let (mesh, warnings) = additions::mesh(
            &OfVertices {
                positions: vertices,
                normals,
                uvs,
            },
            faces,
            smooth,
        )?;
        self.change(py, |state| {
            let number = state.additions.len();
            state.additions.push(Addition::Mesh {
                name: name.unwrap_or_else(|| format!("mesh {number}")),
                mesh,
                paint,
                image: texture,
                emission,
            });
        });
        Ok(warnings)
    }

    /// Adds a lamp without a body: `"point"` (position, intensity in W/sr), `"spot"` (position,
    /// target, intensity, cutoff and beam in degrees), `"directional"` (direction in which it
    /// travels, irradiance in W/m^2), `"constant"` (radiance from everywhere). Colours are a
    /// number, or red, green and blue.
    #[pyo3(signature = (kind, **settings))]
    fn add_light(
        &self,
        py: Python<'_>,
        kind: &str,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let light = additions::light(kind, settings)?;
        self.change(py, |state| state.additions.push(light));
        Ok(())
    }

    /// What the scene consists of: "files", "shapes", "triangles", "emitters", "width", "height",
    /// "spp", "max_depth", "warnings".
    fn info(&self, py: Python<'_>) -> PyResult<Py<PyDict>> {
        let loaded = work::run(py, None, || self.state().read())?;
        let of = &loaded.description;
        let info = PyDict::new(py);
        let files = self.files();
        let files: Vec<_> = files
            .iter()
            .map(|f| f.to_string_lossy().into_owned())
            .collect();
        info.set_item("files", files)?;
        info.set_item("shapes", of.shapes.len())?;
        info.set_item("triangles", triangles(of))?;
        info.set_item("emitters", of.emitters.len())?;
        info.set_item("width", of.film.width)?;
        info.set_item("height", of.film.height)?;
        info.set_item("spp", of.render.spp)?;
        info.set_item("max_depth", of.render.max_depth)?;
        info.set_item("warnings", of.warnings.clone())?;
        Ok(info.unbind())
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        py.detach(|| {
            let state = self.state();
            let (title, more) = (state.args.title(), state.additions.len());
            format!("<twintree.Scene of {title}, {more} added>")
        })
    }
}

/// Reads a scene file (`.xml` of Mitsuba, `.pbrt`) or models (`.ply .obj .stl .gltf .glb`), several
/// of them as further arguments.
///
/// Of a scene file, keywords are values of its `$names` (`load("a.xml", spp=16)`), but for
/// `lenient`, `texture_memory`, `limit_decoded` and `define`, a dictionary of more such values. Of
/// models, keywords are the options of [`Scene`].
///
/// Raises `ValueError` with the file, line and column of what is wrong.
#[pyfunction]
#[pyo3(signature = (path, *more, **options))]
pub fn load(
    py: Python<'_>,
    path: std::path::PathBuf,
    more: &Bound<'_, PyTuple>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Scene> {
    crate::messages::listen();
    let mut files: Vec<OsString> = vec![path.into()];
    for file in more {
        files.push(file.extract::<std::path::PathBuf>()?.into());
    }
    let probe = State::new(files.clone(), Vec::new())?;
    let keywords = match &*probe.input {
        Input::Scene(_) => scene_words(options)?,
        Input::Models(_) => words(options)?,
    };
    let mut state = State::new(files, keywords)?;
    let state = work::run(py, None, move || {
        state.read()?;
        Ok(state)
    })?;
    Ok(Scene {
        state: Mutex::new(state),
    })
}
