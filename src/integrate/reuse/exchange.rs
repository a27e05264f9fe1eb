//! Groups of stems that take light from each other's suffixes.

use super::stem::{Stem, Suffix, is_shareable};
use crate::accel::Ray;
use crate::bsdf::Transport;
use crate::integrate::next_event::{crosses, shadow_ray};
use crate::integrate::vertex::Walk;
use crate::integrate::wave::Outcome;
use crate::math::Rgb;
use crate::math::offset::offset_origin;

/// What a sample gets of what was found behind a stem.
pub(super) struct Gift {
    /// The account of the suffix.
    pub slot: u32,
    /// The sample.
    pub sample: u32,
    /// Whether the sample found it itself.
    pub is_own: bool,
    /// Factor for the account's radiance.
    pub weight: Rgb,
}

/// A stem that could have drawn the vertex of a suffix.
struct Link {
    /// The stem that did, and this one.
    stems: [u32; 2],
    /// What the stem came with, times BSDF and cosine, relative to how the suffix's own stem sees
    /// its vertex.
    throughput: Rgb,
    /// Solid angle that a unit of area at the vertex takes.
    area: f64,
    /// Density with which it would have been drawn, unit area.
    density: f64,
}

/// Makes groups meet.
pub(super) struct Exchange<'e, 's> {
    walk: &'e Walk<'s>,
    stems: &'e [Stem<'s>],
    /// Who gets what.
    pub gifts: Vec<Gift>,
    /// Rays between stems and suffixes.
    pub rays_traced: u64,
    links: Vec<Link>,
    rays: Vec<Ray>,
    blocked: Vec<bool>,
}

impl<'e, 's> Exchange<'e, 's> {
    pub fn new(walk: &'e Walk<'s>, stems: &'e [Stem<'s>]) -> Self {
        Self {
            walk,
            stems,
            gifts: Vec::new(),
            rays_traced: 0,
            links: Vec::new(),
            rays: Vec::new(),
            blocked: Vec::new(),
        }
    }

    /// Shares the suffixes of a group of stems, whose accounts are complete. Those that brought no
    /// light are passed over.
    pub fn meet(&mut self, group: &[u32], outcomes: &[Outcome]) {
        self.links.clear();
        self.rays.clear();
        for &from in group {
            let Some(suffix) = &self.stems[from as usize].suffix else {
                continue;
            };
            if outcomes[suffix.slot as usize].radiance == Rgb::ZERO {
                continue;
            }
            let begin = (self.links.len(), self.rays.len());
            for &to in group {
                self.link(suffix, [from, to]);
            }
            // By rounding alone: a path that is not among those that could have found what it
            // found keeps it.
            if !self.links[begin.0..].iter().any(Link::is_own) {
                self.links.truncate(begin.0);
                self.rays.truncate(begin.1);
                self.gifts.push(Gift {
                    slot: suffix.slot,
                    sample: self.stems[from as usize].sample,
                    is_own: true,
                    weight: Rgb::ONE,
                });
            }
        }
        self.look();
        self.give();
    }

    /// Links a stem with a suffix, if it could have drawn its vertex. (Whether something is in
    /// between, [`Self::look`] asks for all links together.)
    fn link(&mut self, suffix: &Suffix, stems: [u32; 2]) {
        let stem = &self.stems[stems[1] as usize];
        let to = suffix.position - stem.position;
        let distance = to.length();
        let wi = to / distance;
        // (Not a number where they coincide.)
        if !wi.is_finite() || !suffix.faces(-wi) {
            return;
        }
        let strict = self.walk.settings.strict_normals;
        if strict && (crosses(stem.normals, wi) || crosses(stem.normals, stem.wo)) {
            return;
        }
        let (f, bsdf_pdf) = stem.bsdf.eval_pdf(stem.wo, wi, Transport::Radiance);
        // Behind it, mostly: nobody needs to ask the field.
        if f == Rgb::ZERO {
            return;
        }
        let throughput = stem.throughput * f;
        let pdf = stem.guided.pdf(wi, bsdf_pdf);
        let [own_view, view] = suffix.views(-wi);
        // The rule that decided about the suffix.
        if !is_shareable(throughput / pdf, view) {
            return;
        }
        let distance = f64::from(distance);
        let area = f64::from(suffix.normals[0].dot(wi).abs()) / (distance * distance);
        let link = Link {
            stems,
            throughput: throughput * (view / own_view),
            area,
            density: f64::from(pdf) * area,
        };
        if !link.is_own() {
            let origin = offset_origin(stem.position, stem.error, stem.normals[0], wi);
            self.rays.push(shadow_ray(origin, suffix.position));
        }
        self.links.push(link);
    }

    /// Takes the links away that something is in the way of.
    fn look(&mut self) {
        self.blocked.resize(self.rays.len(), false);
        let rays = &self.walk.scene.rays;
        rays.occluded_batch(&self.rays, &mut self.blocked);
        self.rays_traced += self.rays.len() as u64;
        let mut blocked = self.blocked.iter();
        self.links
            .retain(|link| link.is_own() || blocked.next() == Some(&false));
    }

    /// Divides what is behind every suffix among the stems that are linked with it.
    fn give(&mut self) {
        for links in self.links.chunk_by(|a, b| a.stems[0] == b.stems[0]) {
            let Some(suffix) = &self.stems[links[0].stems[0] as usize].suffix else {
                continue;
            };
            let density: f64 = links.iter().map(|link| link.density).sum();
            self.gifts.extend(links.iter().map(|link| Gift {
                slot: suffix.slot,
                sample: self.stems[link.stems[1] as usize].sample,
                is_own: link.is_own(),
                weight: link.brings(density) / suffix.throughput,
            }));
        }
    }
}

impl Gift {
    /// Pays it out of the accounts. What is not finite is for its own sample alone: there it is
    /// found again.
    pub fn pay(&self, outcomes: &mut [Outcome]) {
        let light = outcomes[self.slot as usize].radiance;
        if light.is_finite() || self.is_own {
            outcomes[self.sample as usize].radiance += self.weight * light;
        }
    }
}

impl Link {
    /// What the stem makes of a unit of light behind, where stems of this density together (its
    /// own in it) could have drawn the vertex. With its own alone that is what it makes of what it
    /// finds itself: no other path can bring it more.
    fn brings(&self, density: f64) -> Rgb {
        self.throughput * (self.area / density) as f32
    }

    /// Whether the stem drew the vertex itself.
    fn is_own(&self) -> bool {
        self.stems[0] == self.stems[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stems whose densities for a vertex are as far apart as can be.
    #[test]
    fn no_stem_gets_more_of_a_vertex_than_if_it_had_drawn_it_itself() {
        let links: Vec<Link> = (0..32)
            .map(|i| Link {
                stems: [7, i],
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
        let account = |radiance| Outcome {
            radiance: Rgb::splat(radiance),
            ..Outcome::default()
        };
        let mut outcomes = [account(0.0), account(0.0), account(2.0), account(f32::NAN)];
        for (slot, sample, is_own) in [(2, 0, false), (2, 1, true), (3, 0, false), (3, 1, true)] {
            let gift = Gift {
                slot,
                sample,
                is_own,
                weight: Rgb::splat(0.25),
            };
            gift.pay(&mut outcomes);
        }
        assert_eq!(outcomes[0].radiance, Rgb::splat(0.5));
        assert!(outcomes[1].radiance.is_nan());
    }
}
