//! Models that stand by themselves, looked up at a point: a material's textures become the numbers
//! of a lobe.

use super::fresnel::sane_eta;
use super::lobes::conductor::{Conductor, Metal, RoughConductor};
use super::lobes::dielectric::{Dielectric, Null, ThinDielectric};
use super::lobes::diffuse::{DiffuseTransmitter, RoughDiffuse};
use super::lobes::metallic_roughness::MetallicRoughness;
use super::lobes::phong::Phong;
use super::lobes::plastic::Plastic;
use super::lobes::principled as principled_lobe;
use super::lobes::principled_sheet::{PrincipledSheet, SheetInput};
use super::lobes::rough_dielectric::{MIN_CONTRAST, RoughDielectric};
use super::lobes::rough_plastic::RoughPlastic;
use super::lobes::ward::Ward;
use super::material::{Principled, PrincipledThin, Roughness};
use super::microfacet::Microfacet;
use super::tree::Node;
use super::{Material, MaterialId, Materials};
use crate::math::{Rgb, Vec2};
use crate::texture::{SurfacePoint, Texture};

/// The materials and the point at which their textures are read.
#[derive(Clone, Copy)]
pub(super) struct Lookup<'a> {
    pub materials: &'a Materials,
    pub point: &'a SurfacePoint<'a>,
}

/// Largest value of a colour: no surface reflects as much, and the models' products stay finite.
pub(super) const MOST: f32 = 1e4;

impl Lookup<'_> {
    pub fn color(&self, t: &Texture) -> Rgb {
        t.eval(self.point).min(Rgb::splat(MOST))
    }

    pub fn scalar(&self, t: &Texture) -> f32 {
        t.eval_scalar(self.point)
    }

    fn facets(&self, r: &Roughness) -> Microfacet {
        Microfacet::new(
            r.distribution,
            self.scalar(&r.alpha_u),
            self.scalar(&r.alpha_v),
        )
    }

    /// An isotropic coat's facets.
    pub fn coat(&self, r: &Roughness) -> Microfacet {
        let alpha = self.scalar(&r.alpha_u);
        Microfacet::new(r.distribution, alpha, alpha)
    }

    /// The node of a model that stands by itself; [`super::resolve`] knows the diffuse one.
    #[inline]
    pub fn leaf(&self, id: MaterialId, material: &Material) -> Option<Node> {
        Some(match material {
            Material::RoughDiffuse {
                reflectance,
                alpha,
                fast_approx,
            } => Node::RoughDiffuse(RoughDiffuse::new(
                self.color(reflectance),
                self.scalar(alpha),
                *fast_approx,
            )),
            Material::DiffuseTransmitter { transmittance } => {
                Node::DiffuseTransmitter(DiffuseTransmitter {
                    transmittance: self.color(transmittance),
                })
            }
            Material::Null => Node::Null(Null),
            Material::Phong {
                diffuse_reflectance,
                specular_reflectance,
                exponent,
            } => Node::Phong(Phong::new(
                self.color(diffuse_reflectance),
                self.color(specular_reflectance),
                self.scalar(exponent),
            )),
            Material::Ward {
                variant,
                diffuse_reflectance,
                specular_reflectance,
                alpha_u,
                alpha_v,
            } => Node::Ward(Ward::new(
                *variant,
                self.color(diffuse_reflectance),
                self.color(specular_reflectance),
                Vec2::new(self.scalar(alpha_u), self.scalar(alpha_v)),
            )),
            Material::MetallicRoughness(m) => Node::MetallicRoughness(MetallicRoughness::new(
                self.color(&m.base_color),
                self.scalar(&m.metallic),
                self.scalar(&m.roughness),
                sane_eta(m.eta).max(1.0),
            )),
            Material::Principled(p) => Node::Principled(self.principled(p)),
            Material::PrincipledThin(p) => Node::PrincipledSheet(self.sheet(p)),
            _ => return self.interface(id, material),
        })
    }

    /// The node of a model with a reflecting interface.
    fn interface(&self, id: MaterialId, material: &Material) -> Option<Node> {
        Some(match material {
            Material::Dielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
            } => Node::Dielectric(Dielectric {
                eta: sane_eta(*eta),
                reflectance: self.color(specular_reflectance),
                transmittance: self.color(specular_transmittance),
            }),
            Material::ThinDielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
            } => Node::ThinDielectric(ThinDielectric {
                eta: sane_eta(*eta),
                reflectance: self.color(specular_reflectance),
                transmittance: self.color(specular_transmittance),
            }),
            Material::RoughDielectric {
                eta,
                roughness,
                specular_reflectance,
                specular_transmittance,
            } => self.rough_dielectric(
                *eta,
                roughness,
                self.color(specular_reflectance),
                self.color(specular_transmittance),
            ),
            Material::Conductor {
                eta,
                k,
                specular_reflectance,
            } => Node::Conductor(Conductor {
                metal: self.metal(eta, k, specular_reflectance),
            }),
            Material::RoughConductor {
                eta,
                k,
                roughness,
                specular_reflectance,
            } => Node::RoughConductor(RoughConductor {
                metal: self.metal(eta, k, specular_reflectance),
                facets: self.facets(roughness),
            }),
            _ => return self.plastic(id, material),
        })
    }

    fn metal(&self, eta: &Texture, k: &Texture, reflectance: &Texture) -> Metal {
        Metal {
            eta: self.color(eta),
            k: self.color(k),
            reflectance: self.color(reflectance),
        }
    }

    fn rough_dielectric(
        &self,
        eta: f32,
        r: &Roughness,
        reflectance: Rgb,
        transmittance: Rgb,
    ) -> Node {
        let eta = sane_eta(eta);
        if (eta - 1.0).abs() < MIN_CONTRAST {
            return Node::Dielectric(Dielectric {
                eta,
                reflectance,
                transmittance,
            });
        }
        Node::RoughDielectric(RoughDielectric {
            eta,
            facets: self.facets(r),
            reflectance,
            transmittance,
        })
    }

    fn plastic(&self, id: MaterialId, material: &Material) -> Option<Node> {
        match material {
            Material::Plastic {
                eta,
                diffuse_reflectance,
                specular_reflectance,
                nonlinear,
            } => Some(Node::Plastic(Plastic::new(
                sane_eta(*eta),
                self.color(diffuse_reflectance),
                self.color(specular_reflectance),
                *nonlinear,
            ))),
            Material::RoughPlastic {
                eta,
                roughness,
                diffuse_reflectance,
                specular_reflectance,
                nonlinear,
            } => {
                let table = self.materials.transmittance(id)?;
                let facets = self.coat(roughness);
                let colors = (
                    self.color(diffuse_reflectance),
                    self.color(specular_reflectance),
                );
                let eta = sane_eta(*eta);
                Some(Node::RoughPlastic(RoughPlastic::new(
                    eta, facets, colors, *nonlinear, table,
                )))
            }
            _ => None,
        }
    }

    fn principled(&self, p: &Principled) -> principled_lobe::Principled {
        principled_lobe::Principled::new(&principled_lobe::PrincipledInput {
            base_color: self.color(&p.base_color),
            roughness: self.scalar(&p.roughness),
            anisotropic: self.scalar(&p.anisotropic),
            metallic: self.scalar(&p.metallic),
            spec_trans: self.scalar(&p.spec_trans),
            eta: sane_eta(p.eta),
            spec_tint: self.scalar(&p.spec_tint),
            sheen: self.scalar(&p.sheen),
            sheen_tint: self.scalar(&p.sheen_tint),
            flatness: self.scalar(&p.flatness),
            clearcoat: self.scalar(&p.clearcoat),
            clearcoat_gloss: self.scalar(&p.clearcoat_gloss),
            rates: [
                p.main_specular_sampling_rate,
                p.clearcoat_sampling_rate,
                p.diffuse_reflectance_sampling_rate,
            ],
        })
    }

    fn sheet(&self, p: &PrincipledThin) -> PrincipledSheet {
        PrincipledSheet::new(&SheetInput {
            base_color: self.color(&p.base_color),
            roughness: self.scalar(&p.roughness),
            anisotropic: self.scalar(&p.anisotropic),
            spec_trans: self.scalar(&p.spec_trans),
            eta: sane_eta(self.scalar(&p.eta)),
            spec_tint: self.scalar(&p.spec_tint),
            sheen: self.scalar(&p.sheen),
            sheen_tint: self.scalar(&p.sheen_tint),
            flatness: self.scalar(&p.flatness),
            diff_trans: self.scalar(&p.diff_trans),
        })
    }
}
