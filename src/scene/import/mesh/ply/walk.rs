//! Any element, row by row: ASCII files, and binary ones whose rows differ in length.

use super::header::{Element, Encoding, Shape, Type};
use crate::scene::import::mesh::{Fault, text::Cursor};

/// Where values come from.
pub(super) enum Source<'a> {
    Text(Cursor<'a>),
    Binary {
        data: &'a [u8],
        pos: usize,
        big: bool,
    },
}

impl<'a> Source<'a> {
    pub fn new(data: &'a [u8], pos: usize, encoding: Encoding) -> Self {
        match encoding {
            Encoding::Ascii => Self::Text(Cursor::new(data, pos)),
            Encoding::Little | Encoding::Big => Self::Binary {
                data,
                pos,
                big: encoding == Encoding::Big,
            },
        }
    }

    pub fn offset(&self) -> usize {
        match self {
            Self::Text(cursor) => cursor.offset(),
            Self::Binary { pos, .. } => *pos,
        }
    }

    /// The next value.
    #[inline]
    fn value(&mut self, of: Type) -> Result<f64, Fault> {
        match self {
            Self::Text(cursor) => {
                cursor.skip_white();
                if cursor.at_end() {
                    return Err(Fault::new(cursor.offset(), "the file ends too early"));
                }
                cursor.number()
            }
            Self::Binary { data, pos, big } => {
                let rest = data.get(*pos..).unwrap_or_default();
                let value = of.read(rest, *big);
                let value = value.ok_or_else(|| Fault::new(*pos, "the file ends too early"))?;
                *pos += of.size();
                Ok(value)
            }
        }
    }

    fn list_length(&mut self, count: Type) -> Result<usize, Fault> {
        let at = self.offset();
        let length = self.value(count)?;
        if length >= 0.0 && length.fract() == 0.0 && length <= f64::from(u32::MAX) {
            return Ok(length as usize);
        }
        let message = format!("a list cannot have {length} items");
        Err(Fault::new(at, message))
    }
}

/// A row: its single values (zero for lists), the items of the wanted lists, and where it stands.
pub(super) struct Row<'a> {
    pub values: &'a [f64],
    pub list: &'a [f64],
    /// Texture coordinates of a face's corners.
    pub corners: &'a [f64],
    pub offset: usize,
}

/// Calls `sink` with each row of `element`; `list` and `corners` are the list properties to keep.
pub(super) fn rows(
    source: &mut Source,
    element: &Element,
    [list, corners]: [Option<usize>; 2],
    mut sink: impl FnMut(Row) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let mut values = vec![0.0; element.properties.len()];
    let (mut items, mut of_corners) = (Vec::new(), Vec::new());
    if values.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        let offset = source.offset();
        items.clear();
        of_corners.clear();
        for (index, property) in element.properties.iter().enumerate() {
            match property.shape {
                Shape::Scalar(of) => values[index] = source.value(of)?,
                Shape::List { count, item } => {
                    for _ in 0..source.list_length(count)? {
                        let value = source.value(item)?;
                        if list == Some(index) {
                            items.push(value);
                        } else if corners == Some(index) {
                            of_corners.push(value);
                        }
                    }
                }
            }
        }
        sink(Row {
            values: &values,
            list: &items,
            corners: &of_corners,
            offset,
        })?;
    }
    Ok(())
}
