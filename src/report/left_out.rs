//! What a scene does without, and what that saves: part of `twintree info`.

use super::totals::{TextureTotals, meshes_of};
use super::words;
use crate::light::Emitter;
use crate::scene::spare::Trimmed;
use crate::scene::{Description, Geometry};
use serde::Serialize;

/// Bytes of a normal in memory.
const NORMAL_BYTES: u64 = 12;

/// Something that this scene does not need.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// What.
    pub what: &'static str,
    /// Why.
    pub why: String,
    /// Memory that it would have taken, bytes; `null` where that depends on more than the scene.
    pub saved_bytes: Option<u64>,
}

impl LeftOut {
    /// In words.
    pub fn sentence(&self) -> String {
        let saved = self.saved_bytes.map(words::bytes);
        let saved = saved.map_or(String::new(), |b| format!(", {b} saved"));
        format!("{}: {}{saved}", self.what, self.why)
    }
}

/// All that the scene does without.
pub fn left_out(
    description: &Description,
    textures: TextureTotals,
    trimmed: Trimmed,
) -> Vec<LeftOut> {
    let all = [
        coordinates(trimmed),
        attributes(trimmed),
        normals(description),
        texture_system(textures),
        cut_outs(description),
        light_tree(description),
        field(description),
    ];
    all.into_iter().flatten().collect()
}

fn coordinates(trimmed: Trimmed) -> Option<LeftOut> {
    (trimmed.uv_meshes > 0).then(|| LeftOut {
        what: "texture coordinates",
        why: format!("no material of {} reads them", meshes(trimmed.uv_meshes)),
        saved_bytes: Some(trimmed.uv_bytes),
    })
}

fn attributes(trimmed: Trimmed) -> Option<LeftOut> {
    (trimmed.attributes > 0).then(|| LeftOut {
        what: "attributes",
        why: format!("no texture names {} of them", trimmed.attributes),
        saved_bytes: Some(trimmed.attribute_bytes),
    })
}

fn normals(description: &Description) -> Option<LeftOut> {
    let all = meshes_of(description);
    let flat: Vec<_> = all.iter().filter(|m| m.normals.is_none()).collect();
    let vertices = flat.iter().map(|m| m.triangles.positions().len() as u64);
    let bytes = vertices.sum::<u64>() * NORMAL_BYTES;
    (!flat.is_empty()).then(|| LeftOut {
        what: "normals",
        why: format!("{} shaded flat", are(flat.len())),
        saved_bytes: Some(bytes),
    })
}

fn texture_system(textures: TextureTotals) -> Option<LeftOut> {
    (textures.count == 0).then(|| LeftOut {
        what: "texture system",
        why: "no material has an image".into(),
        saved_bytes: None,
    })
}

fn cut_outs(description: &Description) -> Option<LeftOut> {
    let materials = &description.materials;
    let masked = |s: &crate::scene::Shape| materials.is_masked(s.material);
    let any = description.shapes.iter().any(masked);
    (!any).then(|| LeftOut {
        what: "tests of opacity",
        why: "no material is cut out".into(),
        saved_bytes: None,
    })
}

/// Lights between which there is something to choose: those that stand in the scene.
fn light_tree(description: &Description) -> Option<LeftOut> {
    let leaves = |emitter: &Emitter| match emitter {
        Emitter::Area { shape, .. } => match &description.shapes.get(*shape as usize)?.geometry {
            Geometry::Mesh(mesh) => Some(mesh.triangles.triangles().len()),
            Geometry::Analytic(_) => Some(1),
        },
        Emitter::Point { .. }
        | Emitter::Spot { .. }
        | Emitter::Projector { .. }
        | Emitter::Goniometric { .. } => Some(1),
        _ => None,
    };
    let count: usize = description.emitters.iter().filter_map(leaves).sum();
    let why = match count {
        0 => "no light stands in the scene",
        1 => "one light leaves nothing to choose",
        _ => return None,
    };
    Some(LeftOut {
        what: "light tree",
        why: why.into(),
        saved_bytes: None,
    })
}

fn field(description: &Description) -> Option<LeftOut> {
    let materials = &description.materials;
    let scatters = |s: &crate::scene::Shape| materials.scatters(s.material);
    let any = description.shapes.iter().any(scatters);
    (!any).then(|| LeftOut {
        what: "learned field",
        why: "no material is rough".into(),
        saved_bytes: None,
    })
}

fn meshes(n: usize) -> String {
    match n {
        1 => "1 mesh".into(),
        n => format!("{n} meshes"),
    }
}

fn are(n: usize) -> String {
    let is = if n == 1 { "is" } else { "are" };
    format!("{} {is}", meshes(n))
}
