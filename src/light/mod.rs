//! Emitters: what shines, how it is sampled from a point (next-event estimation) and how photons
//! leave it.
//!
//! Lights fall into two sets. *Local* ones are in the scene: triangles, exact shapes, points. They
//! are the leaves of a light tree (`tree.rs`), so that choosing among a million takes seven steps.
//! *Distant* ones are outside: images, skies, suns, parallel light; there are few, and each knows
//! what it may send to a surface with a given normal. Which set a sample comes from follows both
//! estimates at the point.
//!
//! Every probability depends on the point and its normal alone, and `pdf_*` computes it from them
//! with the operations that `sample` uses: the densities agree to rounding.

use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::SurfacePoint;

mod analytic;
mod area;
mod beside;
mod blocks;
mod build;
mod caustic_emitter;
mod caustic_emitters;
mod cluster;
mod description;
mod distant;
mod emission;
mod environment;
mod equal_area;
mod goniometric;
mod incident;
mod latlong;
mod leaf;
mod local;
mod nearby;
mod point;
mod projector;
mod quad;
mod selection;
mod source;
mod sphere;
mod spot;
mod sun;
mod sunsky;
mod target;
#[cfg(test)]
mod tests;
mod tree;
mod tree_build;
mod triangle;

pub use beside::{Collision, DrawnDistance, LitSegment};
pub use caustic_emitter::{CausticEmitter, Shining};
pub use description::{Emitter, EmitterShape, Falloff, Slide, SunSky};
pub use emission::Emission;
pub use environment::{EnvironmentImage, Layout};
pub use selection::{CHILDREN, ClusterFactors, LightSelection};
pub use source::LightSource;

use area::{AreaEmitter, DARK};
use distant::{Distant, Drawn};
use leaf::Leaf;
use local::Local;

/// Index of an emitter in [`Lights`].
pub type EmitterId = u32;

/// A direction towards light, sampled from a point.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction from the point to the light.
    pub dir: Vec3,
    /// Distance to the sampled light point; infinite for environments and directional lights.
    pub distance: f32,
    /// What comes along `dir` if nothing is in between: [`Lights::radiance`] tells.
    pub incoming: Incoming,
    /// Density in solid angle, including the probability of choosing this emitter; for delta lights
    /// that probability alone.
    pub pdf: f32,
    /// The light has no extent (point, spot, directional): no BSDF sample can meet it.
    pub delta: bool,
    /// Leaf of the light tree; `None` for light from outside the scene.
    pub leaf: Option<u32>,
}

/// Light that a sample would bring. Most samples are blocked, and the texels of a map are far from
/// the processor: they are looked up for those that are not.
#[derive(Clone, Copy, Debug)]
pub struct Incoming(Source);

#[derive(Clone, Copy, Debug)]
enum Source {
    /// Known, of an emitter.
    Here(Rgb, EmitterId),
    /// Known, of all that shine from one direction outside the scene.
    Mixed(Rgb),
    /// By number in [`Lights::distant`].
    Distant(u32, Drawn),
}

/// All emitters of a scene, ready to sample.
#[derive(Debug)]
pub struct Lights {
    /// One for each emitter of the description; `None` for those that are no area lights.
    areas: Vec<Option<AreaEmitter>>,
    local: Option<Local>,
    distant: Vec<(EmitterId, Distant)>,
    emission: Option<emission::Sources>,
}

/// Least and greatest probability of the distant lights where both sets can send light: neither
/// estimate knows what is hidden.
const DISTANT_SHARE: [f32; 2] = [0.2, 0.8];

impl Lights {
    /// Samples a direction towards light from the point `p`. `n` is the surface normal there (zero
    /// where light from all sides counts). `selection` is what is known beside the light tree: `()`
    /// knows nothing. `u[0]` chooses the emitter, `u[1..3]` a point on it. `None` where no light
    /// can arrive.
    #[inline(always)]
    pub fn sample(
        &self,
        p: Vec3,
        n: Vec3,
        selection: &mut impl LightSelection,
        u: [f32; 3],
    ) -> Option<LightSample> {
        let place = Vec2::new(u[1], u[2]);
        let share = self.distant_share(p, n);
        let mut pick = u[0];
        let sample = if pick < share {
            pick /= share;
            self.sample_distant(n, share, pick, place)
        } else {
            pick = (pick - share) / (1.0 - share);
            self.sample_local((p, n), selection, 1.0 - share, pick, place)
        }?;
        let above = n == Vec3::ZERO || sample.dir.dot(n) > 0.0;
        // A density may underflow: a light that is never drawn brings nothing, and 0 / 0 is no
        // number.
        (above && sample.pdf > 0.0).then_some(sample)
    }

    /// Incident radiance along a sample's direction if nothing is in between. For delta lights the
    /// incident irradiance on a surface facing them (intensity over squared distance).
    #[inline]
    pub fn radiance(&self, incoming: &Incoming) -> Rgb {
        match &incoming.0 {
            Source::Here(radiance, _) | Source::Mixed(radiance) => *radiance,
            Source::Distant(number, drawn) => self.distant[*number as usize].1.radiance_of(drawn),
        }
    }

    /// Reads a word of everything that [`Lights::radiance`] will read for these samples. Called in
    /// advance for many in a row, so that the processor waits for all of them at once.
    #[inline]
    pub fn prefetch<'i>(&self, incoming: impl Iterator<Item = &'i Incoming>) {
        let mut sum = 0;
        for i in incoming {
            if let Source::Distant(number, Drawn::Map(patch)) = &i.0 {
                if let Distant::Map(map) = &self.distant[*number as usize].1 {
                    sum ^= map.prefetch(patch);
                }
            }
        }
        std::hint::black_box(sum);
    }

    /// Probability that [`Lights::sample`] draws from the distant lights.
    #[inline]
    fn distant_share(&self, p: Vec3, n: Vec3) -> f32 {
        let Some(local) = &self.local else { return 1.0 };
        if self.distant.is_empty() {
            return 0.0;
        }
        let far = self.distant_importance(n);
        if far <= 0.0 {
            return 0.0;
        }
        let near = local.tree.importance(p, n) * local.unit;
        if near <= 0.0 {
            return 1.0;
        }
        let [least, most] = DISTANT_SHARE;
        // Written as a ratio of one to the other, which cannot overflow to not a number.
        (1.0 / (1.0 + near / far)).clamp(least, most)
    }

    #[inline]
    fn distant_importance(&self, n: Vec3) -> f32 {
        self.distant.iter().map(|(_, d)| d.importance(n)).sum()
    }

    #[inline(always)]
    fn sample_local(
        &self,
        (p, n): (Vec3, Vec3),
        selection: &mut impl LightSelection,
        share: f32,
        pick: f32,
        u: Vec2,
    ) -> Option<LightSample> {
        let local = self.local.as_ref()?;
        let (index, probability) = local.choose((p, n), selection, pick, u)?;
        self.sample_chosen(local, p, (index, probability * share), u)
    }

    /// Samples a leaf that was chosen with a probability.
    #[inline(always)]
    fn sample_chosen(
        &self,
        local: &Local,
        p: Vec3,
        (index, probability): (usize, f32),
        u: Vec2,
    ) -> Option<LightSample> {
        let (emitter, leaf) = &local.leaves[index];
        let number = Some(index as u32);
        if let Some(incident) = leaf.sample(p, u) {
            let area = self.areas[*emitter as usize].as_ref()?;
            let q = p + incident.dir * incident.distance;
            return Some(LightSample {
                dir: incident.dir,
                distance: incident.distance,
                incoming: Incoming(Source::Here(
                    area.radiance_at(q, -incident.dir, incident.place),
                    *emitter,
                )),
                pdf: incident.pdf * probability,
                delta: false,
                leaf: number,
            });
        }
        let incident = leaf.delta(p)?;
        Some(LightSample {
            dir: incident.dir,
            distance: incident.distance,
            incoming: Incoming(Source::Here(incident.irradiance, *emitter)),
            pdf: probability,
            delta: true,
            leaf: number,
        })
    }

    #[inline]
    fn sample_distant(&self, n: Vec3, share: f32, pick: f32, u: Vec2) -> Option<LightSample> {
        let total = self.distant_importance(n);
        let mut rest = pick * total;
        let (mut chosen, mut weight) = (None, 0.0);
        for (i, (_, light)) in self.distant.iter().enumerate() {
            let w = light.importance(n);
            if w <= 0.0 {
                continue;
            }
            (chosen, weight) = (Some(i), w);
            if rest < w {
                break;
            }
            rest -= w;
        }
        let chosen = chosen?;
        let light = &self.distant[chosen].1;
        let (dir, drawn, pdf) = light.sample(n, u)?;
        let delta = light.is_delta();
        let mut pdf = if delta {
            weight / total
        } else {
            weight / total * pdf
        };
        let mut incoming = Incoming(Source::Distant(chosen as u32, drawn));
        if !delta && self.distant.len() > 1 {
            let mut radiance = light.radiance_of(&drawn);
            // A ray along `dir` meets all of them, and any might have drawn it.
            for (i, (_, other)) in self.distant.iter().enumerate() {
                if i != chosen && !other.is_delta() {
                    let (more, density) = other.radiance_pdf(n, dir);
                    radiance += more;
                    pdf += other.importance(n) / total * density;
                }
            }
            incoming = Incoming(Source::Mixed(radiance));
        }
        pdf *= share;
        (pdf > 0.0 && pdf.is_finite()).then_some(LightSample {
            dir,
            distance: f32::INFINITY,
            incoming,
            pdf,
            delta,
            leaf: None,
        })
    }

    /// Density (solid angle, selection included) with which [`Lights::sample`] at `p`, `n` draws
    /// the direction to the point `q` of triangle `prim` of area emitter `emitter`; `ng` is the
    /// unit geometric normal at `q`.
    #[inline]
    pub fn pdf_area(
        &self,
        (p, n): (Vec3, Vec3),
        selection: &impl LightSelection,
        (emitter, prim): (EmitterId, u32),
        (q, ng): (Vec3, Vec3),
    ) -> f32 {
        let (Some(local), Some(Some(area))) = (&self.local, self.areas.get(emitter as usize))
        else {
            return 0.0;
        };
        let (leaf, ng) = area.facing(prim, ng, p - q);
        if leaf == DARK || (n != Vec3::ZERO && n.dot(q - p) <= 0.0) {
            return 0.0;
        }
        let leaf = leaf as usize;
        let density = local.leaves[leaf].1.pdf(p, q, ng);
        if density <= 0.0 {
            return 0.0;
        }
        let share = 1.0 - self.distant_share(p, n);
        density * local.tree.probability(p, n, selection, leaf) * share
    }

    /// Radiance arriving from outside the scene along the ray direction `dir` (the sum over maps,
    /// skies, suns, constants), and the density (solid angle, selection included) with which
    /// [`Lights::sample`] at `p`, `n` draws it.
    #[inline]
    pub fn environment_pdf(&self, p: Vec3, n: Vec3, dir: Vec3) -> (Rgb, f32) {
        let total = self.distant_importance(n);
        let (mut radiance, mut density) = (Rgb::ZERO, 0.0);
        for (_, light) in &self.distant {
            let (more, pdf) = light.radiance_pdf(n, dir);
            radiance += more;
            let weight = light.importance(n);
            if weight > 0.0 {
                density += weight / total * pdf;
            }
        }
        let behind = n != Vec3::ZERO && n.dot(dir) <= 0.0;
        if behind || density <= 0.0 {
            return (radiance, 0.0);
        }
        (radiance, density * self.distant_share(p, n))
    }

    /// Radiance that area emitter `emitter` sends from `point` along `wo` (unit, away from the
    /// surface); 0 from a dark side.
    #[inline]
    pub fn emitted(&self, emitter: EmitterId, point: &SurfacePoint, wo: Vec3) -> Rgb {
        match self.areas.get(emitter as usize) {
            Some(Some(area)) if area.shines(point.ng.dot(wo)) => area.radiance(point),
            _ => Rgb::ZERO,
        }
    }

    /// Radiance arriving from outside the scene along the ray direction `dir` (the sum over
    /// environments).
    #[inline]
    pub fn environment(&self, dir: Vec3) -> Rgb {
        self.distant
            .iter()
            .fold(Rgb::ZERO, |sum, (_, d)| sum + d.radiance(dir))
    }

    /// Whether any light comes from outside the scene in a way that a ray can meet.
    pub fn has_environment(&self) -> bool {
        self.distant.iter().any(|(_, d)| !d.is_delta())
    }

    /// How many emitters there are (a mesh that glows counts once).
    pub fn len(&self) -> usize {
        self.areas.len()
    }

    /// Whether nothing shines.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes held by the light tree and by environments, without meshes and textures shared with
    /// the scene.
    pub fn memory_bytes(&self) -> usize {
        let local = self.local.as_ref().map_or(0, |l| {
            l.tree.memory_bytes() + l.leaves.len() * size_of::<(EmitterId, Leaf)>()
        });
        let distant: usize = self
            .distant
            .iter()
            .map(|(_, d)| match d {
                Distant::Map(map) => map.memory_bytes(),
                _ => size_of::<Distant>(),
            })
            .sum();
        local + distant
    }
}
