//! Distances along a ray in a scattering medium, by the lights beside it.
//!
//! Light that scatters once on a ray comes as the inverse square of the distance to the light, which
//! free flight knows nothing of. Equiangular sampling draws distances so that the light sees them
//! under equal angles, which cancels that factor (Kulla and Fajardo 2012, "Importance sampling
//! techniques for path tracing in participating media", section 3.1). The light is drawn first, by
//! what it sends to the whole segment.

use super::area::DARK;
use super::nearby::Nearby;
use super::{EmitterId, LightSample, Lights};
use crate::math::mis::power_heuristic;
use crate::math::{Vec2, Vec3};
use crate::medium::Segment;

/// The nearest that a ray may pass a light, relative to the way along it: nearer, angles are no
/// numbers of `f32`.
const CLOSEST: f32 = 1e-5;

/// A segment in a medium, and what the lights beside it send to it.
#[derive(Clone, Copy, Debug)]
pub struct LitSegment {
    segment: Segment,
    /// An extinction coefficient by which light weakens on its way, per unit length.
    sigma: f32,
    total: f32,
}

/// The triangle of a light and a segment.
struct Angles {
    /// Distance of the light from the segment's line.
    height: f32,
    /// Where the segment begins, seen from the light's foot on that line.
    begin: f32,
    /// The angle under which the light sees the segment, in radians.
    angle: f32,
}

impl Angles {
    fn of(segment: &Segment, light: &Nearby) -> Self {
        let to = light.center - segment.origin;
        let along = to.dot(segment.direction);
        let beside = (to - segment.direction * along).length();
        let least = (CLOSEST * along.abs())
            .max(light.radius)
            .max(f32::MIN_POSITIVE);
        let (height, begin) = (beside.max(least), -along);
        // The difference of two arcs would cancel where the light is far from a short segment.
        let angle = match segment.length.is_finite() {
            true => {
                let end = begin + segment.length;
                (height * segment.length).atan2(height * height + begin * end)
            }
            false => height.atan2(begin),
        };
        Self {
            height,
            begin,
            angle,
        }
    }

    /// The distance on the segment at a share `u` of the angle.
    fn distance(&self, u: f32) -> f32 {
        let (sin, cos) = (u * self.angle).sin_cos();
        let square = self.height * self.height + self.begin * self.begin;
        sin * square / (self.height * cos - self.begin * sin)
    }

    /// The density of that, per unit length.
    fn pdf(&self, distance: f32) -> f32 {
        let x = self.begin + distance;
        self.height / (self.angle * (self.height * self.height + x * x))
    }
}

impl LitSegment {
    /// The segment.
    pub fn segment(&self) -> &Segment {
        &self.segment
    }

    /// What a light sends to the segment, about: the integral of its strength over the squared
    /// distance, weakened by the way to the nearest point and from there.
    fn weight(&self, light: &Nearby) -> f32 {
        self.weight_at(light, &Angles::of(&self.segment, light))
    }

    fn weight_at(&self, light: &Nearby, at: &Angles) -> f32 {
        let nearest = (-at.begin).clamp(0.0, self.segment.length);
        let beside = at.height.hypot(nearest + at.begin);
        let weight = light.strength * at.angle / at.height;
        let weight = weight * (-self.sigma * (nearest + beside)).exp();
        // Not where it is no number.
        if weight > 0.0 {
            weight.min(f32::MAX * 1e-3)
        } else {
            0.0
        }
    }

    /// The density with which a distance is drawn by a light, its choice included.
    fn pdf(&self, light: &Nearby, distance: f32) -> f32 {
        let at = Angles::of(&self.segment, light);
        self.weight_at(light, &at) / self.total * at.pdf(distance)
    }
}

/// A place on a segment: where it is, and with what density free flight collides there.
#[derive(Clone, Copy, Debug)]
pub struct Collision {
    /// The segment.
    pub lit: LitSegment,
    /// Distance along it.
    pub distance: f32,
    /// The density of free flight, per unit length.
    pub density: f32,
}

/// A distance that was drawn by a light.
#[derive(Clone, Copy, Debug)]
pub struct DrawnDistance {
    /// Number of the light's leaf.
    pub leaf: u32,
    /// Distance along the segment.
    pub distance: f32,
    /// Its density, per unit length, the choice of the light included.
    pub pdf: f32,
}

impl Lights {
    /// The lights beside a segment, if any is: light weakens by `sigma` per unit length.
    pub fn beside(&self, segment: Segment, sigma: f32) -> Option<LitSegment> {
        let local = self.local.as_ref()?;
        let mut lit = LitSegment {
            segment,
            sigma,
            total: 0.0,
        };
        lit.total = local.strongest.iter().map(|light| lit.weight(light)).sum();
        (lit.total > 0.0 && lit.total.is_finite()).then_some(lit)
    }

    /// Draws a light by `u[0]` and a distance by `u[1]`.
    pub fn distance_beside(&self, lit: &LitSegment, u: [f32; 2]) -> Option<DrawnDistance> {
        let local = self.local.as_ref()?;
        let mut rest = u[0] * lit.total;
        let mut chosen = None;
        for light in &local.strongest {
            let weight = lit.weight(light);
            if weight > 0.0 {
                chosen = Some(light);
                if rest < weight {
                    break;
                }
                rest -= weight;
            }
        }
        let light = chosen?;
        let distance = Angles::of(&lit.segment, light).distance(u[1]);
        let pdf = lit.pdf(light, distance);
        // Also refuses what is no number.
        let usable = distance > 0.0 && distance < lit.segment.length && pdf > 0.0;
        (usable && pdf.is_finite()).then_some(DrawnDistance {
            leaf: light.leaf,
            distance,
            pdf,
        })
    }

    /// The density of [`Lights::distance_beside`] for a leaf and a distance.
    pub fn pdf_beside(&self, lit: &LitSegment, leaf: u32, distance: f32) -> f32 {
        let nearby = self.local.as_ref().and_then(|local| local.nearby(leaf));
        nearby.map_or(0.0, |light| lit.pdf(light, distance))
    }

    /// Samples a leaf from `p`, in the middle of a medium; the density is that of the direction
    /// alone.
    pub fn sample_leaf(&self, leaf: u32, p: Vec3, u: Vec2) -> Option<LightSample> {
        let local = self.local.as_ref()?;
        let sample = self.sample_chosen(local, p, (leaf as usize, 1.0), u)?;
        (sample.pdf > 0.0).then_some(sample)
    }

    /// The leaf that triangle `prim` of an area emitter is, seen from `p`; `q` and `ng` are as in
    /// [`Lights::pdf_area`].
    pub fn leaf_at(
        &self,
        p: Vec3,
        (emitter, prim): (EmitterId, u32),
        (q, ng): (Vec3, Vec3),
    ) -> Option<u32> {
        let area = self.areas.get(emitter as usize)?.as_ref()?;
        let (leaf, _) = area.facing(prim, ng, p - q);
        (leaf != DARK).then_some(leaf)
    }

    /// MIS weight of light that comes from a leaf to a collision by free flight, against distances
    /// that are drawn by lights. The rest, 1 less this, is the weight of those.
    ///
    /// The leaf, and not the direction, is what they are weighed by: light samples have the same
    /// density on a leaf in both, and what phase sampling finds shares the weight of free flight.
    /// What a field has learned of the lights does not count, so that it need not be asked: any
    /// weights that sum to one are right.
    pub fn free_flight_weight(&self, collision: &Collision, leaf: u32) -> f32 {
        let Some(local) = &self.local else { return 1.0 };
        let Collision {
            lit,
            distance,
            density,
        } = collision;
        let by_light = self.pdf_beside(lit, leaf, *distance);
        // Also refuses what is no number.
        let drawn = by_light > 0.0;
        if !drawn {
            return 1.0;
        }
        let p = lit.segment.at(*distance);
        let share = 1.0 - self.distant_share(p, Vec3::ZERO);
        let chosen = local.tree.probability(p, Vec3::ZERO, &(), leaf as usize);
        power_heuristic(density * chosen * share, by_light)
    }
}
