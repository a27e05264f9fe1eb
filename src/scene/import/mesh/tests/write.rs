//! Writers of all formats. Text has all digits of the `f32` values, so that every format holds the
//! same.

use crate::math::{Vec2, Vec3};
use flate2::{Compression, write::ZlibEncoder};
use std::fmt::Write as _;
use std::io::Write as _;

/// A mesh with everything. Empty vectors are left out of the files.
#[derive(Default, Clone)]
pub struct Model {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub colors: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl Model {
    pub fn obj(&self) -> Vec<u8> {
        let mut text = String::from("# written by a test\no thing\n");
        for (i, p) in self.positions.iter().map(|v| v.as_dvec3()).enumerate() {
            write!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
            if let Some(c) = self.colors.get(i).map(|v| v.as_dvec3()) {
                write!(text, " {} {} {}", c.x, c.y, c.z).unwrap();
            }
            text.push('\n');
        }
        for uv in self.uvs.iter().map(|v| v.as_dvec2()) {
            writeln!(text, "vt {} {}", uv.x, uv.y).unwrap();
        }
        for n in self.normals.iter().map(|v| v.as_dvec3()) {
            writeln!(text, "vn {:e} {:e} {:e}", n.x, n.y, n.z).unwrap();
        }
        for t in &self.triangles {
            text.push('f');
            for i in t.map(|i| i + 1) {
                match (self.uvs.is_empty(), self.normals.is_empty()) {
                    (true, true) => write!(text, " {i}"),
                    (false, true) => write!(text, " {i}/{i}"),
                    (true, false) => write!(text, " {i}//{i}"),
                    (false, false) => write!(text, " {i}/{i}/{i}"),
                }
                .unwrap();
            }
            text.push('\n');
        }
        text.into_bytes()
    }

    fn rows(&self) -> impl Iterator<Item = Vec<f32>> + '_ {
        (0..self.positions.len()).map(|i| {
            let mut row = self.positions[i].to_array().to_vec();
            row.extend(self.normals.get(i).iter().flat_map(|n| n.to_array()));
            row.extend(self.uvs.get(i).iter().flat_map(|uv| uv.to_array()));
            row.extend(self.colors.get(i).iter().flat_map(|c| c.to_array()));
            row
        })
    }

    fn ply_header(&self, format: &str, number: &str) -> String {
        let mut text = format!("ply\nformat {format} 1.0\ncomment a test\n");
        writeln!(text, "element vertex {}", self.positions.len()).unwrap();
        let some = |yes: bool, names: &'static [&'static str]| if yes { names } else { &[] };
        let groups = [
            some(true, &["x", "y", "z"]),
            some(!self.normals.is_empty(), &["nx", "ny", "nz"]),
            some(!self.uvs.is_empty(), &["s", "t"]),
            some(!self.colors.is_empty(), &["r", "g", "b"]),
        ];
        for name in groups.iter().copied().flatten() {
            writeln!(text, "property {number} {name}").unwrap();
        }
        writeln!(text, "element face {}", self.triangles.len()).unwrap();
        text + "property list uchar int vertex_indices\nend_header\n"
    }

    pub fn ply_ascii(&self) -> Vec<u8> {
        let mut text = self.ply_header("ascii", "float");
        for row in self.rows() {
            let words: Vec<_> = row.iter().map(|&v| f64::from(v).to_string()).collect();
            writeln!(text, "{}", words.join(" ")).unwrap();
        }
        for [a, b, c] in &self.triangles {
            writeln!(text, "3 {a} {b} {c}").unwrap();
        }
        text.into_bytes()
    }

    pub fn ply_little(&self) -> Vec<u8> {
        let mut bytes = self
            .ply_header("binary_little_endian", "float")
            .into_bytes();
        for value in self.rows().flatten() {
            bytes.extend(value.to_le_bytes());
        }
        for t in &self.triangles {
            bytes.push(3);
            bytes.extend(t.iter().flat_map(|i| i.to_le_bytes()));
        }
        bytes
    }

    pub fn ply_big_double(&self) -> Vec<u8> {
        let mut bytes = self.ply_header("binary_big_endian", "double").into_bytes();
        for value in self.rows().flatten() {
            bytes.extend(f64::from(value).to_be_bytes());
        }
        for t in &self.triangles {
            bytes.push(3);
            bytes.extend(t.iter().flat_map(|i| i.to_be_bytes()));
        }
        bytes
    }

    /// One mesh of a `serialized` file, without the list at the end.
    pub fn serialized_part(&self, version: u16, double: bool) -> Vec<u8> {
        deflate(version, &self.serialized_inner(version, double))
    }

    /// What is compressed of it.
    pub fn serialized_inner(&self, version: u16, double: bool) -> Vec<u8> {
        let mut flags = if double { 0x2000u32 } else { 0x1000 };
        flags |= if self.normals.is_empty() { 0 } else { 1 };
        flags |= if self.uvs.is_empty() { 0 } else { 2 };
        flags |= if self.colors.is_empty() { 0 } else { 8 };
        let mut inner = flags.to_le_bytes().to_vec();
        if version == 4 {
            inner.extend("thing\0".bytes());
        }
        inner.extend((self.positions.len() as u64).to_le_bytes());
        inner.extend((self.triangles.len() as u64).to_le_bytes());
        let values = self.positions.iter().flat_map(|p| p.to_array());
        let values = values.chain(self.normals.iter().flat_map(|n| n.to_array()));
        let values = values.chain(self.uvs.iter().flat_map(|uv| uv.to_array()));
        for value in values.chain(self.colors.iter().flat_map(|c| c.to_array())) {
            if double {
                inner.extend(f64::from(value).to_le_bytes());
            } else {
                inner.extend(value.to_le_bytes());
            }
        }
        inner.extend(
            self.triangles
                .iter()
                .flatten()
                .flat_map(|i| i.to_le_bytes()),
        );
        inner
    }
}

/// A mesh of a `serialized` file from its uncompressed part.
pub fn deflate(version: u16, inner: &[u8]) -> Vec<u8> {
    let mut bytes = 0x041cu16.to_le_bytes().to_vec();
    bytes.extend(version.to_le_bytes());
    let mut encoder = ZlibEncoder::new(bytes, Compression::fast());
    encoder.write_all(inner).unwrap();
    encoder.finish().unwrap()
}

/// A `serialized` file of several meshes.
pub fn serialized(version: u16, parts: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut offsets = Vec::new();
    for part in parts {
        offsets.push(bytes.len());
        bytes.extend(part);
    }
    for offset in offsets {
        if version == 4 {
            bytes.extend((offset as u64).to_le_bytes());
        } else {
            bytes.extend((offset as u32).to_le_bytes());
        }
    }
    bytes.extend((parts.len() as u32).to_le_bytes());
    bytes
}
