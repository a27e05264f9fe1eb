//! *Sample* and its density at one vertex of one path.

use super::field::{Field, GROUPS, NONE};
use super::links::quadrant;
use super::model::Query;
use crate::math::equal_area::{DirectionCell, direction_code};
use crate::math::rng::BELOW_ONE;
use crate::math::{Rgb, Vec2, Vec3};
use std::f32::consts::PI;

/// Longest path: levels 0 to 20 and the one for normals.
const PATH: usize = 24;
/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuideSample {
    /// Unit direction towards light.
    pub direction: Vec3,
    /// Its solid-angle density, the same as [`LocalField::pdf`] gives for it.
    pub pdf: f32,
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

impl<'f> LocalField<'f> {
    /// See [`Field::at`].
    #[inline]
    pub(crate) fn new(
        field: &'f Field,
        position: Vec3,
        side: Vec3,
        normal: Option<Vec3>,
        throughput: Rgb,
    ) -> Self {
        let normal = normal.filter(|n| n.is_finite());
        let key = field.grid.key(position, side);
        let cell = field.cell_of_key(key);
        let factor = match normal {
            Some(n) if field.groups == GROUPS => field.caps.factors(n, field.product),
            _ => [1.0; GROUPS],
        };
        let mut local = Self {
            field,
            cell,
            key: field.cell_key[cell as usize],
            channels: channels(throughput),
            factor,
            running: [0.0; GROUPS],
            total: 0.0,
            query: Query {
                position,
                normal,
                product: field.product,
            },
        };
        local.weigh();
        local
    }

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
        let x = ((select.x - e) / (1.0 - e)).clamp(0.0, BELOW_ONE);
        let Some((slot, group)) = self.pick(x, select.y) else {
            return self.evaluated(DirectionCell::SPHERE.direction(direction));
        };
        let (q, model) = self.field.slot(slot);
        let w = self.field.models.sample(model, q, &self.query, direction);
        let code = self.code(w);
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
            list = field.next(list);
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
        let code = self.code(w);
        let (slot, group, level) = self.find(code);
        let q = DirectionCell::containing(code, level);
        let model = self.field.model(slot);
        self.defended(self.link_pdf(slot, group, q, model, w))
    }

    /// The number of a direction by which links are found. Where the whole sphere is one base cell, no link divides
    /// directions, and any number will do: the true one is 4 % of a guided render.
    #[inline]
    fn code(&self, w: Vec3) -> u32 {
        if self.field.groups == GROUPS {
            direction_code(w)
        } else {
            0
        }
    }

    /// The slot of the link that holds a direction, its base cell, and the level of its direction cell.
    #[inline]
    fn find(&self, code: u32) -> (usize, usize, u8) {
        let field = self.field;
        let group = if field.groups == GROUPS {
            code >> 28
        } else {
            0
        } as usize;
        let entry = field.cell_entry[self.cell as usize * field.groups + group];
        let (mut space, mut direction) = (entry.space_level, entry.direction_level);
        let mut n = entry.node.0;
        loop {
            let first = n >> 2;
            match n & 3 {
                0 => return (first as usize, group, direction),
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
            list = field.next(list);
        }
        out
    }
}
