//! The head of a PLY file: which elements follow, and of which properties each consists.

use super::super::{Fault, text::Cursor};
use crate::scene::import::encoding;
use rustc_hash::FxHashSet;

/// A number's type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// How the body is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Little,
    Big,
}

/// One value of an element, or a list of values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    Scalar(Type),
    List { count: Type, item: Type },
}

/// A named value or list.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub name: String,
    pub shape: Shape,
}

/// A table of the file.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
    /// Byte of the header where it stands.
    pub offset: usize,
}

/// The head of the file.
#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Images that comments name.
    pub images: Vec<String>,
    /// First byte after it.
    pub end: usize,
}

impl Type {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"long" | b"int64" => Self::I64,
            b"ulong" | b"uint64" => Self::U64,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of a value.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The value at the start of `bytes`, if they are enough.
    #[inline]
    pub fn read(self, bytes: &[u8], big: bool) -> Option<f64> {
        #[inline]
        fn take<const N: usize>(bytes: &[u8], big: bool) -> Option<[u8; N]> {
            let mut word = *bytes.first_chunk::<N>()?;
            if big {
                word.reverse();
            }
            Some(word)
        }
        Some(match self {
            Self::I8 => f64::from(i8::from_le_bytes(take(bytes, big)?)),
            Self::U8 => f64::from(u8::from_le_bytes(take(bytes, big)?)),
            Self::I16 => f64::from(i16::from_le_bytes(take(bytes, big)?)),
            Self::U16 => f64::from(u16::from_le_bytes(take(bytes, big)?)),
            Self::I32 => f64::from(i32::from_le_bytes(take(bytes, big)?)),
            Self::U32 => f64::from(u32::from_le_bytes(take(bytes, big)?)),
            Self::I64 => i64::from_le_bytes(take(bytes, big)?) as f64,
            Self::U64 => u64::from_le_bytes(take(bytes, big)?) as f64,
            Self::F32 => f64::from(f32::from_le_bytes(take(bytes, big)?)),
            Self::F64 => f64::from_le_bytes(take(bytes, big)?),
        })
    }

    /// What a colour of this type is divided by: whole numbers fill their range.
    pub fn full_scale(self) -> f32 {
        match self {
            Self::U8 => 255.0,
            Self::U16 => 65535.0,
            _ => 1.0,
        }
    }
}

impl Element {
    /// Bytes that a row takes at least.
    pub fn smallest_row(&self, encoding: Encoding) -> usize {
        let size = |p: &Property| match (encoding, &p.shape) {
            // A digit and a blank.
            (Encoding::Ascii, _) => 2,
            (_, Shape::Scalar(t)) => t.size(),
            (_, Shape::List { count, .. }) => count.size(),
        };
        self.properties.iter().map(size).sum()
    }

    /// The property with one of these names.
    pub fn find(&self, names: &[&str]) -> Option<usize> {
        self.properties
            .iter()
            .position(|p| names.contains(&p.name.as_str()))
    }
}

/// Reads the header.
pub(super) fn parse(data: &[u8]) -> Result<Header, Fault> {
    let mut cursor = Cursor::new(data, encoding::start(data));
    if cursor.word() != b"ply" {
        return Err(Fault::new(0, "not a PLY file: its first word is not `ply`"));
    }
    let newline = newline(&cursor);
    end_line(&mut cursor, newline);
    let (mut encoding, mut images) = (None, Vec::new());
    let mut elements: Vec<Element> = Vec::new();
    let mut names = FxHashSet::default();
    loop {
        if cursor.at_end() {
            return Err(Fault::new(data.len(), "the header has no `end_header`"));
        }
        let offset = cursor.offset();
        match word(&mut cursor) {
            b"format" => encoding = Some(format(&mut cursor)?),
            b"element" => {
                let element = element(&mut cursor, offset)?;
                if !names.insert(element.name.clone()) {
                    let message = format!("element `{}` stands twice", element.name.escape_debug());
                    return Err(Fault::new(offset, message));
                }
                elements.push(element);
            }
            b"property" => {
                let property = property(&mut cursor)?;
                let element = elements.last_mut();
                let message = "a property stands before the first element";
                let element = element.ok_or_else(|| Fault::new(offset, message))?;
                element.properties.push(property);
            }
            b"end_header" => break,
            b"comment" => images.extend(image(&mut cursor)),
            b"obj_info" | b"" => {}
            other => {
                let shown = String::from_utf8_lossy(&other[..other.len().min(40)]);
                let message = format!("`{}` is not a word of a PLY header", shown.escape_debug());
                return Err(Fault::new(offset, message));
            }
        }
        end_line(&mut cursor, newline);
    }
    end_line(&mut cursor, newline);
    let encoding = encoding.ok_or_else(|| Fault::new(0, "the header has no `format`"))?;
    Ok(Header {
        encoding,
        elements,
        images,
        end: cursor.offset(),
    })
}

/// The image that a comment of MeshLab's kind names: `comment TextureFile NAME`.
fn image(cursor: &mut Cursor) -> Option<String> {
    let is_image = word(cursor).eq_ignore_ascii_case(b"texturefile");
    cursor.skip_blanks();
    let line = cursor.line();
    let name = line.trim_ascii_end();
    (is_image && !name.is_empty()).then(|| String::from_utf8_lossy(name).into_owned())
}

fn word<'a>(cursor: &mut Cursor<'a>) -> &'a [u8] {
    cursor.skip_blanks();
    cursor.word()
}

/// How the first line ends: old Macintosh files have a carriage return alone.
fn newline(cursor: &Cursor) -> u8 {
    let mut ahead = cursor.clone();
    while ahead.peek().is_some_and(|b| b != b'\r' && b != b'\n') {
        ahead.step();
    }
    let first = ahead.peek();
    ahead.step();
    match (first, ahead.peek()) {
        (Some(b'\r'), next) if next != Some(b'\n') => b'\r',
        _ => b'\n',
    }
}

/// To the byte after the line end. A backslash continues nothing here.
fn end_line(cursor: &mut Cursor, newline: u8) {
    while cursor.peek().is_some_and(|b| b != newline) {
        cursor.step();
    }
    if !cursor.at_end() {
        cursor.step();
    }
}

fn format(cursor: &mut Cursor) -> Result<Encoding, Fault> {
    let offset = cursor.offset();
    match word(cursor) {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::Little),
        b"binary_big_endian" => Ok(Encoding::Big),
        _ => {
            let message =
                "the format is none of `ascii`, `binary_little_endian`, `binary_big_endian`";
            Err(Fault::new(offset, message))
        }
    }
}

fn name(cursor: &mut Cursor, of: &str) -> Result<String, Fault> {
    let offset = cursor.offset();
    let name = word(cursor);
    if name.is_empty() {
        return Err(Fault::new(offset, format!("the {of} has no name")));
    }
    Ok(String::from_utf8_lossy(name).into_owned())
}

fn element(cursor: &mut Cursor, offset: usize) -> Result<Element, Fault> {
    let name = name(cursor, "element")?;
    cursor.skip_blanks();
    let at = cursor.offset();
    let wrong = |message: &str| Fault::new(at, message.to_owned());
    let shown = String::from_utf8_lossy(cursor.clone().word()).into_owned();
    let count = cursor.integer()?;
    if !cursor.at_word_end() {
        let shown = shown.escape_debug();
        return Err(wrong(&format!(
            "the number of rows is `{shown}`, and a whole number was expected"
        )));
    }
    let count = usize::try_from(count).map_err(|_| wrong("the number of rows is negative"))?;
    Ok(Element {
        name,
        count,
        properties: Vec::new(),
        offset,
    })
}

fn value_type(cursor: &mut Cursor) -> Result<Type, Fault> {
    let offset = cursor.offset();
    let word = word(cursor);
    Type::from_name(word).ok_or_else(|| {
        let shown = String::from_utf8_lossy(&word[..word.len().min(40)]);
        Fault::new(offset, format!("`{}` is not a type", shown.escape_debug()))
    })
}

fn property(cursor: &mut Cursor) -> Result<Property, Fault> {
    let mut ahead = cursor.clone();
    let shape = if word(&mut ahead) == b"list" {
        *cursor = ahead;
        let count = value_type(cursor)?;
        let item = value_type(cursor)?;
        Shape::List { count, item }
    } else {
        Shape::Scalar(value_type(cursor)?)
    };
    let name = name(cursor, "property")?;
    Ok(Property { name, shape })
}
