//! STL: triangles and nothing else, binary or ASCII.
//!
//! The format has no indices: corners that lie at the same place, bit for bit, become one vertex, so
//! that closed models are closed. Surfaces are flat: a normal per triangle is all that the format knows
//! (and those in the file are often wrong, so that of the corners' order counts).

use super::{Fault, MeshOptions, Raw, place, text::Cursor};
use crate::math::Vec3;
use crate::scene::import::ImportError;
use rustc_hash::FxHashMap;
use std::path::Path;

/// Text of the author's choice, then the number of triangles.
const HEADER: usize = 80;
/// A normal, three corners, two bytes.
const RECORD: usize = 50;

/// Reads an STL file.
pub(super) fn read(data: &[u8], options: &MeshOptions, path: &Path) -> Result<Raw, ImportError> {
    // Some binary files begin with "solid" too: what decides is whether the size is right.
    if is_binary(data) || !starts_as_text(data) {
        return binary(data, options).map_err(|e| e.in_binary(path));
    }
    ascii(data, options).map_err(|e| e.in_text(data, path))
}

fn promised(data: &[u8]) -> Option<usize> {
    let count = u32::from_le_bytes(*data.get(HEADER..)?.first_chunk()?);
    (count as usize).checked_mul(RECORD)
}

fn is_binary(data: &[u8]) -> bool {
    promised(data).is_some_and(|size| data.len() - (HEADER + 4) == size)
}

fn starts_as_text(data: &[u8]) -> bool {
    data.trim_ascii_start().starts_with(b"solid")
}

/// Joins corners into vertices.
#[derive(Default)]
struct Corners {
    number: FxHashMap<[u32; 3], u32>,
    raw: Raw,
}

impl Corners {
    fn vertex(&mut self, p: [f32; 3], options: &MeshOptions) -> u32 {
        // -0 and 0 are one place.
        let key = p.map(|x| (x + 0.0).to_bits());
        let positions = &mut self.raw.positions;
        *self.number.entry(key).or_insert_with(|| {
            let [x, y, z] = p.map(f64::from);
            let position: Vec3 = place(&options.to_world, x, y, z);
            positions.push(position);
            (positions.len() - 1) as u32
        })
    }

    fn finish(mut self) -> Raw {
        self.raw.flat = true;
        self.raw
    }
}

fn binary(data: &[u8], options: &MeshOptions) -> Result<Raw, Fault> {
    let early = || Fault::new(data.len(), "the file ends too early for a binary STL");
    let size = promised(data).ok_or_else(early)?;
    let records = data.get(HEADER + 4..).and_then(|rest| rest.get(..size));
    let mut corners = Corners::default();
    for record in records.ok_or_else(early)?.chunks_exact(RECORD) {
        let number = |i: usize| {
            let word = record[12 + 4 * i..].first_chunk().copied();
            f32::from_le_bytes(word.unwrap_or_default())
        };
        let triangle = [0, 3, 6].map(|i| [number(i), number(i + 1), number(i + 2)]);
        let triangle = triangle.map(|p| corners.vertex(p, options));
        corners.raw.triangles.push(triangle);
    }
    Ok(corners.finish())
}

fn ascii(data: &[u8], options: &MeshOptions) -> Result<Raw, Fault> {
    let mut corners = Corners::default();
    let mut facet: Vec<u32> = Vec::new();
    let mut cursor = Cursor::new(data, 0);
    while !cursor.at_end() {
        cursor.skip_blanks();
        let start = cursor.offset();
        match cursor.word() {
            b"vertex" => {
                let mut p = [0.0; 3];
                for value in &mut p {
                    cursor.skip_blanks();
                    *value = cursor.number()? as f32;
                }
                facet.push(corners.vertex(p, options));
            }
            b"endfacet" => {
                let Some(first) = facet.first_chunk::<3>().filter(|_| facet.len() == 3) else {
                    let message = format!("a facet has three vertices, this one {}", facet.len());
                    return Err(Fault::new(start, message));
                };
                corners.raw.triangles.push(*first);
                facet.clear();
            }
            _ => {}
        }
        cursor.next_line();
    }
    Ok(corners.finish())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::import::mesh::{MeshKind, read as load};

    const SQUARE: [[[f32; 3]; 3]; 2] = [
        [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0]],
        [[-0.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]],
    ];

    fn binary_square(header: &[u8]) -> Vec<u8> {
        let mut file = header.to_vec();
        file.resize(HEADER, b' ');
        file.extend(2u32.to_le_bytes());
        for triangle in SQUARE {
            file.extend([0; 12]);
            file.extend(triangle.iter().flatten().flat_map(|x| x.to_le_bytes()));
            file.extend([0; 2]);
        }
        file
    }

    fn ascii_square() -> String {
        let mut text = String::from("solid square\n");
        for triangle in SQUARE {
            text += "  facet normal 0 0 1\n    outer loop\n";
            for [x, y, z] in triangle {
                text += &format!("      vertex {x} {y} {z:e}\n");
            }
            text += "    endloop\n  endfacet\n";
        }
        text + "endsolid square\n"
    }

    #[test]
    fn both_kinds_give_the_same_flat_mesh_with_shared_corners() {
        let files = [
            binary_square(b"made by a scanner"),
            binary_square(b"solid, and binary all the same"),
            ascii_square().into_bytes(),
        ];
        for file in files {
            let options = MeshOptions::default();
            let loaded = load(&file, MeshKind::Stl, &options, Path::new("a.stl")).unwrap();
            let mesh = loaded.mesh;
            assert_eq!(mesh.triangles.positions().len(), 4);
            assert_eq!(mesh.triangles.triangles(), [[0, 1, 2], [0, 2, 3]]);
            assert!(mesh.normals.is_none());
        }
    }

    #[test]
    fn broken_files_are_errors_with_a_place() {
        let fail = |data: &[u8]| {
            let options = MeshOptions::default();
            load(data, MeshKind::Stl, &options, Path::new("a.stl"))
                .unwrap_err()
                .to_string()
        };
        let short = &binary_square(b"")[..150];
        assert!(fail(short).contains("ends too early"), "{}", fail(short));
        assert!(fail(b"").contains("ends too early"));
        let text = ascii_square().replacen("1e0", "one", 1);
        assert!(
            fail(text.as_bytes()).starts_with("a.stl:4:"),
            "{}",
            fail(text.as_bytes())
        );
        let text = "solid\nfacet\nvertex 0 0 0\nendfacet\n";
        assert!(fail(text.as_bytes()).contains("three vertices"));
    }
}
