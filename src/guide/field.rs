//! The frozen field: *sample* and its density.
//!
//! Memory layout. Each node of R that has leaf links owns a *list*: its links sorted by direction,
//! in up to 16 buckets (one a base direction cell), each bucket with running RGB sums of F. Lists are
//! chained upwards, so a cell of R knows every link of its path. Beside that a cell keeps, per base
//! direction cell, the RGB sum over its whole path and the node of P to enter at; both are what makes
//! a query fast:
//!
//! * [`Field::at`] finds the cell (one descent of R) and weights 16 base cells by throughput and
//!   normal;
//! * sampling picks a base cell, then a list of the path, then a link by binary search in running
//!   sums, then a direction from the link's model;
//! * the density descends P from the entry: typically 2 to 5 steps.
//!
//! Sums are kept for each colour channel and combined with the path's throughput at the query, so
//! the probability of a link is exactly the difference of two combined running sums, the same
//! numbers in `sample` and in `pdf`: rounding cannot make them disagree.

use super::links::quadrant;
use super::model::{FrozenSet, Query};
use super::settings::{Product, Settings};
use super::space::Grid;
use super::train::Trainer;
use crate::math::equal_area::{CODE_LEVELS, DirectionCell, direction_code};
use crate::math::{Rgb, Vec2, Vec3};
use std::f32::consts::PI;

/// No list, no parent.
pub(crate) const NONE: u32 = u32::MAX;
/// Base direction cells of the finest base level.
const GROUPS: usize = 16;
/// Longest path: levels 0 to 20 and the one for normals.
const PATH: usize = 24;
/// Bytes of one cell's look-up tables: 16 RGB sums, 16 entries, list and key.
pub(crate) const CELL_BYTES: usize = GROUPS * (12 + size_of::<Entry>()) + 16;

/// Where a cell and base direction enter P.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    pub node: u32,
    pub space_level: u8,
    pub direction_level: u8,
}

/// A node of P in 4 bytes: first child (or slot of the link), and how it divides in the low 2 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node(u32);

impl Node {
    pub fn new(first: u32, split: u32) -> Self {
        Self(first << 2 | split)
    }
}

/// An immutable learned field. Cheap to share between threads; made by [`Trainer::freeze`].
#[derive(Clone, Debug)]
pub struct Field {
    grid: Grid,
    groups: usize,
    pub(crate) scale: f64,
    defensive: f32,
    product: Product,
    /// Per node of R: first child, or the marked number of a cell.
    pub(crate) space: Vec<u32>,
    pub(crate) cell_list: Vec<u32>,
    pub(crate) cell_key: Vec<u64>,
    /// Per cell: all groups' red, then green, then blue.
    pub(crate) cell_flux: Vec<f32>,
    pub(crate) cell_entry: Vec<Entry>,
    pub(crate) next: Vec<u32>,
    /// Per list: groups + 1 slots.
    pub(crate) starts: Vec<u32>,
    /// Running sums before each slot's link.
    pub(crate) prefix: Vec<Vec3>,
    /// Each slot's direction cell: start code above, level in the low bits.
    cells_q: Vec<u32>,
    pub(crate) model_of: Vec<u32>,
    pub(crate) models: FrozenSet,
    pub(crate) nodes: Vec<Node>,
    caps: Caps,
}

/// Centres and chord radii of the base direction cells, by component.
#[derive(Clone, Debug)]
struct Caps {
    x: [f32; GROUPS],
    y: [f32; GROUPS],
    z: [f32; GROUPS],
    radius: [f32; GROUPS],
}

impl Caps {
    fn new(groups: usize) -> Self {
        let level = (groups.ilog2() / 2) as u8;
        let mut caps = Self {
            x: [0.0; GROUPS],
            y: [0.0; GROUPS],
            z: [0.0; GROUPS],
            radius: [2.0; GROUPS],
        };
        for g in 0..groups {
            let code = ((g as u64) << (2 * u32::from(CODE_LEVELS - level))) as u32;
            let (c, r) = DirectionCell::containing(code, level).cap();
            (caps.x[g], caps.y[g], caps.z[g], caps.radius[g]) = (c.x, c.y, c.z, r);
        }
        caps
    }

    /// Per base cell a factor for the normal `n`, positive wherever any direction of the cell lies
    /// above the horizon: n.w lies within `radius` of n.centre, and is taken to be uniform there.
    fn factors(&self, n: Vec3, product: Product) -> [f32; GROUPS] {
        std::array::from_fn(|g| {
            let t = n.x * self.x[g] + n.y * self.y[g] + n.z * self.z[g];
            let r = self.radius[g];
            let above = (t + r).clamp(0.0, 2.0 * r);
            match product {
                Product::None => 1.0,
                Product::Horizon => above / (2.0 * r),
                Product::Cosine => above * above / (4.0 * r) + (t - r).max(0.0),
            }
        })
    }
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuideSample {
    /// Unit direction towards light.
    pub direction: Vec3,
    /// Its solid-angle density, the same as [`LocalField::pdf`] gives for it.
    pub pdf: f32,
}

impl Field {
    pub(crate) fn empty(trainer: &Trainer, groups: usize, scale: f64) -> Self {
        let settings: &Settings = &trainer.settings;
        Self {
            grid: trainer.space.grid,
            groups,
            scale,
            defensive: settings.defensive,
            product: settings.product,
            space: Vec::with_capacity(trainer.space.nodes.len()),
            cell_list: Vec::new(),
            cell_key: Vec::new(),
            cell_flux: Vec::new(),
            cell_entry: Vec::new(),
            next: Vec::new(),
            starts: Vec::new(),
            prefix: Vec::new(),
            cells_q: Vec::new(),
            model_of: Vec::new(),
            models: FrozenSet::Constant(Vec::new()),
            nodes: Vec::new(),
            caps: Caps::new(groups),
        }
    }

    pub(crate) fn push_slot(&mut self, prefix: Vec3, q: DirectionCell, model: u32) {
        self.prefix.push(prefix);
        self.cells_q.push(q.start() | u32::from(q.level()));
        self.model_of.push(model);
    }

    pub(crate) fn set_slot(&mut self, slot: u32, q: DirectionCell, model: u32) {
        // Levels up to 10 leave the 12 lowest bits of a start code free.
        self.cells_q[slot as usize] = q.start() | u32::from(q.level());
        self.model_of[slot as usize] = model;
    }

    pub(crate) fn leaf_mark(cell: usize) -> u32 {
        cell as u32 | 0x8000_0000
    }

    pub(crate) fn bucket(&self, list: u32, group: usize) -> std::ops::Range<usize> {
        let at = list as usize * (self.groups + 1) + group;
        self.starts[at] as usize..self.starts[at + 1] as usize
    }

    pub(crate) fn bucket_total(&self, range: &std::ops::Range<usize>) -> Vec3 {
        if range.is_empty() {
            return Vec3::ZERO;
        }
        self.prefix[range.end - 1]
    }

    #[inline]
    fn cell_of_key(&self, key: u64) -> u32 {
        let mut n = self.space[0];
        let mut level = 0;
        while n & 0x8000_0000 == 0 {
            n = self.space[(n + self.grid.octant(key, level)) as usize];
            level += 1;
        }
        n & 0x7fff_ffff
    }

    /// The number of the cell of R that holds a point, below [`Field::cell_count`]. The normal only
    /// matters for fields split by normals.
    #[inline]
    pub fn cell(&self, position: Vec3, normal: Vec3) -> u32 {
        self.cell_of_key(self.grid.key(position, normal))
    }

    /// Cells of R (its leaves).
    pub fn cell_count(&self) -> u32 {
        self.cell_list.len() as u32
    }

    /// The distribution of light at a point.
    ///
    /// `normal` (unit), where given, keeps samples above its horizon as [`Settings::product`] says.
    /// `throughput` weights the colours: light that the path's throughput would absorb is not looked
    /// for; pass white when unsure. Neither changes which directions are possible, only how likely.
    #[inline]
    pub fn at(&self, position: Vec3, normal: Option<Vec3>, throughput: Rgb) -> LocalField<'_> {
        let normal = normal.filter(|n| n.is_finite());
        let key = self.grid.key(position, normal.unwrap_or(Vec3::Z));
        let cell = self.cell_of_key(key);
        let channels = channels(throughput);
        let factor = match normal {
            Some(n) if self.groups == GROUPS => self.caps.factors(n, self.product),
            _ => [1.0; GROUPS],
        };
        let mut local = LocalField {
            field: self,
            cell,
            key: self.cell_key[cell as usize],
            channels,
            factor,
            running: [0.0; GROUPS],
            total: 0.0,
            query: Query {
                position,
                normal,
                product: self.product,
            },
        };
        local.weigh();
        local
    }

    /// Bytes of the frozen field.
    pub fn bytes(&self) -> u64 {
        let of = |n: usize, size: usize| (n * size) as u64;
        of(self.space.len(), 4)
            + of(self.cell_list.len(), 12)
            + of(self.cell_flux.len(), 4)
            + of(self.cell_entry.len(), size_of::<Entry>())
            + of(self.next.len() + self.starts.len() + self.model_of.len(), 4)
            + of(self.prefix.len(), 16)
            + of(self.nodes.len(), 4)
            + self.models.bytes() as u64
    }
}

/// Weights of the three channels: the throughput, normalised (its scale must not matter), with a
/// trace of white, because the surface's own colour is not in the throughput yet.
#[inline]
fn channels(throughput: Rgb) -> Vec3 {
    let largest = throughput.max_element();
    if !(largest > 0.0 && throughput.is_finite()) {
        return Vec3::ONE;
    }
    (throughput / largest).max(Vec3::ZERO) + 0.01
}

/// The field at one point for one path: what [`Field::at`] returns.
#[derive(Clone, Copy, Debug)]
pub struct LocalField<'f> {
    field: &'f Field,
    cell: u32,
    key: u64,
    channels: Vec3,
    factor: [f32; GROUPS],
    running: [f32; GROUPS],
    total: f32,
    query: Query,
}

impl LocalField<'_> {
    #[inline]
    fn weigh(&mut self) {
        let groups = self.field.groups;
        let at = self.cell as usize * 3 * groups;
        let flux = &self.field.cell_flux[at..at + 3 * groups];
        let (r, rest) = flux.split_at(groups);
        let (g, b) = rest.split_at(groups);
        let c = self.channels;
        let mut sum = 0.0;
        for i in 0..groups {
            let w = c.x * r[i] + c.y * g[i] + c.z * b[i];
            sum += w * self.factor[i];
            self.running[i] = sum;
        }
        self.total = if sum.is_finite() { sum } else { 0.0 };
    }

    /// The cell's number, see [`Field::cell`].
    #[inline]
    pub fn cell(&self) -> u32 {
        self.cell
    }

    /// Whether the field expects any light here above the horizon. If not, samples are uniform on
    /// the sphere.
    #[inline]
    pub fn has_light(&self) -> bool {
        self.total > 0.0
    }

    /// Incident flux per area, summed over all directions (the paper's RGB of the whole path), in
    /// W/m^2; for [`super::Target::Radiance`] the fluence, the integral of radiance.
    pub fn irradiance(&self) -> Rgb {
        let groups = self.field.groups;
        let at = self.cell as usize * 3 * groups;
        let flux = &self.field.cell_flux[at..at + 3 * groups];
        let sum = |c: usize| {
            let s: f32 = flux[c * groups..(c + 1) * groups].iter().sum();
            (f64::from(s) * self.field.scale) as f32
        };
        Rgb::new(sum(0), sum(1), sum(2))
    }

    /// A direction. `select` chooses among links, `direction` inside one; both uniform in the unit
    /// square.
    #[inline]
    pub fn sample(&self, select: Vec2, direction: Vec2) -> GuideSample {
        let e = self.field.defensive;
        if select.x < e || self.total <= 0.0 {
            return self.evaluated(DirectionCell::SPHERE.direction(direction));
        }
        let x = ((select.x - e) / (1.0 - e)).clamp(0.0, 1.0 - f32::EPSILON * 0.5);
        let Some((slot, group)) = self.pick(x, select.y) else {
            return self.evaluated(DirectionCell::SPHERE.direction(direction));
        };
        let (q, model) = self.field.slot(slot);
        let w = self.field.models.sample(model, q, &self.query, direction);
        let code = direction_code(w);
        if q.contains(code) {
            let pdf = self.link_pdf(slot, group, q, model, w);
            return GuideSample {
                direction: w,
                pdf: self.defended(pdf),
            };
        }
        // Rounding carried it over the cell's edge: its density is the neighbour's.
        self.evaluated(w)
    }

    fn evaluated(&self, w: Vec3) -> GuideSample {
        GuideSample {
            direction: w,
            pdf: self.pdf(w),
        }
    }

    /// The link for two random numbers: base cell, list of the path, link of the list.
    #[inline]
    fn pick(&self, x: f32, y: f32) -> Option<(usize, usize)> {
        let field = self.field;
        let t = x * self.total;
        let group = self.running[..field.groups].iter().position(|&r| r > t)?;
        let mut buckets = [(0usize, 0usize, 0f32); PATH];
        let mut count = 0;
        let mut total = 0.0;
        let mut list = field.cell_list[self.cell as usize];
        while list != NONE && count < PATH {
            let range = field.bucket(list, group);
            if !range.is_empty() {
                let sum = self.channels.dot(field.prefix[range.end - 1]);
                total += sum;
                buckets[count] = (range.start, range.end, sum);
                count += 1;
            }
            list = field.next[list as usize];
        }
        let mut t = y * total;
        let mut chosen = None;
        for &(start, end, sum) in &buckets[..count] {
            if sum <= 0.0 {
                continue;
            }
            chosen = Some((start, end, t.min(sum * (1.0 - f32::EPSILON))));
            if t < sum {
                break;
            }
            t -= sum;
        }
        let (start, end, t) = chosen?;
        // The first slot whose running sum after its link exceeds t: that link has mass.
        let after = &field.prefix[start + 1..end];
        let i = after.partition_point(|p| self.channels.dot(*p) <= t);
        Some((start + i.min(after.len() - 1), group))
    }

    /// Density of a direction that a link holds, without the defensive share.
    #[inline]
    fn link_pdf(&self, slot: usize, group: usize, q: DirectionCell, model: u32, w: Vec3) -> f32 {
        let p = &self.field.prefix[slot..slot + 2];
        let mass = self.channels.dot(p[1]) - self.channels.dot(p[0]);
        if mass <= 0.0 {
            return 0.0;
        }
        let local = self.field.models.pdf(model, q, &self.query, w);
        mass / self.total * self.factor[group] * local
    }

    #[inline]
    fn defended(&self, pdf: f32) -> f32 {
        let e = self.field.defensive;
        (1.0 - e) * pdf + e * (0.25 / PI)
    }

    /// Solid-angle density of [`LocalField::sample`] at a unit direction: positive everywhere.
    #[inline]
    pub fn pdf(&self, w: Vec3) -> f32 {
        if self.total <= 0.0 {
            return 0.25 / PI;
        }
        let code = direction_code(w);
        let (slot, group) = self.find(code);
        let (q, model) = self.field.slot(slot);
        self.defended(self.link_pdf(slot, group, q, model, w))
    }

    /// The slot of the link that holds a direction, and its base cell.
    #[inline]
    fn find(&self, code: u32) -> (usize, usize) {
        let field = self.field;
        let group = if field.groups == GROUPS {
            code >> 28
        } else {
            0
        } as usize;
        let entry = field.cell_entry[self.cell as usize * field.groups + group];
        let (mut space, mut direction) = (entry.space_level, entry.direction_level);
        let mut n = field.nodes[entry.node as usize].0;
        loop {
            let first = n >> 2;
            match n & 3 {
                0 => return (first as usize, group),
                1 => {
                    n = field.nodes[(first + field.grid.octant(self.key, space)) as usize].0;
                    space += 1;
                }
                _ => {
                    n = field.nodes[(first + quadrant(code, direction)) as usize].0;
                    direction += 1;
                }
            }
        }
    }

    /// Every link of the path: its direction cell and its F in W/m^2. Their cells partition the
    /// sphere, their F sum to [`LocalField::irradiance`]. For pictures and tests.
    pub fn links(&self) -> Vec<(DirectionCell, Rgb)> {
        let field = self.field;
        let mut out = Vec::new();
        let mut list = field.cell_list[self.cell as usize];
        while list != NONE {
            for group in 0..field.groups {
                let range = field.bucket(list, group);
                for slot in range.start..range.end.saturating_sub(1) {
                    let f = field.prefix[slot + 1] - field.prefix[slot];
                    out.push((field.slot(slot).0, f * field.scale as f32));
                }
            }
            list = field.next[list as usize];
        }
        out
    }
}

impl Field {
    #[inline]
    fn slot(&self, slot: usize) -> (DirectionCell, u32) {
        let packed = self.cells_q[slot];
        let q = DirectionCell::containing(packed & !0xf, (packed & 0xf) as u8);
        let model = if self.model_of.is_empty() {
            0
        } else {
            self.model_of[slot]
        };
        (q, model)
    }
}
