//! The frozen field: which record serves a point, and what it says.

use super::near::KdTree;
use super::place::RecordPlace;
use super::square;
use crate::guide::GuideSample;
use crate::guide::gaussian::{Domain, LOBES, Lobe, Mixture};
use crate::math::{Frame, Pcg32, Rgb, Vec2, Vec3, warp::uniform_sphere};

/// A record is asked this many of its radii away at most.
const REACH: f32 = 2.0;
/// A normal that differs moves a record away: by its radius times the root of this per unit of 1 -
/// cosine.
const TURN: f32 = 4.0;
/// Records for surfaces turned further away are not asked (cosine).
const LEAST_COSINE: f32 = 0.5;

/// Cached mixtures, ready to be asked. Made by [`super::GmmTrainer::freeze`].
#[derive(Clone, Debug)]
pub struct Mixtures {
    tree: KdTree,
    /// In the tree's order.
    keys: Vec<Key>,
    records: Vec<Known>,
    /// Square of the largest distance at which some record is asked.
    reach: f32,
}

/// What decides whether a record is asked.
#[derive(Clone, Copy, Debug)]
struct Key {
    normal: Vec3,
    /// Squared radius.
    square: f32,
}

/// What a record knows.
#[derive(Clone, Debug)]
struct Known {
    irradiance: Rgb,
    mixture: Mixture,
}

/// A record's answer for one path vertex.
#[derive(Clone, Copy, Debug)]
pub struct LocalMixture<'f> {
    known: &'f Known,
    frame: Frame,
}

impl Mixtures {
    pub(super) fn new(known: Vec<(RecordPlace, Rgb, Mixture)>) -> Self {
        let positions: Vec<Vec3> = known.iter().map(|k| k.0.position).collect();
        let tree = KdTree::new(&positions);
        let mut keys = Vec::with_capacity(known.len());
        let mut records = Vec::with_capacity(known.len());
        for &i in tree.order() {
            let (place, irradiance, mixture) = &known[i as usize];
            keys.push(Key {
                normal: place.normal,
                square: place.radius * place.radius,
            });
            records.push(Known {
                irradiance: *irradiance,
                mixture: mixture.clone(),
            });
        }
        let largest = keys.iter().map(|k| k.square).fold(0.0, f32::max);
        Self {
            tree,
            keys,
            records,
            reach: largest * REACH * REACH,
        }
    }

    /// The nearest record on surfaces that face `normal`; `None` where none is near.
    #[inline]
    pub fn at(&self, position: Vec3, normal: Vec3) -> Option<LocalMixture<'_>> {
        let mut best = None;
        let mut bound = self.reach;
        self.tree.visit(position, bound, |slot, d| {
            let key = &self.keys[slot];
            let cosine = key.normal.dot(normal);
            let distance = d + key.square * TURN * (1.0 - cosine);
            let asked = cosine > LEAST_COSINE && d < key.square * REACH * REACH;
            if asked && distance < bound {
                bound = distance;
                best = Some(slot);
            }
            bound
        });
        let slot = best?;
        Some(LocalMixture {
            known: &self.records[slot],
            frame: Frame::new(self.keys[slot].normal),
        })
    }

    /// Records there are.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Bytes of the frozen field.
    pub fn bytes(&self) -> u64 {
        let arrays = size_of_val(&*self.keys) + size_of_val(&*self.records);
        (arrays + self.tree.bytes()) as u64
    }

    /// Noise over a box: mixtures that know nothing, at places that mean nothing. For tests that
    /// show that no field can change the mean of an image.
    pub fn random(min: Vec3, max: Vec3, seed: u64) -> Self {
        let mut rng = Pcg32::new(seed, 0x006d_6978);
        let mut next = || rng.next_f32();
        let known = (0..2000).map(|_| {
            let position = min + (max - min) * Vec3::new(next(), next(), next());
            let normal = uniform_sphere(Vec2::new(next(), next()));
            let lobes: [Lobe; LOBES] = std::array::from_fn(|_| {
                let (sx, sy) = (0.01 + 0.3 * next() * next(), 0.01 + 0.3 * next() * next());
                let correlation = 1.8 * next() - 0.9;
                Lobe {
                    weight: next(),
                    mean: Vec2::new(next(), next()),
                    covariance: [sx * sx, correlation * sx * sy, sy * sy],
                }
            });
            let place = RecordPlace {
                position,
                normal,
                radius: 0.2 * (max - min).length(),
            };
            let irradiance = Rgb::new(next(), next(), next());
            (
                place,
                irradiance,
                Mixture::new(&lobes, 0.01, Domain::Square),
            )
        });
        Self::new(known.collect())
    }
}

impl LocalMixture<'_> {
    /// Incident flux per area, in W/m^2.
    pub fn irradiance(&self) -> Rgb {
        self.known.irradiance
    }

    /// A direction of the record's hemisphere. `select` chooses the lobe, `u` the place in it, both
    /// uniform.
    #[inline]
    pub fn sample(&self, select: f32, u: Vec2) -> GuideSample {
        let local = square::to_hemisphere(self.known.mixture.sample(select, u));
        let direction = self.frame.to_world(local).normalize();
        // The density of the direction as it is after rounding; on the horizon itself of the point.
        let place = square::to_square(self.frame.to_local(direction));
        let place = place.or_else(|| square::to_square(Vec3::new(local.x, local.y, 0.0)));
        let density = self.known.mixture.density(place.unwrap_or(Vec2::ZERO));
        GuideSample {
            direction,
            pdf: density * square::DENSITY,
        }
    }

    /// Solid-angle density of [`LocalMixture::sample`]: positive in the record's hemisphere, 0
    /// below it.
    #[inline]
    pub fn pdf(&self, w: Vec3) -> f32 {
        match square::to_square(self.frame.to_local(w)) {
            Some(place) => self.known.mixture.density(place) * square::DENSITY,
            None => 0.0,
        }
    }
}
