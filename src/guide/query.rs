//! *Sample* and its density at one vertex of one path.

use super::field::Field;
use super::link_index::{GROUPS, Lists, Slot};
use super::model::Query;
use crate::math::equal_area::{DirectionCell, direction_code};
use crate::math::rng::BELOW_ONE;
use crate::math::{Rgb, Vec2, Vec3};
use std::f32::consts::PI;

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
    total: f32,
    query: Query,
}

impl Field {
    /// The distribution of light at a point.
    ///
    /// `normal` (unit), where given, keeps samples above its horizon as
    /// [`Settings::product`](super::Settings::product) says. A field split by normals needs it to
    /// find the right cell. `throughput` weights the colours: light that the path's throughput
    /// would absorb is not looked for; pass white when unsure. Neither changes which directions are
    /// possible, only how likely.
    #[inline]
    pub fn at(&self, position: Vec3, normal: Option<Vec3>, throughput: Rgb) -> LocalField<'_> {
        let side = normal.unwrap_or(Vec3::Z);
        LocalField::new(self, position, side, normal, throughput)
    }

    /// The same for a surface whose side `side` is known while light may reach it from beyond its
    /// `horizon`, too (a leaf, frosted glass): then pass no horizon.
    #[inline]
    pub fn at_side(
        &self,
        position: Vec3,
        side: Vec3,
        horizon: Option<Vec3>,
        throughput: Rgb,
    ) -> LocalField<'_> {
        LocalField::new(self, position, side, horizon, throughput)
    }
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
        let key = field.grid.key(position, side);
        let mut local = Self {
            field,
            cell: field.cell_of_key(key),
            key,
            channels: channels(throughput),
            total: 0.0,
            query: Query {
                position,
                normal: normal.filter(|n| n.is_finite()),
                product: field.product,
            },
        };
        let total = match &field.lists {
            None => local.channels.dot(local.flux()),
            Some(lists) => local.running(lists)[GROUPS - 1],
        };
        local.total = if total.is_finite() { total } else { 0.0 };
        local
    }

    /// Flux of all directions, in units of the field's scale.
    #[inline]
    fn flux(&self) -> Vec3 {
        let [r, g, b] = self.field.flux(self.cell).map(|c| c.iter().sum());
        Vec3::new(r, g, b)
    }

    /// Running sums over the base direction cells, as channels and normal weigh them.
    #[inline]
    fn running(&self, lists: &Lists) -> [f32; GROUPS] {
        let [r, g, b] = self.field.flux(self.cell);
        let c = self.channels;
        let weights: [f32; GROUPS] = std::array::from_fn(|i| {
            (c.x * r[i] + c.y * g[i] + c.z * b[i]) * lists.factor(i, &self.query)
        });
        let mut sum = 0.0;
        weights.map(|w| {
            sum += w;
            sum
        })
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
        let scaled = |flux: f32| (f64::from(flux) * self.field.scale) as f32;
        let Vec3 { x, y, z } = self.flux();
        Rgb::new(scaled(x), scaled(y), scaled(z))
    }

    /// A direction. `select` chooses among links, `direction` inside one; both uniform in the unit
    /// square.
    #[inline]
    pub fn sample(&self, select: Vec2, direction: Vec2) -> GuideSample {
        let e = self.field.defensive;
        if select.x < e || self.total <= 0.0 {
            return self.evaluated(DirectionCell::SPHERE.direction(direction));
        }
        let models = &self.field.models;
        let Some(lists) = &self.field.lists else {
            let sphere = DirectionCell::SPHERE;
            return self.evaluated(models.sample(self.cell, sphere, &self.query, direction));
        };
        let x = ((select.x - e) / (1.0 - e)).clamp(0.0, BELOW_ONE);
        let running = self.running(lists);
        let group = running.iter().position(|&r| r > x * self.total);
        let picked = group.and_then(|g| lists.pick(self.cell, g, self.channels, select.y));
        let Some(slot) = picked else {
            return self.evaluated(DirectionCell::SPHERE.direction(direction));
        };
        let w = models.sample(slot.model, slot.q, &self.query, direction);
        if slot.q.contains(direction_code(w)) {
            return GuideSample {
                direction: w,
                pdf: self.defended(self.link_pdf(lists, slot, w)),
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

    /// Density of a direction that a link holds, without the defensive share.
    #[inline]
    fn link_pdf(&self, lists: &Lists, slot: Slot, w: Vec3) -> f32 {
        let mass = lists.mass(slot, self.channels);
        if mass <= 0.0 {
            return 0.0;
        }
        let local = self.field.models.pdf(slot.model, slot.q, &self.query, w);
        mass / self.total * lists.factor(slot.group, &self.query) * local
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
        let pdf = match &self.field.lists {
            None => {
                let sphere = DirectionCell::SPHERE;
                self.field.models.pdf(self.cell, sphere, &self.query, w)
            }
            Some(lists) => {
                let code = direction_code(w);
                let slot = lists.find(&self.field.grid, self.cell, self.key, code);
                self.link_pdf(lists, slot, w)
            }
        };
        self.defended(pdf)
    }

    /// Every link of the path: its direction cell and its F in W/m^2. Their cells partition the
    /// sphere, their F sum to [`LocalField::irradiance`]. For pictures and tests.
    pub fn links(&self) -> Vec<(DirectionCell, Rgb)> {
        let links = match &self.field.lists {
            None => vec![(DirectionCell::SPHERE, self.flux())],
            Some(lists) => lists.links(self.cell),
        };
        let scale = self.field.scale as f32;
        links.into_iter().map(|(q, f)| (q, f * scale)).collect()
    }
}
