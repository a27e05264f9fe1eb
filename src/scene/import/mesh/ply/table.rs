//! A binary element whose rows are all of one length: columns are copied out of it by all threads.

use super::header::{Element, Shape, Type};
use rayon::prelude::*;

/// Rows a thread takes at once.
const GRAIN: usize = 1 << 14;

/// Rows of equal length.
pub(super) struct Table<'a> {
    bytes: &'a [u8],
    stride: usize,
    big: bool,
    /// Byte of the row and type of each property; of the items for the one list.
    fields: Vec<(usize, Type)>,
}

impl<'a> Table<'a> {
    /// The rows of `element` at the start of `rest`, if all are of one length: it has no list but
    /// `list`, and all lists have three items.
    pub fn new(rest: &'a [u8], element: &Element, list: Option<usize>, big: bool) -> Option<Self> {
        let mut fields = Vec::new();
        let mut stride = 0;
        for (index, property) in element.properties.iter().enumerate() {
            match property.shape {
                Shape::Scalar(of) => {
                    fields.push((stride, of));
                    stride += of.size();
                }
                Shape::List { count, item } if list == Some(index) => {
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
        };
        let list = list.and_then(|l| element.properties.get(l).map(|p| (l, &p.shape)));
        if let Some((at, &Shape::List { count, .. })) = list {
            let length_at = table.fields[at].0 - count.size();
            let three = |row: &[u8]| count.read(&row[length_at..], big) == Some(3.0);
            if stride == 0 || !table.rows().all(three) {
                return None;
            }
        }
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

    /// The three items of the list `list` in each row. What is no index becomes `u32::MAX`.
    pub fn triangles(&self, list: usize) -> Vec<[u32; 3]> {
        let (at, of) = self.fields[list];
        let mut triangles = Vec::new();
        if matches!(of, Type::I32 | Type::U32) {
            let big = self.big;
            let read = |row: &[u8]| {
                [0, 4, 8].map(|item| {
                    let word = row[at + item..].first_chunk().copied().unwrap_or_default();
                    if big {
                        u32::from_be_bytes(word)
                    } else {
                        u32::from_le_bytes(word)
                    }
                })
            };
            self.rows().map(read).collect_into_vec(&mut triangles);
            return triangles;
        }
        let size = of.size();
        let read = |row: &[u8]| {
            [0, 1, 2].map(|i| {
                let value = of.read(&row[at + i * size..], self.big);
                value.and_then(super::to_index).unwrap_or(u32::MAX)
            })
        };
        self.rows().map(read).collect_into_vec(&mut triangles);
        triangles
    }
}
