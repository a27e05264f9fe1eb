//! The trees in a field file: counters, the surface points' keys, P in preorder as one byte a node
//! (which also says where R is divided, so R needs no record), R's path-vertex counts, and each
//! leaf link's sums. A tree that is written as its preorder cannot hold a cycle or a dangling
//! index; everything else is checked against the length of the file before memory is set aside for
//! it.

use super::bytes::{Reader, Writer};
use super::links::{Product, Split};
use super::measure::Measure;
use super::settings::{GuideError, Settings};
use super::space::Space;
use super::tally::{Flux, Tally};
use super::train::{Intakes, Trainer};
use crate::math::sum::SumUnit;

/// Appends the trees.
pub(super) fn write_body(t: &Trainer, w: &mut Writer) {
    write_counters(t, w);
    write_measure(&t.space.measure, t.settings.media, w);
    write_keys(&t.space.seen, w);
    w.u8(t.space.seen_level);
    let shape = t.product.preorder();
    w.varint(shape.len() as u128);
    shape.iter().for_each(|(_, s)| w.u8(*s as u8));
    for r in t.space.preorder() {
        let node = &t.space.nodes[r as usize];
        w.varint(node.visits_before.into());
        node.visits.iter().for_each(|&v| w.varint(v.into()));
    }
    let stride = t.table_stride();
    for l in t.product.leaves() {
        let tally = &t.tallies[l as usize];
        let fluxes = tally.photons.0.iter().chain(&tally.paths.0);
        fluxes.for_each(|&q| w.varint(q));
        let counts = tally.count.iter().chain(&tally.squares);
        counts.for_each(|&n| w.varint(n.into()));
        let at = l as usize * stride;
        let table = &t.table[at..at + stride];
        table.iter().for_each(|&e| w.varint(e.into()));
    }
    for l in t.product.leaves() {
        t.stats.write(l, w);
    }
}

fn write_counters(t: &Trainer, w: &mut Writer) {
    let i = &t.intakes;
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
    for unit in [t.photon_unit, t.path_unit] {
        // Exponents fit 9 bits; i32::MIN stands for none.
        w.u32(unit.map_or(i32::MIN, SumUnit::exponent) as u32);
    }
}

/// Sorted keys, each as the distance from the one before.
fn write_keys(keys: &[u64], w: &mut Writer) {
    w.varint(keys.len() as u128);
    let mut before = 0;
    for &key in keys {
        w.varint(u128::from(key - before));
        before = key;
    }
}

/// Points and what they stand for: of media only where the field has them.
fn write_measure(measure: &Measure, media: bool, w: &mut Writer) {
    write_keys(&measure.keys, w);
    w.f64(measure.area);
    if media {
        w.varint(measure.on_surfaces as u128);
        w.f64(measure.cross_section);
    }
}

fn read_measure(media: bool, r: &mut Reader) -> Option<Measure> {
    let keys = read_keys(r)?;
    let area = r.f64()?;
    let (on_surfaces, cross_section) = match media {
        true => (r.small::<u64>()? as usize, r.f64()?),
        false => (keys.len(), 0.0),
    };
    let known = |total: f64| total.is_finite() && total >= 0.0;
    let fits = on_surfaces <= keys.len() && known(area) && known(cross_section);
    fits.then_some(Measure {
        keys,
        on_surfaces,
        area,
        cross_section,
    })
}

/// Reads the trees; `None` where the content does not fit together.
///
/// # Errors
/// When the settings are refused.
pub(super) fn read_body(settings: Settings, r: &mut Reader) -> Result<Option<Trainer>, GuideError> {
    let mut trainer = Trainer::build(settings)?;
    trainer.product = Product::new();
    trainer.space = Space::new(trainer.space.grid);
    Ok(fill(&mut trainer, r).map(|()| trainer))
}

fn fill(t: &mut Trainer, r: &mut Reader) -> Option<()> {
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
    t.space.measure = read_measure(t.settings.media, r)?;
    t.space.seen = read_keys(r)?;
    t.space.seen_level = r.u8()?;
    read_shape(t, r)?;
    for node in t.space.preorder() {
        let node = &mut t.space.nodes[node as usize];
        // Sums of counts must stay far from overflow.
        let small = |v: u64| (v < 1 << 48).then_some(v);
        node.visits_before = small(r.small()?)?;
        for v in &mut node.visits {
            *v = small(r.small()?)?;
        }
    }
    let leaves = t.product.leaves();
    let stride = t.table_stride();
    // Six fluxes, four counts and the table, a byte each at least.
    if leaves.len().checked_mul(10 + stride)? > r.left() {
        return None;
    }
    t.tallies = vec![Tally::default(); leaves.len()];
    t.table = vec![0; leaves.len() * stride];
    for &l in &leaves {
        let tally = &mut t.tallies[l as usize];
        tally.photons = read_flux(r)?;
        tally.paths = read_flux(r)?;
        for n in tally.count.iter_mut().chain(&mut tally.squares) {
            *n = r.small()?;
        }
        for e in &mut t.table[l as usize * stride..(l as usize + 1) * stride] {
            *e = r.small()?;
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
    Some(Flux([r.varint()?, r.varint()?, r.varint()?]))
}

fn read_keys(r: &mut Reader) -> Option<Vec<u64>> {
    let n = r.count(1)?;
    let mut keys = Vec::with_capacity(n);
    let mut before = 0u64;
    for _ in 0..n {
        before = before.checked_add(r.small()?)?;
        keys.push(before);
    }
    Some(keys)
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
