//! From a material and a point to numbers: every texture is looked up once, sides are chosen, frames
//! turned.

use super::layer::{Coating, Layer, RoughCoating};
use super::lobes::conductor::{Conductor, Metal, RoughConductor};
use super::lobes::dielectric::{Dielectric, Null, ThinDielectric};
use super::lobes::diffuse::{Diffuse, DiffuseTransmitter, RoughDiffuse};
use super::lobes::phong::Phong;
use super::lobes::plastic::Plastic;
use super::lobes::principled as principled_lobe;
use super::lobes::principled_sheet::{PrincipledSheet, SheetInput};
use super::lobes::rough_dielectric::{MIN_CONTRAST, RoughDielectric};
use super::lobes::rough_plastic::RoughPlastic;
use super::lobes::ward::Ward;
use super::material::{Principled, PrincipledThin, Roughness};
use super::microfacet::Microfacet;
use super::perturb::{Perturbation, bumped_normal};
use super::tree::{Mix, Node, NodeId, Tree};
use super::{Material, MaterialId, Materials};
use crate::math::{Frame, Rgb, Vec2, Vec3};
use crate::texture::{SurfacePoint, Texture};

/// The state of resolving one material at one point.
pub(super) struct Resolver<'a> {
    materials: &'a Materials,
    point: &'a SurfacePoint<'a>,
    tree: Tree,
}

/// Indices of refraction that the equations bear without overflow.
fn sane_eta(eta: f32) -> f32 {
    if eta.is_finite() {
        eta.clamp(1e-4, 1e4)
    } else {
        1.0
    }
}

impl<'a> Resolver<'a> {
    pub fn new(materials: &'a Materials, point: &'a SurfacePoint<'a>) -> Self {
        Self {
            materials,
            point,
            tree: Tree::default(),
        }
    }

    /// The tree of `material`, seen from the local direction `wo`.
    #[inline]
    pub fn resolve(mut self, material: MaterialId, frame: &Frame, wo: Vec3) -> Tree {
        self.add(material, frame, wo);
        self.tree
    }

    fn color(&self, t: &Texture) -> Rgb {
        t.eval(self.point)
    }

    fn scalar(&self, t: &Texture) -> f32 {
        t.eval_scalar(self.point)
    }

    fn facets(&self, r: &Roughness) -> Microfacet {
        Microfacet::new(
            r.distribution,
            self.scalar(&r.alpha_u),
            self.scalar(&r.alpha_v),
        )
    }

    /// Adds the nodes of `material`; `frame` is the shading frame that maps turn and `wo` is local to
    /// it, mirrored where a two-sided material is seen from its back.
    fn add(&mut self, id: MaterialId, frame: &Frame, wo: Vec3) -> NodeId {
        let Some(material) = self.materials.list.get(id as usize) else {
            return self.tree.push(Node::Black);
        };
        if let Some(node) = self.leaf(id, &material.model) {
            return self.tree.push(node);
        }
        self.nest(id, &material.model, frame, wo)
    }

    /// Adds a material named by `parent`. Only materials added before it are followed, so that no
    /// circle can be.
    fn child(&mut self, parent: MaterialId, id: MaterialId, frame: &Frame, wo: Vec3) -> NodeId {
        if id >= parent {
            return self.tree.push(Node::Black);
        }
        self.add(id, frame, wo)
    }

    /// The node of a model that stands by itself.
    #[inline]
    fn leaf(&self, id: MaterialId, material: &Material) -> Option<Node> {
        Some(match material {
            Material::Diffuse { reflectance } => Node::Diffuse(Diffuse {
                reflectance: self.color(reflectance),
            }),
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
                let alpha = self.scalar(&roughness.alpha_u);
                let facets = Microfacet::new(roughness.distribution, alpha, alpha);
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

    /// Nodes of a model around others.
    fn nest(&mut self, id: MaterialId, material: &Material, frame: &Frame, wo: Vec3) -> NodeId {
        match material {
            Material::Mask { inner, .. } => self.child(id, *inner, frame, wo),
            Material::TwoSided { front, .. } if wo.z >= 0.0 => self.child(id, *front, frame, wo),
            Material::TwoSided { back, .. } => {
                let flipped = Vec3::new(wo.x, wo.y, -wo.z);
                let inner = self.child(id, *back, frame, flipped);
                self.tree.push(Node::Flipped(inner))
            }
            Material::BumpMap {
                displacement,
                scale,
                inner,
            } => {
                let n = self.bump(displacement, *scale, frame);
                self.perturbed(id, *inner, n, frame, wo)
            }
            Material::NormalMap { normals, inner } => {
                let n = self.color(normals) * 2.0 - Vec3::ONE;
                self.perturbed(id, *inner, n, frame, wo)
            }
            Material::Blend {
                weight,
                first,
                second,
            } => {
                let w = self.scalar(weight).clamp(0.0, 1.0);
                let first = self.child(id, *first, frame, wo);
                let second = self.child(id, *second, frame, wo);
                self.tree.push(Node::Mix(Mix {
                    first,
                    second,
                    weights: [1.0 - w, w],
                    p_first: 1.0 - w,
                }))
            }
            Material::Mixture { parts } => self.mixture(id, parts, frame, wo),
            _ => self.coated(id, material, frame, wo),
        }
    }

    fn perturbed(
        &mut self,
        id: MaterialId,
        inner: MaterialId,
        n: Vec3,
        frame: &Frame,
        wo: Vec3,
    ) -> NodeId {
        let p = Perturbation::new(n, wo);
        let local = p.frame();
        let turned = Frame {
            s: frame.to_world(local.s),
            t: frame.to_world(local.t),
            n: frame.to_world(local.n),
        };
        let inner = self.child(id, inner, &turned, local.to_local(wo));
        self.tree.push(Node::Perturbed(p, inner))
    }

    /// The local normal under a displacement texture, whose gradient is a central difference over the
    /// pixel's width, or over a ten-thousandth of the texture where that is not known: less than a
    /// texel of an 8k image, and still a thousand times the rounding of f32 texture coordinates.
    fn bump(&self, displacement: &Texture, scale: f32, frame: &Frame) -> Vec3 {
        if displacement.constant().is_some() {
            return Vec3::Z;
        }
        let p = self.point;
        let step = |axis: Vec3| {
            let width = 0.5 * p.footprint / axis.length();
            if width.is_finite() {
                width.clamp(1e-4, 0.1)
            } else {
                1e-4
            }
        };
        let slope = |axis: Vec3, offset: Vec2| {
            let at = |sign: f32| {
                let mut moved = *p;
                moved.uv += offset * sign;
                moved.p += axis * (sign * offset.length());
                displacement.eval_scalar(&moved)
            };
            scale * (at(1.0) - at(-1.0)) / (2.0 * offset.length())
        };
        let du = slope(p.dp_du, Vec2::new(step(p.dp_du), 0.0));
        let dv = slope(p.dp_dv, Vec2::new(0.0, step(p.dp_dv)));
        bumped_normal(frame, p.ng, (p.dp_du, p.dp_dv), Vec2::new(du, dv))
    }

    /// A sum of any number of parts as a chain of sums of two.
    fn mixture(
        &mut self,
        id: MaterialId,
        parts: &[(f32, MaterialId)],
        frame: &Frame,
        wo: Vec3,
    ) -> NodeId {
        // Mitsuba scales weights whose sum exceeds 1.
        let total: f32 = parts.iter().map(|p| p.0.max(0.0)).sum();
        let scale = 1.0 / total.max(1.0);
        let mut chain: Option<(NodeId, f32)> = None;
        for &(weight, part) in parts.iter().rev() {
            let weight = weight.max(0.0) * scale;
            let node = self.child(id, part, frame, wo);
            let (second, rest) = match chain {
                Some(rest) => rest,
                None => (self.tree.push(Node::Black), 0.0),
            };
            let sum = weight + rest;
            let tail = if rest > 0.0 { 1.0 } else { 0.0 };
            let mix = self.tree.push(Node::Mix(Mix {
                first: node,
                second,
                weights: [weight, tail],
                p_first: if sum > 0.0 { weight / sum } else { 0.0 },
            }));
            chain = Some((mix, sum));
        }
        match chain {
            Some((root, _)) => root,
            None => self.tree.push(Node::Black),
        }
    }

    fn coated(&mut self, id: MaterialId, material: &Material, frame: &Frame, wo: Vec3) -> NodeId {
        match material {
            Material::Coating {
                eta,
                thickness,
                sigma_a,
                specular_reflectance,
                inner,
            } => {
                let absorption = self.color(sigma_a) * *thickness;
                let layer =
                    Layer::new(sane_eta(*eta), absorption, self.color(specular_reflectance));
                let inner = self.child(id, *inner, frame, layer.inside(wo));
                self.tree.push(Node::Coating(Coating { layer }, inner))
            }
            Material::RoughCoating {
                eta,
                roughness,
                thickness,
                sigma_a,
                specular_reflectance,
                inner,
            } => {
                let Some(table) = self.materials.transmittance(id) else {
                    return self.tree.push(Node::Black);
                };
                let absorption = self.color(sigma_a) * *thickness;
                let layer =
                    Layer::new(sane_eta(*eta), absorption, self.color(specular_reflectance));
                let alpha = self.scalar(&roughness.alpha_u);
                let facets = Microfacet::new(roughness.distribution, alpha, alpha);
                let inner = self.child(id, *inner, frame, layer.inside(wo));
                let coating = RoughCoating {
                    layer,
                    facets,
                    table,
                };
                self.tree.push(Node::RoughCoating(coating, inner))
            }
            _ => self.tree.push(Node::Black),
        }
    }
}
