//! Round shapes: exact where they are whole, meshes where they are parts.

use super::graphics::single;
use super::importer::Importer;
use super::params::Params;
use super::pending::{InlineKind, PendingGeometry, Round, RoundKind};
use crate::accel::{AnalyticKind, AnalyticShape};
use crate::math::{DAffine3, DVec3};
use crate::scene::Geometry;

impl<'s> Importer<'s> {
    /// A shape turned around z as a mesh, as far around as `phimax`.
    pub fn round(&mut self, p: &Params<'_, 's>, kind: RoundKind) -> InlineKind<'s> {
        let phi = p.float_in("phimax", 360.0, 0.0..=360.0).to_radians();
        InlineKind::Round(Round { kind, phi })
    }

    fn is_whole(p: &Params) -> bool {
        p.float("phimax", 360.0) >= 360.0
    }

    /// Says that a part of a round shape is made of triangles.
    fn tell_part(&mut self, p: &Params) {
        let name = p.name();
        self.warn_at(
            p.at(),
            &format!("this part of a {name} is rendered as a mesh"),
        );
    }

    fn exact(&mut self, p: &Params, kind: AnalyticKind, placed: DAffine3) -> PendingGeometry<'s> {
        if placed.matrix3.determinant() == 0.0 {
            self.warn_at(
                p.at(),
                "this shape is flattened to nothing and will not be seen",
            );
        }
        let shape = AnalyticShape::new(kind, single(placed));
        PendingGeometry::Ready(Geometry::Analytic(shape))
    }

    /// A sphere, or a part between two heights.
    pub fn sphere(&mut self, p: &Params<'_, 's>, to_world: DAffine3) -> PendingGeometry<'s> {
        let radius = p.positive("radius", 1.0);
        let z = [p.float("zmin", -radius), p.float("zmax", radius)];
        if Self::is_whole(p) && z[0] <= -radius && z[1] >= radius {
            // v grows upwards in pbrt, downwards here.
            let scale = DVec3::new(radius, radius, -radius);
            return self.exact(
                p,
                AnalyticKind::Sphere,
                to_world * DAffine3::from_scale(scale),
            );
        }
        self.tell_part(p);
        let kind = self.round(p, RoundKind::Sphere { radius, z });
        self.inline(to_world, kind)
    }

    /// An open cylinder around z.
    pub fn cylinder(&mut self, p: &Params<'_, 's>, to_world: DAffine3) -> PendingGeometry<'s> {
        let radius = p.positive("radius", 1.0);
        let z = [p.float("zmin", -1.0), p.float("zmax", 1.0)];
        if Self::is_whole(p) {
            let [low, high] = [z[0].min(z[1]), z[0].max(z[1])];
            let placed = DAffine3::from_translation(DVec3::Z * low)
                * DAffine3::from_scale(DVec3::new(radius, radius, high - low));
            return self.exact(p, AnalyticKind::Cylinder, to_world * placed);
        }
        self.tell_part(p);
        let kind = self.round(p, RoundKind::Cylinder { radius, z });
        self.inline(to_world, kind)
    }

    /// A disk; one with textures is a mesh, since its coordinates are others than here.
    pub fn disk(
        &mut self,
        p: &Params<'_, 's>,
        to_world: DAffine3,
        textured: bool,
    ) -> PendingGeometry<'s> {
        let (height, radius) = (p.float("height", 0.0), p.positive("radius", 1.0));
        let inner = p.float_in("innerradius", 0.0, 0.0..=radius);
        let whole = Self::is_whole(p) && inner == 0.0;
        if whole && !textured {
            let placed = DAffine3::from_translation(DVec3::Z * height)
                * DAffine3::from_scale(DVec3::new(radius, radius, 1.0));
            return self.exact(p, AnalyticKind::Disk, to_world * placed);
        }
        if !whole {
            self.tell_part(p);
        }
        let radii = [inner, radius];
        let kind = self.round(p, RoundKind::Disk { height, radii });
        self.inline(to_world, kind)
    }
}
