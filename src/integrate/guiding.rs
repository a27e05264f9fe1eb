//! Guided directions: the field's distribution at a vertex, mixed with the BSDF's.
//!
//! A direction is drawn from the field with probability `a` and from the BSDF otherwise; whichever
//! drew it, its density is the mixture `a p_field + (1 - a) p_bsdf` (one-sample multiple importance
//! sampling with the balance heuristic). Next-event estimation is joined to that mixture. The field
//! shapes densities only: whatever it says, the expected image is the same.

use super::manifold::ManifoldSampling;
use super::path::NO_CELL;
use crate::bsdf::{Bsdf, BsdfSample, LobeFlags, Rest, Transport};
use crate::guide::gmm::{LocalMixture, Mixtures};
use crate::guide::ppg::{LocalTree, SdTree};
use crate::guide::{
    Cells, Chances, Field, FractionRecord, Fractions, GuideSample, LearnedSelection, LightChoice,
    LocalField,
};
use crate::light::ClusterFactors;
use crate::math::rng::BELOW_ONE;
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::SurfacePoint;
use std::f32::consts::FRAC_1_PI;

/// Lobes narrower than this roughness find their light better by themselves.
const MIN_ROUGHNESS: f32 = 0.05;
/// Lobes of this roughness or more look nearly the same from all sides.
const MATT: f32 = 0.6;

/// A learned field, ready to guide.
#[derive(Debug)]
pub struct Guide<F = Field> {
    /// Where light comes from.
    pub field: F,
    /// How often to trust it.
    pub fractions: Fractions,
    /// Manifold next-event estimation, for suns and lamps that no direction of the field is narrow
    /// enough for.
    pub manifold: Option<ManifoldSampling>,
}

/// What guides paths: one of the representations of the light field.
#[derive(Clone, Copy, Debug)]
pub enum Guidance<'a> {
    /// The double hierarchy.
    Double(&'a Guide),
    /// Cached Gaussian mixtures, trusted half of the time everywhere.
    Gmm(&'a Mixtures),
    /// An SD-tree, that of practical path guiding.
    Ppg(&'a Guide<SdTree>),
}

impl<'a> From<&'a Guide> for Guidance<'a> {
    fn from(guide: &'a Guide) -> Self {
        Self::Double(guide)
    }
}

impl<'a> From<&'a Guide<SdTree>> for Guidance<'a> {
    fn from(guide: &'a Guide<SdTree>) -> Self {
        Self::Ppg(guide)
    }
}

impl<'a> From<&'a Mixtures> for Guidance<'a> {
    fn from(mixtures: &'a Mixtures) -> Self {
        Self::Gmm(mixtures)
    }
}

/// A field at one vertex.
#[derive(Clone)]
enum Local<'a> {
    Double(LocalField<'a>),
    Gmm(LocalMixture<'a>),
    Ppg(LocalTree<'a>),
}

impl Local<'_> {
    #[inline]
    fn pdf(&self, wi: Vec3) -> f32 {
        match self {
            Self::Double(field) => field.pdf(wi),
            Self::Gmm(mixture) => mixture.pdf(wi),
            Self::Ppg(tree) => tree.pdf(wi),
        }
    }

    /// Its cell.
    #[inline]
    fn cell(&self) -> u32 {
        match self {
            Self::Double(field) => field.cell(),
            Self::Gmm(_) => NO_CELL,
            Self::Ppg(tree) => tree.cell(),
        }
    }

    #[inline]
    fn sample(&self, select: Vec2, u: Vec2) -> GuideSample {
        match self {
            Self::Double(field) => field.sample(select, u),
            Self::Gmm(mixture) => mixture.sample(select.x, u),
            Self::Ppg(tree) => tree.sample(select.x, u),
        }
    }
}

/// The field at one vertex.
#[derive(Clone)]
pub struct GuidedVertex<'a> {
    local: Local<'a>,
    /// How often to draw from it, and how often to sample a light.
    chances: Chances,
    irradiance: Rgb,
    /// Radiance that the surface is expected to reflect, where it is matt, or the medium to
    /// scatter.
    reflected: Option<Rgb>,
    /// The lobes that are sampled here: all, or all but a delta lobe.
    lobes: Rest,
    /// What the cell knows of the light tree's clusters.
    light_factors: Option<&'a ClusterFactors>,
}

/// A path that was scattered more often than this is not guided in media. In a dense one it goes on
/// for hundreds of collisions, and no direction is better than others there. (A glass of juice,
/// 64 samples: 8.6 s and relMSE 0.029 guided everywhere, 3.4 s and 0.046 at surfaces alone.)
const MOST_SCATTERED: u32 = 3;

/// Whether a field could serve a material, or a medium where a path was scattered `depth` times: some
/// lobe is smooth and none too narrow.
#[inline]
pub fn is_guidable(bsdf: &Bsdf, depth: u32) -> bool {
    let flags = bsdf.flags();
    flags.has(LobeFlags::SMOOTH)
        && !(flags.has(LobeFlags::VOLUME) && depth > MOST_SCATTERED)
        && bsdf.roughness() >= MIN_ROUGHNESS
}

/// The side of a surface that a path comes from, as fields tell sides apart: the shading normal
/// there, or zero at a collision in a medium.
#[inline]
pub(super) fn side(point: &SurfacePoint, bsdf: &Bsdf, wo: Vec3) -> Vec3 {
    match bsdf.flags().has(LobeFlags::VOLUME) {
        true => Vec3::ZERO,
        false => point.facing(wo),
    }
}

/// Whether what a surface reflects by these lobes follows from the irradiance. A floor of roughness
/// 0.1 mirrors a bright gap of a door to some eyes; paths that came from there were ended nine
/// times in ten (relative variance of a sample in veach-ajar 7.0, now 6.0). Guarded by
/// `irradiance_speaks_for_matt_surfaces_alone`.
#[inline]
pub(super) fn is_matt(bsdf: &Bsdf, lobes: Rest) -> bool {
    bsdf.roughness() >= MATT && (lobes != Rest::ALL || !bsdf.flags().has(LobeFlags::DELTA))
}

impl<F: Cells> Guide<F> {
    /// A field that is trusted half of the time everywhere.
    pub fn new(field: F) -> Self {
        let fractions = Fractions::new(&field);
        Self {
            field,
            fractions,
            manifold: None,
        }
    }

    /// The same, drawing from the field with this probability everywhere, if one is given.
    pub fn with_mixture(self, share: Option<f32>) -> Self {
        let fractions = match share {
            Some(share) => self.fractions.with_share(share),
            None => self.fractions,
        };
        Self { fractions, ..self }
    }

    /// Learns how often to trust the field from what it has guided.
    pub fn learn_fractions(&mut self, parts: &[Vec<FractionRecord>]) {
        let parts: Vec<_> = parts.iter().map(|part| &part[..]).collect();
        self.fractions.update_in_parts(&self.field, &parts);
    }

    /// Guides by a field that refines this one; `share` as in [`Guide::with_mixture`].
    pub fn renew(&mut self, field: F, share: Option<f32>) {
        let fractions = self.fractions.carried_over(&self.field, &field);
        let manifold = self.manifold.take();
        let renewed = Self {
            field,
            fractions,
            manifold,
        };
        *self = renewed.with_mixture(share);
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        let chains = self.manifold.as_ref().map(|a| a.chains().bytes());
        self.field.bytes() + chains.unwrap_or(0)
    }

    /// Sets the rate of manifold next-event estimation, if there are chains to sample; 0 ends it.
    pub fn set_manifold_rate(&mut self, rate: f32) {
        let manifold = self.manifold.take().map(|m| m.with_rate(rate));
        self.manifold = manifold.filter(|_| rate > 0.0);
    }
}

impl<'a> Guidance<'a> {
    /// Manifold next-event estimation, if paths use it.
    #[inline]
    pub fn manifold(&self) -> Option<&'a ManifoldSampling> {
        match self {
            Self::Double(guide) => guide.manifold.as_ref(),
            Self::Ppg(guide) => guide.manifold.as_ref(),
            Self::Gmm(_) => None,
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Double(guide) => guide.bytes(),
            Self::Gmm(mixtures) => mixtures.bytes(),
            Self::Ppg(guide) => guide.bytes(),
        }
    }

    /// What a cell has learned of the light tree's clusters; nothing of [`NO_CELL`].
    #[inline]
    pub fn light_factors(&self, cell: u32) -> Option<&'a ClusterFactors> {
        match self {
            Self::Double(guide) => guide.fractions.light_factors(cell),
            Self::Ppg(guide) => guide.fractions.light_factors(cell),
            Self::Gmm(_) => None,
        }
    }

    /// What the field says at a vertex of a path that was scattered `depth` times, or nothing where it should not be asked: no smooth lobe, a
    /// lobe too narrow, no light known.
    #[inline]
    pub fn at(
        &self,
        point: &SurfacePoint,
        bsdf: &Bsdf,
        wo: Vec3,
        throughput: Rgb,
        depth: u32,
    ) -> Option<GuidedVertex<'a>> {
        if !is_guidable(bsdf, depth) {
            return None;
        }
        let (local, irradiance, chances) = match self {
            Self::Double(guide) => guide.ask(point, bsdf, wo, throughput)?,
            // The rivals know surfaces alone.
            _ if bsdf.flags().has(LobeFlags::VOLUME) => return None,
            Self::Ppg(guide) => guide.ask(point, bsdf, wo)?,
            Self::Gmm(mixtures) => {
                let mixture = mixtures.at(point.p, point.facing(wo))?;
                // Mixtures learn no chances of their own.
                (Local::Gmm(mixture), mixture.irradiance(), Chances::UNKNOWN)
            }
        };
        Some(GuidedVertex {
            light_factors: self.light_factors(local.cell()),
            local,
            chances,
            irradiance,
            reflected: None,
            lobes: Rest::ALL,
        })
    }
}

/// Where there is one, the normal above which all light comes that the surface sends on.
#[inline]
fn horizon(bsdf: &Bsdf, wo: Vec3) -> Option<Vec3> {
    let normal = bsdf.light_normal(wo);
    (normal != Vec3::ZERO).then_some(normal)
}

impl Guide<SdTree> {
    /// The same of an SD-tree.
    #[inline]
    fn ask(
        &self,
        point: &SurfacePoint,
        bsdf: &Bsdf,
        wo: Vec3,
    ) -> Option<(Local<'_>, Rgb, Chances)> {
        let normal = point.facing(wo);
        let local = self.field.at(point.p, normal, horizon(bsdf, wo))?;
        let chances = self.fractions.chances(local.cell());
        Some((Local::Ppg(local), local.irradiance(), chances))
    }
}

impl Guide {
    /// The field at a vertex, the irradiance there and the chances of what to do; nothing without
    /// light.
    #[inline]
    fn ask(
        &self,
        point: &SurfacePoint,
        bsdf: &Bsdf,
        wo: Vec3,
        throughput: Rgb,
    ) -> Option<(Local<'_>, Rgb, Chances)> {
        let side = side(point, bsdf, wo);
        let horizon = horizon(bsdf, wo);
        let local = self.field.at_side(point.p, side, horizon, throughput);
        if !local.has_light() {
            return None;
        }
        let chances = self.fractions.chances(local.cell());
        let irradiance = local.irradiance();
        Some((Local::Double(local), irradiance, chances))
    }
}

impl GuidedVertex<'_> {
    /// The same for these of the material's lobes: all, or all but a delta lobe that is followed
    /// beside them.
    #[inline]
    pub fn among(self, lobes: Rest, bsdf: &Bsdf) -> Self {
        let reflected = || match bsdf.flags().has(LobeFlags::VOLUME) {
            // Of the fluence. The albedo is part of the throughput already.
            true => self.irradiance * (0.25 * FRAC_1_PI),
            false => bsdf.albedo() * self.irradiance * FRAC_1_PI,
        };
        Self {
            lobes,
            reflected: is_matt(bsdf, lobes).then(reflected),
            ..self
        }
    }

    /// Radiance that the surface is expected to reflect: what roulette goes by. None where some
    /// lobe is narrow: the field's mean over directions says nothing about what shines in it.
    #[inline]
    pub fn reflected(&self) -> Option<Rgb> {
        self.reflected
    }

    /// How often to sample a light here.
    #[inline]
    pub fn light_probability(&self) -> f32 {
        self.chances.light
    }

    /// How to choose the light.
    #[inline]
    pub fn light_selection(&self) -> LearnedSelection<'_> {
        LearnedSelection {
            factors: self.light_factors,
            choice: LightChoice::NONE,
        }
    }

    /// The cell by which it is chosen: see [`Guidance::light_factors`].
    #[inline]
    pub fn light_cell(&self) -> u32 {
        self.local.cell()
    }

    /// Density of the field alone.
    #[inline]
    pub fn field_pdf(&self, wi: Vec3) -> f32 {
        self.local.pdf(wi)
    }

    /// Density of the BSDF alone, from that of the mixture.
    #[inline]
    pub fn bsdf_pdf(&self, mixture: f32, field: f32) -> f32 {
        ((mixture - self.chances.field * field) / (1.0 - self.chances.field)).max(0.0)
    }

    /// Density of the mixture for a direction to which the BSDF gives `bsdf_pdf`.
    #[inline]
    pub fn pdf(&self, wi: Vec3, bsdf_pdf: f32) -> f32 {
        self.mixture(self.local.pdf(wi), bsdf_pdf)
    }

    /// Density of the mixture from those of its parts.
    #[inline]
    fn mixture(&self, field: f32, bsdf: f32) -> f32 {
        let share = self.chances.field;
        share * field + (1.0 - share) * bsdf / self.lobes.chance
    }

    /// Draws a direction from the mixture. `u` are four uniform numbers.
    #[inline]
    pub fn sample(&self, bsdf: &Bsdf, wo: Vec3, u: [f32; 4]) -> Option<BsdfSample> {
        if u[0] < self.chances.field {
            let select = Vec2::new(u[0] / self.chances.field, u[3]);
            return self.sample_field(bsdf, wo, select, Vec2::new(u[1], u[2]));
        }
        let share = 1.0 - self.chances.field;
        let u_lobe = ((u[0] - self.chances.field) / share).min(BELOW_ONE);
        let u_lobe = self.lobes.choose(u_lobe);
        let mut sample = bsdf.sample(wo, u_lobe, Vec2::new(u[1], u[2]), Transport::Radiance)?;
        if sample.lobe.has(LobeFlags::DELTA) {
            sample.weight *= self.lobes.chance / share;
            sample.pdf *= share / self.lobes.chance;
            return Some(sample);
        }
        let pdf = self.pdf(sample.wi, sample.pdf);
        sample.weight *= sample.pdf / pdf;
        sample.pdf = pdf;
        Some(sample)
    }

    fn sample_field(&self, bsdf: &Bsdf, wo: Vec3, select: Vec2, u: Vec2) -> Option<BsdfSample> {
        let drawn = self.local.sample(select, u);
        let (value, bsdf_pdf) = bsdf.eval_pdf(wo, drawn.direction, Transport::Radiance);
        if value == Rgb::ZERO {
            return None;
        }
        let pdf = self.mixture(drawn.pdf, bsdf_pdf);
        // Guided directions cross no interface that would scale the throughput's eta: a transmitted
        // direction of a rough interface keeps roulette a little shorter-lived, which is unbiased.
        Some(BsdfSample {
            wi: drawn.direction,
            weight: value / pdf,
            pdf,
            eta: 1.0,
            lobe: LobeFlags::SMOOTH,
        })
    }
}
