//! The strongest lights of a scene, which distances in media are drawn by (see `beside.rs`).

use super::cluster::Cluster;
use crate::math::Vec3;

/// How many lights are looked at for a segment: the strongest. Free flight finds the others.
const MOST: usize = 32;

/// A light that distances are drawn by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearby {
    pub leaf: u32,
    pub center: Vec3,
    pub radius: f32,
    pub strength: f32,
}

/// The strongest lights of a tree, by leaf.
pub(super) fn strongest(clusters: &[Cluster]) -> Vec<Nearby> {
    let nearby = |(leaf, c): (usize, &Cluster)| Nearby {
        leaf: leaf as u32,
        center: c.center,
        radius: c.radius,
        strength: c.strength,
    };
    let mut lights: Vec<Nearby> = clusters.iter().enumerate().map(nearby).collect();
    // A stable order: equally strong ones stay in theirs.
    lights.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    lights.truncate(MOST);
    lights.sort_by_key(|light| light.leaf);
    lights
}
