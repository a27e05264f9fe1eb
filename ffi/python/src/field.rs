//! Learned fields: files, numbers, and queries over arrays.

use crate::arrays::{self, Array, finite, floats, matching, triples, unit};
use crate::failure::Fault;
use crate::picture::from_json;
use crate::work;
use pyo3::prelude::*;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use twintree::cli::field_file::{self, Opened};
use twintree::guide::FieldFile;
use twintree::math::{Pcg32, Rgb, Vec2, Vec3};
use twintree::report::field::FieldReport;

/// Queries that one task answers.
const GRAIN: usize = 4096;

/// A field and its frozen form.
pub struct Shared {
    file: FieldFile,
    frozen: twintree::guide::Field,
    name: PathBuf,
}

impl Shared {
    /// As the program has fields that it has read.
    pub fn opened(&self, any_scene: bool) -> Opened {
        Opened {
            path: self.name.clone(),
            file: self.file.clone(),
            // It goes into no part and no checkpoint.
            fingerprint: 0,
            any_scene,
        }
    }
}

/// What guides a render.
pub enum Guides {
    /// A field in memory.
    Field(Arc<Shared>),
    /// A file, which the program reads.
    File,
}

/// A learned field of where light comes from: for any place a distribution of directions, to sample
/// from and to evaluate. `Scene.train`, `Trainer.field` and `Field.load` make one. It does not
/// change.
///
/// Fields survive a fork: workers of a pool may use them.
#[pyclass(frozen, module = "twintree")]
pub struct Field {
    shared: Arc<Shared>,
    /// Whether Ctrl-C has ended its training before all records had taught.
    #[pyo3(get)]
    interrupted: bool,
}

impl Field {
    /// A field of sums.
    pub fn of(file: FieldFile) -> Self {
        Self::named(file, Path::new("a twintree.Field"))
    }

    /// The same, of training that Ctrl-C may have ended.
    pub fn learned(file: FieldFile, interrupted: bool) -> Self {
        Self {
            interrupted,
            ..Self::of(file)
        }
    }

    fn named(file: FieldFile, name: &Path) -> Self {
        let (frozen, _) = file.freeze();
        Self {
            shared: Arc::new(Shared {
                file,
                frozen,
                name: name.into(),
            }),
            interrupted: false,
        }
    }

    /// Whether Ctrl-C has ended its training.
    pub fn is_interrupted(&self) -> bool {
        self.interrupted
    }

    /// For a render on other threads.
    pub fn shared(&self, _: Python<'_>) -> Arc<Shared> {
        self.shared.clone()
    }
}

/// Places, with the normals there if there are any.
struct Places {
    positions: Vec<Vec3>,
    normals: Option<Vec<Vec3>>,
}

impl Places {
    fn read(
        positions: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        count: Option<usize>,
    ) -> PyResult<Self> {
        let mut list = triples("positions", positions)?;
        if let (Some(count), 1) = (count, list.len()) {
            list = vec![list[0]; count];
        }
        let normals = match normals {
            None => None,
            Some(value) => {
                let normals = triples("normals", value)?;
                unit("normals", &normals)?;
                Some(matching("normals", normals, list.len())?)
            }
        };
        Ok(Self {
            positions: list,
            normals,
        })
    }

    fn at<'f>(
        &self,
        field: &'f twintree::guide::Field,
        i: usize,
    ) -> twintree::guide::LocalField<'f> {
        let normal = self.normals.as_ref().map(|n| n[i]);
        field.at(self.positions[i], normal, Rgb::ONE)
    }
}

/// Directions: (N, 3), or (N, M, 3) with M for each place.
fn directions(value: &Bound<'_, PyAny>) -> PyResult<(Vec<Vec3>, Vec<usize>)> {
    let Array { values, shape } = floats("directions", value)?;
    if shape.last() != Some(&3) || shape.len() > 3 {
        let shape = Array { values, shape }.shape_text();
        let text = format!("directions: expected the shape (N, 3) or (N, M, 3), not {shape}");
        return Err(Fault::Value(text).into());
    }
    finite("directions", &values, 3)?;
    let list: Vec<Vec3> = values.chunks_exact(3).map(Vec3::from_slice).collect();
    unit("directions", &list)?;
    Ok((list, shape[..shape.len() - 1].to_vec()))
}

#[pymethods]
impl Field {
    /// Reads a field that `save` or `twintree train` wrote. Raises `ValueError` where it is none,
    /// or damaged.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        work::run(py, None, move || {
            Ok(Self::named(Opened::read(&path)?.file, &path))
        })
    }

    /// Writes the field, whole or not at all. Raises `RuntimeError` where that cannot be done.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let shared = self.shared.clone();
        work::run(py, None, move || {
            Ok(field_file::write(&path, &shared.file)?)
        })
    }

    /// What is in it: the keys of `twintree field --json`.
    #[getter]
    fn stats(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let shared = &self.shared;
        let json = work::run(py, None, || {
            Ok(FieldReport::of(&shared.name, &shared.file).to_json())
        })?;
        from_json(py, &json)
    }

    /// Lower and upper corner of what it covers, in the scene's units.
    #[getter]
    fn bounds(&self) -> ([f32; 3], [f32; 3]) {
        let settings = self.shared.file.trainer.settings();
        (settings.min.into(), settings.max.into())
    }

    /// Draws `n` directions at each place: `positions` (N, 3) in the scene's units, `normals` (N,
    /// 3) unit vectors, or None in a medium. Returns directions (N, n, 3), unit vectors towards
    /// light, and their densities per steradian (N, n), float32. The same seed gives the same bits
    /// on any number of threads.
    #[pyo3(signature = (positions, normals = None, n = 1, seed = 0, *, threads = None))]
    fn sample(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        n: usize,
        seed: u64,
        threads: Option<u16>,
    ) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
        crate::render::check_threads(threads)?;
        let places = Places::read(positions, normals, None)?;
        let count = places.positions.len();
        let all = room(count, n)?;
        let shared = self.shared.clone();
        let (directions, pdfs) = work::run(py, threads, move || {
            let mut directions = vec![0.0f32; 3 * all];
            let mut pdfs = vec![0.0f32; all];
            let draw = |(i, (directions, pdfs)): (usize, (&mut [f32], &mut [f32]))| {
                let local = places.at(&shared.frozen, i);
                let mut numbers = Pcg32::new(seed, i as u64);
                let mut square = || Vec2::new(numbers.next_f32(), numbers.next_f32());
                for (w, pdf) in directions.chunks_exact_mut(3).zip(pdfs) {
                    let (select, within) = (square(), square());
                    let sample = local.sample(select, within);
                    w.copy_from_slice(&sample.direction.to_array());
                    *pdf = sample.pdf;
                }
            };
            let each = n.max(1);
            let pairs = directions
                .par_chunks_exact_mut(3 * each)
                .zip(pdfs.par_chunks_exact_mut(each));
            pairs
                .enumerate()
                .with_min_len(GRAIN / each.min(GRAIN))
                .for_each(draw);
            Ok((directions, pdfs))
        })?;
        Ok((
            arrays::to_python(py, directions, &[count, n, 3])?,
            arrays::to_python(py, pdfs, &[count, n])?,
        ))
    }

    /// The density per steradian with which `sample` draws: `directions` of unit length, (N, 3),
    /// one for each of `positions` (N, 3), or (N, M, 3), M for each; a single position (3,) takes
    /// any number. Returns (N,) or (N, M), float32, positive everywhere. `normals` as for `sample`.
    #[pyo3(signature = (positions, normals, directions, *, threads = None))]
    fn pdf(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        directions: &Bound<'_, PyAny>,
        threads: Option<u16>,
    ) -> PyResult<Py<PyAny>> {
        crate::render::check_threads(threads)?;
        let (list, shape) = self::directions(directions)?;
        let rows = shape.first().copied().unwrap_or(1);
        let places = Places::read(positions, normals, Some(rows))?;
        if places.positions.len() != rows {
            let count = places.positions.len();
            let text = format!("directions: expected {count} rows, one a position, not {rows}");
            return Err(Fault::Value(text).into());
        }
        let shared = self.shared.clone();
        let each = shape.get(1).copied().unwrap_or(1);
        let pdfs = work::run(py, threads, move || {
            let mut pdfs = vec![0.0f32; list.len()];
            if each > 0 {
                let tasks = pdfs
                    .par_chunks_mut(each)
                    .zip(list.par_chunks(each))
                    .enumerate();
                tasks
                    .with_min_len(GRAIN / each.min(GRAIN))
                    .for_each(|(i, (pdfs, list))| {
                        let local = places.at(&shared.frozen, i);
                        for (pdf, w) in pdfs.iter_mut().zip(list) {
                            *pdf = local.pdf(*w);
                        }
                    });
            }
            Ok(pdfs)
        })?;
        arrays::to_python(py, pdfs, &shape)
    }

    /// Light that arrives at each of `positions` (N, 3), W/m^2 in red, green and blue: (N, 3),
    /// float32. In a medium the fluence.
    #[pyo3(signature = (positions, normals = None, *, threads = None))]
    fn irradiance(
        &self,
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        threads: Option<u16>,
    ) -> PyResult<Py<PyAny>> {
        crate::render::check_threads(threads)?;
        let places = Places::read(positions, normals, None)?;
        let count = places.positions.len();
        let shared = self.shared.clone();
        let values: Vec<Rgb> = work::run(py, threads, move || {
            let of = |i| places.at(&shared.frozen, i).irradiance();
            Ok((0..count).into_par_iter().map(of).collect())
        })?;
        arrays::to_python(py, arrays::flat(&values), &[count, 3])
    }

    fn __repr__(&self) -> String {
        let stats = self.shared.file.trainer.stats();
        format!(
            "<twintree.Field of {} links in {} cells>",
            stats.links, stats.space_cells
        )
    }
}

/// Refuses more samples than memory could hold.
fn room(count: usize, n: usize) -> Result<usize, Fault> {
    // Bytes of a direction and its density, while they are copied.
    const BYTES: u64 = 32;
    let all = count.checked_mul(n);
    let bytes = all.and_then(|all| (all as u64).checked_mul(BYTES));
    let free = twintree::cli::memory::available_bytes().unwrap_or(u64::MAX);
    match (all, bytes) {
        (Some(all), Some(bytes)) if bytes <= free => Ok(all),
        _ => Err(Fault::Value(format!(
            "n: {n} directions at {count} places do not fit into memory"
        ))),
    }
}
