//! *Train*: records are checked and added to their links, in pieces on all threads.
//!
//! A batch may be larger than the trees that learn from it, and on some machines memory that is
//! touched for the first time costs as much as what is done with it. So batches are read where they
//! lie, in as many parts as they were made in, and a piece at a time is turned into deposits.

use super::links::ProductPosition;
use super::model::Look;
use super::quantise::{Dropped, Intake, batch_unit};
use super::recent::Vertex;
use super::record::{Deposit, Origin, PathSample, Photon};
use super::space::Space;
use super::train::Trainer;
use crate::math::Rgb;
use crate::math::sum::SumUnit;
use rayon::prelude::*;

/// Records that one task checks.
const PIECE: usize = 1 << 13;
/// Pieces taken at a time: bounds the scratch memory, changes no result.
const PIECES: usize = 16;

/// A piece of a batch.
#[derive(Default)]
struct Checked {
    deposits: Vec<Deposit>,
    non_finite: u64,
    bad_direction: u64,
    /// Where the vertices lie: leaf of R and octant in it.
    vertices: Vec<(Vertex, u32)>,
}

impl Checked {
    fn photons(photons: &[Photon], intake: &Intake) -> Self {
        let mut checked = Self::default();
        checked.deposits.reserve(photons.len());
        for photon in photons {
            checked.add(intake.photon(photon));
        }
        checked
    }

    /// Vertices count even where it was dark: they are the denominator.
    fn paths(samples: &[PathSample], intake: &Intake, space: &Space) -> Self {
        let mut checked = Self::default();
        checked.deposits.reserve(samples.len());
        checked.vertices.reserve(samples.len());
        for sample in samples {
            let record = intake.path(sample);
            let key = match &record {
                Ok(deposit) => Some(deposit.key),
                Err(Dropped::Dark) => Some(intake.grid.key(sample.position, sample.normal)),
                Err(_) => None,
            };
            checked.vertices.extend(key.map(|key| {
                let (leaf, octant) = space.leaf_below(0, key);
                (Vertex { key, leaf }, octant)
            }));
            checked.add(record);
        }
        checked
    }

    fn add(&mut self, record: Result<Deposit, Dropped>) {
        match record {
            Ok(deposit) => self.deposits.push(deposit),
            Err(Dropped::NonFinite) => self.non_finite += 1,
            Err(Dropped::BadDirection) => self.bad_direction += 1,
            Err(Dropped::Dark) => {}
        }
    }
}

/// The next parts of a batch, as many as are taken at a time; `None` at its end.
fn next_pieces<R, T: AsRef<[R]>>(parts: &mut impl Iterator<Item = T>) -> Option<Vec<T>> {
    let (mut some, mut count) = (Vec::new(), 0);
    while count < PIECES * PIECE {
        let Some(part) = parts.next() else { break };
        count += part.as_ref().len();
        some.push(part);
    }
    (!some.is_empty()).then_some(some)
}

/// Parts cut into pieces.
fn in_pieces<R, T: AsRef<[R]>>(parts: &[T]) -> Vec<&[R]> {
    let cut = |part| <T as AsRef<[R]>>::as_ref(part).chunks(PIECE);
    parts.iter().flat_map(cut).collect()
}

impl Trainer {
    /// *Train* on photons. `emitted` is how many photons the lights sent out to yield this batch.
    /// The result does not depend on threads, nor on how photons are cut into batches between two
    /// refinements.
    pub fn train(&mut self, photons: &[Photon], emitted: u64) {
        self.train_on_photons(vec![photons], emitted);
    }

    /// The same for a batch that lies in several places, each of which is let go of once it is
    /// learned from; nothing depends on where it is cut.
    pub fn train_on_photons(&mut self, parts: Vec<impl AsRef<[Photon]> + Sync>, emitted: u64) {
        self.intakes.batches += 1;
        self.intakes.emitted = self.intakes.emitted.saturating_add(emitted);
        let all = || parts.iter().flat_map(AsRef::as_ref);
        if self.photon_unit.is_none() {
            self.photon_unit = batch_unit(all().map(|p| p.power));
        }
        let Some(unit) = self.photon_unit else {
            return;
        };
        let count = parts.iter().map(|p| p.as_ref().len()).sum();
        self.recent
            .start(Origin::Photon, self.intakes.photons, count);
        let mut parts = parts.into_iter();
        while let Some(parts) = next_pieces(&mut parts) {
            for pieces in in_pieces(&parts).chunks(PIECES) {
                let intake = self.intake(unit);
                let check = |piece: &&[Photon]| Checked::photons(piece, &intake);
                let pieces: Vec<_> = pieces.par_iter().map(check).collect();
                self.intakes.photons += self.deposit(&pieces, unit, Origin::Photon);
            }
        }
    }

    /// *Train* on camera paths: every sampled direction of every vertex, dark ones included. A
    /// batch may lie in several places, each of which is let go of once it is learned from; nothing
    /// depends on where it is cut.
    pub fn train_paths(&mut self, parts: Vec<impl AsRef<[PathSample]> + Sync>) {
        self.intakes.batches += 1;
        let all = || parts.iter().flat_map(AsRef::as_ref);
        if self.path_unit.is_none() {
            self.path_unit = batch_unit(all().map(|s| s.radiance));
        }
        // Vertices count even while everything is dark.
        let unit = self.path_unit.unwrap_or(SumUnit::from_exponent(0));
        let lit = all().filter(|s| s.radiance != Rgb::ZERO).count();
        self.recent.start(Origin::Path, self.intakes.paths, lit);
        let mut parts = parts.into_iter();
        while let Some(parts) = next_pieces(&mut parts) {
            for pieces in in_pieces(&parts).chunks(PIECES) {
                let (intake, space) = (self.intake(unit), &self.space);
                let check = |piece: &&[PathSample]| Checked::paths(piece, &intake, space);
                let pieces: Vec<_> = pieces.par_iter().map(check).collect();
                self.visit(&pieces);
                self.deposit(&pieces, unit, Origin::Path);
            }
        }
    }

    fn intake(&self, unit: SumUnit) -> Intake<'_> {
        Intake {
            settings: &self.settings,
            grid: &self.space.grid,
            unit,
        }
    }

    /// Counts the vertices of usable samples.
    fn visit(&mut self, pieces: &[Checked]) {
        for piece in pieces {
            for (vertex, octant) in &piece.vertices {
                self.space.nodes[vertex.leaf as usize].visits[*octant as usize] += 1;
            }
            self.intakes.paths += piece.vertices.len() as u64;
            self.recent.keep_vertices(&piece.vertices);
        }
    }

    /// Finds each record's link and adds it up there. Returns how many were used.
    fn deposit(&mut self, pieces: &[Checked], unit: SumUnit, origin: Origin) -> u64 {
        let count = pieces.iter().map(|p| p.deposits.len()).sum();
        let mut usable = Vec::with_capacity(count);
        for piece in pieces {
            usable.extend_from_slice(&piece.deposits);
            self.intakes.dropped_non_finite += piece.non_finite;
            self.intakes.dropped_direction += piece.bad_direction;
        }
        let mut places = vec![ProductPosition::ROOT; count];
        let order = self.descend(&usable, &mut places, true);
        self.add_up(&usable, &order, (unit, origin), Look::First);
        self.recent.keep(&usable, &places);
        count as u64
    }
}
