//! What guides paths: a learned field, and what was learned beside it.

use super::guided_vertex::{GuidedVertex, Local, is_guidable, side};
use super::manifold::ManifoldSampling;
use crate::bsdf::{Bsdf, LobeFlags};
use crate::guide::gmm::Mixtures;
use crate::guide::ppg::SdTree;
use crate::guide::{Cells, Chances, Field, FractionRecord, Fractions};
use crate::light::ClusterFactors;
use crate::math::{Rgb, Vec3};
use crate::texture::SurfacePoint;

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

    /// What a cell has learned of the light tree's clusters; nothing of
    /// [`NO_CELL`](super::path::NO_CELL).
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
        let factors = self.light_factors(local.cell());
        Some(GuidedVertex::new(local, irradiance, chances, factors))
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
