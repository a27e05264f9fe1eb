//! What a scene gets beside its files: meshes of arrays, and lamps.

use crate::arrays::{finite, floats, integers, pairs, triples};
use crate::failure::Fault;
use crate::work;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use twintree::cli::Failure;
use twintree::cli::load::Loaded;
use twintree::image::file::ImageFile;
use twintree::light::{Emitter, Falloff};
use twintree::math::{Affine3A, Rgb, Vec2, Vec3};
use twintree::scene::import::mesh::{Buffers, MeshOptions, from_buffers};
use twintree::scene::import::models::palette::{COLORED, Paint};
use twintree::scene::import::parts::Parts;
use twintree::scene::import::{ImportError, OpenTexture};
use twintree::scene::{Geometry, Mesh, Shape};
use twintree::texture::{BitmapSettings, Filter, Texture, UvTransform, Wrap};

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
        /// The image that is its colour.
        image: Option<PathBuf>,
        /// Radiance that it emits.
        emission: Option<Rgb>,
    },
    /// A lamp without a body.
    Light(Emitter),
}

impl Addition {
    /// Puts it among the parts of a scene.
    fn add(&self, parts: &mut Parts, textures: &dyn OpenTexture) -> Result<(), Failure> {
        let (name, mesh, paint, image, emission) = match self {
            Self::Light(emitter) => {
                parts.emitters.push(emitter.clone());
                return Ok(());
            }
            Self::Mesh {
                name,
                mesh,
                paint,
                image,
                emission,
            } => (name, mesh, paint, image, emission),
        };
        let image = image.as_ref().map(|path| textures.open(color_of(path)));
        let image = image.transpose()?;
        if let Some(Texture::Bitmap(bitmap)) = &image {
            let path = bitmap.settings().path.display();
            for oddity in bitmap.oddities() {
                parts.warn(format!("{path}: {oddity}"));
            }
        }
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
            material: paint.add(&mut parts.materials, image),
            emitter,
            flip_normals: false,
            group: None,
            boundary: paint.boundary(&mut parts.media),
        });
        Ok(())
    }
}

/// An image that is a colour, and repeats.
fn color_of(path: &Path) -> BitmapSettings {
    BitmapSettings {
        path: path.to_owned(),
        raw: false,
        gamma: None,
        filter: Filter::Linear,
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Repeat,
        to_uv: UvTransform::default(),
        channel: None,
    }
}

/// Puts additions among parts.
pub fn add_all(
    additions: &[Addition],
    parts: &mut Parts,
    textures: &dyn OpenTexture,
) -> Result<(), Failure> {
    additions.iter().try_for_each(|a| a.add(parts, textures))
}

/// Puts additions into a scene that was read.
pub fn add_to(loaded: &mut Loaded, additions: &[Addition]) -> Result<(), Failure> {
    let description = &mut loaded.description;
    let mut parts = Parts {
        shapes: std::mem::take(&mut description.shapes),
        materials: std::mem::take(&mut description.materials),
        media: std::mem::take(&mut description.media),
        emitters: std::mem::take(&mut description.emitters),
        ..Parts::default()
    };
    add_all(additions, &mut parts, loaded.store())?;
    let description = &mut loaded.description;
    description.shapes = parts.shapes;
    description.materials = parts.materials;
    description.media = parts.media;
    description.emitters = parts.emitters;
    for warning in parts.warnings.into_list() {
        tracing::warn!("{warning}");
        description.warnings.push(warning);
    }
    Ok(())
}

/// What a mesh is made of, with an image as its colour or without.
pub fn paint(material: &str, image: Option<&Path>, has_uvs: bool) -> Result<Paint, Fault> {
    let paint: Paint = material
        .parse()
        .map_err(|e| Fault::Value(format!("material: {e}")))?;
    let Some(path) = image else {
        return Ok(paint);
    };
    if !has_uvs {
        let text = "texture: uvs= must say where on the mesh it lies";
        return Err(Fault::Value(text.into()));
    }
    if !paint.takes_image() {
        let colored = COLORED.join(", ");
        let text = format!("texture: it cannot be the colour of {material}, only of {colored}");
        return Err(Fault::Value(text));
    }
    // Its texels are read when the scene is built.
    ImageFile::open(path).map_err(|e| Fault::from(Failure::from(e)))?;
    Ok(paint)
}

/// Arrays that say something of each vertex of a mesh.
pub struct OfVertices<'a, 'py> {
    /// (N, 3).
    pub positions: &'a Bound<'py, PyAny>,
    /// (N, 3).
    pub normals: Option<&'a Bound<'py, PyAny>>,
    /// (N, 2).
    pub uvs: Option<&'a Bound<'py, PyAny>>,
}

/// One for each of `count` vertices, where there are any.
fn one_each<T>(name: &str, list: Option<Vec<T>>, count: usize) -> Result<Option<Vec<T>>, Fault> {
    match list.as_ref().map(Vec::len).filter(|given| *given != count) {
        None => Ok(list),
        Some(given) => Err(Fault::Value(format!(
            "{name}: expected {count} rows, one a vertex, not {given}"
        ))),
    }
}

/// A mesh of arrays, and what was odd about it.
pub fn mesh(
    vertices: &OfVertices,
    faces: &Bound<'_, PyAny>,
    smooth: bool,
) -> PyResult<(Arc<Mesh>, Vec<String>)> {
    let positions = triples("vertices", vertices.positions)?;
    let count = positions.len();
    let normals = vertices.normals.map(|n| triples("normals", n));
    let normals = one_each("normals", normals.transpose()?, count)?;
    let uvs = vertices.uvs.map(|u| pairs("uvs", u)).transpose()?;
    let uvs = one_each("uvs", uvs, count)?;
    // Row 0 of an image lies at v = 0; here v points up, as in most files of meshes.
    let down = |uv: Vec2| Vec2::new(uv.x, 1.0 - uv.y);
    let uvs = uvs.map(|list| list.into_iter().map(down).collect());
    let triangles = corners(faces, count)?;
    if triangles.is_empty() {
        return Err(Fault::Value("faces: there is no triangle".into()).into());
    }
    let buffers = Buffers {
        positions,
        normals,
        uvs,
        triangles,
        ..Buffers::default()
    };
    let options = MeshOptions {
        flat_without_normals: !smooth,
        ..MeshOptions::default()
    };
    let loaded = work::run(faces.py(), None, || {
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
