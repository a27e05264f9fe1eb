//! A binary element whose rows are all of one length: columns are copied out of it by all threads.

use super::header::{Element, Shape, Type};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Rows a thread takes at once.
const GRAIN: usize = 1 << 14;

/// Rows of equal length.
pub(super) struct Table<'a> {
    bytes: &'a [u8],
    stride: usize,
    big: bool,
    /// Byte of the row and type of each property; of the items for the one list.
    fields: Vec<(usize, Type)>,
    /// Type of the number of items in the list.
    count: Option<Type>,
}

impl<'a> Table<'a> {
    /// The rows of `element` at the start of `rest`, if all may be of one length: it has no list
    /// but `list`, and there is room for three items in each. [`Table::triangles`] finds out
    /// whether each has.
    pub fn new(rest: &'a [u8], element: &Element, list: Option<usize>, big: bool) -> Option<Self> {
        let mut fields = Vec::new();
        let (mut stride, mut of_list) = (0, None);
        for (index, property) in element.properties.iter().enumerate() {
            match property.shape {
                Shape::Scalar(of) => {
                    fields.push((stride, of));
                    stride += of.size();
                }
                Shape::List { count, item } if list == Some(index) => {
                    of_list = Some(count);
                    fields.push((stride + count.size(), item));
                    stride += count.size() + 3 * item.size();
                }
                Shape::List { .. } => return None,
            }
        }
        let bytes = rest.get(..element.count.checked_mul(stride)?)?;
        let table = Self {
            bytes,
            stride,
            big,
            fields,
            count: of_list,
        };
        (stride > 0).then_some(table)
    }

    /// Bytes of all rows.
    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Byte at which row `row` starts.
    pub fn row_start(&self, row: usize) -> usize {
        row * self.stride
    }

    fn rows(&self) -> impl IndexedParallelIterator<Item = &'a [u8]> {
        self.bytes.par_chunks_exact(self.stride).with_min_len(GRAIN)
    }

    /// One value for each row, made of `N` of its properties. There is room for one more.
    pub fn column<const N: usize, T: Send>(
        &self,
        properties: [usize; N],
        make: impl Fn([f64; N]) -> T + Sync,
    ) -> Vec<T> {
        let fields = properties.map(|p| self.fields[p]);
        let mut column = Vec::with_capacity(self.bytes.len() / self.stride + 1);
        if !self.big && fields.iter().all(|f| f.1 == Type::F32) {
            let read = |row: &[u8]| {
                make(fields.map(|(at, _)| {
                    let word = row[at..].first_chunk().copied().unwrap_or_default();
                    f64::from(f32::from_le_bytes(word))
                }))
            };
            self.rows().map(read).collect_into_vec(&mut column);
        } else {
            let read = |row: &[u8]| {
                make(fields.map(|(at, of)| of.read(&row[at..], self.big).unwrap_or_default()))
            };
            self.rows().map(read).collect_into_vec(&mut column);
        }
        column
    }

    /// The three items of the list `list` in each row, and whether all are below `vertices`; what
    /// is no index counts as `u32::MAX`. Nothing if a list has another number of items.
    ///
    /// In one pass: a large mesh is in no cache, and looking at it again would take as long as
    /// this.
    pub fn triangles(&self, list: usize, vertices: usize) -> Option<(Vec<[u32; 3]>, bool)> {
        let (at, of) = *self.fields.get(list)?;
        let (count, big, size) = (self.count?, self.big, of.size());
        let length_at = at - count.size();
        let three = |row: &[u8]| match count {
            Type::U8 => row[length_at] == 3,
            _ => count.read(&row[length_at..], big) == Some(3.0),
        };
        let item = |row: &[u8], i: usize| {
            let value = of.read(&row[at + i * size..], big);
            value.and_then(super::to_index).unwrap_or(u32::MAX)
        };
        let word = |row: &[u8], i: usize| {
            let word = row[at + 4 * i..].first_chunk().copied().unwrap_or_default();
            if big {
                u32::from_be_bytes(word)
            } else {
                u32::from_le_bytes(word)
            }
        };
        if matches!(of, Type::I32 | Type::U32) {
            self.indices(vertices, three, word)
        } else {
            self.indices(vertices, three, item)
        }
    }

    /// Three indices of each row by `item`, if each row is `even`, and whether all are below
    /// `vertices`.
    fn indices(
        &self,
        vertices: usize,
        even: impl Fn(&[u8]) -> bool + Sync,
        item: impl Fn(&[u8], usize) -> u32 + Sync,
    ) -> Option<(Vec<[u32; 3]>, bool)> {
        // A file of other polygons shows it at once, before anything is copied.
        if !self.bytes.chunks_exact(self.stride).take(GRAIN).all(&even) {
            return None;
        }
        let (uneven, beyond) = (AtomicBool::new(false), AtomicBool::new(false));
        let read = |row: &[u8]| {
            let triangle = [0, 1, 2].map(|i| item(row, i));
            if !even(row) {
                uneven.store(true, Ordering::Relaxed);
            }
            if triangle.iter().any(|&i| i as usize >= vertices) {
                beyond.store(true, Ordering::Relaxed);
            }
            triangle
        };
        let mut triangles = Vec::new();
        self.rows().map(read).collect_into_vec(&mut triangles);
        (!uneven.into_inner()).then(|| (triangles, !beyond.into_inner()))
    }
}
