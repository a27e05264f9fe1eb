//! What the metallic-roughness model consists of: the parameters of glTF's extensions, and what
//! becomes of them at a point.

use crate::bsdf::facet_albedo::AlbedoCurve;
use crate::bsdf::fresnel::contrast;
use crate::bsdf::microfacet::{Distribution, Microfacet};
use crate::bsdf::model::Lookup;
use crate::bsdf::thin_film::ThinFilm;
use crate::math::{Rgb, Vec2};
use crate::texture::Texture;

/// Facets that are wider along one direction.
#[derive(Clone, Debug)]
pub struct Anisotropy {
    /// How much: at 1 the facets along the direction are as rough as can be.
    pub strength: f32,
    /// The direction from the tangent to the bitangent, radians.
    pub rotation: f32,
    /// Raw image: the direction `(x, y) * 0.5 + 0.5` before it is turned, and a factor on the
    /// strength.
    pub map: Texture,
    /// The bitangent points down the image.
    pub mirrored: bool,
}

/// A thin film.
#[derive(Clone, Debug)]
pub struct Film {
    /// How much of the surface has it.
    pub strength: Texture,
    /// Its index of refraction, 1 or more.
    pub eta: f32,
    /// Its thickness, nanometres.
    pub thickness: Texture,
}

/// Light that a diffuse base lets through.
#[derive(Clone, Debug)]
pub struct DiffuseTransmission {
    /// The share of the base's light that goes through.
    pub share: Texture,
    /// Its colour.
    pub color: Texture,
}

impl Anisotropy {
    /// The facets at a point, and the direction along which they are wide.
    pub(super) fn facets(&self, at: &Lookup, roughness: f32) -> (Microfacet, Vec2) {
        let map = at.color(&self.map);
        let y = if self.mirrored {
            0.5 - map.y
        } else {
            map.y - 0.5
        };
        let along = Vec2::new(map.x - 0.5, y).normalize_or(Vec2::X);
        let along = Vec2::from_angle(self.rotation).rotate(along);
        let strength = (self.strength * map.z).clamp(0.0, 1.0);
        let narrow = (roughness * roughness).max(SMOOTHEST);
        let wide = narrow + (1.0 - narrow) * strength * strength;
        (Microfacet::new(Distribution::Ggx, wide, narrow), along)
    }
}

/// The narrowest facets: smoother ones are mirrors, which this model has not.
pub(super) const SMOOTHEST: f32 = 1e-3;

/// The reflectance of a dielectric as a linear function of Fresnel's: `offset + slope R`. The
/// specification's `specular (f0 + (1 - f0) (1 - cos)^5)`, with Fresnel's own curve between the
/// reflectance at normal incidence, which the colour changes, and that at grazing angles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflectance {
    pub offset: Rgb,
    pub slope: Rgb,
}

impl Reflectance {
    pub fn new(eta: f32, specular: f32, color: Rgb) -> Self {
        let fresnel = contrast(eta) * contrast(eta);
        let normal = (color.max(Rgb::ZERO) * fresnel).min(Rgb::ONE);
        let slope = (Rgb::ONE - normal) / (1.0 - fresnel).max(1e-6);
        Self {
            offset: (normal - slope * fresnel) * specular,
            slope: slope * specular,
        }
    }

    #[inline]
    pub fn of(&self, fresnel: f32) -> Rgb {
        self.offset + self.slope * fresnel
    }
}

/// How much of the light the facets of the dielectric send back: their albedo, which follows their
/// reflectance linearly.
#[derive(Clone, Copy, Debug)]
pub(super) struct FacetsAlbedo {
    curve: AlbedoCurve,
    offset: f32,
    slope: f32,
}

impl FacetsAlbedo {
    pub fn new(
        curve: AlbedoCurve,
        dielectric: &Reflectance,
        eta: f32,
        film: Option<ThinFilm>,
    ) -> Self {
        // The base must not show through where any channel reflects: the largest counts.
        let (mut offset, mut slope) = (
            dielectric.offset.max_element(),
            dielectric.slope.min_element(),
        );
        if let Some(film) = film {
            let fresnel = contrast(eta) * contrast(eta);
            let bare = dielectric.of(fresnel);
            let normal = film.over(bare, bare, 1.0).max_element();
            slope = (1.0 - normal) / (1.0 - fresnel).max(1e-6);
            offset = normal - slope * fresnel;
        }
        Self {
            curve,
            offset,
            slope,
        }
    }

    #[inline]
    fn with(&self, of: impl Fn(&AlbedoCurve) -> f32) -> f32 {
        let facets = self.slope * of(&self.curve);
        if self.offset == 0.0 {
            return facets;
        }
        facets + self.offset * of(&self.curve.of_mirrors())
    }

    /// Seen from the given cosine, 0 to 1.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        self.with(|curve| curve.at(cos))
    }

    /// Under light from everywhere.
    pub fn mean(&self) -> f32 {
        self.with(AlbedoCurve::mean)
    }
}
