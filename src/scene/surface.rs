//! From a ray's hit to a point on a surface: position with its rounding error, normals, texture
//! coordinates and tangents, for triangles and exact shapes, in the world or in an instance.

use super::analytic::exact_point;
use super::description::Mesh;
use super::transform::{ERROR_SAFETY, to_world_point};
use crate::accel::{AnalyticShape, Hit, NO_INSTANCE, Opacity, Ray};
use crate::bsdf::{MaterialId, Materials};
use crate::light::EmitterId;
use crate::math::offset::gamma;
use crate::math::{Affine3A, Frame, Vec2, Vec3};
use crate::texture::SurfacePoint;
use std::sync::Arc;

/// [`Surface::emitter`] of a surface that does not glow.
pub const DARK: EmitterId = EmitterId::MAX;

/// Largest turn of a normal by rounding that rays are moved for, radians: triangles with more are
/// all but lines.
const MOST_TURNED: f32 = 1e-2;

/// A shape as rays meet it.
#[derive(Debug)]
pub struct Surface {
    /// What it is made of.
    pub form: Form,
    /// Its material.
    pub material: MaterialId,
    /// The emitter it carries, or [`DARK`].
    pub emitter: EmitterId,
    /// The group it belongs to, if it does not stand in the world by itself.
    pub group: Option<u32>,
    /// What its material asks of [`Surfaces::point`].
    pub needs: Needs,
}

/// What a surface is made of.
#[derive(Debug)]
pub enum Form {
    /// Triangles.
    Mesh(Arc<Mesh>),
    /// An exact shape, with its normal turned around or not.
    Analytic(AnalyticShape, bool),
}

/// Differentials that a material reads; the others are not computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Tangents along u and v (textures, anisotropy, normal maps).
    pub tangents: bool,
    /// Change of the normal with u and v (bump maps).
    pub normal_change: bool,
    /// The width of a ray's cone, for textures that may be read as averages over it.
    pub footprint: bool,
}

/// All surfaces of a scene.
#[derive(Debug)]
pub struct Surfaces {
    /// Indexed by [`Hit::shape`].
    pub list: Vec<Surface>,
    /// Indexed by [`Hit::instance`]: group to world and back.
    pub instances: Vec<(Affine3A, Affine3A)>,
    /// Indexed by [`Hit::instance`]: the group that stands there.
    pub instance_groups: Vec<u32>,
    /// All materials.
    pub materials: Materials,
}

impl Surfaces {
    /// Whether any surface scatters to more than a few discrete directions.
    pub fn scatter(&self) -> bool {
        let scatters = |s: &Surface| self.materials.scatters(s.material);
        self.list.iter().any(scatters)
    }

    /// Whether light may come by way of any surface that next-event estimation does not find.
    pub fn cast_caustics(&self) -> bool {
        let casts = |s: &Surface| self.materials.casts_caustics(s.material);
        self.list.iter().any(casts)
    }

    /// The point where `ray` met something. `footprint` is the width of the ray's cone there.
    #[inline(always)]
    pub fn point(&self, ray: &Ray, hit: &Hit, footprint: f32) -> SurfacePoint<'_> {
        let surface = &self.list[hit.shape as usize];
        if hit.instance == NO_INSTANCE {
            let mut point = surface.local_point(ray.at(hit.t), hit);
            point.footprint = surface.footprint(footprint);
            return point;
        }
        let (to_world, to_group) = &self.instances[hit.instance as usize];
        let met = to_group.transform_point3(ray.at(hit.t));
        let local = surface.local_point(met, hit);
        let along = match &surface.form {
            Form::Mesh(mesh) if mesh.tangents.is_some() => local.frame.s,
            _ => local.dp_du,
        };
        let mut point = to_world_point(local, along, to_world, to_group);
        point.footprint = surface.footprint(footprint);
        point
    }
}

impl Surfaces {
    /// Reads a word of everything in the meshes that [`Surfaces::point`] will read for these hits.
    /// Called in advance for many hits in a row, so that the processor waits for all of them at
    /// once: hits are scattered over memory, and waiting for each took a tenth of a render.
    #[inline]
    pub fn prefetch(&self, hits: &[Hit]) {
        let mut sum = 0;
        for hit in hits.iter().filter(|h| h.is_some()) {
            if let Form::Mesh(mesh) = &self.list[hit.shape as usize].form {
                sum ^= touch_triangle(mesh, hit.prim);
            }
        }
        std::hint::black_box(sum);
    }
}

#[inline]
fn touch_triangle(mesh: &Mesh, prim: u32) -> u32 {
    let corners = mesh.triangles.triangles()[prim as usize];
    let positions = mesh.triangles.positions();
    let mut sum = 0;
    for i in corners.map(|i| i as usize) {
        sum ^= positions[i].x.to_bits();
        if let Some(normals) = &mesh.normals {
            sum ^= normals[i].x.to_bits();
        }
        if let Some(uvs) = &mesh.uvs {
            sum ^= uvs[i].x.to_bits();
        }
    }
    sum
}

impl Opacity for Surfaces {
    fn opacity(&self, hit: &Hit) -> f32 {
        let surface = &self.list[hit.shape as usize];
        // Opacity is read from a texture: only texture coordinates matter, and those need no ray
        // for triangles. Exact shapes carry theirs in the hit.
        let point = match &surface.form {
            Form::Mesh(_) => surface.local_point(Vec3::ZERO, hit),
            Form::Analytic(..) => SurfacePoint::at_uv(Vec2::new(hit.u, hit.v)),
        };
        self.materials.opacity(surface.material, &point)
    }
}

impl Surface {
    /// The width that textures are averaged over, of a cone of this width.
    #[inline(always)]
    fn footprint(&self, width: f32) -> f32 {
        if self.needs.footprint { width } else { 0.0 }
    }

    /// The point in the shape's own space (world space unless it is in a group).
    #[inline(always)]
    fn local_point(&self, met: Vec3, hit: &Hit) -> SurfacePoint<'_> {
        match &self.form {
            Form::Mesh(mesh) => mesh_point(mesh, hit, self.needs),
            Form::Analytic(shape, flip) => exact_point(shape, *flip, met, hit),
        }
    }
}

/// How far the plane that a ray tracer computes from the edges may be from the triangle's: the
/// rounding of the edges' product turns the normal by that over the product's length, which is
/// little unless the triangle is long and thin. Guarded by the stability suite's
/// `s03_triangles_are_left`.
#[inline]
fn plane_error(e1: Vec3, e2: Vec3, cross_length: f32) -> f32 {
    let edges = e1.length_squared() * e2.length_squared();
    let longest = e1.length_squared().max(e2.length_squared()).sqrt();
    let turned = gamma(3) * edges.sqrt() / cross_length.max(f32::MIN_POSITIVE);
    turned.min(MOST_TURNED) * longest
}

#[inline(always)]
fn mesh_point<'a>(mesh: &'a Mesh, hit: &Hit, needs: Needs) -> SurfacePoint<'a> {
    let vertices = mesh.triangles.triangles()[hit.prim as usize];
    let [a, b, c] = mesh.triangles.corners(hit.prim);
    let (e1, e2) = (b - a, c - a);
    let w = 1.0 - hit.u - hit.v;
    let p = a * w + b * hit.u + c * hit.v;
    let cross = e1.cross(e2);
    let cross_length = cross.length();
    let error = (a.abs() * w.abs() + b.abs() * hit.u.abs() + c.abs() * hit.v.abs())
        * (ERROR_SAFETY * gamma(7))
        + Vec3::splat(plane_error(e1, e2, cross_length));
    let ng = cross.normalize_or(Vec3::Z);

    let corner_uvs = mesh
        .uvs
        .as_ref()
        .map(|uvs| vertices.map(|i| uvs[i as usize]));
    let uv = corner_uvs.map_or(Vec2::new(hit.u, hit.v), |[ta, tb, tc]| {
        ta * w + tb * hit.u + tc * hit.v
    });
    let corner_normals = mesh
        .normals
        .as_ref()
        .map(|normals| vertices.map(|i| normals[i as usize]));
    let n = corner_normals.map_or(ng, |[na, nb, nc]| {
        (na * w + nb * hit.u + nc * hit.v).normalize_or(ng)
    });

    let mut point = SurfacePoint {
        p,
        error,
        ng,
        frame: Frame::new(n),
        dp_du: Vec3::ZERO,
        dp_dv: Vec3::ZERO,
        dn_du: Vec3::ZERO,
        dn_dv: Vec3::ZERO,
        uv,
        footprint: 0.0,
        prim: hit.prim,
        vertices,
        barycentric: Vec2::new(hit.u, hit.v),
        attributes: (!mesh.attributes.list.is_empty()).then_some(&mesh.attributes),
    };
    if needs.tangents {
        let along = UvInverse::new(corner_uvs);
        (point.dp_du, point.dp_dv) = along.map_or_else(|| tangents_of(ng), |m| m.apply(e1, e2));
        point.frame = Frame::with_tangent(n, given_tangent(mesh, hit).unwrap_or(point.dp_du));
        if let (true, Some(m), Some(normals)) = (needs.normal_change, along, corner_normals) {
            change_normal(&mut point, &m, normals);
        }
    }
    point
}

/// Sets how the normal of a triangle's point changes with u and v.
fn change_normal(point: &mut SurfacePoint, along: &UvInverse, [na, nb, nc]: [Vec3; 3]) {
    let (n, Vec2 { x: u, y: v }) = (point.frame.n, point.barycentric);
    let (du, dv) = along.apply(nb - na, nc - na);
    let mean = na * (1.0 - u - v) + nb * u + nc * v;
    let scale = mean.length().max(1e-6).recip();
    point.dn_du = (du - n * n.dot(du)) * scale;
    point.dn_dv = (dv - n * n.dot(dv)) * scale;
}

/// The tangent that the mesh's file gives for a point, if it gives any: it wins over that along u.
#[inline]
fn given_tangent(mesh: &Mesh, hit: &Hit) -> Option<Vec3> {
    let tangents = mesh.tangents.as_ref()?;
    let corners = mesh.triangles.triangles()[hit.prim as usize];
    let [a, b, c] = corners.map(|i| tangents[i as usize].truncate());
    let tangent = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
    (tangent.length_squared() > 1e-6).then_some(tangent)
}

/// Tangents where the texture coordinates give none.
fn tangents_of(n: Vec3) -> (Vec3, Vec3) {
    let frame = Frame::new(n);
    (frame.s, frame.t)
}

/// The inverse of the map from a triangle's edges to texture coordinates.
#[derive(Clone, Copy)]
struct UvInverse {
    d1: Vec2,
    d2: Vec2,
    inv_det: f32,
}

impl UvInverse {
    /// `None` where the coordinates are missing or collapse to a line.
    #[inline]
    fn new(uvs: Option<[Vec2; 3]>) -> Option<Self> {
        let [a, b, c] = uvs?;
        let (d1, d2) = (b - a, c - a);
        let det = d1.perp_dot(d2);
        // Below this the tangents would be rounding noise: 2^-40 of the coordinates' own area.
        if det.abs() <= 1e-12 * d1.length_squared().max(d2.length_squared()) || !det.is_finite() {
            return None;
        }
        Some(Self {
            d1,
            d2,
            inv_det: det.recip(),
        })
    }

    /// Derivatives along u and v of a quantity that changes by `e1`, `e2` along the edges.
    #[inline]
    fn apply(&self, e1: Vec3, e2: Vec3) -> (Vec3, Vec3) {
        (
            (e1 * self.d2.y - e2 * self.d1.y) * self.inv_det,
            (e2 * self.d1.x - e1 * self.d2.x) * self.inv_det,
        )
    }
}
