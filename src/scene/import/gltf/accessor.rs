//! Accessors: arrays of numbers inside buffers, with strides, integer encodings and sparse
//! overrides.

use super::container::Container;
use super::error;
use super::schema::{Accessor, Sparse};
use crate::scene::import::ImportError;
use rayon::prelude::*;

/// Elements a thread takes at once.
const GRAIN: usize = 1 << 14;

/// Type of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    pub(super) fn of(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Numbers of `N` components at the start of `bytes`, which are long enough. Normalised
    /// integers stand for fractions of their largest value (glTF 2.0, 3.6.2.2).
    #[inline]
    fn read<const N: usize>(self, bytes: &[u8], normalized: bool) -> [f32; N] {
        let size = self.size();
        std::array::from_fn(|i| {
            let part = &bytes[i * size..];
            let two = || part.first_chunk::<2>().copied().unwrap_or_default();
            let four = || part.first_chunk::<4>().copied().unwrap_or_default();
            let (value, largest) = match self {
                Self::F32 => return f32::from_le_bytes(four()),
                Self::I8 => (f32::from(part[0] as i8), 127.0),
                Self::U8 => (f32::from(part[0]), 255.0),
                Self::I16 => (f32::from(i16::from_le_bytes(two())), 32767.0),
                Self::U16 => (f32::from(u16::from_le_bytes(two())), 65535.0),
                Self::U32 => (u32::from_le_bytes(four()) as f32, u32::MAX as f32),
            };
            if normalized {
                (value / largest).max(-1.0)
            } else {
                value
            }
        })
    }

    #[inline]
    fn read_index(self, bytes: &[u8]) -> u32 {
        match self {
            Self::U8 | Self::I8 => u32::from(bytes[0]),
            Self::U16 | Self::I16 => {
                u16::from_le_bytes(bytes.first_chunk().copied().unwrap_or_default()).into()
            }
            Self::U32 | Self::F32 => {
                u32::from_le_bytes(bytes.first_chunk().copied().unwrap_or_default())
            }
        }
    }
}

/// Components of an element, by the name of its type.
pub(super) fn components(kind: &str) -> Option<usize> {
    Some(match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => return None,
    })
}

/// Reads accessors of a file.
#[derive(Clone, Copy)]
pub(super) struct Accessors<'a> {
    pub container: &'a Container,
}

/// Elements at equal distances.
struct Rows<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
}

impl<'a> Rows<'a> {
    /// Element `i`, with whatever follows it.
    #[inline]
    fn row(&self, i: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..]
    }
}

impl<'a> Accessors<'a> {
    fn fail(&self, message: impl Into<String>) -> ImportError {
        error(&self.container.path, message)
    }

    fn get(&self, index: usize) -> Result<(&'a Accessor, Component, usize), ImportError> {
        let accessor = self.container.document.accessors.get(index);
        let accessor =
            accessor.ok_or_else(|| self.fail(format!("there is no accessor {index}")))?;
        let unpacked = self.container.unpacked.get(&index);
        let code = unpacked.map_or(accessor.component_type, |u| u.code);
        Component::of(code)
            .zip(components(&accessor.kind))
            .map(|(component, n)| (accessor, component, n))
            .ok_or_else(|| self.fail(format!("accessor {index} is of no known type")))
    }

    /// How many components its elements have.
    pub fn width(&self, index: usize) -> Result<usize, ImportError> {
        self.get(index).map(|(.., n)| n)
    }

    /// `count` elements of `size` bytes from `offset` in a view, checked to be there.
    fn rows(
        &self,
        view: usize,
        (offset, count, size): (usize, usize, usize),
        stride: Option<usize>,
    ) -> Result<Rows<'a>, ImportError> {
        let stride = stride.filter(|s| *s > 0).unwrap_or(size);
        let bytes = self.container.view(view)?.get(offset..).unwrap_or_default();
        let last = count.saturating_sub(1).checked_mul(stride);
        let needed = last.and_then(|at| at.checked_add(if count > 0 { size } else { 0 }));
        match needed {
            Some(needed) if needed <= bytes.len() => Ok(Rows {
                bytes,
                stride,
                count,
            }),
            _ => Err(self.fail(format!(
                "{count} elements are promised in buffer view {view}, which ends before"
            ))),
        }
    }

    /// The elements themselves, or `None` where they are all zero.
    fn base(
        &self,
        index: usize,
        accessor: &Accessor,
        size: usize,
    ) -> Result<Option<Rows<'a>>, ImportError> {
        if let Some(unpacked) = self.container.unpacked.get(&index) {
            let bytes = unpacked.bytes.as_slice();
            let (stride, count) = (size, bytes.len() / size.max(1));
            return Ok(Some(Rows {
                bytes,
                stride,
                count,
            }));
        }
        let Some(view) = accessor.buffer_view else {
            return Ok(None);
        };
        let views = &self.container.document.buffer_views;
        let stride = views.get(view).and_then(|v| v.byte_stride);
        let place = (accessor.byte_offset, accessor.count, size);
        self.rows(view, place, stride).map(Some)
    }

    /// Which elements a sparse accessor replaces, and by what.
    fn sparse(
        &self,
        sparse: &Sparse,
        size: usize,
        count: usize,
    ) -> Result<(Vec<usize>, Rows<'a>), ImportError> {
        let at = &sparse.indices;
        let kind = Component::of(at.component_type)
            .ok_or_else(|| self.fail("sparse indices are of no known type"))?;
        let place = (at.byte_offset, sparse.count, kind.size());
        let rows = self.rows(at.buffer_view, place, None)?;
        self.container.unpack(sparse.count, size_of::<usize>())?;
        let indices: Vec<usize> = (0..sparse.count)
            .map(|i| kind.read_index(rows.row(i)) as usize)
            .collect();
        if indices.iter().any(|&i| i >= count) {
            return Err(self.fail("a sparse accessor replaces an element beyond its end"));
        }
        let place = (sparse.values.byte_offset, sparse.count, size);
        let values = self.rows(sparse.values.buffer_view, place, None)?;
        Ok((indices, values))
    }

    /// The elements of accessor `index`, which must have `N` components.
    pub fn floats<const N: usize>(&self, index: usize) -> Result<Vec<[f32; N]>, ImportError> {
        let (accessor, component, width) = self.get(index)?;
        if width != N {
            let kind = &accessor.kind;
            return Err(self.fail(format!("accessor {index} is {kind}, not of {N} numbers")));
        }
        let size = N * component.size();
        let read = |row: &[u8]| component.read::<N>(row, accessor.normalized);
        let base = self.base(index, accessor, size)?;
        self.container
            .unpack(accessor.count, N * size_of::<f32>())?;
        let mut values = match base {
            None => vec![[0.0; N]; accessor.count],
            Some(rows) => (0..rows.count)
                .into_par_iter()
                .with_min_len(GRAIN)
                .map(|i| read(rows.row(i)))
                .collect(),
        };
        if let Some(sparse) = &accessor.sparse {
            let (indices, rows) = self.sparse(sparse, size, values.len())?;
            for (i, at) in indices.into_iter().enumerate() {
                values[at] = read(rows.row(i));
            }
        }
        Ok(values)
    }

    /// The whole numbers of accessor `index`.
    pub fn indices(&self, index: usize) -> Result<Vec<u32>, ImportError> {
        let (accessor, component, width) = self.get(index)?;
        if width != 1 || matches!(component, Component::F32) {
            return Err(self.fail(format!("accessor {index} is no list of indices")));
        }
        let base = self.base(index, accessor, component.size())?;
        self.container.unpack(accessor.count, size_of::<u32>())?;
        let mut values = match base {
            None => vec![0; accessor.count],
            Some(rows) => (0..rows.count)
                .into_par_iter()
                .with_min_len(GRAIN)
                .map(|i| component.read_index(rows.row(i)))
                .collect(),
        };
        if let Some(sparse) = &accessor.sparse {
            let (indices, rows) = self.sparse(sparse, component.size(), values.len())?;
            for (i, at) in indices.into_iter().enumerate() {
                values[at] = component.read_index(rows.row(i));
            }
        }
        Ok(values)
    }
}
