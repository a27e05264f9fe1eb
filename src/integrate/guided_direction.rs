//! How a guided path goes on from a vertex: in which directions, and whether roulette lets it.

use super::direction::{drops, record_departure, spawn_ray};
use super::guided_path::{GuidedPath, NO_ROUGH_VERTEX, PrefixState};
use super::manifold::{LastRoughVertex, Receiver, SpecularChain};
use super::observer::PathObserver;
use super::path::Arrival;
use super::roulette;
use super::settings::{PathSettings, Roulette};
use super::vertex::Vertex;
use crate::accel::Ray;
use crate::bsdf::{BsdfSample, LobeFlags, Rest, Transport};
use crate::math::{Rgb, Vec2};

/// How the smooth lobes of a vertex are followed.
#[derive(Clone, Copy)]
pub(super) struct DirectionSplit {
    /// Directions in which the path goes on.
    pub factor: u32,
    /// What each is expected to bring by the field, if the field can tell and is to be asked.
    expected: Option<f32>,
}

impl DirectionSplit {
    /// For a path that has just come to a vertex.
    #[inline]
    pub fn decide(settings: &PathSettings, vertex: &Vertex, path: &GuidedPath) -> Self {
        let asks = settings.guided.roulette == Roulette::Field;
        let reflected = vertex.guided.filter(|_| asks).and_then(|g| g.reflected());
        let Some(reflected) = reflected else {
            return Self {
                factor: 1,
                expected: None,
            };
        };
        let expected = |throughput: Rgb| (throughput * reflected).element_sum();
        let factor = roulette::split_factor(path, expected(path.base.throughput));
        Self {
            factor,
            expected: Some(expected(path.base.throughput / factor as f32)),
        }
    }
}

/// A vertex of a guided path, and how the path goes on from there.
pub(super) struct GuidedDeparture<'v, 's> {
    pub vertex: Vertex<'v, 's>,
    /// The lobes among which the path's own direction is drawn.
    pub lobes: Rest,
    /// Into how many directions.
    pub split: DirectionSplit,
    /// The number of the prefix that ends here.
    pub prefix: Option<u32>,
    /// Where manifold next-event estimation samples from, and with which probability.
    pub receiver: Option<(Receiver, f32)>,
    /// Distance from the vertex before.
    pub distance: f32,
}

impl GuidedDeparture<'_, '_> {
    /// Whether a path leaves its first rough vertex here, and for certain in one direction that is
    /// drawn from a density: among smooth lobes alone, with nothing to end or split it.
    #[inline]
    pub fn ends_prefix(&self, settings: &PathSettings, path: &GuidedPath) -> bool {
        let first = path.prefix == PrefixState::Growing && self.vertex.guided.is_some();
        let smooth = self.lobes != Rest::ALL || !self.vertex.bsdf.flags().has(LobeFlags::DELTA);
        // What roulette will say.
        let certain = match self.split.expected {
            Some(_) => path.pixel_estimate <= 0.0,
            None => path.base.depth + 1 < settings.rr_depth,
        };
        first && smooth && certain && self.split.factor == 1
    }

    /// The next ray, by a direction that is to be drawn or by `lobe`, if that is drawn already.
    /// `None` if the path ends.
    #[inline(always)]
    pub fn go(
        &self,
        settings: &PathSettings,
        path: &mut GuidedPath,
        (arrival, lobe, u_roulette): (&Arrival, Option<BsdfSample>, f32),
        rough_vertices: &mut Vec<LastRoughVertex>,
        observer: &mut impl PathObserver,
    ) -> Option<Ray> {
        let sampled = self.sample(settings, path, lobe, u_roulette);
        if lobe.is_none() {
            let whole = self.split.factor == 1;
            let (vertex, base) = (&self.vertex, &path.base);
            record_departure(vertex, whole, base, arrival, sampled.as_ref(), observer);
        }
        Some(self.leave(path, &sampled?.0, rough_vertices))
    }

    /// The next direction, of the mixture of BSDF and field (or `lobe`, if that is drawn already),
    /// and the probability with which roulette let the path take it, both already part of the
    /// throughput.
    #[inline(always)]
    fn sample(
        &self,
        settings: &PathSettings,
        path: &mut GuidedPath,
        lobe: Option<BsdfSample>,
        u_roulette: f32,
    ) -> Option<(BsdfSample, f32)> {
        let Vertex {
            bsdf, wo, guided, ..
        } = self.vertex;
        let u = path.base.sampler.next4();
        path.base.depth += 1;
        let sample = match (lobe, guided) {
            (Some(lobe), _) => lobe,
            (None, Some(guided)) => guided.sample(bsdf, wo, u)?,
            (None, None) => {
                let u_lobe = self.lobes.choose(u[0]);
                bsdf.sample(wo, u_lobe, Vec2::new(u[1], u[2]), Transport::Radiance)?
            }
        };
        if drops(settings, &self.vertex, sample.wi) {
            return None;
        }
        path.base.throughput *= sample.weight;
        // Underflown: whatever it would meet counts for nothing (S21).
        if path.base.throughput == Rgb::ZERO {
            return None;
        }
        path.base.eta *= sample.eta;
        let by_field = guided.is_some() && settings.guided.roulette == Roulette::Field;
        // What the field expects comes by the smooth lobes.
        let expected = self.split.expected.filter(|_| lobe.is_none());
        let most = roulette::most(&self.vertex);
        let survival = match expected {
            Some(expected) => roulette::by_field(path, expected),
            None if path.base.depth < settings.rr_depth => 1.0,
            None if by_field => most,
            None => roulette::by_throughput(&path.base, path.reference_throughput, most),
        };
        if u_roulette >= survival {
            return None;
        }
        path.base.throughput /= survival;
        if by_field {
            path.reference_throughput = roulette::scaled_throughput(&path.base);
        }
        Some((sample, survival))
    }

    /// The ray along a sampled direction; keeps what later vertices need to know of this one.
    #[inline(always)]
    fn leave(
        &self,
        path: &mut GuidedPath,
        sample: &BsdfSample,
        rough_vertices: &mut Vec<LastRoughVertex>,
    ) -> Ray {
        if sample.lobe.has(LobeFlags::DELTA) {
            path.chain = path.chain.then(sample.lobe);
        } else {
            path.chain = SpecularChain::EMPTY;
            path.rough_vertex = NO_ROUGH_VERTEX;
            if let Some((receiver, probability)) = self.receiver {
                path.rough_vertex = rough_vertices.len() as u32;
                rough_vertices.push(LastRoughVertex {
                    receiver,
                    dir: sample.wi,
                    pdf: sample.pdf,
                    probability,
                });
            }
            path.prefix = self.prefix.map_or(PrefixState::Past, PrefixState::EndsHere);
        }
        spawn_ray(&self.vertex, &mut path.base, sample, self.distance)
    }
}
