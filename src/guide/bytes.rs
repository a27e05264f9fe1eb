//! Numbers as bytes and back, without ever reading past the end.

/// Appends little-endian numbers.
#[derive(Debug, Default)]
pub(crate) struct Writer(Vec<u8>);

impl Writer {
    pub fn u8(&mut self, v: u8) {
        self.0.push(v);
    }
    pub fn u32(&mut self, v: u32) {
        self.0.extend(v.to_le_bytes());
    }
    pub fn u64(&mut self, v: u64) {
        self.0.extend(v.to_le_bytes());
    }
    /// Bit by bit, whatever it is.
    pub fn f64(&mut self, v: f64) {
        self.u64(v.to_bits());
    }
    pub fn bytes(&mut self, v: &[u8]) {
        self.0.extend(v);
    }
    pub fn into_bytes(self) -> Vec<u8> {
        self.0
    }
    /// Seven bits a byte, the lowest first: most sums are small.
    pub fn varint(&mut self, mut v: u128) {
        while v >= 0x80 {
            self.0.push(v as u8 | 0x80);
            v >>= 7;
        }
        self.0.push(v as u8);
    }
}

/// Reads them back; `None` at the end.
#[derive(Debug)]
pub(crate) struct Reader<'a> {
    rest: &'a [u8],
    /// Size of the whole file.
    end: usize,
}

impl<'a> Reader<'a> {
    /// Reads `rest`, which ends where a file of `end` bytes does.
    pub fn new(rest: &'a [u8], end: usize) -> Self {
        Self { rest, end }
    }
    /// What was not read yet.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }
    /// The byte of the file that comes next.
    pub fn at(&self) -> usize {
        self.end - self.rest.len()
    }
    /// Bytes to come.
    pub fn left(&self) -> usize {
        self.rest.len()
    }
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, tail) = self.rest.split_first_chunk::<N>()?;
        self.rest = tail;
        Some(*head)
    }
    pub fn u8(&mut self) -> Option<u8> {
        self.take::<1>().map(|b| b[0])
    }
    pub fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }
    pub fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }
    pub fn f64(&mut self) -> Option<f64> {
        self.u64().map(f64::from_bits)
    }
    pub fn varint(&mut self) -> Option<u128> {
        let mut v = 0u128;
        for shift in (0..128).step_by(7) {
            let byte = self.u8()?;
            let bits = u128::from(byte & 0x7f);
            v |= bits << shift;
            if byte & 0x80 == 0 {
                // The last byte of a number of 19 has room for two bits only.
                return (v >> shift == bits).then_some(v);
            }
        }
        None
    }
    /// A varint of a smaller type.
    pub fn small<T: TryFrom<u128>>(&mut self) -> Option<T> {
        T::try_from(self.varint()?).ok()
    }
    /// A count of things of at least `size` bytes each, if the rest can hold them.
    pub fn count(&mut self, size: usize) -> Option<usize> {
        let n = self.small::<usize>()?;
        (n.checked_mul(size)? <= self.rest.len()).then_some(n)
    }
    pub fn bytes(&mut self, n: usize) -> Option<&'a [u8]> {
        let (head, tail) = self.rest.split_at_checked(n)?;
        self.rest = tail;
        Some(head)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn varints_come_back_and_too_long_ones_do_not() {
        let numbers = [
            0,
            1,
            127,
            128,
            300,
            u128::from(u64::MAX),
            u128::MAX >> 1,
            u128::MAX,
        ];
        let mut w = Writer::default();
        numbers.iter().for_each(|&n| w.varint(n));
        let bytes = w.into_bytes();
        let mut r = Reader::new(&bytes, bytes.len());
        for n in numbers {
            assert_eq!(r.varint(), Some(n));
        }
        assert_eq!((r.varint(), r.at()), (None, bytes.len()));
        // One bit too many, and no end.
        for last in [0x04, 0x80] {
            let mut long = [0x80; 19];
            long[18] = last;
            assert_eq!(Reader::new(&long, 19).varint(), None);
        }
        let mut r = Reader::new(&[0x80, 0x02], 2);
        assert_eq!(r.small::<u8>(), None, "256 is no u8");
    }

    #[test]
    fn counts_are_bounded_by_what_is_left() {
        assert_eq!(Reader::new(&[3, 0, 0, 0], 4).count(1), Some(3));
        assert_eq!(Reader::new(&[3, 0, 0, 0], 4).count(2), None);
    }
}
