//! From a material and a point to numbers: every texture is looked up once, sides are chosen,
//! frames turned.

use super::clear_coat::ClearCoat;
use super::diffuse_only::Form;
use super::fresnel::sane_eta;
use super::layer::{Coating, Layer, RoughCoating};
use super::lobes::diffuse::DiffuseLobe;
use super::material::{InvalidNormals, Leaf};
use super::model::{Lookup, Model};
use super::perturb::{Perturbation, bumped_normal};
use super::sheen::Sheen;
use super::tree::{Mix, Node, NodeId, Tree};
use super::volume::{self, Collision};
use super::{Bsdf, LobeFlags, Material, MaterialId, Materials};
use crate::math::{Frame, Rgb, Vec2, Vec3, luminance};
use crate::medium::PhaseFunction;
use crate::texture::{SurfacePoint, Texture};

impl Materials {
    /// Resolves material `id` at a point seen from direction `wo` (unit, away from the surface).
    // Inlined so that the result is built where the caller keeps it instead of being copied there.
    #[inline(always)]
    pub fn resolve(&self, id: MaterialId, point: &SurfacePoint, wo: Vec3) -> Bsdf {
        if let Some((frame, diffuse)) = self.resolve_plain(id, point, wo) {
            return Bsdf {
                frame,
                ng: point.ng,
                flags: DiffuseLobe::FLAGS,
                form: Form::Diffuse(diffuse),
            };
        }
        let mut bsdf = Bsdf {
            frame: point.frame,
            ng: point.ng,
            flags: LobeFlags::default(),
            form: Form::Tree(Tree::default()),
        };
        // The tree grows where it stays: it is too large to be moved at every vertex.
        if let Form::Tree(tree) = &mut bsdf.form {
            bsdf.flags = self.grow(id, point, wo, tree);
        }
        bsdf
    }

    /// Fills the tree of material `id` and tells what it does.
    fn grow(&self, id: MaterialId, point: &SurfacePoint, wo: Vec3, tree: &mut Tree) -> LobeFlags {
        let mut resolver = Resolver {
            materials: self,
            point,
            tree,
        };
        resolver.add(id, &point.frame, point.frame.to_local(wo));
        tree.flags(tree.root())
    }
}

impl Bsdf {
    /// How a medium of this albedo scatters what comes from `wo`, a unit vector. The weight of a
    /// sample leaves the albedo out: that is part of the collision.
    pub fn of_medium(phase: PhaseFunction, albedo: Rgb, wo: Vec3) -> Self {
        let mut tree = Tree::default();
        tree.push(Node::Collision(Collision::new(phase, albedo)));
        Self {
            frame: Frame::new(wo),
            ng: wo,
            flags: volume::FLAGS,
            form: Form::Tree(tree),
        }
    }
}

/// Resolving one material at one point into a tree.
struct Resolver<'a> {
    materials: &'a Materials,
    point: &'a SurfacePoint<'a>,
    tree: &'a mut Tree,
}

impl Resolver<'_> {
    /// Adds the nodes of `material`; `frame` is the shading frame that maps turn and `wo` is local
    /// to it, mirrored where a two-sided material is seen from its back.
    #[inline]
    fn add(&mut self, id: MaterialId, frame: &Frame, wo: Vec3) -> NodeId {
        let Some(prepared) = self.materials.list.get(id as usize) else {
            return self.tree.push(Node::Black);
        };
        let at = Lookup {
            point: self.point,
            prepared: prepared.coat_table,
        };
        // The most common model goes straight to its place, past the copies of the general way.
        if let Material::Diffuse(diffuse) = &prepared.material {
            return self.tree.push(Node::Leaf(Leaf::Diffuse(diffuse.lobe(&at))));
        }
        if let Some(leaf) = prepared.material.leaf(&at) {
            return self.tree.push(Node::Leaf(leaf));
        }
        self.nest(id, &prepared.material, &at, (frame, wo))
    }

    /// Adds a material named by `parent`. Only materials added before it are followed, so that no
    /// circle can be.
    fn child(&mut self, parent: MaterialId, id: MaterialId, frame: &Frame, wo: Vec3) -> NodeId {
        if id >= parent {
            return self.tree.push(Node::Black);
        }
        self.add(id, frame, wo)
    }

    /// Nodes of a material around others.
    fn nest(
        &mut self,
        id: MaterialId,
        material: &Material,
        at: &Lookup,
        (frame, wo): (&Frame, Vec3),
    ) -> NodeId {
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
                invalid_normals,
                inner,
            } => {
                let n = self.bump(displacement, *scale, frame);
                self.perturbed(id, *inner, (n, *invalid_normals), frame, wo)
            }
            Material::NormalMap {
                normals,
                invalid_normals,
                inner,
            } => {
                let n = at.color(normals) * 2.0 - Vec3::ONE;
                self.perturbed(id, *inner, (n, *invalid_normals), frame, wo)
            }
            Material::Blend {
                weight,
                first,
                second,
            } => {
                let w = at.scalar(weight).clamp(0.0, 1.0);
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
            _ => self.coated(id, material, at, (frame, wo)),
        }
    }

    fn perturbed(
        &mut self,
        id: MaterialId,
        inner: MaterialId,
        (n, invalid): (Vec3, InvalidNormals),
        frame: &Frame,
        wo: Vec3,
    ) -> NodeId {
        let p = Perturbation::new(n, wo, invalid);
        let local = p.frame();
        let turned = Frame {
            s: frame.to_world(local.s),
            t: frame.to_world(local.t),
            n: frame.to_world(local.n),
        };
        let inner = self.child(id, inner, &turned, local.to_local(wo));
        self.tree.push(Node::Perturbed(p, inner))
    }

    /// The local normal under a displacement texture.
    fn bump(&self, displacement: &Texture, scale: f32, frame: &Frame) -> Vec3 {
        if displacement.constant().is_some() {
            return Vec3::Z;
        }
        let p = self.point;
        let gradient = match displacement.gradient(p) {
            Some([u, v]) => Vec2::new(luminance(u), luminance(v)),
            None => Vec2::new(
                self.slope(displacement, Vec2::X, p.dp_du),
                self.slope(displacement, Vec2::Y, p.dp_dv),
            ),
        };
        bumped_normal(frame, p.ng, (p.dp_du, p.dp_dv), gradient * scale)
    }

    /// Change of a texture along u or v, which move the point by `axis`: a central difference over
    /// two ten-thousandths of the texture, a thousand times the rounding of f32 texture
    /// coordinates.
    fn slope(&self, texture: &Texture, along: Vec2, axis: Vec3) -> f32 {
        const STEP: f32 = 1e-4;
        let at = |step: f32| {
            let mut moved = *self.point;
            moved.uv += along * step;
            moved.p += axis * step;
            texture.eval_scalar(&moved)
        };
        (at(STEP) - at(-STEP)) / (2.0 * STEP)
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

    fn coated(
        &mut self,
        id: MaterialId,
        material: &Material,
        at: &Lookup,
        (frame, wo): (&Frame, Vec3),
    ) -> NodeId {
        match material {
            Material::Coating {
                eta,
                thickness,
                sigma_a,
                specular_reflectance,
                inner,
            } => {
                let absorption = at.color(sigma_a) * *thickness;
                let layer = Layer::new(sane_eta(*eta), absorption, at.color(specular_reflectance));
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
                let absorption = at.color(sigma_a) * *thickness;
                let layer = Layer::new(sane_eta(*eta), absorption, at.color(specular_reflectance));
                let facets = at.coat(roughness);
                let inner = self.child(id, *inner, frame, layer.inside(wo));
                let coating = RoughCoating {
                    layer,
                    facets,
                    table: at.coat_table(roughness, *eta),
                };
                self.tree.push(Node::RoughCoating(coating, inner))
            }
            Material::ClearCoat {
                weight,
                roughness,
                inner,
            } => {
                let coat = ClearCoat::new(at.scalar(weight), at.scalar(roughness));
                let inner = self.child(id, *inner, frame, wo);
                self.tree.push(Node::ClearCoat(coat, inner))
            }
            Material::Sheen {
                color,
                roughness,
                inner,
            } => {
                let sheen = Sheen::new(at.color(color), at.scalar(roughness));
                let inner = self.child(id, *inner, frame, wo);
                self.tree.push(Node::Sheen(sheen, inner))
            }
            _ => self.tree.push(Node::Black),
        }
    }
}
