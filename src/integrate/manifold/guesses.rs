//! Initial guesses by region of space: how photons from small lights came there.

use super::guess::Guess;
use super::receiver::Receiver;
use crate::accel::Bounds;
use crate::math::Vec3;
use crate::math::kd::KdPlane;
use rayon::prelude::*;

/// A photon that came by a chain.
#[derive(Clone, Copy, Debug)]
pub struct Landed {
    /// Where.
    pub receiver: Receiver,
    /// Towards where it came from.
    pub dir: Vec3,
    /// How it came.
    pub guess: Guess,
}

/// Photons in a region, at most. The larger it is, the rarer are the images that no photon of a
/// region has found, and the more guesses are far from a receiver (measured: `EXPERIMENTS.md`).
const MAX_PHOTONS: usize = 160;
/// Most guesses of a region.
const MAX_GUESSES: usize = 48;

/// How far beyond its photons a region reaches, relative to its size: some of what can be seen
/// there lies between them and the next ones. (Measured: `EXPERIMENTS.md`.)
const MARGIN: f32 = 0.05;

/// A node of the tree over space, in eight bytes.
#[derive(Clone, Copy, Debug)]
struct RegionNode {
    /// Two bits: the axis that it is split along, or [`REGION`]. Thirty bits: its first child,
    /// which the second follows, or the region.
    what: u32,
    /// Where it is split.
    at: f32,
}

/// Instead of an axis: a region.
const REGION: u32 = 3;

impl RegionNode {
    fn split(plane: KdPlane, first: usize) -> Self {
        Self::new(plane.axis, first, plane.at)
    }

    fn region(number: usize) -> Self {
        Self::new(REGION, number, 0.0)
    }

    /// There are fewer than 2^30 nodes: no more than photons.
    fn new(kind: u32, first: usize, at: f32) -> Self {
        let what = kind << 30 | first as u32;
        Self { what, at }
    }
}

/// Where photons have landed, and their guesses.
#[derive(Clone, Copy, Debug)]
struct Region {
    bounds: Bounds,
    first: u32,
    guesses: u32,
}

/// All guesses.
#[derive(Debug)]
pub struct Guesses {
    nodes: Vec<RegionNode>,
    regions: Vec<Region>,
    list: Vec<Guess>,
}

fn bounds_of(landed: &[Landed]) -> Bounds {
    let places = landed.iter().map(|l| l.receiver.position);
    places.fold(Bounds::EMPTY, Bounds::with)
}

impl Guesses {
    /// From all photons. `begin` makes a photon's guess, `covers` tells which of a region's guesses
    /// leads to the way a photon came.
    pub fn new(
        mut landed: Vec<Landed>,
        begin: &(impl Fn(&Landed) -> Guess + Sync),
        covers: &(impl Fn(&[Guess], &Landed) -> Option<usize> + Sync),
    ) -> Self {
        let mut guesses = Self {
            nodes: vec![RegionNode::region(0)],
            regions: Vec::new(),
            list: Vec::new(),
        };
        let mut regions = Vec::new();
        guesses.divide(0, &mut landed, &mut regions);
        let found: Vec<Vec<Guess>> = regions
            .par_iter()
            .map(|photons| region(photons, begin, covers))
            .collect();
        for (photons, found) in regions.into_iter().zip(found) {
            let Bounds { min, max } = bounds_of(photons);
            let margin = MARGIN * (max - min).max_element();
            guesses.regions.push(Region {
                bounds: Bounds {
                    min: min - margin,
                    max: max + margin,
                },
                first: guesses.list.len() as u32,
                guesses: found.len() as u32,
            });
            guesses.list.extend(found);
        }
        guesses
    }

    /// Divides a node until its regions are small; which they are.
    fn divide<'l>(
        &mut self,
        node: usize,
        landed: &'l mut [Landed],
        regions: &mut Vec<&'l [Landed]>,
    ) {
        let Bounds { min, max } = bounds_of(landed);
        let size = max - min;
        if landed.len() <= MAX_PHOTONS || size.max_element() <= 0.0 {
            self.nodes[node] = RegionNode::region(regions.len());
            regions.push(landed);
            return;
        }
        // Regions are of one size, and as large as they may be.
        let regions_here = landed.len().div_ceil(MAX_PHOTONS);
        let middle = regions_here / 2 * landed.len() / regions_here;
        let plane = KdPlane::divide(landed, middle, |l| (l.receiver.position, 0));
        let first = self.nodes.len();
        self.nodes[node] = RegionNode::split(plane, first);
        self.nodes.extend([RegionNode::region(0); 2]);
        let (low, high) = landed.split_at_mut(middle);
        self.divide(first, low, regions);
        self.divide(first + 1, high, regions);
    }

    /// Those of the region that a point lies in; none where no photons have landed around it.
    #[inline]
    pub fn near(&self, p: Vec3) -> &[Guess] {
        let mut node = 0;
        let region = loop {
            let RegionNode { what, at } = self.nodes[node];
            let (kind, first) = (what >> 30, (what & (u32::MAX >> 2)) as usize);
            if kind == REGION {
                break first;
            }
            node = first + usize::from(p[kind as usize] >= at);
        };
        let Region {
            bounds,
            first,
            guesses,
        } = self.regions[region];
        if !(p.cmpge(bounds.min) & p.cmple(bounds.max)).all() {
            return &[];
        }
        &self.list[first as usize..(first + guesses) as usize]
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        let places = size_of_val(&*self.nodes) + size_of_val(&*self.regions);
        (places + size_of_val(&*self.list)) as u64
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

/// The guesses of a region's photons: one for every photon that no guess so far leads to. How often
/// they are drawn goes by the root of the number of photons: images that bring little, which are
/// the small ones, are the ones that paths do not meet by themselves. (All alike: as good. By the
/// number itself: 1.09 times the variance in a torus in glass.)
fn region(
    landed: &[Landed],
    begin: impl Fn(&Landed) -> Guess,
    covers: impl Fn(&[Guess], &Landed) -> Option<usize>,
) -> Vec<Guess> {
    let mut found: Vec<Guess> = Vec::new();
    let mut came: Vec<u32> = Vec::new();
    for photon in landed {
        if let Some(owner) = covers(&found, photon) {
            came[owner] += 1;
            continue;
        }
        if found.len() >= 2 * MAX_GUESSES {
            continue;
        }
        found.push(begin(photon));
        // One that does not even lead to its own photon is of no use.
        if covers(&found, photon) != Some(found.len() - 1) {
            found.pop();
            continue;
        }
        came.push(1);
    }
    for (guess, came) in found.iter_mut().zip(came) {
        *guess = guess.weighted((came as f32).sqrt());
    }
    found.sort_by(|a, b| b.weight().total_cmp(&a.weight()));
    found.truncate(MAX_GUESSES);
    found
}
