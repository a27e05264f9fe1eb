//! Files of named arrays: the format of the RGL's material database and of Mitsuba's `TensorFile`.
//!
//! All numbers are little-endian. The head is `tensor_file\0`, two bytes of a version (1, 0) and a
//! u32 count of arrays. Of each follow its name (a u16 of bytes, and these), a u16 count of
//! dimensions, a byte for the type, a u64 offset of its values from the file's beginning, and a u64
//! for each dimension, the one that changes slowest first.

/// How such files begin.
const MAGIC: &[u8] = b"tensor_file\0\x01\x00";
/// More dimensions than any array has that something is made of.
const MOST_DIMENSIONS: u16 = 8;

/// What the values of an array are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Bytes.
    U8,
    /// Single precision.
    F32,
    /// Something that nothing here reads, by its number.
    Other(u8),
}

/// An array.
#[derive(Clone, Debug)]
pub(super) struct Tensor<'a> {
    name: &'a str,
    kind: Kind,
    shape: Vec<usize>,
    bytes: &'a [u8],
}

/// A file that was taken apart.
#[derive(Debug)]
pub(super) struct TensorFile<'a>(Vec<Tensor<'a>>);

impl<'a> TensorFile<'a> {
    /// Finds the arrays. No value is copied, none may lie outside of the file.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, String> {
        let Some(rest) = bytes.strip_prefix(MAGIC) else {
            return Err("it is no tensor file, version 1.0, by its first bytes".into());
        };
        let mut head = Head { bytes, rest };
        let count = u32::from_le_bytes(head.array()?);
        let tensors = (0..count).map(|_| head.tensor());
        tensors.collect::<Result<_, _>>().map(Self)
    }

    /// Whether there is an array of that name.
    pub fn has(&self, name: &str) -> bool {
        self.0.iter().any(|t| t.name == name)
    }

    /// The array of that name, which must be of this type and of so many dimensions.
    fn find<const N: usize>(
        &self,
        name: &str,
        kind: Kind,
    ) -> Result<(&Tensor<'a>, [usize; N]), String> {
        let found = self.0.iter().find(|t| t.name == name);
        let found = found.ok_or_else(|| format!("it has no \"{name}\""))?;
        match <[usize; N]>::try_from(found.shape.as_slice()) {
            Ok(shape) if found.kind == kind => Ok((found, shape)),
            _ => Err(format!(
                "\"{name}\" has {} dimensions of {:?}, not {N} of {kind:?}",
                found.shape.len(),
                found.kind
            )),
        }
    }

    /// The numbers of an array of `N` dimensions, and how many there are along each.
    pub fn floats<const N: usize>(&self, name: &str) -> Result<([usize; N], Vec<f32>), String> {
        let (found, shape) = self.find(name, Kind::F32)?;
        let words = found.bytes.chunks_exact(size_of::<f32>());
        // Chunks of four bytes are arrays of four.
        let floats = words.map(|w| f32::from_le_bytes([w[0], w[1], w[2], w[3]]));
        Ok((shape, floats.collect()))
    }

    /// The bytes of a list.
    pub fn list_of_bytes(&self, name: &str) -> Result<&'a [u8], String> {
        Ok(self.find::<1>(name, Kind::U8)?.0.bytes)
    }
}

/// The part of the head that is still to be read.
struct Head<'a> {
    bytes: &'a [u8],
    rest: &'a [u8],
}

impl<'a> Head<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let Some((taken, rest)) = self.rest.split_at_checked(count) else {
            return Err(format!(
                "it ends within its head, at {} bytes",
                self.bytes.len()
            ));
        };
        self.rest = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    fn tensor(&mut self) -> Result<Tensor<'a>, String> {
        let length = u16::from_le_bytes(self.array()?);
        let name = std::str::from_utf8(self.take(length.into())?);
        let name = name.map_err(|_| "the name of an array is no text")?;
        let dimensions = u16::from_le_bytes(self.array()?);
        if dimensions > MOST_DIMENSIONS {
            return Err(format!("\"{name}\" has {dimensions} dimensions"));
        }
        let [kind] = self.array()?;
        let (kind, size) = match kind {
            1 => (Kind::U8, 1),
            10 => (Kind::F32, size_of::<f32>()),
            other => (Kind::Other(other), 0),
        };
        let offset = u64::from_le_bytes(self.array()?);
        let shape = (0..dimensions).map(|_| Ok(u64::from_le_bytes(self.array()?)));
        let shape = shape.collect::<Result<Vec<u64>, String>>()?;
        let bytes = self.values(offset, &shape, size);
        let bytes = bytes.ok_or_else(|| {
            let end = self.bytes.len();
            format!("the values of \"{name}\", {shape:?} from byte {offset}, lie beyond its end at {end}")
        })?;
        Ok(Tensor {
            name,
            kind,
            // Smaller than the file's size, or without values.
            shape: shape.into_iter().map(|n| n as usize).collect(),
            bytes,
        })
    }

    /// The bytes of an array of values of `size` bytes; `None` if the file has not so many.
    fn values(&self, offset: u64, shape: &[u64], size: usize) -> Option<&'a [u8]> {
        let product = |product: u64, n: &u64| product.checked_mul(*n);
        let length = shape.iter().try_fold(size as u64, product)?;
        let from = usize::try_from(offset).ok()?;
        let to = usize::try_from(offset.checked_add(length)?).ok()?;
        self.bytes.get(from..to)
    }
}
