//! The field file: sums, not densities, so that fields trained apart add up.
//!
//! Little-endian. Magic, version, length of the rest, CRC-32 of the rest; then the settings as JSON,
//! the counters, the surface points' keys, P in preorder as one byte a node (which also says where R
//! is divided, so R needs no record), R's path-vertex counts, and each leaf link's sums. A tree that
//! is written as its preorder cannot hold a cycle or a dangling index; everything else is checked
//! against the length of the file before memory is set aside for it.

use super::links::Split;
use super::settings::{GuideError, Settings};
use super::tally::{Flux, Tally};
use super::train::{Intakes, Trainer};
use crate::math::sum::SumUnit;
use std::path::Path;

const MAGIC: &[u8; 8] = b"TWINTREE";
const VERSION: u32 = 2;
/// Magic, version, length, checksum.
const HEADER: usize = 8 + 4 + 8 + 4;

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
    pub fn u128(&mut self, v: u128) {
        self.0.extend(v.to_le_bytes());
    }
}

/// Reads them back; `None` at the end.
#[derive(Debug)]
pub(crate) struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, tail) = self.0.split_first_chunk::<N>()?;
        self.0 = tail;
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
    pub fn u128(&mut self) -> Option<u128> {
        self.take().map(u128::from_le_bytes)
    }
    /// A count of things of at least `size` bytes each, if the rest can hold them.
    fn count(&mut self, size: usize) -> Option<usize> {
        let n = usize::try_from(self.u64()?).ok()?;
        (n.checked_mul(size)? <= self.0.len()).then_some(n)
    }
    fn bytes(&mut self, n: usize) -> Option<&[u8]> {
        let (head, tail) = self.0.split_at_checked(n)?;
        self.0 = tail;
        Some(head)
    }
}

fn checksum(bytes: &[u8]) -> u32 {
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    crc.sum()
}

fn bad<T>(why: &str) -> Result<T, GuideError> {
    Err(GuideError::File(why.to_owned()))
}

impl Trainer {
    /// Writes the field to a file: to a temporary one beside it first, so that an interrupted write
    /// leaves no half file.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn save(&self, path: &Path) -> Result<(), GuideError> {
        let io = |source| GuideError::Io {
            path: path.to_owned(),
            source,
        };
        let dir = match path.parent() {
            Some(d) if !d.as_os_str().is_empty() => d,
            _ => Path::new("."),
        };
        let mut file = tempfile::NamedTempFile::new_in(dir).map_err(io)?;
        std::io::Write::write_all(&mut file, &self.to_bytes()).map_err(io)?;
        file.persist(path).map_err(|e| io(e.error))?;
        Ok(())
    }

    /// Reads a field that [`Trainer::save`] wrote; it can be trained further, merged and frozen.
    ///
    /// # Errors
    /// When the file cannot be read, is not a field, is of another version, or is damaged.
    pub fn load(path: &Path) -> Result<Self, GuideError> {
        let bytes = std::fs::read(path).map_err(|source| GuideError::Io {
            path: path.to_owned(),
            source,
        })?;
        Self::from_bytes(&bytes)
    }

    /// The file's content.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut w = Writer::default();
        // Settings hold numbers and names only: this cannot fail.
        let settings = serde_json::to_vec(&self.settings).unwrap_or_default();
        w.u64(settings.len() as u64);
        w.0.extend(&settings);
        self.write_counters(&mut w);
        w.u64(self.space.points.len() as u64);
        self.space.points.iter().for_each(|&k| w.u64(k));
        w.u64(self.space.total_area.to_bits());
        w.u64(self.space.seen.len() as u64);
        self.space.seen.iter().for_each(|&k| w.u64(k));
        let shape = self.product.preorder();
        w.u64(shape.len() as u64);
        shape.iter().for_each(|(_, s)| w.u8(*s as u8));
        for r in self.space_preorder() {
            let node = &self.space.nodes[r as usize];
            w.u64(node.visits_before);
            node.visits.iter().for_each(|&v| w.u64(v));
        }
        let stride = self.table_stride();
        for l in self.product.leaves() {
            let t = &self.tallies[l as usize];
            t.photons
                .0
                .iter()
                .chain(&t.paths.0)
                .for_each(|&q| w.u128(q));
            t.count.iter().chain(&t.squares).for_each(|&n| w.u64(n));
            let at = l as usize * stride;
            self.table[at..at + stride].iter().for_each(|&e| w.u32(e));
        }
        for l in self.product.leaves() {
            self.stats.write(l, &mut w);
        }
        let mut out = Vec::with_capacity(HEADER + w.0.len());
        out.extend(MAGIC);
        out.extend(VERSION.to_le_bytes());
        out.extend((w.0.len() as u64).to_le_bytes());
        out.extend(checksum(&w.0).to_le_bytes());
        out.extend(w.0);
        out
    }

    fn write_counters(&self, w: &mut Writer) {
        let i = &self.intakes;
        for v in [
            i.emitted,
            i.photons,
            i.paths,
            i.batches,
            i.rounds,
            i.dropped_non_finite,
            i.dropped_direction,
        ] {
            w.u64(v);
        }
        for unit in [self.photon_unit, self.path_unit] {
            // Exponents fit 9 bits; i32::MIN stands for none.
            w.u32(unit.map_or(i32::MIN, SumUnit::exponent) as u32);
        }
    }

    /// Nodes of R in preorder: an order that does not depend on the history of splits.
    pub(crate) fn space_preorder(&self) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.space.nodes.len());
        let mut stack = vec![0u32];
        while let Some(r) = stack.pop() {
            order.push(r);
            let first = self.space.nodes[r as usize].first;
            if first != 0 {
                stack.extend((first..first + 8).rev());
            }
        }
        order
    }

    /// Reads what [`Trainer::to_bytes`] made.
    ///
    /// # Errors
    /// When the bytes are not a field, of another version, or damaged; the error says which.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, GuideError> {
        let mut r = Reader(bytes);
        if r.take::<8>().as_ref() != Some(MAGIC) {
            return bad("not a twintree field (wrong magic); was it written by `twintree train`?");
        }
        match r.u32() {
            Some(VERSION) => {}
            Some(v) => {
                return bad(&format!(
                    "version {v}, this program reads {VERSION}; train anew"
                ));
            }
            None => return bad("cut off in the header"),
        }
        let (Some(length), Some(crc)) = (r.u64(), r.u32()) else {
            return bad("cut off in the header");
        };
        if length != r.0.len() as u64 {
            return bad(&format!(
                "{} bytes of content instead of {length}: cut off?",
                r.0.len()
            ));
        }
        if checksum(r.0) != crc {
            return bad("wrong checksum: damaged");
        }
        let mut trainer = read_head(&mut r)?;
        match read_body(&mut trainer, &mut r) {
            Some(()) if r.0.is_empty() => Ok(trainer),
            Some(()) => bad("bytes left over at the end: damaged"),
            None => bad("content does not fit together: damaged"),
        }
    }
}

fn read_head(r: &mut Reader) -> Result<Trainer, GuideError> {
    let json = r.count(1).and_then(|n| r.bytes(n));
    let Some(json) = json else {
        return bad("cut off in the settings");
    };
    let settings: Settings =
        serde_json::from_slice(json).map_err(|e| GuideError::File(format!("settings: {e}")))?;
    settings.validate()?;
    let mut trainer = Trainer::build(settings)?;
    trainer.product = super::links::Product::new();
    trainer.space = super::space::Space::new(trainer.space.grid);
    Ok(trainer)
}

fn read_body(t: &mut Trainer, r: &mut Reader) -> Option<()> {
    t.intakes = Intakes {
        emitted: r.u64()?,
        photons: r.u64()?,
        paths: r.u64()?,
        batches: r.u64()?,
        rounds: r.u64()?,
        dropped_non_finite: r.u64()?,
        dropped_direction: r.u64()?,
    };
    t.photon_unit = read_unit(r)?;
    t.path_unit = read_unit(r)?;
    t.space.points = read_keys(r)?;
    t.space.total_area = f64::from_bits(r.u64()?);
    if !(t.space.total_area.is_finite() && t.space.total_area >= 0.0) {
        return None;
    }
    t.space.seen = read_keys(r)?;
    read_shape(t, r)?;
    for node in t.space_preorder() {
        let node = &mut t.space.nodes[node as usize];
        // Sums of counts must stay far from overflow.
        let small = |v: u64| (v < 1 << 48).then_some(v);
        node.visits_before = small(r.u64()?)?;
        for v in &mut node.visits {
            *v = small(r.u64()?)?;
        }
    }
    let leaves = t.product.leaves();
    let stride = t.table_stride();
    let each = 6 * 16 + 32 + 4 * stride;
    if leaves.len().checked_mul(each)? > r.0.len() {
        return None;
    }
    t.tallies = vec![Tally::default(); leaves.len()];
    t.table = vec![0; leaves.len() * stride];
    for &l in &leaves {
        let tally = &mut t.tallies[l as usize];
        tally.photons = read_flux(r)?;
        tally.paths = read_flux(r)?;
        for n in tally.count.iter_mut().chain(&mut tally.squares) {
            *n = r.u64()?;
        }
        for e in &mut t.table[l as usize * stride..(l as usize + 1) * stride] {
            *e = r.u32()?;
        }
    }
    t.stats = super::model::StatSet::read(t.settings.model, &leaves, r)?;
    Some(())
}

fn read_unit(r: &mut Reader) -> Option<Option<SumUnit>> {
    match r.u32()? as i32 {
        i32::MIN => Some(None),
        e if (-149..=127).contains(&e) => Some(Some(SumUnit::from_exponent(e))),
        _ => None,
    }
}

fn read_flux(r: &mut Reader) -> Option<Flux> {
    Some(Flux([r.u128()?, r.u128()?, r.u128()?]))
}

fn read_keys(r: &mut Reader) -> Option<Vec<u64>> {
    let n = r.count(8)?;
    let keys: Vec<u64> = (0..n).map(|_| r.u64()).collect::<Option<_>>()?;
    keys.is_sorted().then_some(keys)
}

/// Replays the preorder: every split makes the children that the next bytes describe.
fn read_shape(t: &mut Trainer, r: &mut Reader) -> Option<()> {
    let n = r.count(1)?;
    let mut stack = vec![0u32];
    for _ in 0..n {
        let node = stack.pop()?;
        let link = t.product.nodes[node as usize].first;
        let at = t.product.links[link as usize];
        let split = match r.u8()? {
            0 => continue,
            1 if t.space.nodes[at.r as usize].level < t.space.grid.max_level => Split::Space,
            2 if at.q.level() < t.settings.max_direction_level.max(t.traits.base_level) => {
                Split::Direction
            }
            _ => return None,
        };
        t.product.split(&mut t.space, link, split);
        let first = t.product.nodes[node as usize].first;
        let arity = if split == Split::Space { 8 } else { 4 };
        stack.extend((first..first + arity).rev());
    }
    let base = t.traits.base_level;
    let based = t.product.links.iter().all(|l| l.q.level() >= base);
    let directed =
        t.traits.splits_directions || t.product.links.iter().all(|l| l.q.level() == base);
    (stack.is_empty() && based && directed).then_some(())
}
