//! Models inside models, without a heap: a resolved material is a short array of [`Node`]s in which
//! blends, coatings and perturbed frames name their children by index.
//!
//! Nearly every material is one node, or two with a bump map; the array holds [`INLINE`] of them in
//! place and goes to the heap only for deeper nests.

use super::albedo_scaling::AlbedoScaling;
use super::clear_coat::ClearCoat;
use super::layer::{Coating, RoughCoating};
use super::lobes::rough_plastic::RoughPlasticLobe;
use super::lobes::{Lobe, weighted};
use super::material::Leaf;
use super::perturb::Perturbation;
use super::sheen::Sheen;
use super::volume::{self, Collision};
use super::{BsdfSample, LobeFlags, Transport};
use crate::math::rng::BELOW_ONE;
use crate::math::{Rgb, Vec2, Vec3};
use smallvec::SmallVec;

/// Nodes held in place.
pub(super) const INLINE: usize = 4;

/// Index of a node in its tree.
pub(super) type NodeId = u16;

/// A model, or a way to combine models.
#[derive(Clone, Copy, Debug)]
pub(super) enum Node {
    /// A model by itself.
    Leaf(Leaf),
    /// Absorbs everything.
    Black,
    /// A model seen from its back as if that were its front.
    Flipped(NodeId),
    /// A model in a frame turned by a bump or normal map.
    Perturbed(Perturbation, NodeId),
    Mix(Mix),
    Coating(Coating, NodeId),
    RoughCoating(RoughCoating, NodeId),
    ClearCoat(ClearCoat, NodeId),
    Sheen(Sheen, NodeId),
    /// No surface: a collision inside of a medium.
    Collision(Collision),
}

/// A weighted sum of two models.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mix {
    pub first: NodeId,
    pub second: NodeId,
    /// Factors on their values.
    pub weights: [f32; 2],
    /// Probability of sampling the first.
    pub p_first: f32,
}

/// The nodes of a resolved material, children before parents.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    nodes: SmallVec<[Node; INLINE]>,
}

/// Mirrors a direction in the surface.
#[inline]
fn flip(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, -w.z)
}

impl Tree {
    /// Adds a node and returns its index. Nests too deep for the index absorb.
    #[inline(always)]
    pub fn push(&mut self, node: Node) -> NodeId {
        if self.nodes.len() >= usize::from(NodeId::MAX) {
            self.nodes[0] = Node::Black;
            return 0;
        }
        self.nodes.push(node);
        (self.nodes.len() - 1) as NodeId
    }

    /// The rough plastic that it is, as seen from its front or its back.
    #[inline]
    pub fn rough_plastic(&self) -> Option<&RoughPlasticLobe> {
        match self.nodes.as_slice() {
            [Node::Leaf(Leaf::RoughPlastic(plastic))]
            | [Node::Leaf(Leaf::RoughPlastic(plastic)), Node::Flipped(0)] => Some(plastic),
            _ => None,
        }
    }

    /// The same, to be changed.
    #[inline]
    pub fn rough_plastic_mut(&mut self) -> Option<&mut RoughPlasticLobe> {
        match self.nodes.as_mut_slice() {
            [Node::Leaf(Leaf::RoughPlastic(plastic))]
            | [Node::Leaf(Leaf::RoughPlastic(plastic)), Node::Flipped(0)] => Some(plastic),
            _ => None,
        }
    }

    /// Whether a bump or normal map is anywhere inside.
    #[inline]
    pub fn turns_normal(&self) -> bool {
        self.nodes.iter().any(|n| matches!(n, Node::Perturbed(..)))
    }

    /// The node that stands for the whole material: the last.
    #[inline]
    pub fn root(&self) -> NodeId {
        self.nodes.len().saturating_sub(1) as NodeId
    }

    #[inline]
    fn node(&self, id: NodeId) -> &Node {
        self.nodes.get(usize::from(id)).unwrap_or(&Node::Black)
    }

    /// The model that a node is.
    #[inline]
    fn at(&self, id: NodeId) -> Subtree<'_> {
        Subtree { tree: self, id }
    }

    /// `f |cos theta_i|` and density of the node, in its local frame.
    pub fn eval_pdf(&self, id: NodeId, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        match self.node(id) {
            Node::Leaf(lobe) => lobe.eval_pdf(wo, wi, transport),
            Node::Black => (Rgb::ZERO, 0.0),
            Node::Collision(collision) => collision.eval_pdf(wi),
            &Node::Flipped(inner) => self.eval_pdf(inner, flip(wo), flip(wi), transport),
            Node::Perturbed(p, inner) => p.eval_pdf(&self.at(*inner), wo, wi, transport),
            Node::Mix(mix) => self.eval_mix(mix, wo, wi, transport),
            Node::Coating(c, inner) => c.eval_pdf(&self.at(*inner), wo, wi, transport),
            Node::RoughCoating(c, inner) => c.eval_pdf(&self.at(*inner), wo, wi, transport),
            Node::ClearCoat(c, inner) => c.eval_pdf(&self.at(*inner), wo, wi, transport),
            Node::Sheen(s, inner) => s.eval_pdf(&self.at(*inner), wo, wi, transport),
        }
    }

    /// Draws a local direction from the node.
    pub fn sample(
        &self,
        id: NodeId,
        wo: Vec3,
        u_lobe: f32,
        u: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        match self.node(id) {
            Node::Leaf(lobe) => lobe.sample(wo, u_lobe, u, transport),
            Node::Black => None,
            Node::Collision(collision) => Some(collision.sample(u_lobe, u)),
            &Node::Flipped(inner) => {
                let s = self.sample(inner, flip(wo), u_lobe, u, transport)?;
                Some(BsdfSample {
                    wi: flip(s.wi),
                    ..s
                })
            }
            Node::Perturbed(p, inner) => p.sample(&self.at(*inner), wo, (u_lobe, u), transport),
            Node::Mix(mix) => self.sample_mix(mix, wo, u_lobe, u, transport),
            Node::Coating(c, inner) => c.sample(&self.at(*inner), wo, (u_lobe, u), transport),
            Node::RoughCoating(c, inner) => c.sample(&self.at(*inner), wo, (u_lobe, u), transport),
            Node::ClearCoat(c, inner) => c.sample(&self.at(*inner), wo, (u_lobe, u), transport),
            Node::Sheen(s, inner) => s.sample(&self.at(*inner), wo, (u_lobe, u), transport),
        }
    }

    fn eval_mix(&self, mix: &Mix, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        let (a, p_a) = self.eval_pdf(mix.first, wo, wi, transport);
        let (b, p_b) = self.eval_pdf(mix.second, wo, wi, transport);
        let value = a * mix.weights[0] + b * mix.weights[1];
        (value, p_a * mix.p_first + p_b * (1.0 - mix.p_first))
    }

    /// One model is drawn from; a smooth direction is weighted by the whole mixture.
    fn sample_mix(
        &self,
        mix: &Mix,
        wo: Vec3,
        u_lobe: f32,
        u: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let p = mix.p_first;
        let (id, other, weight, p_id, rescaled) = if u_lobe < p {
            (mix.first, mix.second, mix.weights, p, u_lobe / p)
        } else {
            let [a, b] = mix.weights;
            let rest = (u_lobe - p) / (1.0 - p);
            (mix.second, mix.first, [b, a], 1.0 - p, rest)
        };
        let s = self.sample(id, wo, rescaled.min(BELOW_ONE), u, transport)?;
        if s.lobe.has(LobeFlags::DELTA) {
            return weighted(
                s.wi,
                s.weight * (weight[0] / p_id),
                s.pdf * p_id,
                s.eta,
                s.lobe,
            );
        }
        let (value, other_pdf) = self.eval_pdf(other, wo, s.wi, transport);
        let pdf = p_id * s.pdf + (1.0 - p_id) * other_pdf;
        let value = s.weight * (s.pdf * weight[0]) + value * weight[1];
        weighted(s.wi, value / pdf, pdf, s.eta, s.lobe)
    }

    /// What the node does.
    pub fn flags(&self, id: NodeId) -> LobeFlags {
        match self.node(id) {
            Node::Leaf(lobe) => lobe.flags(),
            Node::Black => LobeFlags::default(),
            Node::Collision(_) => volume::FLAGS,
            &Node::Flipped(inner) | &Node::Perturbed(_, inner) => self.flags(inner),
            Node::Mix(mix) => self.flags(mix.first) | self.flags(mix.second),
            Node::Coating(_, inner) => self.flags(*inner) | Coating::FLAGS,
            Node::RoughCoating(_, inner) => self.flags(*inner) | RoughCoating::FLAGS,
            Node::ClearCoat(_, inner) => self.flags(*inner) | ClearCoat::FLAGS,
            Node::Sheen(_, inner) => self.flags(*inner) | Sheen::FLAGS,
        }
    }

    /// The node's colour.
    pub fn albedo(&self, id: NodeId) -> Rgb {
        match self.node(id) {
            Node::Leaf(lobe) => lobe.albedo(),
            Node::Black => Rgb::ZERO,
            Node::Collision(collision) => collision.albedo(),
            &Node::Flipped(inner) | &Node::Perturbed(_, inner) => self.albedo(inner),
            Node::Mix(mix) => {
                let [a, b] = mix.weights;
                self.albedo(mix.first) * a + self.albedo(mix.second) * b
            }
            &Node::Coating(_, inner)
            | &Node::RoughCoating(_, inner)
            | &Node::ClearCoat(_, inner)
            | &Node::Sheen(_, inner) => self.albedo(inner),
        }
    }

    /// The node's normal in its local frame: about of unit length, shorter where those of a mixture
    /// differ.
    pub fn normal(&self, id: NodeId) -> Vec3 {
        match self.node(id) {
            Node::Leaf(_) | Node::Black | Node::Collision(_) => Vec3::Z,
            // Seen from its back, in a mirrored frame, it is on the side of the front again.
            &Node::Flipped(inner) => -flip(self.normal(inner)),
            Node::Perturbed(p, inner) => p.frame().to_world(self.normal(*inner)),
            Node::Mix(mix) => {
                let [a, b] = mix.weights;
                self.normal(mix.first) * a + self.normal(mix.second) * b
            }
            &Node::Coating(_, inner)
            | &Node::RoughCoating(_, inner)
            | &Node::ClearCoat(_, inner)
            | &Node::Sheen(_, inner) => self.normal(inner),
        }
    }

    /// Smallest roughness of the node's smooth parts.
    pub fn roughness(&self, id: NodeId) -> Option<f32> {
        match self.node(id) {
            Node::Leaf(lobe) => lobe.roughness(),
            Node::Black => None,
            Node::Collision(collision) => Some(collision.roughness()),
            &Node::Flipped(inner)
            | &Node::Perturbed(_, inner)
            | &Node::Coating(_, inner)
            | &Node::Sheen(_, inner) => self.roughness(inner),
            Node::Mix(mix) => smaller(self.roughness(mix.first), self.roughness(mix.second)),
            Node::RoughCoating(c, inner) => smaller(Some(c.alpha()), self.roughness(*inner)),
            Node::ClearCoat(c, inner) => smaller(Some(c.alpha()), self.roughness(*inner)),
        }
    }
}

/// A node with all that it names: a model like any other to the coatings and frames around it.
struct Subtree<'a> {
    tree: &'a Tree,
    id: NodeId,
}

impl Lobe for Subtree<'_> {
    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        self.tree.eval_pdf(self.id, wo, wi, transport)
    }

    #[inline]
    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        self.tree.sample(self.id, wo, u_lobe, u, transport)
    }

    fn flags(&self) -> LobeFlags {
        self.tree.flags(self.id)
    }

    fn albedo(&self) -> Rgb {
        self.tree.albedo(self.id)
    }

    fn roughness(&self) -> Option<f32> {
        self.tree.roughness(self.id)
    }
}

fn smaller(a: Option<f32>, b: Option<f32>) -> Option<f32> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}
