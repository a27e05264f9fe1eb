//! Modes 1 and 2: indices of triangles, by the edges and vertices that they share with recent ones,
//! and plain sequences of indices.

use super::{EARLY, unzigzag};

/// A cursor over bytes.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn byte(&mut self) -> Result<u8, &'static str> {
        let (first, rest) = self.0.split_first().ok_or(EARLY)?;
        self.0 = rest;
        Ok(*first)
    }

    /// Seven bits a byte, the lowest first; the last byte has no high bit.
    fn number(&mut self) -> Result<u32, &'static str> {
        let mut value = 0;
        for shift in (0..35).step_by(7) {
            let byte = self.byte()?;
            value |= u32::from(byte & 127) << shift;
            if byte < 128 {
                return Ok(value);
            }
        }
        Err("is compressed, and holds a number of more than 32 bits")
    }
}

/// The last 16 of something; 0 is the most recent.
struct Recent<T> {
    list: [T; 16],
    next: usize,
}

impl<T: Copy> Recent<T> {
    fn new(value: T) -> Self {
        Self {
            list: [value; 16],
            next: 0,
        }
    }

    fn push(&mut self, value: T) {
        self.list[self.next] = value;
        self.next = (self.next + 1) % 16;
    }

    fn get(&self, back: u8) -> T {
        self.list[(self.next + 15 - usize::from(back)) % 16]
    }
}

/// What the codes of triangles refer to.
struct State<'a> {
    data: Reader<'a>,
    /// The smallest index not met yet.
    next: u32,
    /// The last index that was written out.
    last: u32,
    edges: Recent<(u32, u32)>,
    vertices: Recent<u32>,
}

/// `count` indices of a list of triangles.
pub(super) fn triangles(bytes: &[u8], count: usize) -> Result<Vec<u32>, String> {
    let Some((0xe1, body)) = bytes.split_first() else {
        return Err("is not compressed as triangles of version 1".into());
    };
    if count % 3 != 0 {
        return Err(format!("has {count} indices, which make no triangles"));
    }
    let (codes, rest) = body.split_at_checked(count / 3).ok_or(EARLY)?;
    let (data, table) = rest.split_last_chunk::<16>().ok_or(EARLY)?;
    let mut state = State {
        data: Reader(data),
        next: 0,
        last: 0,
        edges: Recent::new((0, 0)),
        vertices: Recent::new(0),
    };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        indices.extend(state.triangle(code, table)?);
    }
    Ok(indices)
}

impl State<'_> {
    fn triangle(&mut self, code: u8, table: &[u8; 16]) -> Result<[u32; 3], &'static str> {
        match (code >> 4, code & 15) {
            (15, row @ 0..=13) => self.apart(0, table[usize::from(row)]),
            (15, row) => {
                let pair = self.data.byte()?;
                if pair == 0 {
                    self.next = 0;
                }
                self.apart(if row == 14 { 0 } else { 15 }, pair)
            }
            (edge, third) => self.beside(edge, third),
        }
    }

    /// A triangle at a recent edge.
    fn beside(&mut self, edge: u8, third: u8) -> Result<[u32; 3], &'static str> {
        let (a, b) = self.edges.get(edge);
        let c = match third {
            0 => self.fresh(),
            1..=12 => self.vertices.get(third),
            13 => self.written(self.last.wrapping_sub(1)),
            14 => self.written(self.last.wrapping_add(1)),
            _ => self.explicit()?,
        };
        if !(1..=12).contains(&third) {
            self.vertices.push(c);
        }
        self.edges.push((c, b));
        self.edges.push((a, c));
        Ok([a, b, c])
    }

    /// A triangle at no recent edge: each corner is fresh (0), recent, or written out (15).
    fn apart(&mut self, first: u8, pair: u8) -> Result<[u32; 3], &'static str> {
        let kinds = [first, pair >> 4, pair & 15];
        let mut corners = [0; 3];
        // Fresh and recent ones come before those written out, which change neither.
        for (corner, &kind) in corners.iter_mut().zip(&kinds) {
            *corner = match kind {
                0 => self.fresh(),
                15 => self.explicit()?,
                recent => self.vertices.get(recent - 1),
            };
        }
        let [a, b, c] = corners;
        for (corner, kind) in corners.into_iter().zip(kinds) {
            if kind == 0 || kind == 15 {
                self.vertices.push(corner);
            }
        }
        self.edges.push((b, a));
        self.edges.push((c, b));
        self.edges.push((a, c));
        Ok(corners)
    }

    fn fresh(&mut self) -> u32 {
        let index = self.next;
        self.next = index.wrapping_add(1);
        index
    }

    fn written(&mut self, index: u32) -> u32 {
        self.last = index;
        index
    }

    fn explicit(&mut self) -> Result<u32, &'static str> {
        let delta = unzigzag(self.data.number()?);
        Ok(self.written(self.last.wrapping_add(delta)))
    }
}

/// `count` indices of any kind.
pub(super) fn sequence(bytes: &[u8], count: usize) -> Result<Vec<u32>, String> {
    let Some((0xd1, body)) = bytes.split_first() else {
        return Err("is not compressed as indices of version 1".into());
    };
    let data = body.len().checked_sub(4).ok_or(EARLY)?;
    let mut data = Reader(&body[..data]);
    let mut last = [0u32; 2];
    let mut indices = Vec::new();
    for _ in 0..count {
        let value = data.number()?;
        let base = &mut last[(value & 1) as usize];
        *base = base.wrapping_add(unzigzag(value >> 1));
        indices.push(*base);
    }
    Ok(indices)
}
