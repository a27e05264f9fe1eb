//! Points on surfaces, as textures and materials see them.

use crate::accel::Ray;
use crate::math::offset::offset_origin;
use crate::math::{Frame, Rgb, Vec2, Vec3};

/// Values that a mesh carries along with its vertices or faces, under a name.
#[derive(Debug, Clone, Default)]
pub struct MeshAttributes {
    /// The attributes, few enough to search.
    pub list: Vec<MeshAttribute>,
}

/// One attribute of a mesh.
#[derive(Debug, Clone)]
pub struct MeshAttribute {
    /// Its name as textures ask for it, such as `vertex_color` or `face_color`.
    pub name: String,
    /// A value for each face instead of each vertex.
    pub per_face: bool,
    /// One value for each vertex or face.
    pub values: Vec<Rgb>,
}

/// A point on a surface, with what textures and materials need to know about it. World space.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<'a> {
    /// Position.
    pub p: Vec3,
    /// Rounding error bound of `p` on each axis (see [`crate::math::offset`]).
    pub error: Vec3,
    /// Unit geometric normal: the side it points to is "outside".
    pub ng: Vec3,
    /// Shading frame: `n` is the interpolated normal, `s` follows dp/du.
    pub frame: Frame,
    /// Change of position with u.
    pub dp_du: Vec3,
    /// Change of position with v.
    pub dp_dv: Vec3,
    /// Change of the (unnormalised direction of the) shading normal with u; zero for flat shapes.
    pub dn_du: Vec3,
    /// Change of the shading normal with v.
    pub dn_dv: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Width in world units of what a pixel sees here (a ray cone's width); 0 asks for the finest
    /// level.
    pub footprint: f32,
    /// Triangle index in its mesh.
    pub prim: u32,
    /// Vertex indices of that triangle.
    pub vertices: [u32; 3],
    /// Barycentric weights of the second and third vertex.
    pub barycentric: Vec2,
    /// The mesh's attributes, if it has any.
    pub attributes: Option<&'a MeshAttributes>,
}

impl SurfacePoint<'_> {
    /// The geometric and the shading normal.
    #[inline]
    pub fn normals(&self) -> [Vec3; 2] {
        [self.ng, self.frame.n]
    }

    /// The shading normal on the side of `w`.
    #[inline]
    pub fn facing(&self, w: Vec3) -> Vec3 {
        if self.frame.n.dot(w) < 0.0 {
            -self.frame.n
        } else {
            self.frame.n
        }
    }

    /// A ray that leaves the point, to the side of its direction.
    #[inline]
    pub fn spawn_ray(&self, dir: Vec3) -> Ray {
        Ray::new(offset_origin(self.p, self.error, self.ng, dir), dir)
    }

    /// A point inside of a medium, seen from `wo`: rays that leave it begin there.
    pub fn in_volume(p: Vec3, wo: Vec3, footprint: f32) -> SurfacePoint<'static> {
        SurfacePoint {
            p,
            ng: wo,
            frame: Frame::new(wo),
            footprint,
            ..SurfacePoint::at_uv(Vec2::ZERO)
        }
    }

    /// A point that stands for no surface in particular, at the given texture coordinates: for
    /// evaluating a texture by itself.
    pub fn at_uv(uv: Vec2) -> SurfacePoint<'static> {
        SurfacePoint {
            p: Vec3::ZERO,
            error: Vec3::ZERO,
            ng: Vec3::Z,
            frame: Frame {
                s: Vec3::X,
                t: Vec3::Y,
                n: Vec3::Z,
            },
            dp_du: Vec3::X,
            dp_dv: Vec3::Y,
            dn_du: Vec3::ZERO,
            dn_dv: Vec3::ZERO,
            uv,
            footprint: 0.0,
            prim: 0,
            vertices: [0; 3],
            barycentric: Vec2::ZERO,
            attributes: None,
        }
    }
}

impl SurfacePoint<'_> {
    /// The mesh's attribute of that name here; black where there is none.
    pub(super) fn attribute(&self, name: &str) -> Rgb {
        let list = self.attributes.map_or(&[][..], |a| &a.list);
        let Some(attribute) = list.iter().find(|a| a.name == name) else {
            return Rgb::ZERO;
        };
        let value = |i: u32| {
            attribute
                .values
                .get(i as usize)
                .copied()
                .unwrap_or(Rgb::ZERO)
        };
        if attribute.per_face {
            return value(self.prim);
        }
        let [a, b, c] = self.vertices.map(value);
        let Vec2 { x: u, y: v } = self.barycentric;
        a * (1.0 - u - v) + b * u + c * v
    }
}
