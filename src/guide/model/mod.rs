//! Local models: how light is spread over directions inside one link.
//!
//! A model is constant along space (the paper's restriction), is sampled and evaluated on its
//! direction cell and integrates to one over it, so that the link's flux *is* its marginal; the
//! tree keeps that as RGB for every model alike. Model statistics are integers while records come
//! in, so that they add exactly; floating point enters in [`LocalModel::refit`], once a link and
//! round.
//!
//! Mixtures are fitted by expectation maximisation, which wants several looks at the same records:
//! after a batch they are shown to the models again and again, [`LocalModel::ITERATIONS`] times,
//! and only what the last look found is kept.
//!
//! A new model is a file with an implementation of [`LocalModel`], a variant of [`ModelKind`] and
//! one line in [`local_models!`].

mod accumulate;
mod constant;
mod gauss;
mod kind;
mod lobe;
mod moments;
mod neighbour_lobes;
mod prior;
mod vmf;

pub(crate) use accumulate::{Batch, Look};
use accumulate::{Slots, accumulate};
pub(crate) use constant::Constant;
pub(crate) use gauss::Gauss;
pub use kind::ModelKind;
pub(crate) use neighbour_lobes::LEVELS_UP;
pub(crate) use vmf::Vmf;

use super::bytes::{Reader, Writer};
use super::record::{Deposit, Origin};
use super::settings::Product;
use super::tally::{Table, Tally};
use crate::math::equal_area::DirectionCell;
use crate::math::{Frame, Vec2, Vec3};
use rayon::prelude::*;

/// The link a model lives on, as far as models care.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Region {
    /// Centre of its cell of R: models with parallax aim from here.
    pub centre: Vec3,
    /// The middle of the octant that its normals point into, or z where R does not tell them apart.
    pub side: Frame,
}

/// Where and how a model is asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Query {
    /// The shading point.
    pub position: Vec3,
    /// Its normal, if the caller wants it to count.
    pub normal: Option<Vec3>,
    /// What the normal does.
    pub product: Product,
}

/// Links of cells that lie together, by their places among all links.
#[derive(Clone, Debug, Default)]
pub(crate) struct Neighbourhood {
    /// Those that may learn from the others.
    pub learning: Vec<u32>,
    /// Those that they may learn from: these and others.
    pub known: Vec<u32>,
}

/// A distribution of directions on one link.
pub(crate) trait LocalModel {
    /// Every link's direction cell has at least this level.
    const BASE_LEVEL: u8;
    /// Levels below the link's own that its table of sub-fluxes resolves (1 or 2).
    const TABLE_LEVELS: u8;
    /// Whether refining may divide directions; if not, P divides space alone.
    const SPLITS_DIRECTIONS: bool;
    /// Records a link must have seen before it is divided, if the settings ask for fewer.
    const SPLIT_RECORDS: u32;
    /// How often the last batch is shown again after refining.
    const ITERATIONS: u32;
    /// Training state.
    type Stats: Clone + Default + PartialEq + Send + Sync + std::fmt::Debug;
    /// Compact form for sampling.
    type Frozen: Clone + Send + Sync + std::fmt::Debug;

    /// Adds a record, by integers only.
    fn train(stats: &mut Self::Stats, region: &Region, deposit: &Deposit, origin: Origin);
    /// The parameters that fit best what is remembered and what was added since.
    fn refit(stats: &mut Self::Stats, region: &Region, table: &Table);
    /// Tries a lobe where one may be missing; further iterations find out what it is worth.
    fn reseed(_: &mut Self::Stats) {}
    /// Remembers what was added.
    fn settle(stats: &mut Self::Stats);
    /// The state a child starts with.
    fn split(parent: &Self::Stats, from: &Region, to: &Region) -> Self::Stats;
    /// Adds what another copy of this model was trained with since both last settled; false if they
    /// did so apart.
    fn merge(into: &mut Self::Stats, other: &Self::Stats) -> bool;
    /// Forgets what was added and not remembered yet; the parameters stay.
    fn clear(stats: &mut Self::Stats);
    /// The model for sampling.
    fn freeze(stats: &Self::Stats, region: &Region) -> Self::Frozen;
    /// Tells neighbours what could matter to them, too. `frozen` are the models of `links`, numbers
    /// among `stats`; who is whose neighbour is found out when asked.
    fn exchange(
        _: &mut [Self::Frozen],
        _: &[Self::Stats],
        _: &[u32],
        _: &dyn Fn() -> Vec<Neighbourhood>,
    ) {
    }
    /// Memory that frozen models take.
    fn bytes(frozen: &[Self::Frozen]) -> usize {
        size_of_val(frozen)
    }
    /// A direction inside the cell.
    fn sample(frozen: &Self::Frozen, q: DirectionCell, query: &Query, u: Vec2) -> Vec3;
    /// Solid-angle density of [`LocalModel::sample`] at a direction of the cell.
    fn pdf(frozen: &Self::Frozen, q: DirectionCell, query: &Query, w: Vec3) -> f32;
    /// Appends the state to a file.
    fn write(stats: &Self::Stats, out: &mut Writer);
    /// Reads what `write` wrote.
    fn read(input: &mut Reader) -> Option<Self::Stats>;
}

/// Facts about a model that the tree needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Traits {
    pub base_level: u8,
    pub table_levels: u8,
    pub splits_directions: bool,
    pub stats_bytes: usize,
    pub split_records: u32,
    pub iterations: u32,
}

/// Generates the run-time choice between models: each entry is `Name => Type`.
macro_rules! local_models {
    ($($kind:ident => $model:ty),* $(,)?) => {
        impl ModelKind {
            /// Every kind, for tables and command lines.
            pub const ALL: &'static [ModelKind] = &[$(ModelKind::$kind),*];

            pub(crate) fn traits(self) -> Traits {
                match self {
                    $(ModelKind::$kind => traits::<$model>()),*
                }
            }
        }

        /// One model's training states, a link each.
        #[derive(Clone, Debug, PartialEq)]
        pub(crate) enum StatSet {
            $($kind(Vec<<$model as LocalModel>::Stats>)),*
        }

        impl StatSet {
            pub fn new(kind: ModelKind) -> Self {
                match kind {
                    $(ModelKind::$kind => Self::$kind(vec![Default::default()])),*
                }
            }
            pub fn accumulate(&mut self, batch: &Batch, order: &[u64], tallies: &mut [Tally], table: &mut [u32]) {
                match self {
                    $(Self::$kind(stats) => accumulate::<$model>(batch, order, Slots { first: 0, tallies, table, stats })),*
                }
            }
            /// The link was divided: child 0 keeps the number, the others are appended.
            pub fn split(&mut self, link: u32, from: &Region, to: &[Region]) {
                match self {
                    $(Self::$kind(stats) => split::<$model>(stats, link, from, to)),*
                }
            }
            pub fn refit(&mut self, regions: &(dyn Fn(u32) -> Region + Sync), table: &[u32]) {
                match self {
                    $(Self::$kind(stats) => refit::<$model>(stats, regions, table)),*
                }
            }
            pub fn merge(&mut self, link: u32, other: &Self, other_link: u32) -> bool {
                match (self, other) {
                    $((Self::$kind(a), Self::$kind(b)) =>
                        <$model>::merge(&mut a[link as usize], &b[other_link as usize]),)*
                    #[allow(unreachable_patterns)]
                    _ => false,
                }
            }
            pub fn freeze(&self, links: &[u32], regions: &(dyn Fn(u32) -> Region + Sync), neighbourhoods: &dyn Fn() -> Vec<Neighbourhood>) -> FrozenSet {
                match self {
                    $(Self::$kind(s) => FrozenSet::$kind(freeze::<$model>(s, links, regions, neighbourhoods))),*
                }
            }
            pub fn write(&self, link: u32, out: &mut Writer) {
                match self {
                    $(Self::$kind(s) => <$model>::write(&s[link as usize], out)),*
                }
            }
            /// Reads the states of all links, which the file holds in the order `links`.
            pub fn read(kind: ModelKind, links: &[u32], input: &mut Reader) -> Option<Self> {
                match kind {
                    $(ModelKind::$kind => read::<$model>(links, input).map(Self::$kind)),*
                }
            }
            /// Tries lobes where some may be missing.
            pub fn reseed(&mut self) {
                match self {
                    $(Self::$kind(s) => s.par_iter_mut().for_each(<$model>::reseed)),*
                }
            }
            /// Remembers what was trained.
            pub fn settle(&mut self) {
                match self {
                    $(Self::$kind(s) => s.par_iter_mut().for_each(<$model>::settle)),*
                }
            }
            /// Forgets what was trained and not settled.
            pub fn clear(&mut self) {
                match self {
                    $(Self::$kind(s) => s.par_iter_mut().for_each(<$model>::clear)),*
                }
            }
        }

        /// One model's frozen forms.
        #[derive(Clone, Debug)]
        pub(crate) enum FrozenSet {
            $($kind(Vec<<$model as LocalModel>::Frozen>)),*
        }

        impl FrozenSet {
            #[inline]
            pub fn sample(&self, model: u32, q: DirectionCell, query: &Query, u: Vec2) -> Vec3 {
                match self {
                    $(Self::$kind(m) => <$model>::sample(&m[model as usize], q, query, u)),*
                }
            }
            #[inline]
            pub fn pdf(&self, model: u32, q: DirectionCell, query: &Query, w: Vec3) -> f32 {
                match self {
                    $(Self::$kind(m) => <$model>::pdf(&m[model as usize], q, query, w)),*
                }
            }
            pub fn bytes(&self) -> usize {
                match self {
                    $(Self::$kind(m) => <$model>::bytes(m)),*
                }
            }
        }
    };
}

local_models! {
    Constant => Constant,
    Vmf => Vmf,
    Gauss => Gauss,
}

fn traits<M: LocalModel>() -> Traits {
    Traits {
        base_level: M::BASE_LEVEL,
        table_levels: M::TABLE_LEVELS,
        splits_directions: M::SPLITS_DIRECTIONS,
        stats_bytes: size_of::<M::Stats>(),
        split_records: M::SPLIT_RECORDS,
        iterations: M::ITERATIONS,
    }
}

fn split<M: LocalModel>(stats: &mut Vec<M::Stats>, link: u32, from: &Region, to: &[Region]) {
    let parent = stats[link as usize].clone();
    for (i, region) in to.iter().enumerate() {
        let child = M::split(&parent, from, region);
        if i == 0 {
            stats[link as usize] = child;
        } else {
            stats.push(child);
        }
    }
}

fn freeze<M: LocalModel>(
    stats: &[M::Stats],
    links: &[u32],
    regions: &(dyn Fn(u32) -> Region + Sync),
    neighbourhoods: &dyn Fn() -> Vec<Neighbourhood>,
) -> Vec<M::Frozen> {
    let one = |&l: &u32| M::freeze(&stats[l as usize], &regions(l));
    let mut frozen: Vec<_> = links.par_iter().map(one).collect();
    M::exchange(&mut frozen, stats, links, neighbourhoods);
    frozen
}

fn read<M: LocalModel>(links: &[u32], input: &mut Reader) -> Option<Vec<M::Stats>> {
    let mut stats = vec![M::Stats::default(); links.len()];
    for &l in links {
        *stats.get_mut(l as usize)? = M::read(input)?;
    }
    Some(stats)
}

fn refit<M: LocalModel>(
    stats: &mut [M::Stats],
    regions: &(dyn Fn(u32) -> Region + Sync),
    table: &[u32],
) {
    if size_of::<M::Stats>() == 0 {
        return;
    }
    let stride = table.len() / stats.len().max(1);
    let used = 8usize << (2 * M::TABLE_LEVELS);
    stats.par_iter_mut().enumerate().for_each(|(i, s)| {
        let entries = &table[i * stride..i * stride + used];
        M::refit(s, &regions(i as u32), &Table { entries });
    });
}
