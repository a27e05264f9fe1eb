//! Where chains begin: what photons from small lights have met last before they landed, region by region.

use super::Place;
use super::seed::Seed;
use crate::math::Vec3;
use rayon::prelude::*;

/// A photon that came by a chain.
#[derive(Clone, Copy, Debug)]
pub struct Landed {
    /// Where.
    pub place: Place,
    /// Towards where it came from.
    pub dir: Vec3,
    /// How it came.
    pub seed: Seed,
}

/// Photons in a region, at most. (Variance times time of a torus in glass, of 2^18 photons with 32 and 64: 0.37, 0.36; of
/// 2^19 with 32 and 128: 0.38, 0.36.)
const PER_REGION: usize = 64;
/// Most seeds of a region.
const MOST: usize = 24;

/// A node of the tree over space.
#[derive(Clone, Copy, Debug)]
enum Node {
    /// The first child; the second is the next node.
    Split { axis: u8, at: f32, first: u32 },
    /// A range of seeds.
    Region { from: u32, to: u32 },
}

/// All seeds.
#[derive(Debug)]
pub struct Seeds {
    nodes: Vec<Node>,
    list: Vec<Seed>,
}

impl Seeds {
    /// From all photons. `covers` tells whether one of a region's seeds leads to the way a photon came.
    pub fn new(
        mut landed: Vec<Landed>,
        covers: &(impl Fn(&[Seed], &Landed) -> Option<usize> + Sync),
    ) -> Self {
        let mut seeds = Self {
            nodes: vec![Node::Region { from: 0, to: 0 }],
            list: Vec::new(),
        };
        let mut regions = Vec::new();
        seeds.divide(0, &mut landed, &mut regions);
        let found: Vec<Vec<Seed>> = regions
            .par_iter()
            .map(|(_, photons)| region(photons, covers))
            .collect();
        for ((node, _), found) in regions.iter().zip(found) {
            let from = seeds.list.len() as u32;
            seeds.list.extend(found);
            let to = seeds.list.len() as u32;
            seeds.nodes[*node] = Node::Region { from, to };
        }
        seeds
    }

    /// Divides a node until its regions are small; which they are.
    fn divide<'l>(
        &mut self,
        node: usize,
        landed: &'l mut [Landed],
        regions: &mut Vec<(usize, &'l [Landed])>,
    ) {
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for l in landed.iter() {
            min = min.min(l.place.position);
            max = max.max(l.place.position);
        }
        let size = max - min;
        if landed.len() <= PER_REGION || size.max_element() <= 0.0 {
            regions.push((node, landed));
            return;
        }
        let axis = size.max_position();
        let middle = landed.len() / 2;
        landed.select_nth_unstable_by(middle, |a, b| {
            a.place.position[axis].total_cmp(&b.place.position[axis])
        });
        let at = landed[middle].place.position[axis];
        let first = self.nodes.len();
        self.nodes[node] = Node::Split {
            axis: axis as u8,
            at,
            first: first as u32,
        };
        let empty = Node::Region { from: 0, to: 0 };
        self.nodes.extend([empty, empty]);
        let (low, high) = landed.split_at_mut(middle);
        self.divide(first, low, regions);
        self.divide(first + 1, high, regions);
    }

    /// Those of the region that a point lies in.
    #[inline]
    pub fn near(&self, p: Vec3) -> &[Seed] {
        let mut node = 0;
        loop {
            match self.nodes[node] {
                Node::Split { axis, at, first } => {
                    node = first as usize + usize::from(p[axis as usize] >= at);
                }
                Node::Region { from, to } => return &self.list[from as usize..to as usize],
            }
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        (self.nodes.len() * size_of::<Node>() + self.list.len() * size_of::<Seed>()) as u64
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

/// The seeds of a region's photons: one for every photon that no seed so far leads to. How often they are drawn goes
/// by the root of the number of photons: images that bring little, which are the small ones, are the ones that
/// paths do not meet by themselves. (All alike: as good. By the number itself: 1.09 times the variance in a torus in
/// glass.)
fn region(landed: &[Landed], covers: impl Fn(&[Seed], &Landed) -> Option<usize>) -> Vec<Seed> {
    let mut found: Vec<Seed> = Vec::new();
    let mut came: Vec<Vec<(Vec3, Vec3)>> = Vec::new();
    let way = |photon: &Landed| (photon.place.position, photon.dir);
    for photon in landed {
        if let Some(owner) = covers(&found, photon) {
            came[owner].push(way(photon));
            continue;
        }
        if found.len() >= 2 * MOST {
            continue;
        }
        found.push(photon.seed);
        // One that does not even lead to its own photon is of no use.
        if covers(&found, photon) != Some(found.len() - 1) {
            found.pop();
            continue;
        }
        came.push(vec![way(photon)]);
    }
    for (seed, photons) in found.iter_mut().zip(&came) {
        seed.fit(photons);
        seed.weight = (photons.len() as f32).sqrt();
    }
    found.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    found.truncate(MOST);
    found
}
