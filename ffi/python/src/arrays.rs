//! Arrays in and out. What comes in is copied: it may be of any type of real numbers, any strides
//! and read-only, and Python may change it meanwhile.

use crate::failure::Fault;
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use twintree::math::{Vec2, Vec3};

/// Numbers of an array in C order, with its shape.
pub struct Array<T> {
    /// The numbers.
    pub values: Vec<T>,
    /// The lengths of its axes.
    pub shape: Vec<usize>,
}

/// An array of this kind of numbers: `float32`, `int64`.
fn converted<'py>(
    name: &str,
    value: &Bound<'py, PyAny>,
    (kinds, expected): (&str, &str),
    dtype: &str,
) -> PyResult<(Bound<'py, PyAny>, Vec<usize>)> {
    let py = value.py();
    let numpy = py.import("numpy")?;
    let array = numpy
        .call_method1("asarray", (value,))
        .map_err(|e| Fault::Type(format!("{name}: {} is no array: {e}", kind_of(value))))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !kinds.contains(&kind) {
        let dtype = array.getattr("dtype")?.str()?;
        return Err(Fault::Type(format!("{name}: expected {expected}, not {dtype}")).into());
    }
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    // Numbers too large for 32 bits become infinite, which is told where it matters.
    let quiet = pyo3::types::PyDict::new(py);
    quiet.set_item("over", "ignore")?;
    let state = numpy.call_method("errstate", (), Some(&quiet))?;
    state.call_method0("__enter__")?;
    // What is as it should be already is copied once only, by the caller.
    let flat = array
        .call_method1("ravel", ())
        .and_then(|a| numpy.call_method1("require", (a, dtype, ("C", "A"))));
    state.call_method1("__exit__", (py.None(), py.None(), py.None()))?;
    Ok((flat?, shape))
}

fn kind_of(value: &Bound<'_, PyAny>) -> String {
    let name = value.get_type().name();
    name.map_or("it".into(), |n| format!("a {n}"))
}

/// Real numbers as 32 bits.
///
/// # Errors
/// When the value is no array of real numbers.
pub fn floats(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Array<f32>> {
    let (flat, shape) = converted(name, value, ("fiu", "real numbers"), "float32")?;
    let flat = flat.cast_into::<PyArray1<f32>>()?;
    debug_assert!(flat.is_c_contiguous());
    let values = flat.readonly().as_slice()?.to_vec();
    Ok(Array { values, shape })
}

/// Whole numbers.
///
/// # Errors
/// When the value is no array of whole numbers.
pub fn integers(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Array<i64>> {
    let (flat, shape) = converted(name, value, ("iu", "whole numbers"), "int64")?;
    let flat = flat.cast_into::<PyArray1<i64>>()?;
    let values = flat.readonly().as_slice()?.to_vec();
    Ok(Array { values, shape })
}

impl<T> Array<T> {
    /// The shape in words.
    pub fn shape_text(&self) -> String {
        shape_text(&self.shape)
    }
}

fn shape_text(shape: &[usize]) -> String {
    let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
    match lengths.as_slice() {
        [one] => format!("({one},)"),
        _ => format!("({})", lengths.join(", ")),
    }
}

/// Points, directions or colours: an array of the shape (N, 3), or (3,) for one.
///
/// # Errors
/// When the shape is another, or a number is not finite.
pub fn triples(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Vec3>> {
    let array = rows(name, value, 3)?;
    Ok(array.chunks_exact(3).map(Vec3::from_slice).collect())
}

/// Texture coordinates: an array of the shape (N, 2), or (2,) for one.
///
/// # Errors
/// When the shape is another, or a number is not finite.
pub fn pairs(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Vec2>> {
    let array = rows(name, value, 2)?;
    Ok(array.chunks_exact(2).map(Vec2::from_slice).collect())
}

/// Rows of so many finite numbers, or a single row.
fn rows(name: &str, value: &Bound<'_, PyAny>, each: usize) -> PyResult<Vec<f32>> {
    let array = floats(name, value)?;
    match array.shape.as_slice() {
        [.., last] if *last == each && array.shape.len() <= 2 => {}
        _ => {
            let shape = array.shape_text();
            let text = format!("{name}: expected the shape (N, {each}), not {shape}");
            return Err(Fault::Value(text).into());
        }
    }
    finite(name, &array.values, each)?;
    Ok(array.values)
}

/// One number for each of `count` records: an array of the shape (N,).
///
/// # Errors
/// When the shape is another.
pub fn singles(name: &str, value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<f32>> {
    let array = floats(name, value)?;
    if array.shape != [count] {
        let shape = array.shape_text();
        return Err(Fault::Value(format!(
            "{name}: expected the shape ({count},), not {shape}"
        ))
        .into());
    }
    Ok(array.values)
}

/// Refuses numbers that are not finite, and names the first row that has one.
///
/// # Errors
/// When there is one.
pub fn finite(name: &str, values: &[f32], row: usize) -> Result<(), Fault> {
    match values.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(at) => Err(Fault::Value(format!(
            "{name}[{}] is not finite: {}",
            at / row,
            values[at]
        ))),
    }
}

/// Refuses directions that are not of unit length.
///
/// # Errors
/// When one is not.
pub fn unit(name: &str, directions: &[Vec3]) -> Result<(), Fault> {
    let is_off = |d: &Vec3| (d.length_squared() - 1.0).abs() > 2e-3;
    match directions.iter().position(is_off) {
        None => Ok(()),
        Some(at) => Err(Fault::Value(format!(
            "{name}[{at}] is no unit vector: its length is {}",
            directions[at].length()
        ))),
    }
}

/// As many as there are of others, or one for all of them.
///
/// # Errors
/// When it is neither.
pub fn matching<T: Copy>(name: &str, list: Vec<T>, count: usize) -> Result<Vec<T>, Fault> {
    match list.as_slice() {
        [one] if count != 1 => Ok(vec![*one; count]),
        all if all.len() == count => Ok(list),
        all => {
            let length = all.len();
            Err(Fault::Value(format!(
                "{name}: expected {count} rows, not {length}"
            )))
        }
    }
}

/// An array of 32-bit floats of a shape.
///
/// # Errors
/// When numpy has no memory for it.
pub fn to_python(py: Python<'_>, values: Vec<f32>, shape: &[usize]) -> PyResult<Py<PyAny>> {
    let flat = PyArray1::from_vec(py, values);
    Ok(flat.reshape(shape)?.into_any().unbind())
}

/// Numbers of vectors, one after the other.
pub fn flat(vectors: &[Vec3]) -> Vec<f32> {
    vectors.iter().flat_map(|v| v.to_array()).collect()
}
