//! One thing that shines from within the scene: what the light tree has at its leaves.

use super::analytic::AnalyticArea;
use super::cluster::Cluster;
use super::goniometric::Goniometric;
use super::incident::{DeltaIncident, EmitterPlace, Incident};
use super::point::PointLight;
use super::projector::Projector;
use super::quad::Quad;
use super::sphere::Sphere;
use super::spot::Spot;
use super::triangle::Triangle;
use crate::math::{Vec2, Vec3};

/// A leaf.
#[derive(Debug)]
pub(super) enum Leaf {
    Triangle(Triangle),
    Quad(Box<Quad>),
    Sphere(Sphere),
    Analytic(Box<AnalyticArea>),
    Point(PointLight),
    Spot(Box<Spot>),
    Projector(Box<Projector>),
    Goniometric(Box<Goniometric>),
}

impl Leaf {
    /// Its bounds and what it can send, for a light of this brightness.
    pub fn cluster(&self, brightness: f32) -> Cluster {
        match self {
            Leaf::Triangle(l) => l.cluster(brightness),
            Leaf::Quad(l) => l.cluster(brightness),
            Leaf::Sphere(l) => l.cluster(brightness),
            Leaf::Analytic(l) => l.cluster(brightness),
            Leaf::Point(l) => l.cluster(),
            Leaf::Spot(l) => l.cluster(),
            Leaf::Projector(l) => l.cluster(),
            Leaf::Goniometric(l) => l.cluster(),
        }
    }

    /// Area of a surface that glows; 0 for lights without extent.
    pub fn area(&self) -> f32 {
        match self {
            Leaf::Triangle(l) => l.area(),
            Leaf::Quad(l) => l.area(),
            Leaf::Sphere(l) => l.area(),
            Leaf::Analytic(l) => l.area(),
            Leaf::Point(_) | Leaf::Spot(_) | Leaf::Projector(_) | Leaf::Goniometric(_) => 0.0,
        }
    }

    /// Samples a direction from `p` to a surface that glows.
    #[inline]
    pub fn sample(&self, p: Vec3, u: Vec2) -> Option<Incident> {
        match self {
            Leaf::Triangle(l) => l.sample(p, u),
            Leaf::Quad(l) => l.sample(p, u),
            Leaf::Sphere(l) => l.sample(p, u),
            Leaf::Analytic(l) => l.sample(p, u),
            Leaf::Point(_) | Leaf::Spot(_) | Leaf::Projector(_) | Leaf::Goniometric(_) => None,
        }
    }

    /// Light from a place without extent.
    #[inline]
    pub fn delta(&self, p: Vec3) -> Option<DeltaIncident> {
        match self {
            Leaf::Point(l) => l.incident(p),
            Leaf::Spot(l) => l.incident(p),
            Leaf::Projector(l) => l.incident(p),
            Leaf::Goniometric(l) => l.incident(p),
            _ => None,
        }
    }

    /// Density with which [`Leaf::sample`] draws the direction from `p` to `q` on it, where the
    /// surface has normal `ng`.
    #[inline]
    pub fn pdf(&self, p: Vec3, q: Vec3, ng: Vec3) -> f32 {
        match self {
            Leaf::Triangle(l) => l.pdf(p, q),
            Leaf::Quad(l) => l.pdf(p, q),
            Leaf::Sphere(l) => l.pdf(p, q),
            Leaf::Analytic(l) => l.pdf(p, q, ng),
            Leaf::Point(_) | Leaf::Spot(_) | Leaf::Projector(_) | Leaf::Goniometric(_) => 0.0,
        }
    }

    /// A point of a surface that glows, its normal, the density in area, and the place.
    pub fn point(&self, u: Vec2) -> (Vec3, Vec3, f32, EmitterPlace) {
        match self {
            Leaf::Triangle(l) => {
                let (p, n, place) = l.point(u);
                (p, n, 1.0 / l.area(), place)
            }
            Leaf::Quad(l) => {
                let (p, n) = l.point(u);
                (p, n, 1.0 / l.area(), EmitterPlace::Surface)
            }
            Leaf::Sphere(l) => {
                let (p, n) = l.point(u);
                (p, n, 1.0 / l.area(), EmitterPlace::Surface)
            }
            Leaf::Analytic(l) => {
                let (p, n, density) = l.point(u);
                (p, n, density, EmitterPlace::Surface)
            }
            Leaf::Point(_) | Leaf::Spot(_) | Leaf::Projector(_) | Leaf::Goniometric(_) => {
                (Vec3::ZERO, Vec3::ZERO, 0.0, EmitterPlace::Surface)
            }
        }
    }
}
