//! How photons leave their lights.
//!
//! What is far from all that they could land on, such as a sun that is a disk behind the scene,
//! sends them there alone: of those that leave a surface by the cosine, one in a thousand would
//! arrive. (`scenes/pool`: one in 650 taught something, now one in 14.)

use super::cluster::Cluster;
use super::distant::Distant;
use super::leaf::Leaf;
use super::target::Target;
use super::{EmitterId, Lights};
use crate::accel::Bounds;
use crate::math::distribution::{Discrete, widen};
use crate::math::rgb::selection_weight;
use crate::math::warp::{concentric_disk, cosine_hemisphere, uniform_cone, uniform_sphere};
use crate::math::{Frame, Rgb, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A photon at the moment it leaves its light.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Where it starts.
    pub org: Vec3,
    /// Unit direction it travels in.
    pub dir: Vec3,
    /// Unit normal of the emitting surface; zero for emitters without one.
    pub ng: Vec3,
    /// Power it carries: the emitter's radiance times cosine over the density of (emitter,
    /// position, direction).
    pub power: Rgb,
    /// Which emitter.
    pub emitter: EmitterId,
}

/// Everything photons can leave from, chosen by power: first the leaves of the light tree, then the
/// distant lights.
#[derive(Debug)]
pub(super) struct Sources {
    choice: Discrete,
    target: Target,
    /// Radius of a ball around the scene.
    radius: f32,
}

/// A light is not taken to send less than this part of what it sends along its normal: some of the
/// target may lie before it though the middle lies behind.
const LEAST_COSINE: f32 = 0.05;

impl Sources {
    /// For a scene within `bounds`, to land on what is within `target`. `None` if nothing shines.
    pub fn new(
        leaves: &[(EmitterId, Leaf, Rgb)],
        distant: &[(EmitterId, Distant)],
        bounds: Bounds,
        target: Bounds,
    ) -> Option<Self> {
        let target = Target::new(target);
        let disk = f64::from(PI) * f64::from(target.radius) * f64::from(target.radius);
        let local = leaves
            .iter()
            .map(|(_, leaf, radiance)| f64::from(power(leaf, *radiance, &target)));
        let far = distant
            .iter()
            .map(|(_, d)| f64::from(selection_weight(d.flux_per_area())) * disk);
        let weights: Vec<f64> = local.chain(far).collect();
        Some(Self {
            choice: Discrete::new(&weights)?,
            target,
            radius: bounds.radius(),
        })
    }

    /// The share of all power that a source has.
    pub fn share(&self, source: usize) -> f32 {
        self.choice.probability(source)
    }

    /// Radius of a ball around the scene.
    pub fn radius(&self) -> f32 {
        self.radius
    }
}

/// Power a leaf sends into the scene, as luminance; of what is far from the target, about what it
/// sends there.
fn power(leaf: &Leaf, radiance: Rgb, target: &Target) -> f32 {
    match leaf {
        Leaf::Point(l) => {
            let angle = target
                .cone(l.position)
                .map_or(4.0 * PI, |c| c.solid_angle());
            angle * selection_weight(l.intensity)
        }
        Leaf::Spot(l) => mean_power(|u| {
            let local = uniform_cone(u, l.one_minus_cos_cutoff());
            l.intensity(local) * (TAU * l.one_minus_cos_cutoff())
        }),
        Leaf::Projector(l) => mean_power(|u| l.slide(u) * l.slide_area()),
        Leaf::Goniometric(l) => selection_weight(l.power()),
        Leaf::Triangle(_) | Leaf::Quad(_) | Leaf::Sphere(_) | Leaf::Analytic(_) => {
            projected_angle(leaf, target) * leaf.area() * selection_weight(radiance)
        }
    }
}

/// Solid angle that a surface shines into, times the cosine, on average; about that, for what is
/// far from the target.
fn projected_angle(leaf: &Leaf, target: &Target) -> f32 {
    let Cluster { center, radius, .. } = leaf.cluster(1.0);
    let near = Target {
        radius: target.radius + radius,
        ..*target
    };
    if near.cone(center).is_none() {
        return PI;
    }
    mean(FACING_GRID, |u| {
        let (p, n, _, _) = leaf.point(u);
        target.cone(p).map_or(PI, |cone| {
            cone.solid_angle() * cone.axis.dot(n).max(LEAST_COSINE)
        })
    })
}

/// Points on each side of the grid by which it is measured how a surface faces what is far away.
const FACING_GRID: usize = 8;

/// Points on each side of the grid by which the power of spots and projectors is measured.
const POWER_GRID: usize = 64;

fn mean_power(power: impl Fn(Vec2) -> Rgb) -> f32 {
    mean(POWER_GRID, |u| selection_weight(power(u)))
}

/// Mean over the unit square, by a grid.
fn mean(grid: usize, value: impl Fn(Vec2) -> f32) -> f32 {
    let cell = 1.0 / grid as f32;
    let sum: f64 = (0..grid * grid)
        .map(|i| {
            let u = Vec2::new((i % grid) as f32, (i / grid) as f32);
            f64::from(value((u + 0.5) * cell))
        })
        .sum();
    sum as f32 * cell * cell
}

impl Lights {
    /// Starts a photon: chooses an emitter by power, a position and a direction. `None` if nothing
    /// shines, or not that way.
    ///
    /// `u[0]` chooses the emitter, `u[1..3]` the position, `u[3..5]` the direction. The mean of the
    /// power over all `u` is the power of all emitters together; of those far from what photons are
    /// to land on, and of distant ones, what falls on a ball around that.
    pub fn emit(&self, u: [f32; 5]) -> Option<Emission> {
        let sources = self.emission.as_ref()?;
        let salt = u64::from(u[1].to_bits()) << 32 | u64::from(u[3].to_bits());
        let chosen = sources.choice.sample(widen(u[0], salt));
        let (at, towards) = (Vec2::new(u[1], u[2]), Vec2::new(u[3], u[4]));
        let leaves = self.local.as_ref().map_or(&[][..], |l| &l.leaves);
        let emission = match leaves.get(chosen.index) {
            Some((emitter, leaf)) => self.emit_local(*emitter, leaf, &sources.target, at, towards),
            None => {
                let (emitter, light) = self.distant.get(chosen.index - leaves.len())?;
                sources.emit_distant(*emitter, light, at, towards)
            }
        };
        emission.map(|e| Emission {
            power: e.power / chosen.probability,
            ..e
        })
    }

    fn emit_local(
        &self,
        emitter: EmitterId,
        leaf: &Leaf,
        target: &Target,
        at: Vec2,
        towards: Vec2,
    ) -> Option<Emission> {
        let from_point = |org: Vec3, dir: Vec3, power: Rgb| Emission {
            org,
            dir: dir.normalize(),
            ng: Vec3::ZERO,
            power,
            emitter,
        };
        match leaf {
            Leaf::Point(l) => {
                let (dir, angle) = match target.cone(l.position) {
                    Some(cone) => (cone.sample(towards), cone.solid_angle()),
                    None => (uniform_sphere(towards), 4.0 * PI),
                };
                Some(from_point(l.position, dir, l.intensity * angle))
            }
            Leaf::Spot(l) => {
                let local = uniform_cone(towards, l.one_minus_cos_cutoff());
                let power = l.intensity(local) * (TAU * l.one_minus_cos_cutoff());
                Some(from_point(l.position, l.to_world * local, power))
            }
            Leaf::Projector(l) => {
                let power = l.slide(towards) * l.slide_area();
                Some(from_point(
                    l.position,
                    l.to_world * l.through(towards),
                    power,
                ))
            }
            Leaf::Goniometric(l) => {
                let (dir, power) = l.sample(towards)?;
                Some(from_point(l.position, dir, power))
            }
            Leaf::Triangle(_) | Leaf::Quad(_) | Leaf::Sphere(_) | Leaf::Analytic(_) => {
                let area = self.areas[emitter as usize].as_ref()?;
                let (org, ng, density, place) = leaf.point(at);
                let radiance = area.radiance_at(org, ng, place);
                let (dir, angle) = match target.cone(org) {
                    Some(cone) => {
                        let dir = cone.sample(towards);
                        (dir, cone.solid_angle() * dir.dot(ng))
                    }
                    None => (Frame::new(ng).to_world(cosine_hemisphere(towards)), PI),
                };
                (angle > 0.0).then(|| Emission {
                    org,
                    dir,
                    ng,
                    power: radiance * (angle / density),
                    emitter,
                })
            }
        }
    }
}

impl Sources {
    /// A photon from outside: a direction by the light's distribution, then a place on a disk
    /// across the target.
    fn emit_distant(
        &self,
        emitter: EmitterId,
        light: &Distant,
        at: Vec2,
        towards: Vec2,
    ) -> Option<Emission> {
        let (to_light, drawn, pdf) = light.sample(Vec3::ZERO, towards)?;
        let radiance = light.radiance_of(&drawn);
        let per_area = if light.is_delta() {
            radiance
        } else {
            radiance / pdf
        };
        let frame = Frame::new(to_light);
        let Target { center, radius } = self.target;
        let across = concentric_disk(at) * radius;
        let org = center + frame.to_world(across.extend(radius));
        Some(Emission {
            org,
            dir: -to_light,
            ng: Vec3::ZERO,
            power: per_area * (PI * radius * radius),
            emitter,
        })
    }
}
