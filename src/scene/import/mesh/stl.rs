//! STL: triangles and nothing else, binary or ASCII.
//!
//! The format has no indices: corners that lie at the same place, bit for bit, become one vertex,
//! so that closed models are closed. Surfaces are flat: a normal per triangle is all that the
//! format knows (and those in the file are often wrong, so that of the corners' order counts).

use super::{Fault, MeshOptions, Raw, place, text::Cursor};
use crate::math::Vec3;
use crate::scene::import::{ImportError, encoding};
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
    let data = &encoding::lines(data);
    ascii(data, options).map_err(|e| e.in_text(data, path))
}

fn promised(data: &[u8]) -> Option<usize> {
    let count = u32::from_le_bytes(*data.get(HEADER..)?.first_chunk()?);
    (count as usize).checked_mul(RECORD)
}

/// The triangles that the header promises are there. Bytes behind them count only if the number of
/// triangles, read as text, would be none: four letters stand for a hundred million triangles and
/// more.
fn is_binary(data: &[u8]) -> bool {
    let text = |b: &u8| b.is_ascii_graphic() || b.is_ascii_whitespace() || *b >= 0x80;
    let count = data.get(HEADER..HEADER + 4).unwrap_or_default();
    promised(data).is_some_and(|size| {
        let room = data.len() - (HEADER + 4);
        room == size || room > size && !count.iter().all(text)
    })
}

fn starts_as_text(data: &[u8]) -> bool {
    let text = &data[encoding::start(data)..];
    let text = text.trim_ascii_start();
    text.get(..5)
        .is_some_and(|w| w.eq_ignore_ascii_case(b"solid"))
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
    let records = records.ok_or_else(early)?;
    let mut corners = Corners::default();
    corners.raw.warnings = odd_bytes(data, records);
    for record in records.chunks_exact(RECORD) {
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

/// What a binary file holds beside its triangles.
fn odd_bytes(data: &[u8], records: &[u8]) -> Vec<String> {
    let mut warnings = Vec::new();
    let behind = data.len() - (HEADER + 4) - records.len();
    if behind > 0 {
        warnings.push(format!(
            "{behind} bytes behind the last triangle are left out"
        ));
    }
    // Both conventions for colours (VisCAM, Magics) keep them in the two bytes behind the corners.
    let colored = records.chunks_exact(RECORD).filter(|r| r[48..] != [0; 2]);
    let colored = colored.count();
    if colored > 0 {
        warnings.push(format!(
            "{colored} triangles have attribute bytes (colours in some dialects): left out"
        ));
    }
    warnings
}

fn ascii(data: &[u8], options: &MeshOptions) -> Result<Raw, Fault> {
    let mut corners = Corners::default();
    let mut facet: Vec<u32> = Vec::new();
    let mut solids = 0i64;
    let mut cursor = Cursor::new(data, encoding::start(data));
    while !cursor.at_end() {
        cursor.skip_blanks();
        let start = cursor.offset();
        let word = cursor.word();
        let is = |name: &[u8]| word.eq_ignore_ascii_case(name);
        if is(b"vertex") {
            facet.push(corners.vertex(point(&mut cursor)?, options));
        } else if is(b"endfacet") {
            let Some(first) = facet.first_chunk::<3>().filter(|_| facet.len() == 3) else {
                let message = format!("a facet has three vertices, this one {}", facet.len());
                return Err(Fault::new(start, message));
            };
            corners.raw.triangles.push(*first);
            facet.clear();
        } else if is(b"solid") {
            solids += 1;
        } else if is(b"endsolid") {
            solids -= 1;
        }
        cursor.next_line();
    }
    if !facet.is_empty() {
        return Err(Fault::new(data.len(), "the file ends inside of a facet"));
    }
    if solids > 0 {
        let warning = "the file has no `endsolid`: it may have been cut short";
        corners.raw.warnings.push(warning.into());
    }
    Ok(corners.finish())
}

/// Three coordinates.
fn point(cursor: &mut Cursor) -> Result<[f32; 3], Fault> {
    let mut p = [0.0; 3];
    for value in &mut p {
        cursor.skip_blanks();
        *value = cursor.number()? as f32;
    }
    Ok(p)
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

    fn square(file: &[u8]) -> Vec<String> {
        let options = MeshOptions::default();
        let loaded = load(file, MeshKind::Stl, &options, Path::new("a.stl")).unwrap();
        assert_eq!(loaded.mesh.triangles.triangles(), [[0, 1, 2], [0, 2, 3]]);
        loaded.warnings
    }

    #[test]
    fn text_may_begin_with_a_mark_have_capitals_and_end_its_lines_as_it_likes() {
        let text = ascii_square();
        for odd in [
            format!("\u{feff}{text}"),
            format!("\u{feff}\r\n{}", text.replace('\n', "\r\n")),
            text.to_uppercase(),
            text.replace('\n', "\r"),
        ] {
            assert_eq!(square(odd.as_bytes()), Vec::<String>::new(), "{odd}");
        }
    }

    #[test]
    fn bytes_behind_the_triangles_change_nothing_but_are_told() {
        for header in [b"solid, and binary all the same".as_slice(), b"scan"] {
            let mut file = binary_square(header);
            file.extend(b"tail bytes");
            let told = square(&file);
            assert!(told[0].starts_with("10 bytes behind"), "{told:?}");
        }
        let mut colored = binary_square(b"COLOR=");
        colored[HEADER + 4 + 48] = 31;
        assert!(square(&colored)[0].starts_with("1 triangles have attribute"));
    }

    #[test]
    fn text_that_was_cut_short_is_told_or_refused() {
        let text = ascii_square();
        let whole = text.replace("endsolid square\n", "");
        assert!(square(whole.as_bytes())[0].contains("endsolid"));
        let inside = &text[..text.rfind("endloop").unwrap()];
        let options = MeshOptions::default();
        let error = load(
            inside.as_bytes(),
            MeshKind::Stl,
            &options,
            Path::new("a.stl"),
        );
        assert!(error.unwrap_err().to_string().contains("inside of a facet"));
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
