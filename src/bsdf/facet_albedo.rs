//! How much of the light that arrives from one direction the rough facets of a dielectric send
//! back: a table for the base that lies beneath them.
//!
//! The albedo of GGX facets with height-correlated masking, over the cosine, the perceptual
//! roughness (the square root of alpha) and the contrast of the interface, `(eta - 1) / (eta + 1)`:
//! in its square, the reflectance at normal incidence, the albedo has a kink at 0 that no straight
//! line follows. One table of 14 KB serves all materials; it is made when the first of them is
//! added.

use super::fresnel::{dielectric, reflect};
use super::material::Distribution;
use super::microfacet::Microfacet;
use super::transmittance::{gauss_legendre, over_normals};
use crate::math::Vec3;
use glam::FloatExt;
use std::sync::OnceLock;

/// Cosines 0 to 1.
const COSINES: usize = 24;
/// Roughnesses 0 to 1.
const ROUGHNESSES: usize = 16;
/// Contrasts: denser where materials are.
const CONTRASTS: [f32; 9] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.45, 0.7, 1.0];
/// Points of the quadrature on each axis.
const NODES: usize = 16;

type Plane = [[f32; COSINES]; ROUGHNESSES];

/// Albedos of facets.
#[derive(Debug)]
pub(super) struct FacetAlbedo {
    planes: Box<[Plane]>,
    /// Under light from everywhere.
    means: Box<[[f32; ROUGHNESSES]]>,
}

/// The albedos of the facets of one surface: a place in the table.
#[derive(Clone, Copy, Debug)]
pub(super) struct AlbedoCurve {
    table: &'static FacetAlbedo,
    /// Entries before the contrast and before the roughness.
    first: [u16; 2],
    /// How far beyond them.
    beyond: [f32; 2],
}

/// The table, made at its first use.
pub(super) fn facet_albedo() -> &'static FacetAlbedo {
    static TABLE: OnceLock<FacetAlbedo> = OnceLock::new();
    TABLE.get_or_init(FacetAlbedo::integrate)
}

/// The relative index, above 1, of an interface of that contrast.
fn index_of(contrast: f32) -> f32 {
    let contrast = contrast.min(0.999);
    (1.0 + contrast) / (1.0 - contrast)
}

impl FacetAlbedo {
    fn integrate() -> Self {
        let rule = gauss_legendre::<NODES>();
        let plane = |&contrast: &f32| {
            let eta = index_of(contrast);
            let mut plane = [[0.0; COSINES]; ROUGHNESSES];
            for (i, row) in plane.iter_mut().enumerate() {
                let roughness = i as f32 / (ROUGHNESSES - 1) as f32;
                let alpha = roughness * roughness;
                let facets = Microfacet::new(Distribution::Ggx, alpha, alpha);
                for (j, albedo) in row.iter_mut().enumerate() {
                    let cos = (j as f32 / (COSINES - 1) as f32).max(1e-3);
                    let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
                    *albedo = over_normals(&facets, wo, &rule, |m| {
                        let wi = reflect(wo, m);
                        facets.shadowing(wo, wi, m) * dielectric(wo.dot(m), eta).r
                    });
                }
            }
            plane
        };
        let planes: Box<[Plane]> = CONTRASTS.iter().map(plane).collect();
        let means = planes.iter().map(|plane| plane.map(mean)).collect();
        Self { planes, means }
    }

    /// For facets of that perceptual roughness on an interface of that contrast.
    pub fn curve(&'static self, roughness: f32, contrast: f32) -> AlbedoCurve {
        let last = CONTRASTS.len() - 2;
        let k = CONTRASTS[1..=last].partition_point(|&c| c <= contrast);
        let (low, high) = (CONTRASTS[k], CONTRASTS[k + 1]);
        let x = roughness.clamp(0.0, 1.0) * (ROUGHNESSES - 1) as f32;
        let i = (x as usize).min(ROUGHNESSES - 2);
        AlbedoCurve {
            table: self,
            first: [k as u16, i as u16],
            beyond: [
                ((contrast - low) / (high - low)).clamp(0.0, 1.0),
                x - i as f32,
            ],
        }
    }
}

/// Twice the integral of albedo times cosine, the albedo linear between the entries.
fn mean(row: [f32; COSINES]) -> f32 {
    let step = 1.0 / (COSINES - 1) as f32;
    let part = |(j, pair): (usize, &[f32])| {
        let x = j as f32 * step;
        (pair[0] * (3.0 * x + step) + pair[1] * (3.0 * x + 2.0 * step)) * step * (1.0 / 3.0)
    };
    row.windows(2).enumerate().map(part).sum()
}

impl AlbedoCurve {
    /// Albedo seen from the given cosine, 0 to 1.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        let x = cos.clamp(0.0, 1.0) * (COSINES - 1) as f32;
        let j = (x as usize).min(COSINES - 2);
        self.between(|k, i| {
            let row = &self.table.planes[k][i];
            row[j].lerp(row[j + 1], x - j as f32)
        })
    }

    /// The albedos of facets as rough that reflect everything.
    pub fn of_mirrors(&self) -> Self {
        Self {
            first: [(CONTRASTS.len() - 2) as u16, self.first[1]],
            beyond: [1.0, self.beyond[1]],
            ..*self
        }
    }

    /// Albedo under light from everywhere.
    #[inline]
    pub fn mean(&self) -> f32 {
        self.between(|k, i| self.table.means[k][i])
    }

    #[inline]
    fn between(&self, of: impl Fn(usize, usize) -> f32) -> f32 {
        let [k, i] = self.first.map(usize::from);
        let [t, s] = self.beyond;
        let plane = |k: usize| of(k, i).lerp(of(k, i + 1), s);
        plane(k).lerp(plane(k + 1), t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::fresnel::contrast;

    #[test]
    fn smooth_facets_reflect_as_fresnel_says() {
        for eta in [1.2, 1.5, 2.0] {
            let curve = facet_albedo().curve(0.0, contrast(eta));
            for i in 6..COSINES {
                let cos = i as f32 / (COSINES - 1) as f32;
                let exact = dielectric(cos, eta).r;
                assert!((curve.at(cos) - exact).abs() < 4e-3, "{eta} {cos}");
            }
        }
        // Of diffuse light an interface of index 1.5 reflects 9.2 % (Egan and Hilgeman 1973).
        let mean = facet_albedo().curve(0.0, contrast(1.5)).mean();
        assert!((mean - 0.092).abs() < 0.004, "{mean}");
    }

    #[test]
    fn albedos_lie_between_nothing_and_all() {
        for roughness in [0.0, 0.3, 0.77, 1.0] {
            for contrast in [0.0, 0.07, 0.2, 0.7, 1.0] {
                let curve = facet_albedo().curve(roughness, contrast);
                for i in 0..=100 {
                    let albedo = curve.at(i as f32 / 100.0);
                    assert!((0.0..=1.001).contains(&albedo), "{roughness} {contrast}");
                }
            }
        }
    }
}
