//! What a scene gets beside its files: meshes of arrays, and lamps.

use crate::arrays::{finite, floats, integers, triples};
use crate::failure::Fault;
use crate::work;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::Path;
use std::sync::Arc;
use twintree::light::{Emitter, Falloff};
use twintree::math::{Affine3A, Rgb, Vec3};
use twintree::scene::import::ImportError;
use twintree::scene::import::mesh::{Buffers, MeshOptions, from_buffers};
use twintree::scene::import::models::palette::Paint;
use twintree::scene::import::parts::Parts;
use twintree::scene::{Description, Geometry, Mesh, Shape};
use twintree::texture::Texture;

/// Something that was added.
#[derive(Clone)]
pub enum Addition {
    /// A mesh.
    Mesh {
        /// Its name, for messages and mattes.
        name: String,
        /// The triangles.
        mesh: Arc<Mesh>,
        /// What it is made of.
        paint: Paint,
        /// Radiance that it emits.
        emission: Option<Rgb>,
    },
    /// A lamp without a body.
    Light(Emitter),
}

impl Addition {
    /// Puts it among the parts of a scene.
    fn add(&self, parts: &mut Parts) {
        let (name, mesh, paint, emission) = match self {
            Self::Light(emitter) => return parts.emitters.push(emitter.clone()),
            Self::Mesh {
                name,
                mesh,
                paint,
                emission,
            } => (name, mesh, paint, emission),
        };
        let shape = parts.shapes.len() as u32;
        let emitter = emission.map(|radiance| {
            parts.emitters.push(Emitter::Area {
                shape,
                radiance: Texture::Constant(radiance),
                both_sides: false,
            });
            parts.emitters.len() as u32 - 1
        });
        parts.shapes.push(Shape {
            name: name.clone(),
            geometry: Geometry::Mesh(mesh.clone()),
            material: paint.add(&mut parts.materials, false),
            emitter,
            flip_normals: false,
            group: None,
            boundary: paint.boundary(&mut parts.media),
        });
    }
}

/// The parts that additions alone make.
pub fn parts_of(additions: &[Addition]) -> Parts {
    let mut parts = Parts::default();
    additions.iter().for_each(|a| a.add(&mut parts));
    parts
}

/// Puts additions into a scene.
pub fn add_to(description: &mut Description, additions: &[Addition]) {
    let mut parts = Parts {
        shapes: std::mem::take(&mut description.shapes),
        materials: std::mem::take(&mut description.materials),
        media: std::mem::take(&mut description.media),
        emitters: std::mem::take(&mut description.emitters),
        ..Parts::default()
    };
    additions.iter().for_each(|a| a.add(&mut parts));
    description.shapes = parts.shapes;
    description.materials = parts.materials;
    description.media = parts.media;
    description.emitters = parts.emitters;
}

/// A mesh of arrays, and what was odd about it.
pub fn mesh(
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    normals: Option<&Bound<'_, PyAny>>,
    smooth: bool,
) -> PyResult<(Arc<Mesh>, Vec<String>)> {
    let positions = triples("vertices", vertices)?;
    let normals = normals.map(|n| triples("normals", n)).transpose()?;
    if let Some(list) = normals.as_ref().filter(|n| n.len() != positions.len()) {
        let (given, count) = (list.len(), positions.len());
        let text = format!("normals: expected {count} rows, one a vertex, not {given}");
        return Err(Fault::Value(text).into());
    }
    let triangles = corners(faces, positions.len())?;
    if triangles.is_empty() {
        return Err(Fault::Value("faces: there is no triangle".into()).into());
    }
    let buffers = Buffers {
        positions,
        normals,
        triangles,
        ..Buffers::default()
    };
    let options = MeshOptions {
        flat_without_normals: !smooth,
        ..MeshOptions::default()
    };
    let loaded = work::run(vertices.py(), None, || {
        let loaded = from_buffers(buffers, &options, Path::new(""));
        // The name of a file that is none.
        loaded.map_err(|e| ImportError { file: None, ..e }.into())
    })?;
    if loaded.mesh.triangles.triangles().is_empty() {
        return Err(Fault::Value("faces: no triangle has an area".into()).into());
    }
    Ok((Arc::new(loaded.mesh), loaded.warnings))
}

fn corners(faces: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<[u32; 3]>> {
    let array = integers("faces", faces)?;
    if !matches!(array.shape.as_slice(), [_, 3]) {
        let shape = array.shape_text();
        let text = format!("faces: expected the shape (M, 3), not {shape}");
        return Err(Fault::Value(text).into());
    }
    let inside = |i: &i64| *i >= 0 && (*i as u64) < count as u64 && *i < i64::from(u32::MAX);
    if let Some(at) = array.values.iter().position(|i| !inside(i)) {
        let (face, name) = (at / 3, array.values[at]);
        let text = format!("faces[{face}] names vertex {name}, and there are {count}");
        return Err(Fault::Value(text).into());
    }
    let triangle = |c: &[i64]| [c[0] as u32, c[1] as u32, c[2] as u32];
    Ok(array.values.chunks_exact(3).map(triangle).collect())
}

/// A colour: a number, or red, green and blue; none below 0.
pub fn color(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Rgb> {
    let array = floats(name, value)?;
    finite(name, &array.values, array.values.len().max(1))?;
    let color = match array.values.as_slice() {
        [grey] => Rgb::splat(*grey),
        [r, g, b] => Rgb::new(*r, *g, *b),
        _ => {
            let text = format!("{name}: expected a number, or red, green and blue");
            return Err(Fault::Value(text).into());
        }
    };
    if color.min_element() < 0.0 {
        return Err(Fault::Value(format!("{name}: {color} is below 0")).into());
    }
    Ok(color)
}

/// A point or a direction.
fn vector(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec3> {
    match triples(name, value)?.as_slice() {
        [one] => Ok(*one),
        list => {
            let text = format!("{name}: expected one, not {}", list.len());
            Err(Fault::Value(text).into())
        }
    }
}

/// The keyword arguments of a lamp, each to be used.
struct Given<'a, 'py> {
    kind: &'a str,
    of: Option<&'a Bound<'py, PyDict>>,
    used: Vec<&'static str>,
}

impl<'py> Given<'_, 'py> {
    fn get(&mut self, name: &'static str) -> PyResult<Bound<'py, PyAny>> {
        self.optional(name)?
            .ok_or_else(|| Fault::Type(format!("a {} light needs {name}=", self.kind)).into())
    }

    fn optional(&mut self, name: &'static str) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.used.push(name);
        self.of.map_or(Ok(None), |of| of.get_item(name))
    }

    fn degrees(&mut self, name: &'static str, default: f32) -> PyResult<f32> {
        let degrees = self.optional(name)?.map_or(Ok(default), |v| v.extract())?;
        match degrees > 0.0 && degrees <= 90.0 {
            true => Ok(degrees),
            false => Err(
                Fault::Value(format!("{name}: {degrees} is not within 0 and 90 degrees")).into(),
            ),
        }
    }

    /// Refuses what has no meaning.
    fn end(&self) -> PyResult<()> {
        for (name, _) in self.of.into_iter().flatten() {
            let name: String = name.extract()?;
            if !self.used.contains(&name.as_str()) {
                let (kind, used) = (self.kind, self.used.join(", "));
                let text = format!("a {kind} light has no {name}, only {used}");
                return Err(Fault::Type(text).into());
            }
        }
        Ok(())
    }
}

/// A lamp without a body.
pub fn light(kind: &str, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Addition> {
    let mut given = Given {
        kind,
        of: keywords,
        used: Vec::new(),
    };
    let emitter = match kind {
        "point" => Emitter::Point {
            position: vector("position", &given.get("position")?)?,
            intensity: color("intensity", &given.get("intensity")?)?,
        },
        "spot" => spot(&mut given)?,
        "directional" => Emitter::Directional {
            direction: direction("direction", vector("direction", &given.get("direction")?)?)?,
            irradiance: color("irradiance", &given.get("irradiance")?)?,
        },
        "constant" => Emitter::Constant {
            radiance: color("radiance", &given.get("radiance")?)?,
        },
        _ => {
            let text = format!(
                "there is no light \"{kind}\", only point, spot, directional and constant\n  \
                 help: add_mesh(..., emission=) makes lamps of any shape"
            );
            return Err(Fault::Value(text).into());
        }
    };
    given.end()?;
    Ok(Addition::Light(emitter))
}

fn spot(given: &mut Given) -> PyResult<Emitter> {
    let position = vector("position", &given.get("position")?)?;
    let target = vector("target", &given.get("target")?)?;
    let axis = direction("target", target - position)?;
    let (x, y) = axis.any_orthonormal_pair();
    let cutoff_degrees = given.degrees("cutoff", 20.0)?;
    Ok(Emitter::Spot {
        to_world: Affine3A::from_cols(x.into(), y.into(), axis.into(), position.into()),
        intensity: color("intensity", &given.get("intensity")?)?,
        cutoff_degrees,
        beam_degrees: given
            .degrees("beam", 0.75 * cutoff_degrees)?
            .min(cutoff_degrees),
        falloff: Falloff::Linear,
        texture: None,
    })
}

fn direction(name: &str, of: Vec3) -> Result<Vec3, Fault> {
    of.try_normalize()
        .ok_or_else(|| Fault::Value(format!("{name}: {of} is no direction")))
}
