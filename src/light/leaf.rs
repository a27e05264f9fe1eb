//! One thing that shines from within the scene: what the light tree has at its leaves.

use super::cluster::Cluster;
use super::exact::ExactArea;
use super::point::PointLight;
use super::projector::Projector;
use super::quad::Quad;
use super::sphere::Sphere;
use super::spot::Spot;
use super::triangle::Triangle;
use crate::math::{Rgb, Vec2, Vec3};

/// Where on an area light a sample fell, as its texture needs to know.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// On a triangle of the mesh, at the weights of its second and third corner.
    Barycentric(u32, Vec2),
    /// On an exact shape: its texture coordinates follow from the position.
    Surface,
}

/// Light that arrives at a point, before its radiance is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Incident {
    /// Unit direction to the light.
    pub dir: Vec3,
    /// Distance to it.
    pub distance: f32,
    /// Density in solid angle.
    pub pdf: f32,
    /// Where on the light.
    pub place: Place,
}

/// A leaf.
#[derive(Debug)]
pub(super) enum Leaf {
    Triangle(Triangle),
    Quad(Box<Quad>),
    Sphere(Sphere),
    Exact(Box<ExactArea>),
    Point(PointLight),
    Spot(Box<Spot>),
    Projector(Box<Projector>),
}

/// Light from a place without extent: unit direction to it, distance, irradiance facing it.
pub(super) struct DeltaIncident {
    pub dir: Vec3,
    pub distance: f32,
    pub irradiance: Rgb,
}

/// The sample that the point `q` with normal `n`, drawn with `density` in area, is for `p`.
#[inline]
pub(super) fn at_distance(
    p: Vec3,
    q: Vec3,
    n: Vec3,
    density: f32,
    place: Place,
) -> Option<Incident> {
    let to = q - p;
    let distance = to.length();
    let dir = to / distance;
    let cos = -dir.dot(n);
    let pdf = distance * distance * density / cos;
    // Also refuses q = p, whose direction is not a number, and a density that overflows: what
    // divides by it would be lost or not a number.
    if cos > 0.0 && pdf > 0.0 && pdf.is_finite() {
        Some(Incident {
            dir,
            distance,
            pdf,
            place,
        })
    } else {
        None
    }
}

/// The density of [`at_distance`] alone; 0 where it draws nothing.
#[inline]
pub(super) fn solid_angle_density(p: Vec3, q: Vec3, n: Vec3, density: f32) -> f32 {
    at_distance(p, q, n, density, Place::Surface).map_or(0.0, |i| i.pdf)
}

impl Leaf {
    /// Its bounds and what it can send, for a light of this brightness.
    pub fn cluster(&self, brightness: f32) -> Cluster {
        match self {
            Leaf::Triangle(l) => l.cluster(brightness),
            Leaf::Quad(l) => l.cluster(brightness),
            Leaf::Sphere(l) => l.cluster(brightness),
            Leaf::Exact(l) => l.cluster(brightness),
            Leaf::Point(l) => l.cluster(),
            Leaf::Spot(l) => l.cluster(),
            Leaf::Projector(l) => l.cluster(),
        }
    }

    /// Area of a surface that glows; 0 for lights without extent.
    pub fn area(&self) -> f32 {
        match self {
            Leaf::Triangle(l) => l.area(),
            Leaf::Quad(l) => l.area(),
            Leaf::Sphere(l) => l.area(),
            Leaf::Exact(l) => l.area(),
            Leaf::Point(_) | Leaf::Spot(_) | Leaf::Projector(_) => 0.0,
        }
    }

    /// Samples a direction from `p` to a surface that glows.
    #[inline]
    pub fn sample(&self, p: Vec3, u: Vec2) -> Option<Incident> {
        match self {
            Leaf::Triangle(l) => l.sample(p, u),
            Leaf::Quad(l) => l.sample(p, u),
            Leaf::Sphere(l) => l.sample(p, u),
            Leaf::Exact(l) => l.sample(p, u),
            Leaf::Point(_) | Leaf::Spot(_) | Leaf::Projector(_) => None,
        }
    }

    /// Light from a place without extent.
    #[inline]
    pub fn delta(&self, p: Vec3) -> Option<DeltaIncident> {
        match self {
            Leaf::Point(l) => l.incident(p),
            Leaf::Spot(l) => l.incident(p),
            Leaf::Projector(l) => l.incident(p),
            _ => None,
        }
    }

    /// Density with which [`Leaf::sample`] draws the direction from `p` to `q` on it, where the surface has normal `ng`.
    #[inline]
    pub fn pdf(&self, p: Vec3, q: Vec3, ng: Vec3) -> f32 {
        match self {
            Leaf::Triangle(l) => l.pdf(p, q),
            Leaf::Quad(l) => l.pdf(p, q),
            Leaf::Sphere(l) => l.pdf(p, q),
            Leaf::Exact(l) => l.pdf(p, q, ng),
            Leaf::Point(_) | Leaf::Spot(_) | Leaf::Projector(_) => 0.0,
        }
    }

    /// A point of a surface that glows, its normal, the density in area, and the place.
    pub fn point(&self, u: Vec2) -> (Vec3, Vec3, f32, Place) {
        match self {
            Leaf::Triangle(l) => {
                let (p, n, place) = l.point(u);
                (p, n, 1.0 / l.area(), place)
            }
            Leaf::Quad(l) => {
                let (p, n) = l.point(u);
                (p, n, 1.0 / l.area(), Place::Surface)
            }
            Leaf::Sphere(l) => {
                let (p, n) = l.point(u);
                (p, n, 1.0 / l.area(), Place::Surface)
            }
            Leaf::Exact(l) => {
                let (p, n, density) = l.point(u);
                (p, n, density, Place::Surface)
            }
            Leaf::Point(_) | Leaf::Spot(_) | Leaf::Projector(_) => {
                (Vec3::ZERO, Vec3::ZERO, 0.0, Place::Surface)
            }
        }
    }
}
