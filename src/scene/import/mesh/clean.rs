//! From what a file holds to what the renderer may rely on.

use super::{Loaded, MeshOptions, Raw, crease, normals, repeated};
use crate::accel::TriangleMesh;
use crate::math::{Vec2, Vec3};
use crate::scene::description::Mesh;
use crate::scene::import::ImportError;
use crate::texture::{MeshAttribute, MeshAttributes};
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;

/// Items a thread takes at once.
const GRAIN: usize = 1 << 14;

/// A mesh that cannot be used, as a whole.
#[derive(Debug)]
pub(super) struct Unusable {
    message: String,
    help: Option<&'static str>,
}

impl Unusable {
    /// The error about the file `path`.
    pub fn in_file(self, path: &Path) -> ImportError {
        ImportError {
            at: None,
            file: Some(path.to_owned()),
            message: self.message,
            help: self.help.map(str::to_owned),
        }
    }
}

/// Checks and repairs `raw`, gives it normals where it needs them, and packs it.
pub(super) fn finish(mut raw: Raw, options: &MeshOptions) -> Result<Loaded, Unusable> {
    let mut warnings = std::mem::take(&mut raw.warnings);
    check_size(&raw, options)?;
    check_positions(&mut raw, options, &mut warnings)?;
    // What has no area is not seen, with or without it; a file without any triangle is a mistake.
    let had_triangles = !raw.triangles.is_empty();
    drop_degenerate(&mut raw, &mut warnings);
    drop_repeated(&mut raw, &mut warnings);
    repair_values(&mut raw, &mut warnings);
    if options.to_world.matrix3.determinant() < 0.0 {
        // A mirror turns the order of corners around, but nothing inside out.
        reverse(&mut raw.triangles);
    }
    if raw.triangles.is_empty() {
        let message = "the mesh has no triangle with an area";
        if !options.lenient && !had_triangles {
            return Err(Unusable {
                message: message.into(),
                help: Some("remove the shape from the scene, or export the mesh again"),
            });
        }
        warnings.push(message.into());
    }
    shade(&mut raw, options, &mut warnings);
    raw.tangents = match raw.normals {
        Some(_) => raw
            .tangents
            .map(|list| normals::tangents(list, &options.to_world)),
        None => None,
    };
    if options.flip_normals {
        turn_around(&mut raw);
    }
    pack(raw, warnings)
}

/// The ray tracers number vertices and triangles with 32 bits, creases the corners of triangles.
fn check_size(raw: &Raw, options: &MeshOptions) -> Result<(), Unusable> {
    let most = raw.positions.len().max(raw.triangles.len());
    let limit = match options.max_smooth_angle {
        None => u32::MAX as usize,
        Some(_) => u32::MAX as usize / 3,
    };
    if most < limit {
        return Ok(());
    }
    Err(Unusable {
        message: format!("{most} vertices or triangles in one mesh: {limit} are too many"),
        help: Some("split the mesh into several files"),
    })
}

fn check_positions(
    raw: &mut Raw,
    options: &MeshOptions,
    warnings: &mut Vec<String>,
) -> Result<(), Unusable> {
    let parts = raw.positions.par_chunks(GRAIN);
    // A sum is not finite if a term is not; where finite terms overflow, the search finds nothing.
    if parts.all(|part| part.iter().fold(Vec3::ZERO, |sum, p| sum + *p).is_finite()) {
        return Ok(());
    }
    let Some(first) = raw.positions.iter().position(|p| !p.is_finite()) else {
        return Ok(());
    };
    let place = format!("vertex {first} (counted from 0)");
    if !options.lenient {
        let p = raw.positions[first];
        return Err(Unusable {
            message: format!("{place} lies at {p} in world space: not finite"),
            help: Some("repair the mesh, or the shape's to_world transform"),
        });
    }
    let bad: Vec<bool> = raw.positions.iter().map(|p| !p.is_finite()).collect();
    let before = raw.triangles.len();
    keep_triangles(raw, |_, t| !t.iter().any(|&i| bad[i as usize]));
    for p in raw.positions.iter_mut().filter(|p| !p.is_finite()) {
        *p = Vec3::ZERO;
    }
    let dropped = before - raw.triangles.len();
    warnings.push(format!(
        "{dropped} triangles dropped: they use vertices that are not finite, the first is {place}"
    ));
    Ok(())
}

/// Drops triangles without area: exactly, by `f64` products of the `f32` positions, and those so
/// small that their normal would vanish in `f32`.
fn drop_degenerate(raw: &mut Raw, warnings: &mut Vec<String>) {
    let positions = &raw.positions;
    let least = f64::from(f32::MIN_POSITIVE);
    // Products of f32 coordinates: their squares stay in the range of f64.
    let has_area = |t: &[u32; 3]| normals::cross(positions, t).length_squared() >= least * least;
    // Nearly all meshes end here, and nothing was allocated for them.
    let parts = raw.triangles.par_chunks(GRAIN);
    if parts.all(|part| part.iter().all(has_area)) {
        return;
    }
    let first = raw.triangles.iter().position(|t| !has_area(t)).unwrap_or(0);
    let flags: Vec<bool> = raw.triangles.par_iter().map(has_area).collect();
    let before = raw.triangles.len();
    keep_triangles(raw, |i, _| flags[i]);
    let dropped = before - raw.triangles.len();
    let of = "triangles without area dropped, the first is triangle";
    warnings.push(format!("{dropped} {of} {first} (counted from 0)"));
}

/// Drops triangles that stand where another one does, where they are many.
fn drop_repeated(raw: &mut Raw, warnings: &mut Vec<String>) {
    let Some(repeats) = repeated::find(raw) else {
        return;
    };
    let dropped = repeats.iter().filter(|r| **r).count();
    let first = repeats.iter().position(|r| *r).unwrap_or(0);
    keep_triangles(raw, |i, _| !repeats[i]);
    warnings.push(format!(
        "{dropped} triangles dropped that stand exactly where another one does, the first is triangle {first} (counted from 0)"
    ));
}

/// Keeps the triangles that `keep` says, with their attributes.
fn keep_triangles(raw: &mut Raw, keep: impl Fn(usize, &[u32; 3]) -> bool) {
    let kept: Vec<usize> = (0..raw.triangles.len())
        .filter(|&i| keep(i, &raw.triangles[i]))
        .collect();
    for attribute in raw.attributes.iter_mut().filter(|a| a.per_face) {
        attribute.values = kept.iter().map(|&i| attribute.values[i]).collect();
    }
    raw.triangles = kept.iter().map(|&i| raw.triangles[i]).collect();
}

/// Texture coordinates and attributes that are not finite become zero.
fn repair_values(raw: &mut Raw, warnings: &mut Vec<String>) {
    let uvs = raw.uvs.iter_mut().flatten();
    let bad_uvs = uvs.filter(|uv| !uv.is_finite()).map(|uv| *uv = Vec2::ZERO);
    let bad_uvs = bad_uvs.count();
    if bad_uvs > 0 {
        warnings.push(format!(
            "{bad_uvs} texture coordinates were not finite: zero instead"
        ));
    }
    for MeshAttribute { name, values, .. } in &mut raw.attributes {
        let bad = values.iter_mut().filter(|v| !v.is_finite());
        let bad = bad.map(|v| *v = crate::math::Rgb::ZERO).count();
        if bad > 0 {
            warnings.push(format!(
                "{bad} values of `{name}` were not finite: zero instead"
            ));
        }
    }
}

/// Leaves `raw.normals` in world space as the options ask.
fn shade(raw: &mut Raw, options: &MeshOptions, warnings: &mut Vec<String>) {
    let flat = raw.flat || (options.flat_without_normals && raw.normals.is_none());
    if options.face_normals || (flat && options.max_smooth_angle.is_none()) {
        raw.normals = None;
        return;
    }
    if let Some(degrees) = options.max_smooth_angle {
        return crease::rebuild(raw, degrees);
    }
    let Some(from_file) = raw.normals.take() else {
        raw.normals = Some(normals::smooth(&raw.positions, &raw.triangles));
        return;
    };
    let world = normals::transform(from_file, &options.to_world);
    orient(&mut raw.triangles, &raw.positions, &world);
    let (repaired, counts) = normals::repair(world, &raw.positions, &raw.triangles);
    if let Some((count, first)) = counts {
        warnings.push(format!(
            "{count} vertices without a usable normal took the surface's, the first is vertex {first} (counted from 0)"
        ));
    }
    raw.normals = Some(repaired);
}

/// Turns the corners of triangles whose given normals point to the other side: the order of corners
/// says everywhere else which side is the front.
fn orient(triangles: &mut [[u32; 3]], positions: &[Vec3], normals: &[Vec3]) {
    triangles
        .par_iter_mut()
        .with_min_len(GRAIN)
        .for_each(|triangle| {
            let sum: Vec3 = triangle.map(|i| normals[i as usize]).into_iter().sum();
            if normals::cross(positions, triangle).dot(sum.as_dvec3()) < 0.0 {
                triangle.swap(1, 2);
            }
        });
}

fn reverse(triangles: &mut [[u32; 3]]) {
    triangles
        .par_iter_mut()
        .with_min_len(GRAIN)
        .for_each(|triangle| triangle.swap(1, 2));
}

fn turn_around(raw: &mut Raw) {
    reverse(&mut raw.triangles);
    for normal in raw.normals.iter_mut().flatten() {
        *normal = -*normal;
    }
    for tangent in raw.tangents.iter_mut().flatten() {
        tangent.w = -tangent.w;
    }
}

fn pack(raw: Raw, warnings: Vec<String>) -> Result<Loaded, Unusable> {
    let triangles = TriangleMesh::new(raw.positions, raw.triangles).map_err(|e| Unusable {
        message: e.to_string(),
        help: None,
    })?;
    let mesh = Mesh {
        triangles: Arc::new(triangles),
        normals: raw.normals,
        tangents: raw.tangents,
        uvs: raw.uvs.map(Arc::new),
        attributes: MeshAttributes {
            list: raw.attributes,
        },
    };
    Ok(Loaded {
        mesh,
        warnings,
        face_materials: raw.face_materials,
        images: raw.images,
    })
}
