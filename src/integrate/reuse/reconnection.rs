//! Groups of prefixes that take light from each other's suffixes.

use super::prefix::{PathPrefix, Suffix, is_shareable};
use crate::accel::Ray;
use crate::bsdf::Transport;
use crate::integrate::context::PathContext;
use crate::integrate::light_sums::LightSums;
use crate::integrate::next_event::shadow_ray;
use crate::math::Rgb;
use crate::math::frame::normals_disagree;
use crate::math::offset::offset_origin;

/// What a sample gets of what was found behind a prefix.
pub(super) struct Contribution {
    /// The accumulator of the suffix.
    pub accumulator: u32,
    /// The sample.
    pub sample: u32,
    /// Whether the sample found it itself.
    pub is_own: bool,
    /// Factor for the accumulator's radiance.
    pub weight: Rgb,
}

/// A prefix that could have drawn the vertex of a suffix.
struct Reconnection {
    /// The prefix that did, and this one.
    prefixes: [u32; 2],
    /// What the prefix came with, times BSDF, cosine and transmittance, relative to how the suffix's
    /// own prefix sees its vertex.
    throughput: Rgb,
    /// Solid angle that a unit of area at the vertex takes.
    area: f64,
    /// Density with which it would have been drawn, unit area.
    density: f64,
}

/// Makes groups meet.
pub(super) struct Reconnector<'e, 's> {
    context: &'e PathContext<'s>,
    prefixes: &'e [PathPrefix<'s>],
    /// Who gets what.
    pub contributions: Vec<Contribution>,
    /// Rays between prefixes and suffixes.
    pub rays_traced: u64,
    links: Vec<Reconnection>,
    rays: Vec<Ray>,
    blocked: Vec<bool>,
}

impl<'e, 's> Reconnector<'e, 's> {
    pub fn new(context: &'e PathContext<'s>, prefixes: &'e [PathPrefix<'s>]) -> Self {
        Self {
            context,
            prefixes,
            contributions: Vec::new(),
            rays_traced: 0,
            links: Vec::new(),
            rays: Vec::new(),
            blocked: Vec::new(),
        }
    }

    /// Shares the suffixes of a group of prefixes, whose accumulators are complete. Those that
    /// brought no light are passed over.
    pub fn meet(&mut self, group: &[u32], radiances: &[Rgb]) {
        self.links.clear();
        self.rays.clear();
        for &from in group {
            let Some(suffix) = &self.prefixes[from as usize].suffix else {
                continue;
            };
            if radiances[suffix.accumulator as usize] == Rgb::ZERO {
                continue;
            }
            let begin = (self.links.len(), self.rays.len());
            for &to in group {
                self.link(suffix, [from, to]);
            }
            // By rounding alone: a path that is not among those that could have found what it
            // found keeps it.
            if !self.links[begin.0..].iter().any(Reconnection::is_own) {
                self.links.truncate(begin.0);
                self.rays.truncate(begin.1);
                self.contributions.push(Contribution {
                    accumulator: suffix.accumulator,
                    sample: self.prefixes[from as usize].sample,
                    is_own: true,
                    weight: Rgb::ONE,
                });
            }
        }
        self.look();
        self.give();
    }

    /// Links a prefix with a suffix, if it could have drawn its vertex. (Whether something is in
    /// between, [`Self::look`] asks for all links together.)
    fn link(&mut self, suffix: &Suffix, prefixes: [u32; 2]) {
        let prefix = &self.prefixes[prefixes[1] as usize];
        let to = suffix.position - prefix.position;
        let distance = to.length();
        let wi = to / distance;
        // (Not a number where they coincide.)
        if !wi.is_finite() || !suffix.faces(-wi) {
            return;
        }
        let strict = self.context.settings.strict_normals;
        if strict && normals_disagree(prefix.normals, [wi, prefix.wo]) {
            return;
        }
        let (f, bsdf_pdf) = prefix.bsdf.eval_pdf(prefix.wo, wi, Transport::Radiance);
        // Behind it, mostly: nobody needs to ask the field.
        if f == Rgb::ZERO {
            return;
        }
        let passed = prefix.transmittance(self.context.scene, wi, distance);
        let throughput = prefix.throughput * f * passed;
        let pdf = prefix.guided.pdf(wi, bsdf_pdf);
        let [own_view, view] = suffix.views(-wi);
        // The rule that decided about the suffix.
        if !is_shareable(throughput / pdf, view) {
            return;
        }
        let distance = f64::from(distance);
        let area = f64::from(suffix.normals[0].dot(wi).abs()) / (distance * distance);
        let link = Reconnection {
            prefixes,
            throughput: throughput * (view / own_view),
            area,
            density: f64::from(pdf) * area,
        };
        if !link.is_own() {
            let origin = offset_origin(prefix.position, prefix.error, prefix.normals[0], wi);
            self.rays.push(shadow_ray(origin, suffix.position));
        }
        self.links.push(link);
    }

    /// Takes the links away that something is in the way of.
    fn look(&mut self) {
        self.blocked.resize(self.rays.len(), false);
        let rays = &self.context.scene.rays;
        rays.occluded_batch(&self.rays, &mut self.blocked);
        self.rays_traced += self.rays.len() as u64;
        let mut blocked = self.blocked.iter();
        self.links
            .retain(|link| link.is_own() || blocked.next() == Some(&false));
    }

    /// Divides what is behind every suffix among the prefixes that are linked with it.
    fn give(&mut self) {
        for links in self.links.chunk_by(|a, b| a.prefixes[0] == b.prefixes[0]) {
            let Some(suffix) = &self.prefixes[links[0].prefixes[0] as usize].suffix else {
                continue;
            };
            let density: f64 = links.iter().map(|link| link.density).sum();
            self.contributions
                .extend(links.iter().map(|link| Contribution {
                    accumulator: suffix.accumulator,
                    sample: self.prefixes[link.prefixes[1] as usize].sample,
                    is_own: link.is_own(),
                    weight: link.brings(density) / suffix.throughput,
                }));
        }
    }
}

impl Contribution {
    /// Pays it out of the accumulators. What is not finite is for its own sample alone: there it is
    /// found again.
    pub fn pay(&self, radiances: &mut [Rgb], parts: Option<&mut LightSums>) {
        let (from, to) = (self.accumulator as usize, self.sample as usize);
        let light = radiances[from];
        if light.is_finite() || self.is_own {
            radiances[to] += self.weight * light;
            if let Some(parts) = parts {
                parts.pass(from, to, self.weight);
            }
        }
    }
}

impl Reconnection {
    /// What the prefix makes of a unit of light behind, where prefixes of this density together
    /// (its own in it) could have drawn the vertex. With its own alone that is what it makes of
    /// what it finds itself: no other path can bring it more.
    fn brings(&self, density: f64) -> Rgb {
        self.throughput * (self.area / density) as f32
    }

    /// Whether the prefix drew the vertex itself.
    fn is_own(&self) -> bool {
        self.prefixes[0] == self.prefixes[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Prefixes whose densities for a vertex are as far apart as can be.
    #[test]
    fn no_stem_gets_more_of_a_vertex_than_if_it_had_drawn_it_itself() {
        let links: Vec<Reconnection> = (0..32)
            .map(|i| Reconnection {
                prefixes: [7, i],
                throughput: Rgb::new(1.0, 0.5, 2.0) * 10f32.powi(i as i32 % 5 - 2),
                area: 0.3 * f64::from(1 + i % 3),
                density: 10f64.powi(i as i32 % 7 - 3),
            })
            .collect();
        let density: f64 = links.iter().map(|link| link.density).sum();
        let mut shares = 0.0;
        for link in &links {
            let (shared, alone) = (link.brings(density), link.brings(link.density));
            assert!(shared.cmple(alone).all(), "{shared} {alone}");
            shares += f64::from(shared.x / alone.x);
        }
        assert!((shares - 1.0).abs() < 1e-5, "the weights come to {shares}");
    }

    #[test]
    fn what_is_not_finite_is_kept_from_others() {
        let mut radiances = [0.0, 0.0, 2.0, f32::NAN].map(Rgb::splat);
        for (accumulator, sample, is_own) in
            [(2, 0, false), (2, 1, true), (3, 0, false), (3, 1, true)]
        {
            let contribution = Contribution {
                accumulator,
                sample,
                is_own,
                weight: Rgb::splat(0.25),
            };
            contribution.pay(&mut radiances, None);
        }
        assert_eq!(radiances[0], Rgb::splat(0.5));
        assert!(radiances[1].is_nan());
    }
}
