//! A shape that glows: which leaves its surface became, and the radiance at each point.

use super::EmitterShape;
use super::analytic::AnalyticArea;
use super::cluster::Cluster;
use super::incident::EmitterPlace;
use super::leaf::Leaf;
use super::quad::Quad;
use super::sphere::Sphere;
use super::triangle::Triangle;
use crate::accel::{AnalyticKind, AnalyticShape, Shape, TriangleMesh};
use crate::math::rgb::{sanitized, selection_weight};
use crate::math::{Frame, Mat3, Rgb, Vec2, Vec3};
use crate::texture::{SurfacePoint, Texture};
use std::f32::consts::{FRAC_1_PI, TAU};

/// [`AreaEmitter::leaf`] of a primitive that does not shine.
pub(super) const DARK: u32 = u32::MAX;

/// An emitter on a shape.
#[derive(Debug)]
pub(super) struct AreaEmitter {
    radiance: Texture,
    /// The radiance, if it is the same everywhere.
    constant: Option<Rgb>,
    shape: EmitterShape,
    both_sides: bool,
    /// The leaf of each triangle, or of the exact shape; then those of the backs, if they glow.
    leaf_of: Vec<u32>,
}

/// Places on a leaf at which a texture is looked up for the leaf's brightness.
const PROBES: usize = 16;

impl AreaEmitter {
    pub fn new(shape: EmitterShape, radiance: Texture, both_sides: bool) -> Self {
        let constant = radiance.constant().map(sanitized);
        Self {
            radiance,
            constant,
            shape,
            both_sides,
            leaf_of: Vec::new(),
        }
    }

    /// The parts of the surface that can shine, each with its mean radiance. Numbers them from
    /// `first`.
    pub fn leaves(&mut self, first: usize) -> Vec<(Leaf, Rgb)> {
        if self.constant == Some(Rgb::ZERO) {
            return Vec::new();
        }
        let count = self.prim_count();
        let sides = if self.both_sides { 2 } else { 1 };
        let mut leaf_of = vec![DARK; count * sides];
        let mut leaves = Vec::new();
        let floor = self
            .constant
            .unwrap_or_else(|| sanitized(self.radiance.mean()));
        for side in 0..sides {
            for (leaf, prims) in self.side(side == 1) {
                let radiance = self.constant.unwrap_or_else(|| self.probe(&leaf, floor));
                if selection_weight(radiance) <= 0.0 {
                    continue;
                }
                for prim in prims.into_iter().flatten() {
                    leaf_of[side * count + prim as usize] = (first + leaves.len()) as u32;
                }
                leaves.push((leaf, radiance));
            }
        }
        self.leaf_of = leaf_of;
        leaves
    }

    fn prim_count(&self) -> usize {
        match &self.shape.shape {
            Shape::Analytic(_) => 1,
            Shape::Triangles(mesh) => mesh.triangles().len(),
        }
    }

    /// The parts of one side, each with the primitives that it stands for.
    fn side(&self, back: bool) -> Vec<(Leaf, [Option<u32>; 2])> {
        let flip = self.shape.flip_normals != back;
        match &self.shape.shape {
            Shape::Analytic(exact) => exact_leaf(exact, flip),
            Shape::Triangles(mesh) => mesh_leaves(mesh, flip, self.constant.is_some()),
        }
    }

    /// Whether light leaves at this cosine to the surface's normal.
    #[inline]
    pub fn shines(&self, cos: f32) -> bool {
        cos > 0.0 || (self.both_sides && cos < 0.0)
    }

    /// Whether the back glows by itself.
    #[inline]
    pub fn both_sides(&self) -> bool {
        self.both_sides
    }

    /// Mean radiance of a leaf, from a few places on it; never far below the texture's own mean, so
    /// that a bright spot between the places is still sampled.
    fn probe(&self, leaf: &Leaf, floor: Rgb) -> Rgb {
        let mut sum = Rgb::ZERO;
        for i in 0..PROBES {
            // The R2 sequence (Roberts 2018).
            let u = Vec2::new(0.754_877_7, 0.569_840_3) * i as f32 + 0.5;
            let (q, n, _, place) = leaf.point(u.fract());
            sum += self.radiance_at(q, n, place);
        }
        sum * (0.9 / PROBES as f32) + floor * 0.1
    }

    /// The leaf that a primitive's front or back became, or [`DARK`].
    #[inline]
    pub fn leaf(&self, prim: u32, back: bool) -> u32 {
        let prim = match self.shape.shape {
            Shape::Analytic(_) => 0,
            Shape::Triangles(_) => prim as usize,
        };
        let first = if back { self.leaf_of.len() / 2 } else { 0 };
        self.leaf_of.get(first + prim).copied().unwrap_or(DARK)
    }

    /// The leaf of a primitive's side that faces `dir`, or [`DARK`], and the normal of that side;
    /// `ng` is that of the front.
    #[inline]
    pub fn facing(&self, prim: u32, ng: Vec3, dir: Vec3) -> (u32, Vec3) {
        let back = self.both_sides() && ng.dot(dir) < 0.0;
        (self.leaf(prim, back), if back { -ng } else { ng })
    }

    /// Radiance at a surface point, on a glowing side.
    #[inline]
    pub fn radiance(&self, point: &SurfacePoint) -> Rgb {
        self.constant
            .unwrap_or_else(|| sanitized(self.radiance.eval(point)))
    }

    /// Radiance at a sampled place.
    #[inline]
    pub fn radiance_at(&self, q: Vec3, n: Vec3, place: EmitterPlace) -> Rgb {
        match self.constant {
            Some(c) => c,
            None => self.textured(q, n, place),
        }
    }

    fn textured(&self, q: Vec3, n: Vec3, place: EmitterPlace) -> Rgb {
        let mut point = SurfacePoint::at_uv(Vec2::ZERO);
        point.p = q;
        point.ng = n;
        point.frame = Frame::new(n);
        point.attributes = self.shape.attributes.as_deref();
        match (place, &self.shape.shape) {
            (EmitterPlace::Barycentric(prim, b), Shape::Triangles(mesh)) => {
                let vertices = mesh.triangles()[prim as usize];
                point.prim = prim;
                point.vertices = vertices;
                point.barycentric = b;
                point.uv = self.triangle_uv(vertices, b);
            }
            (_, Shape::Analytic(exact)) => point.uv = exact_uv(exact, q),
            (EmitterPlace::Surface, Shape::Triangles(_)) => {}
        }
        sanitized(self.radiance.eval(&point))
    }

    /// Texture coordinates on a triangle; a mesh without any has its barycentric weights, as in
    /// Mitsuba.
    fn triangle_uv(&self, vertices: [u32; 3], b: Vec2) -> Vec2 {
        let at = |i: usize| {
            let uvs = self.shape.uvs.as_ref()?;
            uvs.get(vertices[i] as usize).copied()
        };
        match (at(0), at(1), at(2)) {
            (Some(p), Some(q), Some(r)) => p * (1.0 - b.x - b.y) + q * b.x + r * b.y,
            _ => b,
        }
    }
}

/// Leaves of a mesh and the triangles they stand for. Neighbours in the list that make a
/// parallelogram become one leaf, if the radiance does not depend on the place.
fn mesh_leaves(mesh: &TriangleMesh, flip: bool, constant: bool) -> Vec<(Leaf, [Option<u32>; 2])> {
    let count = mesh.triangles().len() as u32;
    let mut leaves = Vec::new();
    let mut prim = 0;
    while prim < count {
        let corners = mesh.corners(prim);
        if constant && prim + 1 < count {
            if let Some(quad) = Quad::from_triangles(corners, mesh.corners(prim + 1), flip) {
                leaves.push((Leaf::Quad(Box::new(quad)), [Some(prim), Some(prim + 1)]));
                prim += 2;
                continue;
            }
        }
        if let Some(triangle) = Triangle::new(corners, prim, flip) {
            leaves.push((Leaf::Triangle(triangle), [Some(prim), None]));
        }
        prim += 1;
    }
    leaves
}

fn exact_leaf(exact: &AnalyticShape, flip: bool) -> Vec<(Leaf, [Option<u32>; 2])> {
    let m = Mat3::from(exact.to_world.matrix3);
    let center = Vec3::from(exact.to_world.translation);
    let leaf = match exact.kind {
        AnalyticKind::Rectangle => {
            // The side of +z, which a mirroring map does not turn over.
            let side = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
            let side = if flip { -side } else { side };
            let facing = m.x_axis.cross(m.y_axis) * side;
            let corner = center - m.x_axis - m.y_axis;
            Quad::new(corner, [m.x_axis * 2.0, m.y_axis * 2.0], facing)
                .map(|q| Leaf::Quad(Box::new(q)))
        }
        AnalyticKind::Sphere => match uniform_scale(&m) {
            Some(radius) => Sphere::new(center, radius, flip).map(Leaf::Sphere),
            None => AnalyticArea::new(*exact, flip).map(|e| Leaf::Analytic(Box::new(e))),
        },
        AnalyticKind::Disk | AnalyticKind::Cylinder => {
            AnalyticArea::new(*exact, flip).map(|e| Leaf::Analytic(Box::new(e)))
        }
    };
    leaf.map(|l| (l, [Some(0), None])).into_iter().collect()
}

/// The factor of a map that scales the same in all directions.
fn uniform_scale(m: &Mat3) -> Option<f32> {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    let scale = x.length();
    let near = |a: f32, b: f32| (a - b).abs() <= 1e-5 * scale;
    let square = [x.dot(y), y.dot(z), z.dot(x)]
        .iter()
        .all(|d| d.abs() <= 1e-5 * scale * scale);
    (near(y.length(), scale) && near(z.length(), scale) && square).then_some(scale)
}

/// Texture coordinates of a point on an exact shape (see [`AnalyticKind`]).
fn exact_uv(exact: &AnalyticShape, q: Vec3) -> Vec2 {
    let p = exact.to_object.transform_point3(q);
    let turn = p.y.atan2(p.x) / TAU;
    let turn = if turn < 0.0 { turn + 1.0 } else { turn };
    match exact.kind {
        AnalyticKind::Sphere => {
            Vec2::new(turn, Vec2::new(p.x, p.y).length().atan2(p.z) * FRAC_1_PI)
        }
        AnalyticKind::Disk => Vec2::new(Vec2::new(p.x, p.y).length(), turn),
        AnalyticKind::Cylinder => Vec2::new(turn, p.z),
        AnalyticKind::Rectangle => Vec2::new(p.x, p.y) * 0.5 + 0.5,
    }
}

/// Bounds of a leaf of this mean radiance.
pub(super) fn cluster_of(leaf: &Leaf, radiance: Rgb) -> Cluster {
    leaf.cluster(selection_weight(radiance))
}
