//! The rays of a path tracer: from the camera, between what it sees, and on from there.

use super::subject::Subject;
use crate::accel::{Ray, RayQuery};
use crate::camera::Camera;
use crate::cli::Failure;
use crate::math::offset::offset_origin;
use crate::math::{Frame, Pcg32, Vec2, Vec3, warp};

/// A kind of ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// From the camera, tile by tile: neighbours go the same way.
    Camera,
    /// Between two points that the camera sees, as if each could be a lamp.
    Shadow,
    /// From a point that the camera sees, in a direction with the density of a white wall.
    Diffuse,
}

/// As many rays of each kind.
pub struct RaySets {
    /// See [`Kind::Camera`].
    pub camera: Vec<Ray>,
    shadow: Vec<Ray>,
    diffuse: Vec<Ray>,
}

/// Where a camera ray met something.
#[derive(Clone, Copy)]
struct Vertex {
    p: Vec3,
    error: Vec3,
    /// Normal on the side of the ray.
    normal: Vec3,
}

impl Vertex {
    fn leave(&self, dir: Vec3) -> Ray {
        Ray::new(offset_origin(self.p, self.error, self.normal, dir), dir)
    }
}

/// Side of a tile of camera rays.
const TILE: u32 = 16;
/// How often another point is drawn for a shadow ray that would run below a surface.
const TRIES: usize = 8;

impl RaySets {
    /// About `count` rays of each kind.
    ///
    /// # Errors
    /// When the camera sees nothing.
    pub fn of(subject: &Subject, count: u32) -> Result<Self, Failure> {
        let mut rng = Pcg32::new(7, 7);
        let camera = camera_rays(subject, count, &mut rng);
        let vertices: Vec<Vertex> = camera.iter().filter_map(|r| vertex(subject, r)).collect();
        if vertices.is_empty() {
            return Err(Failure::wrong(
                "no ray of the camera meets anything",
                "give a scene whose camera sees its shapes, or a mesh file",
            ));
        }
        let from = || vertices.iter().cycle().take(camera.len());
        let shadow = from().map(|v| shadow_ray(v, &vertices, &mut rng)).collect();
        let diffuse = from()
            .map(|v| {
                let local = warp::cosine_hemisphere(uniform(&mut rng));
                v.leave(Frame::new(v.normal).to_world(local))
            })
            .collect();
        Ok(Self {
            camera,
            shadow,
            diffuse,
        })
    }

    /// The rays of a kind.
    pub fn of_kind(&self, kind: Kind) -> &[Ray] {
        match kind {
            Kind::Camera => &self.camera,
            Kind::Shadow => &self.shadow,
            Kind::Diffuse => &self.diffuse,
        }
    }

    /// Share of the shadow rays that are blocked: rates depend on it.
    pub fn blocked_share(&self, tracer: &dyn RayQuery) -> f64 {
        let mut blocked = vec![false; self.shadow.len()];
        tracer.occluded_batch(&self.shadow, &mut blocked);
        blocked.iter().filter(|b| **b).count() as f64 / blocked.len() as f64
    }
}

fn uniform(rng: &mut Pcg32) -> Vec2 {
    Vec2::new(rng.next_f32(), rng.next_f32())
}

/// One ray a pixel, of a film with the scene's proportions and whole tiles.
fn camera_rays(subject: &Subject, count: u32, rng: &mut Pcg32) -> Vec<Ray> {
    let tiles = f64::from(count) / f64::from(TILE * TILE);
    let columns = ((tiles * subject.aspect).sqrt().round() as u32).clamp(1, tiles as u32);
    let rows = (tiles as u32 / columns).max(1);
    let camera = Camera::new(&subject.camera, columns * TILE, rows * TILE);
    let mut rays = Vec::with_capacity((columns * rows * TILE * TILE) as usize);
    for tile in 0..columns * rows {
        let corner = Vec2::new((tile % columns) as f32, (tile / columns) as f32) * TILE as f32;
        for pixel in 0..TILE * TILE {
            let inside = Vec2::new((pixel % TILE) as f32, (pixel / TILE) as f32);
            let film = corner + inside + uniform(rng);
            let camera = camera.ray(film, uniform(rng));
            rays.extend(camera.sees.then_some(camera.ray));
        }
    }
    rays
}

fn vertex(subject: &Subject, ray: &Ray) -> Option<Vertex> {
    let hit = subject.scene.rays.intersect(ray);
    if !hit.is_some() {
        return None;
    }
    let point = subject.scene.surfaces.point(ray, &hit, 0.0);
    let towards = point.ng.dot(ray.dir) < 0.0;
    Some(Vertex {
        p: point.p,
        error: point.error,
        normal: if towards { point.ng } else { -point.ng },
    })
}

/// A ray to another vertex that lies above this one's surface, and this one above its.
fn shadow_ray(from: &Vertex, all: &[Vertex], rng: &mut Pcg32) -> Ray {
    /// Stops short of the surface that it goes to.
    const SHORT: f32 = 1.0 - 1e-3;
    for _ in 0..TRIES {
        let to = &all[rng.next_u32() as usize % all.len()];
        let way = to.p - from.p;
        let dir = way.normalize_or_zero();
        if from.normal.dot(dir) > 0.0 && to.normal.dot(dir) < 0.0 {
            let mut ray = from.leave(dir);
            ray.tmax = way.length() * SHORT;
            return ray;
        }
    }
    // What is convex sees no other part of itself: a lamp far away, then.
    from.leave(Frame::new(from.normal).to_world(warp::cosine_hemisphere(uniform(rng))))
}
