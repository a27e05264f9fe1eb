//! The records of the last batch, kept for refining (see [`super::again`]).

use super::links::ProductPosition;
use super::record::{Deposit, Origin};

/// Most records that are kept, some 70 bytes each. Of a larger batch the first ones have to speak
/// for all: constants lose nothing but the way a known sum is spread, mixtures all the others.
const MAX_RECORDS: usize = 1 << 22;

/// The records of the last batch.
#[derive(Clone, Debug)]
pub(crate) struct Recent {
    pub origin: Option<Origin>,
    /// Records of this origin before the batch.
    pub before: u64,
    pub deposits: Vec<Deposit>,
    pub places: Vec<ProductPosition>,
    pub vertices: Vec<Vertex>,
    /// How many are kept.
    pub most: usize,
}

/// Where a path vertex lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    pub key: u64,
    /// Leaf of R.
    pub leaf: u32,
}

impl Default for Recent {
    fn default() -> Self {
        Self::of(MAX_RECORDS)
    }
}

impl Recent {
    /// None yet, and never more than `most`.
    pub fn of(most: usize) -> Self {
        Self {
            origin: None,
            before: 0,
            deposits: Vec::new(),
            places: Vec::new(),
            vertices: Vec::new(),
            most: most.min(MAX_RECORDS),
        }
    }

    /// Forgets all and waits for a batch of this origin, which there were so many records of
    /// `before`; `count` of its records will be kept, if there is room.
    pub fn start(&mut self, origin: Origin, before: u64, count: usize) {
        *self = Self::of(self.most);
        self.origin = Some(origin);
        self.before = before;
        let count = count.min(self.most);
        self.deposits.reserve_exact(count);
        self.places.reserve_exact(count);
    }

    /// Keeps records and their places, as long as there is room.
    pub fn keep(&mut self, deposits: &[Deposit], places: &[ProductPosition]) {
        let room = self.most.saturating_sub(self.deposits.len());
        let kept = deposits.len().min(room);
        self.deposits.extend_from_slice(&deposits[..kept]);
        self.places.extend_from_slice(&places[..kept]);
    }

    /// Keeps path vertices, as long as there is room.
    pub fn keep_vertices(&mut self, vertices: &[(Vertex, u32)]) {
        let room = self.most.saturating_sub(self.vertices.len());
        self.vertices
            .extend(vertices.iter().take(room).map(|v| v.0));
    }
}
