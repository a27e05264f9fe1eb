//! Which material each face has.

use super::block::Block;
use crate::math::Rgb;
use crate::scene::import::mesh::{FACE_MATERIAL, FaceMaterials};
use crate::texture::MeshAttribute;
use rustc_hash::FxHashMap;

/// The materials that the blocks name, and their numbers for all faces if there are any.
pub(super) fn materials(blocks: &mut [Block]) -> (FaceMaterials, Option<MeshAttribute>) {
    let mut all = FaceMaterials::default();
    for block in blocks.iter_mut() {
        all.libraries.append(&mut block.libraries);
    }
    if blocks.iter().all(|b| b.materials.is_empty()) {
        return (all, None);
    }
    let mut known: FxHashMap<String, u32> = FxHashMap::default();
    let mut number = |name: String| {
        let next = known.len() as u32;
        *known.entry(name).or_insert_with_key(|name| {
            all.names.push(name.clone());
            next
        })
    };
    let mut values = Vec::new();
    let mut current = number(String::new());
    let mut before = 0;
    for block in blocks.iter_mut() {
        for (faces, name) in std::mem::take(&mut block.materials) {
            values.resize(before + faces, shade(current));
            current = number(name);
        }
        before += block.sizes.len();
        values.resize(before, shade(current));
    }
    let attribute = MeshAttribute {
        name: FACE_MATERIAL.into(),
        per_face: true,
        values,
    };
    (all, Some(attribute))
}

/// A number as an attribute's value: exact up to 2^24 materials.
fn shade(number: u32) -> Rgb {
    Rgb::splat(number as f32)
}
