//! The metallic-roughness model of glTF 2.0 (its specification's appendix B): a metal, a diffuse
//! base under rough dielectric facets, or as much of each as the file says. With what the extensions
//! of the format add to it: reflectances of other strength and colour (`KHR_materials_specular`),
//! brushed facets (`KHR_materials_anisotropy`), a thin film (`KHR_materials_iridescence`), and a
//! base that lets light through (`KHR_materials_diffuse_transmission`).
//!
//! Facets are GGX with height-correlated masking (Heitz 2014). The specification leaves open how
//! the base gives way to the facets. Here it keeps what they reflect, seen from both directions
//! (Kelemen and Szirmay-Kalos 2001): a factor `(1 - E(wo)) (1 - E(wi)) / (1 - E_mean)` with the
//! facets' albedo E. It is reciprocal, and a white base returns all light. E is that of facets
//! without direction, and of a film as it is seen from above.

pub use super::metallic_roughness_parts::{Anisotropy, DiffuseTransmission, Film};
use super::metallic_roughness_parts::{FacetsAlbedo, Reflectance, SMOOTHEST};
use super::principled_parts::schlick_weight;
use super::{
    GLOSSY_REFLECTION, GLOSSY_TRANSMISSION, Lobe, cosine_pdf, mean, sample_cosine, share,
    smooth_sample,
};
use crate::bsdf::facet_albedo::facet_albedo;
use crate::bsdf::fresnel::{contrast, dielectric, reflect, sane_eta};
use crate::bsdf::microfacet::{Distribution, Microfacet};
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::{Parameters, white};
use crate::bsdf::thin_film::ThinFilm;
use crate::bsdf::transmittance::RoughTransmittance;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;
use std::f32::consts::{FRAC_1_PI, PI};

/// Parameters of glTF 2.0's metallic-roughness model; each in `[0, 1]` unless said otherwise.
#[derive(Clone, Debug)]
pub struct MetallicRoughness {
    /// Colour of the diffuse base, and of the metal.
    pub base_color: Texture,
    /// 0 is the dielectric, 1 the metal.
    pub metallic: Texture,
    /// Perceptual roughness, the square root of the facets' width.
    pub roughness: Texture,
    /// Relative index of refraction of the dielectric, 1 or more.
    pub eta: f32,
    /// Factor on the dielectric's reflectance.
    pub specular: Texture,
    /// Factor on its reflectance at normal incidence, 0 or more.
    pub specular_color: Texture,
    /// Facets that are wider along one direction.
    pub anisotropy: Option<Anisotropy>,
    /// A film on all of it.
    pub film: Option<Film>,
    /// Light that the base lets through. The surface then has two sides alike.
    pub transmission: Option<DiffuseTransmission>,
}

impl MetallicRoughness {
    /// The model without extensions.
    pub fn plain(base_color: Texture, metallic: Texture, roughness: Texture, eta: f32) -> Self {
        Self {
            base_color,
            metallic,
            roughness,
            eta,
            specular: white(),
            specular_color: white(),
            anisotropy: None,
            film: None,
            transmission: None,
        }
    }
}

impl Model for MetallicRoughness {
    type Lobe = MetallicRoughnessLobe;

    fn read(_: &mut dyn Parameters) -> Result<Self, String> {
        Err("only glTF files have this model".into())
    }

    fn is_plugin() -> bool {
        false
    }

    fn lobe(&self, at: &Lookup) -> MetallicRoughnessLobe {
        let (color, roughness) = (at.color(&self.base_color), at.scalar(&self.roughness));
        let metallic = at.scalar(&self.metallic).clamp(0.0, 1.0);
        let eta = sane_eta(self.eta).max(1.0);
        let specular = at.scalar(&self.specular).clamp(0.0, 1.0);
        let dielectric = Reflectance::new(eta, specular, at.color(&self.specular_color));
        let (facets, along) = match &self.anisotropy {
            Some(anisotropy) => anisotropy.facets(at, roughness),
            None => {
                let alpha = (roughness * roughness).max(SMOOTHEST);
                (Microfacet::new(Distribution::Ggx, alpha, alpha), Vec2::X)
            }
        };
        let film = self.film.as_ref().map(|film| ThinFilm {
            strength: at.scalar(&film.strength).clamp(0.0, 1.0),
            eta: sane_eta(film.eta).max(1.0),
            thickness: at.scalar(&film.thickness).max(0.0),
        });
        let curve = facet_albedo().curve(roughness, contrast(eta));
        let albedo = FacetsAlbedo::new(curve, &dielectric, eta, film);
        let free = (1.0 - albedo.mean()).max(1e-3);
        let base = (1.0 - metallic) * FRAC_1_PI / free;
        let (through, passed) = match &self.transmission {
            Some(t) => (at.scalar(&t.share).clamp(0.0, 1.0), at.color(&t.color)),
            None => (0.0, Rgb::ZERO),
        };
        MetallicRoughnessLobe {
            color,
            metallic,
            eta,
            facets,
            along,
            dielectric,
            film,
            albedo,
            base: color * (base * (1.0 - through)),
            passed: passed * (base * through),
            free,
            both_sides: self.transmission.is_some(),
        }
    }

    fn textures(&self) -> Textures<'_> {
        let (color, metallic) = (&self.base_color, &self.metallic);
        let mut all = Textures::default();
        // Their product counts: one of the two may vary.
        match color.constant().or(metallic.constant()) {
            Some(_) => all.linear.extend([color, metallic]),
            None => all.nonlinear.extend([color, metallic]),
        }
        let bent = [&self.roughness, &self.specular, &self.specular_color];
        all.nonlinear.extend(bent);
        all.nonlinear.extend(self.anisotropy.iter().map(|a| &a.map));
        let film = self.film.iter();
        all.nonlinear
            .extend(film.flat_map(|f| [&f.strength, &f.thickness]));
        let transmission = self.transmission.iter();
        all.nonlinear
            .extend(transmission.flat_map(|t| [&t.share, &t.color]));
        all
    }

    fn is_anisotropic(&self) -> bool {
        self.anisotropy.is_some()
    }

    fn transmits(&self) -> bool {
        self.transmission.is_some()
    }

    fn prepare(&self) -> Option<&'static RoughTransmittance> {
        facet_albedo();
        None
    }

    fn casts_caustics(&self) -> bool {
        self.metallic.constant() != Some(Rgb::ZERO)
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::tests::models::{grey, metallic_roughness, rgb};
        let anisotropy = Anisotropy {
            strength: 0.8,
            rotation: 0.6,
            map: rgb(0.8, 0.1, 0.9),
            mirrored: false,
        };
        let film = Film {
            strength: grey(0.9),
            eta: 1.4,
            thickness: grey(350.0),
        };
        let transmission = DiffuseTransmission {
            share: grey(0.6),
            color: rgb(0.3, 0.8, 0.2),
        };
        vec![
            ("metallic_roughness", metallic_roughness(0.4, 0.3)),
            (
                "metallic_roughness_dielectric",
                metallic_roughness(0.7, 0.0),
            ),
            (
                "metallic_roughness_brushed",
                Self {
                    anisotropy: Some(anisotropy),
                    ..metallic_roughness(0.4, 0.8)
                },
            ),
            (
                "metallic_roughness_film",
                Self {
                    film: Some(film),
                    specular: grey(0.7),
                    specular_color: rgb(2.0, 0.5, 0.9),
                    ..metallic_roughness(0.5, 0.2)
                },
            ),
            (
                "metallic_roughness_leaf",
                Self {
                    transmission: Some(transmission),
                    ..metallic_roughness(0.5, 0.0)
                },
            ),
        ]
    }
}

/// The model at a point.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct MetallicRoughnessLobe {
    color: Rgb,
    metallic: f32,
    eta: f32,
    facets: Microfacet,
    /// The direction along which the facets are wide, from the tangent.
    along: Vec2,
    dielectric: Reflectance,
    film: Option<ThinFilm>,
    albedo: FacetsAlbedo,
    /// Colour of the base over pi and over what the facets leave of diffuse light.
    base: Rgb,
    /// The same of the light that goes through.
    passed: Rgb,
    /// What the facets leave of diffuse light.
    free: f32,
    /// Light that comes from below meets the same.
    both_sides: bool,
}

/// Probabilities of the facets, of diffuse reflection and of diffuse transmission.
struct Odds {
    facets: f32,
    base: f32,
    passed: f32,
}

impl MetallicRoughnessLobe {
    #[inline]
    fn odds(&self, albedo: f32) -> Odds {
        let (color, dielectric) = (mean(self.color), 1.0 - self.metallic);
        let (base, passed) = (mean(self.base), mean(self.passed));
        let facets = share(
            dielectric * albedo + self.metallic * color,
            (1.0 - albedo) * PI * self.free * (base + passed),
        );
        let base = share(base, passed);
        Odds {
            facets,
            base: (1.0 - facets) * base,
            passed: (1.0 - facets) * (1.0 - base),
        }
    }

    /// Reflectance of a facet: Fresnel's for the dielectric, Schlick's for the metal, under the
    /// film.
    #[inline]
    fn fresnel(&self, cos: f32) -> Rgb {
        let metal = self.color.lerp(Rgb::ONE, schlick_weight(cos));
        let bare = self.dielectric.of(dielectric(cos, self.eta).r);
        let Some(film) = &self.film else {
            return bare.lerp(metal, self.metallic);
        };
        let normal = self.dielectric.of(contrast(self.eta) * contrast(self.eta));
        let metal = film.over(metal, self.color, cos);
        film.over(bare, normal, cos).lerp(metal, self.metallic)
    }

    /// The direction with the tangent along the facets.
    #[inline]
    fn turned(&self, w: Vec3) -> Vec3 {
        let Vec2 { x, y } = self.along;
        Vec3::new(x * w.x + y * w.y, x * w.y - y * w.x, w.z)
    }

    /// The direction back in the surface's own frame.
    #[inline]
    fn turned_back(&self, w: Vec3) -> Vec3 {
        let Vec2 { x, y } = self.along;
        Vec3::new(x * w.x - y * w.y, x * w.y + y * w.x, w.z)
    }

    /// What is left for the base of light from one side and to the other.
    #[inline]
    fn left(&self, albedo: f32, cos: f32) -> f32 {
        (1.0 - albedo).max(0.0) * (1.0 - self.albedo.at(cos)).max(0.0)
    }
}

impl Lobe for MetallicRoughnessLobe {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        let side = if self.both_sides { wo.z.signum() } else { 1.0 };
        let (wo, wi) = (wo * side, wi * side);
        if wo.z <= 0.0 || wi.z == 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let albedo = self.albedo.at(wo.z);
        let odds = self.odds(albedo);
        if wi.z < 0.0 {
            let value = self.passed * (self.left(albedo, -wi.z) * -wi.z);
            return (value, odds.passed * cosine_pdf(-wi.z));
        }
        let (o, i) = (self.turned(wo), self.turned(wi));
        let m = (o + i).normalize();
        let seen = self.facets.d(m) * self.facets.g1(o, m) / (4.0 * wo.z);
        let facets = self.fresnel(o.dot(m)) * (seen * self.facets.shadowing(o, i, m));
        let value = facets + self.base * (self.left(albedo, wi.z) * wi.z);
        (value, odds.facets * seen + odds.base * cosine_pdf(wi.z))
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        let side = if self.both_sides { wo.z.signum() } else { 1.0 };
        let up = wo * side;
        if up.z <= 0.0 {
            return None;
        }
        let odds = self.odds(self.albedo.at(up.z));
        let mut lobe = GLOSSY_REFLECTION;
        let wi = if u_lobe < odds.facets {
            let o = self.turned(up);
            self.turned_back(reflect(o, self.facets.sample(o, u)).normalize())
        } else if u_lobe < odds.facets + odds.base || odds.passed == 0.0 {
            sample_cosine(u)
        } else {
            lobe = GLOSSY_TRANSMISSION;
            let w = sample_cosine(u);
            Vec3::new(w.x, w.y, -w.z)
        };
        if (wi.z > 0.0) != (lobe == GLOSSY_REFLECTION) {
            return None;
        }
        let wi = wi * side;
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        smooth_sample(wi, value, pdf, 1.0, lobe)
    }

    fn flags(&self) -> LobeFlags {
        if self.both_sides {
            GLOSSY_REFLECTION | GLOSSY_TRANSMISSION
        } else {
            GLOSSY_REFLECTION
        }
    }

    fn albedo(&self) -> Rgb {
        self.color
    }

    fn roughness(&self) -> Option<f32> {
        Some(self.facets.alpha())
    }
}
