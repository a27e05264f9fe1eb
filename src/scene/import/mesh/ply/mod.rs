//! Stanford PLY: ASCII, and binary of both byte orders.
//!
//! [`header`] says which tables follow. A binary table whose rows are all equally long (vertices of
//! plain numbers, faces that are all triangles) is copied column by column by all threads
//! ([`table`]); everything else is walked row by row ([`walk`]). [`columns`] knows what the names
//! mean.
//!
//! An own reader, because the crates for PLY build a map from names to values for every row:
//! minutes and many times the file's memory at the tens of millions of triangles that this one
//! reads at the speed of the disk.

mod columns;
mod corners;
mod header;
mod table;
#[cfg(test)]
mod tests;
mod walk;

use super::{Fault, MeshOptions, Raw, place, polygon};
use crate::math::{Rgb, Vec2, Vec3};
use crate::scene::import::ImportError;
use crate::texture::MeshAttribute;
use columns::{Attribute, Columns};
use header::{Element, Encoding, Header, Shape};
use std::path::Path;
use table::Table;
use walk::{Row, Source};

const LIST_NAMES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads a PLY file.
pub(super) fn read(data: &[u8], options: &MeshOptions, path: &Path) -> Result<Raw, ImportError> {
    let header = header::parse(data).map_err(|e| e.in_text(data, path))?;
    let mut reader = Reader::new(data, &header, options).map_err(|e| e.in_text(data, path))?;
    let result = reader.elements(&header.elements);
    result.map_err(|e| match header.encoding {
        Encoding::Ascii => e.in_text(data, path),
        Encoding::Little | Encoding::Big => e.in_binary(path),
    })?;
    let mut raw = reader.into_raw();
    raw.images = header.images;
    Ok(raw)
}

/// A whole number in the range of indices.
#[inline]
fn to_index(value: f64) -> Option<u32> {
    (value >= 0.0 && value < f64::from(u32::MAX) && value.fract() == 0.0).then_some(value as u32)
}

struct Reader<'a> {
    data: &'a [u8],
    pos: usize,
    encoding: Encoding,
    options: &'a MeshOptions,
    vertices: usize,
    raw: Raw,
    /// Faces that are not all triangles.
    indices: Vec<u32>,
    sizes: Vec<u32>,
    /// Texture coordinates of the faces' corners, as many as `indices`, where vertices have none.
    corners: Vec<Vec2>,
}

impl<'a> Reader<'a> {
    fn new(data: &'a [u8], header: &Header, options: &'a MeshOptions) -> Result<Self, Fault> {
        let vertex = header.elements.iter().find(|e| e.name == "vertex");
        let vertex = vertex.ok_or_else(|| Fault::new(0, "the file has no element `vertex`"))?;
        Ok(Self {
            data,
            pos: header.end,
            encoding: header.encoding,
            options,
            vertices: vertex.count,
            raw: Raw::default(),
            indices: Vec::new(),
            sizes: Vec::new(),
            corners: Vec::new(),
        })
    }

    fn elements(&mut self, elements: &[Element]) -> Result<(), Fault> {
        for element in elements {
            self.check_room(element)?;
            match element.name.as_str() {
                "vertex" => self.vertices(element)?,
                "face" => self.faces(element)?,
                "tristrips" => self.strips(element)?,
                _ => self.skip(element)?,
            }
        }
        Ok(())
    }

    /// Nothing is allocated for rows that the file cannot hold.
    fn check_room(&self, element: &Element) -> Result<(), Fault> {
        let row = element.smallest_row(self.encoding);
        let room = self.data.len().saturating_sub(self.pos) + 1;
        if element.count.checked_mul(row).is_some_and(|n| n <= room) {
            return Ok(());
        }
        let message = format!(
            "{} rows of `{}` are promised, but the file ends before",
            element.count,
            element.name.escape_debug()
        );
        Err(Fault::new(self.data.len(), message))
    }

    fn table(&self, element: &Element, list: Option<usize>) -> Option<Table<'a>> {
        let big = match self.encoding {
            Encoding::Ascii => return None,
            Encoding::Little => false,
            Encoding::Big => true,
        };
        Table::new(self.data.get(self.pos..)?, element, list, big)
    }

    fn walk(
        &mut self,
        element: &Element,
        lists: [Option<usize>; 2],
        mut sink: impl FnMut(&mut Self, Row) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let mut source = Source::new(self.data, self.pos, self.encoding);
        walk::rows(&mut source, element, lists, |row| sink(self, row))?;
        self.pos = source.offset();
        Ok(())
    }

    fn skip(&mut self, element: &Element) -> Result<(), Fault> {
        if let Some(table) = self.table(element, None) {
            self.pos += table.len();
            return Ok(());
        }
        self.walk(element, [None; 2], |_, _| Ok(()))
    }

    fn vertices(&mut self, element: &Element) -> Result<(), Fault> {
        let columns = Columns::of(element, "vertex_");
        let Some(position) = columns.position else {
            let message = "the vertices have no properties `x`, `y` and `z`";
            return Err(Fault::new(element.offset, message));
        };
        self.raw
            .attributes
            .extend(columns.attributes.iter().map(|a| empty(a, false)));
        let options = self.options;
        let point = |[x, y, z]: [f64; 3]| place(&options.to_world, x, y, z);
        let uv = |[u, v]: [f64; 2]| {
            let v = if options.flip_tex_coords { 1.0 - v } else { v };
            Vec2::new(u as f32, v as f32)
        };
        if let Some(table) = self.table(element, None) {
            self.raw.positions = table.column(position, point);
            self.raw.normals = columns.normal.map(|n| table.column(n, vec3));
            self.raw.uvs = columns.uv.map(|c| table.column(c, uv));
            fill(&mut self.raw.attributes, &columns.attributes, &table, false);
            self.pos += table.len();
            return Ok(());
        }
        let (mut normals, mut uvs) = (Vec::new(), Vec::new());
        self.walk(element, [None; 2], |reader, row| {
            let raw = &mut reader.raw;
            raw.positions.push(point(position.map(|p| row.values[p])));
            normals.extend(columns.normal.map(|n| vec3(n.map(|p| row.values[p]))));
            uvs.extend(columns.uv.map(|c| uv(c.map(|p| row.values[p]))));
            push(&mut raw.attributes, &columns.attributes, row.values, false);
            Ok(())
        })?;
        self.raw.normals = columns.normal.map(|_| normals);
        self.raw.uvs = columns.uv.map(|_| uvs);
        Ok(())
    }

    /// The property that lists a face's vertices.
    fn index_list(element: &Element) -> Result<usize, Fault> {
        let list = element.find(&LIST_NAMES);
        let is_list = |l: &usize| matches!(element.properties[*l].shape, Shape::List { .. });
        list.filter(is_list).ok_or_else(|| {
            let name = element.name.escape_debug();
            let message = format!("`{name}` has no list `vertex_indices` or `vertex_index`");
            Fault::new(element.offset, message)
        })
    }

    fn faces(&mut self, element: &Element) -> Result<(), Fault> {
        let list = Self::index_list(element)?;
        let is_list = |l: &usize| matches!(element.properties[*l].shape, Shape::List { .. });
        let corners = element.find(&["texcoord"]).filter(is_list);
        let corners = corners.filter(|_| self.raw.uvs.is_none());
        let columns = Columns::of(element, "face_").attributes;
        self.raw
            .attributes
            .extend(columns.iter().map(|a| empty(a, true)));
        let table = match corners {
            None => self.table(element, Some(list)),
            Some(_) => None,
        };
        let triangles = table
            .as_ref()
            .and_then(|t| t.triangles(list, self.vertices));
        if let (Some(table), Some((triangles, inside))) = (table, triangles) {
            if !inside {
                return Err(self.beyond(&table, &triangles));
            }
            self.raw.triangles = triangles;
            fill(&mut self.raw.attributes, &columns, &table, true);
            self.pos += table.len();
            return Ok(());
        }
        self.walk(element, [Some(list), corners], |reader, row| {
            reader.polygon(&row)?;
            if corners.is_some() {
                reader.lay(&row);
            }
            push(&mut reader.raw.attributes, &columns, row.values, true);
            Ok(())
        })
    }

    /// The error about the first triangle that names a vertex that is not there.
    fn beyond(&self, table: &Table, triangles: &[[u32; 3]]) -> Fault {
        let vertices = self.vertices;
        let beyond = |t: &[u32; 3]| t.iter().any(|&i| i as usize >= vertices);
        let at = triangles.iter().position(beyond).unwrap_or_default();
        let names = triangles[at];
        let message = format!("face {at} names vertices {names:?}, but the file has {vertices}");
        Fault::new(self.pos + table.row_start(at), message)
    }

    fn polygon(&mut self, row: &Row) -> Result<(), Fault> {
        for &value in row.list {
            self.indices.push(self.index(value, row.offset)?);
        }
        self.sizes.push(row.list.len() as u32);
        Ok(())
    }

    /// Notes the texture coordinates of a face's corners; (0, 0) where there are too few.
    fn lay(&mut self, row: &Row) {
        let part = |i: usize| row.corners.get(i).map_or(0.0, |v| *v as f32);
        let flip = self.options.flip_tex_coords;
        self.corners.extend((0..row.list.len()).map(|i| {
            let (u, v) = (part(2 * i), part(2 * i + 1));
            Vec2::new(u, if flip { 1.0 - v } else { v })
        }));
    }

    fn index(&self, value: f64, offset: usize) -> Result<u32, Fault> {
        let index = to_index(value).filter(|&i| (i as usize) < self.vertices);
        index.ok_or_else(|| {
            let message = format!(
                "a face names vertex {value}, but the file has {}",
                self.vertices
            );
            Fault::new(offset, message)
        })
    }

    /// Strips of triangles, as old scans have them: -1 starts a new strip, every other triangle
    /// turns.
    fn strips(&mut self, element: &Element) -> Result<(), Fault> {
        let list = Self::index_list(element)?;
        self.walk(element, [Some(list), None], |reader, row| {
            for strip in row.list.split(|&i| i == -1.0) {
                for (n, corners) in strip.windows(3).enumerate() {
                    let mut triangle = [0; 3];
                    for (index, &value) in triangle.iter_mut().zip(corners) {
                        *index = reader.index(value, row.offset)?;
                    }
                    triangle.rotate_left(n % 2);
                    triangle[1..].rotate_left(n % 2);
                    reader.indices.extend(triangle);
                    reader.sizes.push(3);
                }
            }
            Ok(())
        })
    }

    fn into_raw(mut self) -> Raw {
        if self.corners.iter().any(|uv| *uv != Vec2::ZERO) {
            // Strips have no coordinates of corners.
            self.corners.resize(self.indices.len(), Vec2::ZERO);
            corners::divide(&mut self.raw, &mut self.indices, &self.corners);
        }
        if !self.sizes.is_empty() {
            let raw = &mut self.raw;
            let (indices, sizes) = (&self.indices, &self.sizes);
            let cut = polygon::triangles(&raw.positions, indices, sizes, &mut raw.attributes);
            raw.triangles.extend(cut.triangles);
            raw.warnings.extend(cut.warning);
        }
        // A file with both faces and strips has values for the faces alone.
        let (vertices, triangles) = (self.raw.positions.len(), self.raw.triangles.len());
        self.raw
            .attributes
            .retain(|a| a.values.len() == if a.per_face { triangles } else { vertices });
        self.raw
    }
}

fn vec3([x, y, z]: [f64; 3]) -> Vec3 {
    Vec3::new(x as f32, y as f32, z as f32)
}

fn empty(attribute: &Attribute, per_face: bool) -> MeshAttribute {
    MeshAttribute {
        name: attribute.name.clone(),
        per_face,
        values: Vec::new(),
    }
}

/// Fills the attributes of vertices or faces from the columns of a table.
fn fill(into: &mut [MeshAttribute], columns: &[Attribute], table: &Table, per_face: bool) {
    let into = into.iter_mut().filter(|a| a.per_face == per_face);
    for (attribute, column) in into.zip(columns) {
        attribute.values = table.column(column.parts, |v| vec3(v) * column.scale);
    }
}

/// Appends the values of a row to the attributes of vertices or faces.
fn push(into: &mut [MeshAttribute], columns: &[Attribute], row: &[f64], per_face: bool) {
    let into = into.iter_mut().filter(|a| a.per_face == per_face);
    for (attribute, column) in into.zip(columns) {
        let value: Rgb = vec3(column.parts.map(|p| row[p])) * column.scale;
        attribute.values.push(value);
    }
}
