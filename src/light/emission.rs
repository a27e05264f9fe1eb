//! How photons leave their lights.

use super::distant::Distant;
use super::leaf::Leaf;
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
    /// Power it carries: the emitter's radiance times cosine over the density of (emitter, position, direction).
    pub power: Rgb,
    /// Which emitter.
    pub emitter: EmitterId,
}

/// Everything photons can leave from, chosen by power: first the leaves of the light tree, then the distant lights.
#[derive(Debug)]
pub(super) struct Sources {
    choice: Discrete,
    center: Vec3,
    /// Radius of a sphere around the scene.
    radius: f32,
}

/// Photons from outside start on a disk a little wider than the scene's sphere, which touches corners.
const MARGIN: f32 = 1.0001;

impl Sources {
    /// `None` if nothing shines.
    pub fn new(
        leaves: &[(EmitterId, Leaf, Rgb)],
        distant: &[(EmitterId, Distant)],
        bounds: Bounds,
    ) -> Option<Self> {
        let radius = bounds.radius() * MARGIN;
        let disk = f64::from(PI) * f64::from(radius) * f64::from(radius);
        let local = leaves
            .iter()
            .map(|(_, leaf, radiance)| f64::from(power(leaf, *radiance)));
        let far = distant
            .iter()
            .map(|(_, d)| f64::from(selection_weight(d.flux_per_area())) * disk);
        let weights: Vec<f64> = local.chain(far).collect();
        Some(Self {
            choice: Discrete::new(&weights)?,
            center: bounds.center(),
            radius,
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

/// Power a leaf sends into the scene, as luminance.
fn power(leaf: &Leaf, radiance: Rgb) -> f32 {
    match leaf {
        Leaf::Point(l) => 4.0 * PI * selection_weight(l.intensity),
        Leaf::Spot(l) => mean_power(|u| {
            let local = uniform_cone(u, l.one_minus_cos_cutoff());
            l.intensity(local) * (TAU * l.one_minus_cos_cutoff())
        }),
        Leaf::Projector(l) => mean_power(|u| l.slide(u) * l.slide_area()),
        Leaf::Triangle(_) | Leaf::Quad(_) | Leaf::Sphere(_) | Leaf::Exact(_) => {
            PI * leaf.area() * selection_weight(radiance)
        }
    }
}

/// Points on each side of the grid by which the power of spots and projectors is measured.
const POWER_GRID: usize = 64;

fn mean_power(power: impl Fn(Vec2) -> Rgb) -> f32 {
    let cell = 1.0 / POWER_GRID as f32;
    let sum: f64 = (0..POWER_GRID * POWER_GRID)
        .map(|i| {
            let u = Vec2::new((i % POWER_GRID) as f32, (i / POWER_GRID) as f32);
            f64::from(selection_weight(power((u + 0.5) * cell)))
        })
        .sum();
    sum as f32 * cell * cell
}

impl Lights {
    /// Starts a photon: chooses an emitter by power, a position and a direction. `None` if nothing shines.
    ///
    /// `u[0]` chooses the emitter, `u[1..3]` the position, `u[3..5]` the direction. The mean of the
    /// power over all `u` is the power of all emitters together; of distant ones, what falls on the
    /// scene's bounding sphere.
    pub fn emit(&self, u: [f32; 5]) -> Option<Emission> {
        let sources = self.emission.as_ref()?;
        let salt = u64::from(u[1].to_bits()) << 32 | u64::from(u[3].to_bits());
        let chosen = sources.choice.sample(widen(u[0], salt));
        let (at, towards) = (Vec2::new(u[1], u[2]), Vec2::new(u[3], u[4]));
        let leaves = self.local.as_ref().map_or(&[][..], |l| &l.leaves);
        let emission = match leaves.get(chosen.index) {
            Some((emitter, leaf)) => self.emit_local(*emitter, leaf, at, towards),
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
                let power = l.intensity * (4.0 * PI);
                Some(from_point(l.position, uniform_sphere(towards), power))
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
            Leaf::Triangle(_) | Leaf::Quad(_) | Leaf::Sphere(_) | Leaf::Exact(_) => {
                let area = self.areas[emitter as usize].as_ref()?;
                let (org, ng, density, place) = leaf.point(at);
                let radiance = area.radiance_at(org, ng, place);
                Some(Emission {
                    org,
                    dir: Frame::new(ng).to_world(cosine_hemisphere(towards)),
                    ng,
                    power: radiance * (PI / density),
                    emitter,
                })
            }
        }
    }
}

impl Sources {
    /// A photon from outside: a direction by the light's distribution, then a place on a disk across the
    /// scene's sphere.
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
        let across = concentric_disk(at) * self.radius;
        let org = self.center + frame.to_world(across.extend(self.radius));
        Some(Emission {
            org,
            dir: -to_light,
            ng: Vec3::ZERO,
            power: per_area * (PI * self.radius * self.radius),
            emitter,
        })
    }
}
