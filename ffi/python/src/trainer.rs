//! Fields of one's own records: the double hierarchy for other renderers.

use crate::arrays::{finite, matching, singles, triples, unit};
use crate::failure::Fault;
use crate::field::Field;
use crate::picture::from_json;
use crate::work;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, MutexGuard, PoisonError};
use twintree::guide::{
    self, FieldFile, Fractions, PathSample, Photon, SampleRanges, Settings, SurfacePoint,
};
use twintree::math::Vec3;

/// A field that learns from records of your own: photons that landed, and samples of camera paths.
///
/// `Trainer(min, max, **settings)` covers the box from `min` to `max`. Settings are those of the
/// program's `guide::Settings`: `memory` (bytes), `model` ("gauss", "vmf", "constant"), `source`
/// ("photons", "paths", "both"), `normal_split`, `product`, `significance` and others;
/// `Trainer.settings` shows them.
#[pyclass(frozen, module = "twintree")]
pub struct Trainer {
    trainer: Mutex<guide::Trainer>,
}

/// The settings with what Python changes about them.
fn settings_of(min: Vec3, max: Vec3, of: Option<&Bound<'_, PyDict>>) -> PyResult<Settings> {
    let wrong = |e: &dyn std::fmt::Display| Fault::Value(format!("settings: {e}"));
    let mut settings = Settings::new(min, max);
    // So that a field that it has is among the keys below.
    settings.media = true;
    let mut value = serde_json::to_value(&settings).map_err(|e| wrong(&e))?;
    value["media"] = false.into();
    for (name, given) in of.into_iter().flatten() {
        let name: String = name.extract()?;
        let own = ["min", "max", "scene_hash"];
        let known = value.get(&name).is_some() && !own.contains(&name.as_str());
        if !known {
            let names = value.as_object().into_iter().flat_map(|o| o.keys());
            let names: Vec<_> = names
                .filter(|n| !own.contains(&n.as_str()))
                .cloned()
                .collect();
            let text = format!("there is no setting \"{name}\", only {}", names.join(", "));
            return Err(Fault::Type(text).into());
        }
        let json: String = given
            .py()
            .import("json")?
            .call_method1("dumps", (&given,))?
            .extract()?;
        let parsed = serde_json::from_str(&json).map_err(|e| wrong(&e))?;
        value[&name] = parsed;
        // Said by the setting's own name.
        let check: Result<Settings, _> = serde_json::from_value(value.clone());
        check.map_err(|e| Fault::Value(format!("{name}: {e}")))?;
    }
    let settings: Settings = serde_json::from_value(value).map_err(|e| wrong(&e))?;
    settings.validate().map_err(Fault::from)?;
    Ok(settings)
}

/// Normals of records: zero in a medium, unit vectors otherwise.
fn normals_of(value: Option<&Bound<'_, PyAny>>, count: usize) -> PyResult<Vec<Vec3>> {
    let Some(value) = value else {
        return Ok(vec![Vec3::ZERO; count]);
    };
    let list = triples("normals", value)?;
    let lit: Vec<Vec3> = list.iter().copied().filter(|n| *n != Vec3::ZERO).collect();
    unit("normals", &lit)?;
    Ok(matching("normals", list, count)?)
}

/// Distances of records: infinite where none are given.
fn distances_of(value: Option<&Bound<'_, PyAny>>, count: usize) -> PyResult<Vec<f32>> {
    let list = value.map_or_else(
        || Ok(vec![f32::INFINITY; count]),
        |v| singles("distances", v, count),
    )?;
    match list.iter().position(|d| d.is_nan() || *d < 0.0) {
        None => Ok(list),
        Some(at) => Err(Fault::Value(format!(
            "distances[{at}] is {}: expected 0 or more",
            list[at]
        ))
        .into()),
    }
}

/// Directions of unit length, one for each record.
fn directions_of(value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<Vec3>> {
    let list = triples("directions", value)?;
    unit("directions", &list)?;
    Ok(matching("directions", list, count)?)
}

/// Colours, none below 0, one for each record.
fn colors_of(name: &str, value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<Vec3>> {
    let list = matching(name, triples(name, value)?, count)?;
    match list.iter().position(|c| c.min_element() < 0.0) {
        None => Ok(list),
        Some(at) => Err(Fault::Value(format!("{name}[{at}] is below 0")).into()),
    }
}

impl Trainer {
    fn trainer(&self) -> MutexGuard<'_, guide::Trainer> {
        self.trainer.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Trainer {
    #[new]
    #[pyo3(signature = (min, max, **settings))]
    fn new(
        min: &Bound<'_, PyAny>,
        max: &Bound<'_, PyAny>,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let corner = |name: &str, value| match triples(name, value)?.as_slice() {
            [one] => Ok(*one),
            _ => Err(PyErr::from(Fault::Value(format!(
                "{name}: expected one point"
            )))),
        };
        let settings = settings_of(corner("min", min)?, corner("max", max)?, settings)?;
        let trainer = work::run(min.py(), None, || Ok(guide::Trainer::build(settings)?))?;
        Ok(Self {
            trainer: Mutex::new(trainer),
        })
    }

    /// Tells where surfaces are: `positions` (N, 3) spread uniformly over all of them, which
    /// together have the `area`; a photon's power over the area of its cell is what the field
    /// learns. `normals` (N, 3) for fields that are split by normals: a point for each side that
    /// light reaches.
    #[pyo3(signature = (positions, area, normals = None))]
    fn set_surface(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        area: f64,
        normals: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        if !(area > 0.0 && area.is_finite()) {
            return Err(Fault::Value(format!("area: {area} is not above 0 and finite")).into());
        }
        let positions = triples("positions", positions)?;
        let normals = normals_of(normals, positions.len())?;
        let points: Vec<SurfacePoint> = positions
            .into_iter()
            .zip(normals)
            .map(|(position, normal)| SurfacePoint { position, normal })
            .collect();
        work::run(py, None, || {
            self.trainer().set_surface(&points, area);
            Ok(())
        })
    }

    /// Learns from photons that landed: `positions` (N, 3), `directions` (N, 3), unit vectors
    /// towards where the light came from, `powers` (N, 3) in W, not divided by the number of
    /// photons, which is `emitted`: all that the lights sent out for this batch. `distances` (N,)
    /// to where it came from, `normals` (N, 3).
    #[pyo3(signature = (positions, directions, powers, emitted, *, distances = None, normals = None))]
    #[allow(clippy::too_many_arguments)]
    fn train(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        directions: &Bound<'_, PyAny>,
        powers: &Bound<'_, PyAny>,
        emitted: u64,
        distances: Option<&Bound<'_, PyAny>>,
        normals: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let positions = triples("positions", positions)?;
        let count = positions.len();
        if emitted == 0 && count > 0 {
            return Err(Fault::Value("emitted: 0 photons cannot have landed".into()).into());
        }
        let directions = directions_of(directions, count)?;
        let powers = colors_of("powers", powers, count)?;
        let distances = distances_of(distances, count)?;
        let normals = normals_of(normals, count)?;
        let photon = |i: usize| Photon {
            position: positions[i],
            direction: directions[i],
            power: powers[i],
            distance: distances[i],
            normal: normals[i],
        };
        let photons: Vec<Photon> = (0..count).map(photon).collect();
        work::run(py, None, || {
            self.trainer().train(&photons, emitted);
            Ok(())
        })
    }

    /// Learns from camera paths: at `positions` (N, 3) the `directions` (N, 3) were sampled with
    /// densities `pdfs` (N,), per steradian, and brought `radiances` (N, 3), W m^-2 sr^-1. Samples
    /// that brought none are part of the mean and must be given, too. A field learns from these
    /// with `source="paths"` or `"both"`.
    #[pyo3(signature = (positions, directions, radiances, pdfs, *, distances = None, normals = None))]
    #[allow(clippy::too_many_arguments)]
    fn train_paths(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        directions: &Bound<'_, PyAny>,
        radiances: &Bound<'_, PyAny>,
        pdfs: &Bound<'_, PyAny>,
        distances: Option<&Bound<'_, PyAny>>,
        normals: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let positions = triples("positions", positions)?;
        let count = positions.len();
        let directions = directions_of(directions, count)?;
        let radiances = colors_of("radiances", radiances, count)?;
        let pdfs = singles("pdfs", pdfs, count)?;
        finite("pdfs", &pdfs, 1)?;
        if let Some(at) = pdfs.iter().position(|p| *p <= 0.0) {
            return Err(Fault::Value(format!("pdfs[{at}] is not above 0")).into());
        }
        let distances = distances_of(distances, count)?;
        let normals = normals_of(normals, count)?;
        let sample = |i: usize| PathSample {
            position: positions[i],
            direction: directions[i],
            radiance: radiances[i],
            pdf: pdfs[i],
            distance: distances[i],
            normal: normals[i],
        };
        let samples: Vec<PathSample> = (0..count).map(sample).collect();
        work::run(py, None, || {
            self.trainer().train_paths(vec![&samples[..]]);
            Ok(())
        })
    }

    /// Divides cells where the last batch says that it pays, up to so many times in a row.
    #[pyo3(signature = (rounds = 4))]
    fn refine(&self, py: Python<'_>, rounds: u32) -> PyResult<()> {
        work::run(py, None, || {
            self.trainer().refine_rounds(rounds.min(64) as _);
            Ok(())
        })
    }

    /// The field as it is now; training may go on.
    fn field(&self, py: Python<'_>) -> PyResult<Field> {
        work::run(py, None, || {
            let trainer = self.trainer().clone();
            let frozen = trainer.freeze();
            let ranges = SampleRanges {
                recipe: "records of one's own".into(),
                ..SampleRanges::default()
            };
            let fractions = Fractions::new(&frozen);
            Ok(Field::of(FieldFile::new(
                trainer, ranges, &frozen, &fractions,
            )))
        })
    }

    /// Sizes, depths and counts, and what came in.
    #[getter]
    fn stats(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let stats = py.detach(|| self.trainer().stats());
        from_json(py, &serde_json::to_string(&stats).unwrap_or_default())
    }

    /// The settings that it was built with.
    #[getter]
    fn settings(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let settings = py.detach(|| self.trainer().settings().clone());
        from_json(py, &serde_json::to_string(&settings).unwrap_or_default())
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let stats = py.detach(|| self.trainer().stats());
        format!("<twintree.Trainer of {} links>", stats.links)
    }
}
