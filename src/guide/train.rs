//! The trainable field and how it is *built*. How it takes records in is in `intake.rs`.

use super::links::{Link, Product, Split};
use super::model::{Batch, Look, Region, StatSet, Traits};
use super::recent::Recent;
use super::record::{Deposit, Origin, SurfacePoint};
use super::settings::{GuideError, Settings, Source};
use super::space::{Grid, Space};
use super::tally::{Table, Tally, apportion};
use crate::math::sum::SumUnit;
use crate::math::{Frame, Vec3};

/// What came in so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Intakes {
    /// Photons emitted by the lights, whether or not they landed.
    pub emitted: u64,
    /// Photons that landed and were used.
    pub photons: u64,
    /// Path samples used.
    pub paths: u64,
    /// Calls of `train` and `train_paths`.
    pub batches: u64,
    /// Rounds of refining.
    pub rounds: u64,
    /// Records dropped because a number in them was not finite (or a pdf not positive).
    pub dropped_non_finite: u64,
    /// Records dropped because their direction was zero or not finite.
    pub dropped_direction: u64,
}

impl Intakes {
    /// Records used of an origin.
    pub(crate) fn of(&self, origin: Origin) -> u64 {
        match origin {
            Origin::Photon => self.photons,
            Origin::Path => self.paths,
        }
    }
}

/// A field that is being learned. See the [module](super).
#[derive(Clone, Debug)]
pub struct Trainer {
    pub(crate) settings: Settings,
    pub(crate) traits: Traits,
    pub(crate) space: Space,
    pub(crate) product: Product,
    pub(crate) tallies: Vec<Tally>,
    /// `table_stride` entries a link.
    pub(crate) table: Vec<u32>,
    pub(crate) stats: StatSet,
    pub(crate) photon_unit: Option<SumUnit>,
    pub(crate) path_unit: Option<SumUnit>,
    pub(crate) intakes: Intakes,
    pub(crate) recent: Recent,
}

impl Trainer {
    /// *Build*: the shallow hierarchies. R is one cell (eight, where sides are told apart), Q is cut to
    /// the model's base level.
    ///
    /// # Errors
    /// When a setting is out of range.
    pub fn build(settings: Settings) -> Result<Self, GuideError> {
        settings.validate()?;
        let traits = settings.model.traits();
        let mut trainer = Self {
            traits,
            space: Space::new(Grid::new(&settings)),
            product: Product::new(),
            tallies: vec![Tally::default()],
            table: vec![0; tables(settings.source) * (8 << (2 * traits.table_levels))],
            stats: StatSet::new(settings.model),
            photon_unit: None,
            path_unit: None,
            intakes: Intakes::default(),
            recent: Recent::default(),
            settings,
        };
        for level in 0..traits.base_level {
            for link in 0..1u32 << (2 * level) {
                trainer.split(link, Split::Direction);
            }
        }
        if trainer.settings.normal_split {
            for link in 0..trainer.product.links.len() as u32 {
                trainer.split(link, Split::Space);
            }
        }
        Ok(trainer)
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Says which scene the field belongs to.
    pub fn set_scene(&mut self, hash: u64) {
        self.settings.scene_hash = hash;
    }

    /// Ends training without refining: the records since there were `batches` are no batch, and are
    /// not kept for a refinement.
    pub(crate) fn conclude(&mut self, batches: u64) {
        self.intakes.batches = batches;
        self.recent = Recent::default();
    }

    /// Keeps no more than so many records of a batch for refining.
    pub fn keep_at_most(&mut self, records: usize) {
        self.recent = Recent::of(records);
    }

    /// What came in so far.
    pub fn intakes(&self) -> Intakes {
        self.intakes
    }

    /// Gives points spread uniformly over all surfaces, which together stand for `total_area`. From
    /// them A(r) is estimated for every cell, now and after later splits. Replaces earlier points.
    /// A field split by normals tells the sides of a surface apart: give it a point for each side
    /// that light can reach, and count the area of both.
    pub fn set_surface(&mut self, points: &[SurfacePoint], total_area: f64) {
        let keys = self.space.keys(points);
        self.space.measure.set_surfaces(keys, total_area);
    }

    /// Gives points spread through all media as their extinction sigma_t is, which together stand
    /// for the integral of sigma_t over the volume, an area. Replaces earlier ones.
    pub fn set_media(&mut self, points: &[Vec3], cross_section: f64) {
        let points: Vec<SurfacePoint> =
            points.iter().map(|&p| SurfacePoint::in_medium(p)).collect();
        let keys = self.space.keys(&points);
        self.space.measure.set_media(keys, cross_section);
    }

    /// Adds records to their links, in the `order` that [`Trainer::descend`] gave.
    pub(crate) fn add_up(
        &mut self,
        deposits: &[Deposit],
        order: &[u64],
        (unit, origin): (SumUnit, Origin),
        look: Look,
    ) {
        let (product, space) = (&self.product, &self.space);
        let batch = Batch {
            deposits,
            links: &product.links,
            regions: &|link| region(space, link),
            octant: &|link, key| {
                let level = space.nodes[link.r as usize].level;
                space.grid.octant(key, level)
            },
            unit,
            origin,
            look,
        };
        self.stats
            .accumulate(&batch, order, &mut self.tallies, &mut self.table);
    }

    /// The unit of an origin's sums, once there were records.
    pub(crate) fn unit(&self, origin: Origin) -> Option<SumUnit> {
        match origin {
            Origin::Photon => self.photon_unit,
            Origin::Path => self.path_unit,
        }
    }

    pub(crate) fn table_stride(&self) -> usize {
        tables(self.settings.source) * self.table_size()
    }

    fn table_size(&self) -> usize {
        8 << (2 * self.traits.table_levels)
    }

    /// The origins whose records decide about splits.
    pub(crate) fn origins(&self) -> &'static [Origin] {
        match self.settings.source {
            Source::Photons => &[Origin::Photon],
            Source::Paths => &[Origin::Path],
            Source::Both => &[Origin::Photon, Origin::Path],
        }
    }

    /// How a link's flux of one origin is spread. A field of one source has one table for all.
    pub(crate) fn table(&self, link: u32, origin: Origin) -> Table<'_> {
        let (stride, size) = (self.table_stride(), self.table_size());
        let at = link as usize * stride + (stride - size) * origin as usize;
        Table {
            entries: &self.table[at..at + size],
        }
    }

    /// A link's space octants' shares of what its density refers to: area for photons, vertices for
    /// path samples.
    pub(crate) fn octant_measure(&self, r: u32, origin: Origin) -> [f64; 8] {
        let node = &self.space.nodes[r as usize];
        if origin == Origin::Path {
            if node.first == 0 {
                return node.visits.map(|v| v as f64);
            }
            return std::array::from_fn(|i| self.space.visits(node.first + i as u32) as f64);
        }
        self.space.octant_areas(r)
    }

    /// Divides a leaf link. Its flux is known by octant and by quadrant, so each child starts with
    /// its own share and every estimate stays right; only the children's own tables begin anew.
    pub(crate) fn split(&mut self, link: u32, how: Split) {
        let parent = self.product.links[link as usize];
        let from = region(&self.space, &parent);
        if how == Split::Leaf {
            return;
        }
        let weights = [Origin::Photon, Origin::Path].map(|o| self.shares(link, how, o));
        let new = self.product.split(&mut self.space, link, how);
        let numbers: Vec<u32> = std::iter::once(link).chain(new).collect();
        let to: Vec<Region> = numbers
            .iter()
            .map(|&n| region(&self.space, &self.product.links[n as usize]))
            .collect();
        self.stats.split(link, &from, &to);
        let shares = share_tally(&self.tallies[link as usize], &weights);
        let stride = self.table_stride();
        self.tallies
            .resize(self.product.links.len(), Tally::default());
        self.table.resize(self.product.links.len() * stride, 0);
        self.table[link as usize * stride..(link as usize + 1) * stride].fill(0);
        for (n, t) in numbers.iter().zip(shares) {
            self.tallies[*n as usize] = t;
        }
    }

    /// How a link's records of one origin divide among the children of a split: by their table;
    /// without records in it, by the other origin's, at last by measure.
    fn shares(&self, link: u32, how: Split, origin: Origin) -> Vec<f64> {
        let other = match origin {
            Origin::Photon => Origin::Path,
            Origin::Path => Origin::Photon,
        };
        for o in [origin, other] {
            let table = self.table(link, o);
            let shares = match how {
                Split::Space => table.octants().to_vec(),
                _ => table.quadrants().to_vec(),
            };
            if shares.iter().sum::<f64>() > 0.0 {
                return shares;
            }
        }
        match how {
            Split::Space => {
                let r = self.product.links[link as usize].r;
                self.octant_measure(r, self.origins()[0]).to_vec()
            }
            _ => vec![1.0; 4],
        }
    }

    /// Bytes held by nodes, links, accumulators and, per cell of R, the look-up tables that
    /// freezing makes. Surface points come on top: 8 bytes each.
    pub fn bytes(&self) -> u64 {
        (self.product.links.len() * self.link_bytes()
            + self.product.nodes.len() * NODE_BYTES
            + self.space.nodes.len() * SPACE_BYTES) as u64
    }

    pub(crate) fn link_bytes(&self) -> usize {
        size_of::<Link>() + size_of::<Tally>() + 4 * self.table_stride() + self.traits.stats_bytes
    }
}

/// Bytes of a node of P.
pub(crate) const NODE_BYTES: usize = size_of::<super::links::ProductNode>();
/// Bytes of a node of R in training plus a frozen cell's look-up tables.
pub(crate) const SPACE_BYTES: usize =
    size_of::<super::space::SpaceNode>() + super::link_index::CELL_BYTES;

pub(crate) fn region(space: &Space, link: &Link) -> Region {
    Region {
        centre: space.centre(link.r),
        side: Frame::new(space.side(link.r)),
    }
}

/// Tables a link keeps.
fn tables(source: Source) -> usize {
    match source {
        Source::Both => 2,
        _ => 1,
    }
}

/// Divides a link's sums among the children of a split, by the shares of each origin.
fn share_tally(t: &Tally, weights: &[Vec<f64>; 2]) -> Vec<Tally> {
    let n = weights[0].len();
    let padded = [0, 1].map(|o| {
        let mut padded = [0f64; 8];
        for (p, w) in padded.iter_mut().zip(&weights[o]) {
            *p = *w;
        }
        padded
    });
    let photons = t.photons.0.map(|q| apportion(q, &padded[0]));
    let paths = t.paths.0.map(|q| apportion(q, &padded[1]));
    let count = [0, 1].map(|o| apportion(u128::from(t.count[o]), &padded[o]));
    (0..n)
        .map(|i| Tally {
            photons: super::tally::Flux(photons.map(|p| p[i])),
            paths: super::tally::Flux(paths.map(|p| p[i])),
            count: count.map(|c| c[i] as u64),
            squares: [0; 2],
        })
        .collect()
}
