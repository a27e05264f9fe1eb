//! Colours that mesh files bring along: of vertices, of faces, and images that PLY files name.

use super::{linear, palette};
use crate::bsdf::material::Diffuse;
use crate::bsdf::{Material, MaterialId};
use crate::math::Rgb;
use crate::scene::Mesh;
use crate::scene::import::parts::Parts;
use crate::scene::import::{ImportError, ImportOptions, named};
use crate::texture::{BitmapSettings, Filter, Texture, UvTransform, Wrap};
use glam::{Affine2, Mat2, Vec2};
use rayon::prelude::*;
use std::path::Path;

/// The colours that a mesh has at its vertices or faces.
pub(super) fn of(mesh: &Mesh) -> Option<Texture> {
    let mut list = mesh.attributes.list.iter();
    let has = list.any(|a| a.name == palette::VERTEX_COLOR);
    has.then(|| Texture::MeshAttribute(palette::VERTEX_COLOR.into()))
}

/// Makes a mesh's colours what materials multiply by, under one name. Those of scans and sculptures
/// are made for the screen: the sRGB curve is undone. (Scenes name attributes and take them as they
/// are.)
///
/// Returns what is to be said about them.
pub(super) fn prepare(mesh: &mut Mesh) -> Option<String> {
    let list = &mut mesh.attributes.list;
    // Colours of faces count as those of vertices; `diffuse_red` and so on are an older spelling.
    for name in ["vertex_diffuse", "face_color", "face_diffuse"] {
        if list.iter().any(|a| a.name == palette::VERTEX_COLOR) {
            break;
        }
        if let Some(attribute) = list.iter_mut().find(|a| a.name == name) {
            attribute.name = palette::VERTEX_COLOR.into();
        }
    }
    let colors = list.iter_mut().find(|a| a.name == palette::VERTEX_COLOR)?;
    let values = &mut colors.values;
    let largest = values.par_iter().map(|v| v.max_element());
    let largest = largest.reduce(|| 0.0, f32::max);
    let least = values.par_iter().map(|v| v.min_element());
    let least = least.reduce(|| 0.0, f32::min);
    // Numbers from 0 to 255 in a type that does not say so.
    let bytes = largest > 1.0 && largest <= 255.0;
    let factor = if bytes { 1.0 / 255.0 } else { 1.0 };
    let fit = |v: Rgb| linear((v * factor).clamp(Rgb::ZERO, Rgb::ONE));
    values.par_iter_mut().for_each(|v| *v = fit(*v));
    if bytes {
        return Some(format!(
            "its colours go up to {largest}: they are taken as numbers from 0 to 255"
        ));
    }
    (largest > 1.0 || least < 0.0)
        .then(|| format!("its colours go from {least} to {largest}: they are cut off at 0 and 1"))
}

/// Opens the image that the PLY file `path` names; `None` if a missing one is forgiven.
pub(super) fn open(
    name: &str,
    path: &Path,
    options: &ImportOptions,
    parts: &mut Parts,
) -> Result<Option<Texture>, ImportError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut file = named::resolve(folder, name);
    if let Some(beside) = named::beside(&file, folder, name) {
        let (path, found) = (path.display(), beside.display());
        parts.warn(format!("{path}: for the texture {name} stands {found}"));
        file = beside;
    }
    let hint = named::hint(&file, folder);
    let opened = options.textures.open(BitmapSettings {
        path: file,
        raw: false,
        gamma: None,
        filter: Filter::Linear,
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Repeat,
        // In files of this kind v points up; row 0 of an image lies at v = 0 here.
        to_uv: UvTransform(Affine2 {
            matrix2: Mat2::from_diagonal(Vec2::new(1.0, -1.0)),
            translation: Vec2::Y,
        }),
        channel: None,
    });
    match opened {
        Ok(texture) => Ok(Some(texture)),
        Err(e) if options.lenient => {
            parts.warn(format!("a texture is left out: {e}{hint}"));
            Ok(None)
        }
        Err(e) => Err(ImportError {
            at: None,
            file: Some(path.to_owned()),
            message: format!("the texture {} cannot be used: {}{hint}", e.path, e.reason),
            help: Some("restore the file, or go on without it with --lenient".into()),
        }),
    }
}

/// A diffuse surface under an image, times the colours of the mesh if it has any.
pub(super) fn painted(image: Texture, colors: Option<Texture>, parts: &mut Parts) -> MaterialId {
    let reflectance = match colors {
        Some(colors) => image.times(colors),
        None => image,
    };
    let id = parts.materials.push(Diffuse { reflectance });
    parts.materials.push(Material::TwoSided {
        front: id,
        back: id,
    })
}
