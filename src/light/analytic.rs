//! Disks, cylinders and stretched spheres that glow, sampled uniformly over the unit shape.
//!
//! An affine map stretches area by a factor that depends on the unit normal alone, `J = |det M|
//! |M^-T n|`, so a uniform point of the unit shape has density `1 / (A J)` in the world.

use super::cluster::Cluster;
use super::incident::{EmitterPlace, Incident, at_distance, solid_angle_density};
use crate::accel::{AnalyticKind, AnalyticShape};
use crate::math::warp::{concentric_disk, uniform_sphere};
use crate::math::{Mat3, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A unit shape placed by an affine map, that glows.
#[derive(Clone, Copy, Debug)]
pub(super) struct AnalyticArea {
    shape: AnalyticShape,
    /// `|det M| M^-T`: a unit normal to a world normal as long as area is stretched.
    normals: Mat3,
    area: f32,
    sign: f32,
}

/// Area of a unit shape.
fn unit_area(kind: AnalyticKind) -> f32 {
    match kind {
        AnalyticKind::Sphere => 4.0 * PI,
        AnalyticKind::Disk => PI,
        AnalyticKind::Cylinder => TAU,
        AnalyticKind::Rectangle => 4.0,
    }
}

/// Points of the grid by which a stretched sphere's or cylinder's area is measured, on each side.
const AREA_GRID: usize = 64;

impl AnalyticArea {
    /// `None` if the map leaves no area.
    pub fn new(shape: AnalyticShape, flip: bool) -> Option<Self> {
        let m = Mat3::from(shape.to_world.matrix3);
        // The cofactor matrix: det M * M^-T even where M flattens the shape to nothing along its
        // normal.
        let cofactors = Mat3::from_cols(
            m.y_axis.cross(m.z_axis),
            m.z_axis.cross(m.x_axis),
            m.x_axis.cross(m.y_axis),
        );
        let mirrored = m.determinant() < 0.0;
        let mut light = Self {
            shape,
            normals: if mirrored {
                cofactors * -1.0
            } else {
                cofactors
            },
            area: 0.0,
            sign: if flip { -1.0 } else { 1.0 },
        };
        let mean: f64 = (0..AREA_GRID * AREA_GRID)
            .map(|i| {
                let u = Vec2::new((i % AREA_GRID) as f32, (i / AREA_GRID) as f32);
                let (_, n) = light.unit_point((u + 0.5) / AREA_GRID as f32);
                f64::from((light.normals * n).length())
            })
            .sum::<f64>()
            / (AREA_GRID * AREA_GRID) as f64;
        light.area = mean as f32 * unit_area(shape.kind);
        light.area.is_normal().then_some(light)
    }

    pub fn area(&self) -> f32 {
        self.area
    }

    pub fn cluster(&self, radiance: f32) -> Cluster {
        let b = self.shape.bounds();
        let corners = [b.min, b.max];
        match self.shape.kind {
            AnalyticKind::Disk | AnalyticKind::Rectangle => {
                let n = (self.normals * Vec3::Z).normalize() * self.sign;
                let cluster = Cluster::around(&corners, n, 1.0, radiance * self.area);
                let radius = match self.shape.kind {
                    AnalyticKind::Disk => self.longest_axis().min(cluster.radius),
                    _ => cluster.radius,
                };
                Cluster { radius, ..cluster }
            }
            // Seen from any side about a third (cylinder) or a quarter (sphere) of the area faces a
            // point.
            AnalyticKind::Cylinder => {
                Cluster::around(&corners, Vec3::Z, -1.0, radiance * self.area / PI)
            }
            AnalyticKind::Sphere => {
                Cluster::around(&corners, Vec3::Z, -1.0, radiance * self.area * 0.25)
            }
        }
    }

    /// The longer half axis of a disk, which a map may have made an ellipse: the root of the larger
    /// eigenvalue of its metric. The box around a disk is wider, and half of what is aimed at that
    /// would miss.
    fn longest_axis(&self) -> f32 {
        let [x, y] = [Vec3::X, Vec3::Y].map(|v| self.shape.to_world.transform_vector3(v));
        let (sum, difference) = (x.dot(x) + y.dot(y), x.dot(x) - y.dot(y));
        (0.5 * (sum + difference.hypot(2.0 * x.dot(y)))).sqrt() * 1.000_01
    }

    /// A point of the unit shape and its unit normal.
    fn unit_point(&self, u: Vec2) -> (Vec3, Vec3) {
        match self.shape.kind {
            AnalyticKind::Sphere => {
                let n = uniform_sphere(u);
                (n, n)
            }
            AnalyticKind::Disk => (concentric_disk(u).extend(0.0), Vec3::Z),
            AnalyticKind::Cylinder => {
                let (sin, cos) = (TAU * u.x).sin_cos();
                (Vec3::new(cos, sin, u.y), Vec3::new(cos, sin, 0.0))
            }
            AnalyticKind::Rectangle => ((u * 2.0 - 1.0).extend(0.0), Vec3::Z),
        }
    }

    /// A point in the world, its unit normal on the glowing side, and the density in area.
    pub fn point(&self, u: Vec2) -> (Vec3, Vec3, f32) {
        let (q, n) = self.unit_point(u);
        let n = self.normals * n;
        let stretch = n.length();
        (
            self.shape.to_world.transform_point3(q),
            n * (self.sign / stretch),
            1.0 / (stretch * unit_area(self.shape.kind)),
        )
    }

    #[inline]
    pub fn sample(&self, p: Vec3, u: Vec2) -> Option<Incident> {
        let (q, n, density) = self.point(u);
        at_distance(p, q, n, density, EmitterPlace::Surface)
    }

    /// `ng` is the normal at `q`, from which the stretch follows: `n = M^T N / |M^T N|` and `J =
    /// |det M| / |M^T N|` for the unit world normal `N`.
    #[inline]
    pub fn pdf(&self, p: Vec3, q: Vec3, ng: Vec3) -> f32 {
        let n = match self.shape.kind {
            AnalyticKind::Disk | AnalyticKind::Rectangle => Vec3::Z,
            AnalyticKind::Sphere | AnalyticKind::Cylinder => {
                let unit = self.shape.to_world.matrix3.transpose();
                let n = Vec3::from(unit * crate::math::Vec3A::from(ng));
                n.normalize_or_zero() * self.sign
            }
        };
        let stretched = self.normals * n;
        let stretch = stretched.length();
        let normal = stretched * (self.sign / stretch);
        let density = 1.0 / (stretch * unit_area(self.shape.kind));
        solid_angle_density(p, q, normal, density)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Affine3A, Pcg32};

    /// The ball of a disk, stretched or not, holds it and is no larger than it has to be.
    #[test]
    fn a_ball_around_a_disk_fits() {
        let turned = Affine3A::from_rotation_x(0.7) * Affine3A::from_rotation_y(-0.3);
        let sheared = Affine3A::from_scale(Vec3::new(2.0, 0.5, 1.0)) * turned;
        let long = turned * Affine3A::from_scale(Vec3::new(3.0, 0.2, 1.0));
        for map in [turned, sheared, long] {
            let disk =
                AnalyticArea::new(AnalyticShape::new(AnalyticKind::Disk, map), false).unwrap();
            let Cluster { center, radius, .. } = disk.cluster(1.0);
            let mut rng = Pcg32::new(3, 3);
            let distances = (0..20_000).map(|_| {
                let (p, _, _) = disk.point(Vec2::new(rng.next_f32(), rng.next_f32()));
                p.distance(center)
            });
            let farthest = distances.fold(0.0, f32::max);
            assert!(
                farthest <= radius && farthest > 0.99 * radius,
                "{farthest} of {radius}"
            );
        }
    }
}
