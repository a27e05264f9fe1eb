//! Mitsuba's `serialized` meshes, versions 3 and 4.
//!
//! A file is a row of meshes, each `0x041C`, the version, and a zlib stream: flags, a name (version
//! 4), the numbers of vertices and triangles, then arrays of positions, normals, texture
//! coordinates, colours and indices. A list of the meshes' offsets ends the file: 64 bits each in
//! version 4, 32 in version 3, then their number in 32 bits. All little endian.

use super::{Fault, MeshOptions, Raw, place};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::MeshAttribute;
use flate2::read::ZlibDecoder;
use std::io::Read;

const MAGIC: u16 = 0x041c;
const HAS_NORMALS: u32 = 0x1;
const HAS_TEXCOORDS: u32 = 0x2;
const HAS_COLORS: u32 = 0x8;
const FACE_NORMALS: u32 = 0x10;
const DOUBLE: u32 = 0x2000;

/// Bytes read at once: memory grows with what the stream really holds, not with what it promises.
const STEP: usize = 1 << 20;
/// A name longer than this is no name.
const LONGEST_NAME: usize = 1 << 16;

/// Reads mesh `options.shape_index` of a file.
pub(super) fn read(data: &[u8], options: &MeshOptions) -> Result<Raw, Fault> {
    let version = version(data, 0)?;
    let start = offset(data, version, options.shape_index)?;
    let version = self::version(data, start)?;
    let mut stream = Stream::new(data, start + 4);
    let flags = stream.u32("flags")?;
    if version == 4 {
        stream.skip_name()?;
    }
    // Old exporters set neither flag; Mitsuba takes that for single precision.
    let precision = if flags & DOUBLE != 0 {
        Precision::Double
    } else {
        Precision::Single
    };
    let vertices = stream.count("number of vertices")?;
    let triangles = stream.count("number of triangles")?;
    let decoded = decoded_bytes(flags, vertices, triangles);
    let what = format!("a mesh of {vertices} vertices and {triangles} triangles");
    options
        .decode
        .check(&what, decoded, data.len() as u64)
        .map_err(|why| stream.fault(why))?;
    stream.vertices(flags, precision, [vertices, triangles], options)
}

/// Bytes that a mesh of so many vertices and triangles takes in memory.
fn decoded_bytes(flags: u32, vertices: usize, triangles: usize) -> u64 {
    let normals = if flags & FACE_NORMALS == 0 { 12 } else { 0 };
    let uvs = if flags & HAS_TEXCOORDS != 0 { 8 } else { 0 };
    let colors = if flags & HAS_COLORS != 0 { 12 } else { 0 };
    let of_vertex = 12 + normals + uvs + colors;
    (vertices as u64)
        .saturating_mul(of_vertex)
        .saturating_add((triangles as u64).saturating_mul(12))
}

fn bytes<const N: usize>(data: &[u8], at: usize) -> Option<[u8; N]> {
    data.get(at..)?.first_chunk().copied()
}

/// Version of the mesh at byte `at`.
fn version(data: &[u8], at: usize) -> Result<u16, Fault> {
    let magic = bytes(data, at).map(u16::from_le_bytes);
    let version = bytes(data, at.saturating_add(2)).map(u16::from_le_bytes);
    match (magic, version) {
        (Some(MAGIC), Some(version @ 3..=4)) => Ok(version),
        (Some(MAGIC), Some(v)) => {
            let message = format!("version {v} of the format is not known (3 and 4 are)");
            Err(Fault::new(at, message))
        }
        (Some(other), Some(_)) => {
            let message = format!("not a serialized mesh: it starts with {other:#06x}, not 0x041c");
            Err(Fault::new(at, message))
        }
        _ => Err(Fault::new(at, "the file ends before the mesh's header")),
    }
}

/// Where mesh `index` starts.
fn offset(data: &[u8], version: u16, index: usize) -> Result<usize, Fault> {
    if index == 0 {
        return Ok(0);
    }
    let end = data.len().saturating_sub(4);
    let count = bytes(data, end).map_or(0, u32::from_le_bytes) as usize;
    let width = if version == 4 { 8 } else { 4 };
    let list = count.checked_mul(width).and_then(|n| end.checked_sub(n));
    let Some(list) = list else {
        let message = format!("the list of meshes ({count}) is longer than the file");
        return Err(Fault::new(end, message));
    };
    if index >= count {
        let message = format!("shape index {index} is out of range: the file has {count} meshes");
        return Err(Fault::new(end, message));
    }
    let at = list + index * width;
    let start = if version == 4 {
        bytes(data, at).map(u64::from_le_bytes)
    } else {
        bytes(data, at).map(|b| u64::from(u32::from_le_bytes(b)))
    };
    start
        .and_then(|s| usize::try_from(s).ok())
        .filter(|&s| s < list)
        .ok_or_else(|| Fault::new(at, format!("offset of mesh {index} is beyond the file")))
}

#[derive(Clone, Copy)]
enum Precision {
    Single,
    Double,
}

/// The inflated bytes of a mesh.
struct Stream<'a> {
    inflate: ZlibDecoder<&'a [u8]>,
    /// Byte of the file where the compressed part starts.
    start: usize,
    /// What remains of the file could not hold more bytes than this: deflate shrinks at most 1032
    /// times.
    at_most: u64,
}

impl<'a> Stream<'a> {
    fn new(data: &'a [u8], start: usize) -> Self {
        let compressed = data.get(start..).unwrap_or_default();
        Self {
            inflate: ZlibDecoder::new(compressed),
            start,
            at_most: compressed.len() as u64 * 1032 + 64,
        }
    }

    fn fault(&self, message: String) -> Fault {
        Fault::new(self.start + self.inflate.total_in() as usize, message)
    }

    fn fill(&mut self, into: &mut [u8], what: &str) -> Result<(), Fault> {
        self.inflate.read_exact(into).map_err(|e| {
            let why = if e.kind() == std::io::ErrorKind::UnexpectedEof {
                "the file ends".into()
            } else {
                e.to_string()
            };
            self.fault(format!("{what} cannot be read: {why}"))
        })
    }

    fn u32(&mut self, what: &str) -> Result<u32, Fault> {
        let mut bytes = [0; 4];
        self.fill(&mut bytes, what)?;
        Ok(u32::from_le_bytes(bytes))
    }

    fn count(&mut self, what: &str) -> Result<usize, Fault> {
        let mut bytes = [0; 8];
        self.fill(&mut bytes, what)?;
        let count = u64::from_le_bytes(bytes);
        // Each vertex and each triangle takes 12 bytes or more.
        if count >= u64::from(u32::MAX) || count * 12 > self.at_most {
            return Err(self.fault(format!(
                "the {what}, {count}, is more than the file can hold"
            )));
        }
        Ok(count as usize)
    }

    fn skip_name(&mut self) -> Result<(), Fault> {
        let mut byte = [0];
        for _ in 0..LONGEST_NAME {
            self.fill(&mut byte, "name")?;
            if byte[0] == 0 {
                return Ok(());
            }
        }
        Err(self.fault("the mesh's name does not end".into()))
    }

    /// The arrays, in the order of the file.
    fn vertices(
        &mut self,
        flags: u32,
        precision: Precision,
        [vertices, triangles]: [usize; 2],
        options: &MeshOptions,
    ) -> Result<Raw, Fault> {
        let mut raw = Raw {
            flat: flags & FACE_NORMALS != 0,
            ..Raw::default()
        };
        let position = |[x, y, z]: [f64; 3]| place(&options.to_world, x, y, z);
        raw.positions = self.array(vertices, precision, "positions", position)?;
        if flags & HAS_NORMALS != 0 {
            raw.normals = Some(self.array(vertices, precision, "normals", to_vec3)?);
        }
        if flags & HAS_TEXCOORDS != 0 {
            let flip = options.flip_tex_coords;
            let uv = |[u, v]: [f64; 2]| Vec2::new(u as f32, if flip { 1.0 - v } else { v } as f32);
            raw.uvs = Some(self.array(vertices, precision, "texture coordinates", uv)?);
        }
        if flags & HAS_COLORS != 0 {
            let color = |[r, g, b]: [f64; 3]| Rgb::new(r as f32, g as f32, b as f32);
            raw.attributes.push(MeshAttribute {
                name: "vertex_color".into(),
                per_face: false,
                values: self.array(vertices, precision, "colours", color)?,
            });
        }
        raw.triangles = self.triangles(triangles, vertices)?;
        Ok(raw)
    }

    /// `count` rows of `N` numbers.
    fn array<const N: usize, T>(
        &mut self,
        count: usize,
        precision: Precision,
        what: &str,
        make: impl Fn([f64; N]) -> T,
    ) -> Result<Vec<T>, Fault> {
        match precision {
            Precision::Single => self.rows::<4, N, T>(count, what, |row| {
                make(row.map(|b| f64::from(f32::from_le_bytes(b))))
            }),
            Precision::Double => {
                self.rows::<8, N, T>(count, what, |row| make(row.map(f64::from_le_bytes)))
            }
        }
    }

    /// `count` rows of `N` words of `WIDTH` bytes.
    fn rows<const WIDTH: usize, const N: usize, T>(
        &mut self,
        count: usize,
        what: &str,
        make: impl Fn([[u8; WIDTH]; N]) -> T,
    ) -> Result<Vec<T>, Fault> {
        let step = STEP / (WIDTH * N);
        let mut buffer = vec![0; step.min(count) * WIDTH * N];
        let mut values = Vec::new();
        while values.len() < count {
            let rows = step.min(count - values.len());
            let part = &mut buffer[..rows * WIDTH * N];
            self.fill(part, what)?;
            values.extend(part.chunks_exact(WIDTH * N).map(|row| {
                let mut words = [[0; WIDTH]; N];
                for (word, bytes) in words.iter_mut().zip(row.chunks_exact(WIDTH)) {
                    word.copy_from_slice(bytes);
                }
                make(words)
            }));
        }
        Ok(values)
    }

    fn triangles(&mut self, count: usize, vertices: usize) -> Result<Vec<[u32; 3]>, Fault> {
        let triangles: Vec<[u32; 3]> =
            self.rows::<4, 3, _>(count, "triangles", |row| row.map(u32::from_le_bytes))?;
        let beyond = |t: &[u32; 3]| t.iter().any(|&i| i as usize >= vertices);
        match triangles.iter().position(beyond) {
            None => Ok(triangles),
            Some(at) => {
                let t = triangles[at];
                let message =
                    format!("triangle {at} names vertices {t:?}, but the mesh has {vertices}");
                Err(self.fault(message))
            }
        }
    }
}

fn to_vec3([x, y, z]: [f64; 3]) -> Vec3 {
    Vec3::new(x as f32, y as f32, z as f32)
}
