//! A block of lines of an OBJ file, parsed by itself.
//!
//! Positive indices are absolute, negative ones count back from the line they stand on: those are
//! kept relative to the block and resolved when the numbers before the block are known.

use super::skipped::Skipped;
use crate::math::{Rgb, Vec2, Vec3};
use crate::scene::import::mesh::{Fault, MeshOptions, place, text::Cursor};
use std::ops::Range;

/// Index of a stream that a corner does not name.
pub(super) const ABSENT: i64 = i64::MIN;

/// A corner of a face: one-based position, texture coordinate and normal.
pub(super) type Corner = [i64; 3];

/// What a block of lines holds.
#[derive(Default)]
pub(super) struct Block {
    range: Range<usize>,
    pub positions: Vec<Vec3>,
    /// Shorter than `positions` where the last have none; empty if none has.
    pub colors: Vec<Rgb>,
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    pub corners: Vec<Corner>,
    /// Corners of each face.
    pub sizes: Vec<u32>,
    /// Names of materials (`usemtl`), each with the number of faces of the block before it.
    pub materials: Vec<(usize, String)>,
    /// Files that define materials (`mtllib`).
    pub libraries: Vec<String>,
    /// What was met and is not read.
    pub skipped: Skipped,
    /// Which indices (3 * corner + stream) are relative to the block.
    relative: Vec<usize>,
}

/// Parses the lines in `range`.
pub(super) fn parse(
    data: &[u8],
    range: Range<usize>,
    options: &MeshOptions,
) -> Result<Block, Fault> {
    let mut block = Block {
        range: range.clone(),
        ..Block::default()
    };
    let mut cursor = Cursor::new(&data[..range.end], range.start);
    while !cursor.at_end() {
        cursor.skip_blanks();
        let start = cursor.offset();
        match cursor.word() {
            b"v" => block.position(&mut cursor, options)?,
            b"vt" => block.uv(&mut cursor, options)?,
            b"vn" => block.normal(&mut cursor)?,
            b"f" => block.face(&mut cursor)?,
            b"usemtl" if options.face_materials => {
                let name = text(cursor.rest_of_line());
                block.materials.push((block.sizes.len(), name));
            }
            b"mtllib" if options.face_materials => {
                block.libraries.push(text(cursor.rest_of_line()));
            }
            other => block.skipped.meet(other, start),
        }
        cursor.next_line();
    }
    Ok(block)
}

impl Block {
    /// Number of positions, texture coordinates and normals.
    pub fn counts(&self) -> [usize; 3] {
        [self.positions.len(), self.uvs.len(), self.normals.len()]
    }

    /// Resolves relative indices: `before` is what the file holds before this block.
    pub fn make_absolute(&mut self, before: [usize; 3]) {
        for &slot in &self.relative {
            let (corner, stream) = (slot / 3, slot % 3);
            self.corners[corner][stream] += before[stream] as i64;
        }
    }

    /// `v x y z`, `v x y z w` or `v x y z r g b`.
    fn position(&mut self, cursor: &mut Cursor, options: &MeshOptions) -> Result<(), Fault> {
        let [x, y, z] = numbers(cursor)?;
        self.positions.push(place(&options.to_world, x, y, z));
        cursor.skip_blanks();
        if cursor.at_line_end() {
            return Ok(());
        }
        let _weight_or_red = cursor.clone().number()?;
        let mut ahead = cursor.clone();
        let Ok([r, g, b]) = numbers(&mut ahead) else {
            return Ok(());
        };
        self.colors.resize(self.positions.len() - 1, Rgb::ONE);
        self.colors.push(Rgb::new(r as f32, g as f32, b as f32));
        Ok(())
    }

    /// `vt u`, `vt u v` or `vt u v w`.
    fn uv(&mut self, cursor: &mut Cursor, options: &MeshOptions) -> Result<(), Fault> {
        let [u] = numbers(cursor)?;
        cursor.skip_blanks();
        let v = if cursor.at_line_end() {
            0.0
        } else {
            cursor.number()?
        };
        let v = if options.flip_tex_coords { 1.0 - v } else { v };
        self.uvs.push(Vec2::new(u as f32, v as f32));
        Ok(())
    }

    fn normal(&mut self, cursor: &mut Cursor) -> Result<(), Fault> {
        let [x, y, z] = numbers(cursor)?;
        self.normals.push(Vec3::new(x as f32, y as f32, z as f32));
        Ok(())
    }

    /// `f v v v ..` with each v one of `v`, `v/vt`, `v//vn`, `v/vt/vn`.
    fn face(&mut self, cursor: &mut Cursor) -> Result<(), Fault> {
        let start = cursor.offset();
        let first = self.corners.len();
        loop {
            cursor.skip_blanks();
            if cursor.at_line_end() {
                break;
            }
            self.corner(cursor)?;
        }
        let size = self.corners.len() - first;
        if size < 3 {
            let message = format!("a face needs three corners, this one has {size}");
            return Err(Fault::new(start, message));
        }
        self.sizes.push(size as u32);
        Ok(())
    }

    #[inline]
    fn corner(&mut self, cursor: &mut Cursor) -> Result<(), Fault> {
        let mut corner = [ABSENT; 3];
        corner[0] = self.index(cursor, 0)?;
        for (stream, index) in corner.iter_mut().enumerate().skip(1) {
            if cursor.peek() != Some(b'/') {
                break;
            }
            cursor.step();
            if cursor.peek() != Some(b'/') && !cursor.at_word_end() {
                *index = self.index(cursor, stream)?;
            }
        }
        if !cursor.at_word_end() {
            let message = "a corner is `v`, `v/vt`, `v//vn` or `v/vt/vn`";
            return Err(Fault::new(cursor.offset(), message));
        }
        self.corners.push(corner);
        Ok(())
    }

    #[inline]
    fn index(&mut self, cursor: &mut Cursor, stream: usize) -> Result<i64, Fault> {
        let index = cursor.integer()?;
        if index >= 0 {
            return Ok(index);
        }
        self.relative.push(self.corners.len() * 3 + stream);
        Ok(self.counts()[stream] as i64 + index + 1)
    }

    /// The error about corner `at`, which names something that the file does not have.
    #[cold]
    pub fn bad_corner(&self, data: &[u8], at: usize, totals: [usize; 3]) -> Fault {
        let names = ["positions (v)", "texture coordinates (vt)", "normals (vn)"];
        let corner = self.corners.get(at).copied().unwrap_or_default();
        let stream = (0..3)
            .find(|&s| {
                let total = totals[s] as i64;
                corner[s] != ABSENT && !(1..=total).contains(&corner[s])
            })
            .unwrap_or(0);
        let message = format!(
            "corner names number {}, but the file has {} {}",
            corner[stream], totals[stream], names[stream]
        );
        Fault::new(self.find_corner(data, at), message)
    }

    /// Where corner `at` stands: the faces of the block are counted again.
    fn find_corner(&self, data: &[u8], at: usize) -> usize {
        let mut cursor = Cursor::new(&data[..self.range.end], self.range.start);
        let mut seen = 0;
        while !cursor.at_end() {
            cursor.skip_blanks();
            if cursor.word() == b"f" {
                cursor.skip_blanks();
                while !cursor.at_line_end() {
                    if seen == at {
                        return cursor.offset();
                    }
                    seen += 1;
                    cursor.word();
                    cursor.skip_blanks();
                }
            }
            cursor.next_line();
        }
        self.range.start
    }
}

fn text(bytes: Vec<u8>) -> String {
    String::from_utf8_lossy(&bytes).into_owned()
}

/// `N` numbers.
#[inline]
fn numbers<const N: usize>(cursor: &mut Cursor) -> Result<[f64; N], Fault> {
    let mut values = [0.0; N];
    for value in &mut values {
        cursor.skip_blanks();
        *value = cursor.number()?;
    }
    Ok(values)
}
