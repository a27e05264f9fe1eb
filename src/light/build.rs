//! From emitters as a scene describes them to lights that can be sampled.

use super::area::{AreaEmitter, cluster_of};
use super::cluster::Cluster;
use super::distant::Distant;
use super::emission::Sources;
use super::goniometric::Goniometric;
use super::leaf::Leaf;
use super::point::PointLight;
use super::projector::Projector;
use super::spot::Spot;
use super::tree::LightTree;
use super::{Emitter, EmitterId, EmitterShape, Lights, Local, nearby, sunsky};
use crate::accel::Bounds;
use crate::math::Rgb;
use crate::math::rgb::sanitized;
use std::sync::Arc;

/// What has been gathered so far.
#[derive(Default)]
struct Gathered {
    areas: Vec<Option<AreaEmitter>>,
    /// Leaves with their mean radiance, which is of no meaning for lights without extent.
    leaves: Vec<(EmitterId, Leaf, Rgb)>,
    distant: Vec<(EmitterId, Distant)>,
}

impl Lights {
    /// Prepares emitters for sampling. `shapes` are the glowing shapes in the order
    /// [`Emitter::Area`] numbers them; `bounds` holds the whole scene, `target` what photons are to
    /// land on.
    ///
    /// Emitters of no power and surfaces of no area are never sampled. Channels of a radiance that
    /// are negative, infinite or not numbers count as 0.
    pub fn build(
        emitters: Vec<Emitter>,
        shapes: &[EmitterShape],
        bounds: Bounds,
        target: Bounds,
    ) -> Self {
        let mut gathered = Gathered::default();
        for (id, emitter) in emitters.into_iter().enumerate() {
            gathered.add(id as EmitterId, emitter, shapes);
        }
        gathered
            .distant
            .retain(|(_, d)| d.flux_per_area().max_element() > 0.0);
        let Gathered {
            areas,
            leaves,
            distant,
        } = gathered;
        let emission = Sources::new(&leaves, &distant, bounds, target);
        Self {
            areas,
            local: local(leaves),
            distant,
            emission,
        }
    }
}

impl Gathered {
    fn add(&mut self, id: EmitterId, emitter: Emitter, shapes: &[EmitterShape]) {
        let mut area = None;
        match emitter {
            Emitter::Area {
                shape,
                radiance,
                both_sides,
            } => {
                // A number without a shape is a mistake of the caller's that costs this light
                // alone.
                if let Some(shape) = shapes.get(shape as usize) {
                    let glowing = AreaEmitter::new(shape.clone(), radiance, both_sides);
                    area = Some(self.add_area(id, glowing));
                }
            }
            Emitter::Point {
                position,
                intensity,
            } => {
                let intensity = sanitized(intensity);
                self.add_delta(
                    id,
                    Leaf::Point(PointLight {
                        position,
                        intensity,
                    }),
                );
            }
            Emitter::Spot {
                to_world,
                intensity,
                cutoff_degrees,
                beam_degrees,
                falloff,
                texture,
            } => {
                let intensity = sanitized(intensity);
                let angles = [cutoff_degrees, beam_degrees];
                let spot = Spot::new(to_world, intensity, angles, falloff, texture);
                self.add_delta(id, Leaf::Spot(Box::new(spot)));
            }
            Emitter::Projector {
                to_world,
                slide,
                values,
                scale,
                fov_degrees,
                aspect,
            } => {
                let shape = [fov_degrees, aspect];
                let projector = Projector::new(to_world, (slide, values), scale, shape);
                self.add_delta(id, Leaf::Projector(Box::new(projector)));
            }
            Emitter::Goniometric {
                to_world,
                image,
                intensity,
            } => {
                let image = Arc::unwrap_or_clone(image);
                if let Some(intensity) = image.into_map(sanitized(intensity), &to_world) {
                    let position = to_world.translation.into();
                    let light = Goniometric {
                        position,
                        intensity,
                    };
                    self.add_delta(id, Leaf::Goniometric(Box::new(light)));
                }
            }
            other => self.add_distant(id, other),
        }
        self.areas.push(area);
    }

    fn add_area(&mut self, id: EmitterId, mut area: AreaEmitter) -> AreaEmitter {
        let leaves = area.leaves(self.leaves.len());
        self.leaves
            .extend(leaves.into_iter().map(|(leaf, mean)| (id, leaf, mean)));
        area
    }

    /// A light without extent; one without strength would never be chosen and is left out.
    fn add_delta(&mut self, id: EmitterId, leaf: Leaf) {
        let cluster = leaf.cluster(0.0);
        if cluster.strength > 0.0 && cluster.strength.is_finite() && cluster.center.is_finite() {
            self.leaves.push((id, leaf, Rgb::ONE));
        }
    }

    fn add_distant(&mut self, id: EmitterId, emitter: Emitter) {
        match emitter {
            Emitter::Directional {
                direction,
                irradiance,
            } => {
                let to_light = -direction.normalize_or_zero();
                let irradiance = sanitized(irradiance);
                if to_light != crate::math::Vec3::ZERO {
                    let light = Distant::Parallel {
                        to_light,
                        irradiance,
                    };
                    self.distant.push((id, light));
                }
            }
            Emitter::Constant { radiance } => {
                self.distant
                    .push((id, Distant::Constant(sanitized(radiance))));
            }
            Emitter::EnvironmentMap {
                image,
                scale,
                to_world,
            } => {
                let image = Arc::unwrap_or_clone(image);
                let map = image.into_map(Rgb::splat(scale), &to_world);
                let map = map.map(|m| (id, Distant::Map(Box::new(m))));
                self.distant.extend(map);
            }
            Emitter::SunSky {
                settings,
                scale,
                to_world,
            } => {
                let parts = sunsky::distant(&settings, scale, &to_world);
                self.distant.extend(parts.into_iter().map(|d| (id, d)));
            }
            Emitter::Area { .. }
            | Emitter::Point { .. }
            | Emitter::Spot { .. }
            | Emitter::Projector { .. }
            | Emitter::Goniometric { .. } => {}
        }
    }
}

/// The tree over the lights in the scene.
fn local(leaves: Vec<(EmitterId, Leaf, Rgb)>) -> Option<Local> {
    let mut clusters: Vec<Cluster> = leaves
        .iter()
        .map(|(_, leaf, radiance)| cluster_of(leaf, *radiance))
        .collect();
    let unit = clusters.iter().map(|c| c.strength).fold(0.0, f32::max);
    for cluster in &mut clusters {
        // Light too weak for the range of f32 beside the strongest is still chosen now and then.
        cluster.strength = (cluster.strength / unit).max(1e-20);
    }
    Some(Local {
        tree: LightTree::build(&clusters)?,
        leaves: leaves.into_iter().map(|(id, leaf, _)| (id, leaf)).collect(),
        unit,
        strongest: nearby::strongest(&clusters),
    })
}
