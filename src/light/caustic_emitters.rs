//! The beacons of a scene: its suns and its brightest lamps.

use super::caustic_emitter::{CausticEmitter, LEAST_SHARE};
use super::cluster::Cluster;
use super::distant::Distant;
use super::leaf::Leaf;
use super::{EmitterId, Lights};
use crate::accel::Bounds;
use crate::math::{Vec2, Vec3};

/// Largest radius of a lamp, relative to that of the scene.
const LARGEST_LAMP: f32 = 0.2;
/// Lamps that are looked at, at most: the brightest.
const MOST_LAMPS: usize = 4;

impl Lights {
    /// All of them.
    pub fn caustic_emitters(&self) -> Vec<CausticEmitter> {
        let sun = |light: &Distant| match light {
            Distant::Sun(sun) => CausticEmitter::sun(sun.center, (2.0 * sun.one_minus_cos).sqrt()),
            Distant::Map(map) => map.caustic_emitter(),
            Distant::Constant(_) | Distant::Parallel { .. } => None,
        };
        let suns = self.distant.iter().filter_map(|(_, d)| sun(d));
        suns.chain(self.lamps()).collect()
    }

    /// Shapes that are small and bright.
    fn lamps(&self) -> Vec<CausticEmitter> {
        let (Some(local), Some(sources)) = (&self.local, &self.emission) else {
            return Vec::new();
        };
        let (mut first, mut total) = (0, 0.0);
        let mut lamps: Vec<(f32, CausticEmitter)> = Vec::new();
        // The leaves of a shape are neighbours.
        for leaves in local.leaves.chunk_by(|a, b| a.0 == b.0) {
            let share: f32 = (first..first + leaves.len())
                .map(|i| sources.share(i))
                .sum();
            first += leaves.len();
            total += share;
            let (center, radius) = ball(leaves);
            if radius > 0.0 && radius <= LARGEST_LAMP * sources.radius() {
                let emitter = leaves[0].0;
                let lamp = CausticEmitter::Lamp {
                    emitter,
                    center,
                    radius,
                };
                lamps.push((share, lamp));
            }
        }
        lamps.retain(|(share, _)| *share >= LEAST_SHARE * total);
        lamps.sort_by(|a, b| b.0.total_cmp(&a.0));
        lamps.truncate(MOST_LAMPS);
        lamps.into_iter().map(|(_, lamp)| lamp).collect()
    }

    /// A point of a shape that glows, chosen by `u`, and the unit normal on its bright side. `None`
    /// if it has none.
    pub fn point_of(&self, emitter: EmitterId, u: [f32; 3]) -> Option<(Vec3, Vec3)> {
        let leaves = &self.local.as_ref()?.leaves;
        let first = leaves.partition_point(|l| l.0 < emitter);
        let count = leaves[first..].partition_point(|l| l.0 == emitter);
        let chosen = ((u[0] * count as f32) as usize).min(count.checked_sub(1)?);
        let (p, n, _, _) = leaves[first + chosen].1.point(Vec2::new(u[1], u[2]));
        Some((p, n))
    }
}

/// A ball around a shape's leaves; of radius 0 if it has no extent.
fn ball(leaves: &[(EmitterId, Leaf)]) -> (Vec3, f32) {
    let glowing = leaves.iter().filter(|(_, leaf)| leaf.area() > 0.0);
    let balls: Vec<Cluster> = glowing.map(|(_, leaf)| leaf.cluster(1.0)).collect();
    let bounds = balls.iter().fold(Bounds::EMPTY, |b, ball| {
        let half = Vec3::splat(ball.radius);
        b.with(ball.center - half).with(ball.center + half)
    });
    let center = bounds.center();
    let reach = |ball: &Cluster| ball.center.distance(center) + ball.radius;
    (center, balls.iter().map(reach).fold(0.0, f32::max))
}
