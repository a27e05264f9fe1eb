//! Primitives: from accessors to a mesh that the renderer may rely on.

use super::accessor::Accessors;
use super::error;
use super::schema::Primitive;
use super::skin;
use crate::math::{DAffine3, Rgb, Vec2, Vec3, Vec4};
use crate::scene::import::ImportError;
use crate::scene::import::mesh::{self, Buffers, Loaded, MeshOptions};
use crate::texture::MeshAttribute;

/// Attribute that vertex colours become.
pub(super) const COLOR: &str = "vertex_color";
/// Attribute that the fourth component of vertex colours becomes.
pub(super) const ALPHA: &str = "vertex_alpha";

/// A primitive to be loaded.
#[derive(Clone, Debug)]
pub(super) struct Job<'a> {
    pub primitive: &'a Primitive,
    /// Mesh space to world (or group) space.
    pub to_world: DAffine3,
    /// Weights of morph targets.
    pub weights: &'a [f64],
    /// Matrices of a skin's joints, mesh space to world space; they take the place of `to_world`.
    pub joints: Option<&'a [DAffine3]>,
    /// Which texture coordinates to take.
    pub uv_set: usize,
    /// Whether the material has textures.
    pub textured: bool,
    /// Whether opacity is read.
    pub alpha: bool,
    /// Whether tangents are read.
    pub tangents: bool,
}

/// Loads a primitive; `None` for points and lines.
pub(super) fn load(accessors: Accessors, job: &Job) -> Result<Option<Loaded>, ImportError> {
    let primitive = job.primitive;
    let path = &accessors.container.path;
    if !primitive.attributes.contains_key("POSITION") {
        return Ok(None);
    }
    // Read first: what has no bytes in the file is an error before anything is made as long as it.
    let positions = vectors(accessors, primitive, job.weights, "POSITION")?.unwrap_or_default();
    let count = positions.len();
    let indices = match primitive.indices {
        Some(indices) => accessors.indices(indices)?,
        None => (0..u32::try_from(count).unwrap_or(u32::MAX)).collect(),
    };
    let Some(triangles) = assemble(&indices, primitive.mode.unwrap_or(4)) else {
        return Ok(None);
    };
    let mut buffers = Buffers {
        positions,
        normals: vectors(accessors, primitive, job.weights, "NORMAL")?,
        tangents: tangents(accessors, job)?,
        uvs: uvs(accessors, primitive, job.uv_set)?,
        triangles,
        attributes: colors(accessors, job)?,
    };
    let mut options = MeshOptions {
        to_world: job.to_world,
        face_normals: buffers.normals.is_none(),
        lenient: true,
        ..MeshOptions::default()
    };
    let mut warnings = missing_uvs(job, &buffers);
    if let Some(joints) = job.joints {
        warnings.extend(skin::bend(accessors, primitive, joints, &mut buffers)?);
        options.to_world = DAffine3::IDENTITY;
    }
    check_lengths(&buffers).map_err(|message| error(path, message))?;
    let mut loaded = mesh::from_buffers(buffers, &options, path)?;
    loaded.warnings.extend(warnings);
    Ok(Some(loaded))
}

/// What is said where a material has textures and the primitive does not say how they lie.
fn missing_uvs(job: &Job, buffers: &Buffers) -> Vec<String> {
    let missing = job.textured && buffers.uvs.is_none();
    let set = job.uv_set;
    let told = format!("its textures ask for TEXCOORD_{set}, which it lacks: (0, 0) everywhere");
    missing.then_some(told).into_iter().collect()
}

fn check_lengths(buffers: &Buffers) -> Result<(), String> {
    let count = buffers.positions.len();
    let same = buffers.normals.as_ref().is_none_or(|v| v.len() == count)
        && buffers.tangents.as_ref().is_none_or(|v| v.len() == count)
        && buffers.uvs.as_ref().is_none_or(|v| v.len() == count)
        && buffers.attributes.iter().all(|a| a.values.len() == count);
    if same {
        return Ok(());
    }
    Err("attributes of one primitive differ in length".into())
}

/// Triangles of a list, strip or fan; `None` for points and lines.
fn assemble(indices: &[u32], mode: u32) -> Option<Vec<[u32; 3]>> {
    Some(match mode {
        4 => indices
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]])
            .collect(),
        // Every other triangle of a strip is turned (glTF 2.0, 3.7.2.1).
        5 => indices
            .windows(3)
            .enumerate()
            .map(|(i, w)| match i % 2 {
                0 => [w[0], w[1], w[2]],
                _ => [w[0], w[2], w[1]],
            })
            .collect(),
        6 => {
            let rest = indices.get(1..).unwrap_or_default();
            rest.windows(2).map(|w| [indices[0], w[0], w[1]]).collect()
        }
        _ => return None,
    })
}

/// Positions or normals, with the weighted morph targets added.
fn vectors(
    accessors: Accessors,
    primitive: &Primitive,
    weights: &[f64],
    name: &str,
) -> Result<Option<Vec<Vec3>>, ImportError> {
    let Some(&index) = primitive.attributes.get(name) else {
        return Ok(None);
    };
    let mut values: Vec<Vec3> = accessors
        .floats(index)?
        .into_iter()
        .map(Vec3::from)
        .collect();
    morph(accessors, primitive, weights, name, |i, change| {
        values.get_mut(i).into_iter().for_each(|v| *v += change);
    })?;
    Ok(Some(values))
}

/// Tangents and the side of the texture, with the weighted morph targets added.
fn tangents(accessors: Accessors, job: &Job) -> Result<Option<Vec<Vec4>>, ImportError> {
    let name = "TANGENT";
    let Some(&index) = job.primitive.attributes.get(name).filter(|_| job.tangents) else {
        return Ok(None);
    };
    let values = accessors.floats(index)?;
    let mut values: Vec<Vec4> = values.into_iter().map(Vec4::from_array).collect();
    morph(accessors, job.primitive, job.weights, name, |i, change| {
        let value = values.get_mut(i).into_iter();
        value.for_each(|v| *v += change.extend(0.0));
    })?;
    Ok(Some(values))
}

/// Calls `add` with what each morph target adds to each vertex.
fn morph(
    accessors: Accessors,
    primitive: &Primitive,
    weights: &[f64],
    name: &str,
    mut add: impl FnMut(usize, Vec3),
) -> Result<(), ImportError> {
    for (target, &weight) in primitive.targets.iter().zip(weights) {
        let Some(&index) = target.get(name).filter(|_| weight != 0.0) else {
            continue;
        };
        for (i, change) in accessors.floats::<3>(index)?.into_iter().enumerate() {
            add(i, Vec3::from(change) * weight as f32);
        }
    }
    Ok(())
}

fn uvs(
    accessors: Accessors,
    primitive: &Primitive,
    set: usize,
) -> Result<Option<Vec<Vec2>>, ImportError> {
    let Some(&index) = primitive.attributes.get(&format!("TEXCOORD_{set}")) else {
        return Ok(None);
    };
    let values = accessors.floats(index)?;
    Ok(Some(values.into_iter().map(Vec2::from).collect()))
}

fn colors(accessors: Accessors, job: &Job) -> Result<Vec<MeshAttribute>, ImportError> {
    let Some(&index) = job.primitive.attributes.get("COLOR_0") else {
        return Ok(Vec::new());
    };
    let attribute = |name: &str, values| MeshAttribute {
        name: name.into(),
        per_face: false,
        values,
    };
    if accessors.width(index)? == 3 {
        let values = accessors
            .floats(index)?
            .into_iter()
            .map(Rgb::from)
            .collect();
        return Ok(vec![attribute(COLOR, values)]);
    }
    let values = accessors.floats::<4>(index)?;
    let color = values
        .iter()
        .map(|&[r, g, b, _]| Rgb::new(r, g, b))
        .collect();
    let mut list = vec![attribute(COLOR, color)];
    if job.alpha {
        let alpha = values.iter().map(|v| Rgb::splat(v[3])).collect();
        list.push(attribute(ALPHA, alpha));
    }
    Ok(list)
}

#[cfg(test)]
mod tests {
    use super::assemble;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        let indices = [0, 1, 2, 3, 4];
        assert_eq!(assemble(&indices, 4), Some(vec![[0, 1, 2]]));
        let strip = vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]];
        assert_eq!(assemble(&indices, 5), Some(strip));
        let fan = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]];
        assert_eq!(assemble(&indices, 6), Some(fan));
        assert_eq!(assemble(&indices, 1), None);
        assert_eq!(assemble(&[], 6), Some(vec![]));
    }
}
