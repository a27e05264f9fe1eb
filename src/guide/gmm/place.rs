//! Where records stand, and how far each listens.

use super::Settings;
use super::cover::Cover;
use super::near::KdTree;
use crate::guide::{Photon, SurfacePoint};
use crate::math::Vec3;
use rayon::prelude::*;

/// Surfaces whose normals are within 25 degrees of each other share their light.
pub(super) const SAME_SIDE: f32 = 0.9;
/// Points that are looked at side by side.
const BLOCK: usize = 4096;
/// Fewest photons of the first batch that a radius is judged by.
const FEWEST: usize = 8;

/// A place for a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RecordPlace {
    pub position: Vec3,
    pub normal: Vec3,
    pub radius: f32,
}

/// Places for at most `most` records so that each of `points` is served, by the density of the
/// first batch.
pub(super) fn places(
    settings: &Settings,
    points: &[SurfacePoint],
    photons: &[Photon],
    most: usize,
) -> (Vec<RecordPlace>, Cover) {
    let diagonal = settings.diagonal();
    let range = [
        settings.min_radius * diagonal,
        settings.max_radius * diagonal,
    ];
    let positions: Vec<Vec3> = photons.iter().map(|p| p.position).collect();
    let density = Density {
        tree: KdTree::new(&positions),
        photons,
        wanted: (settings.photons as usize / settings.batches as usize).max(FEWEST),
    };
    let mut cover = Cover::new(settings.min, range[0]);
    let mut places: Vec<RecordPlace> = Vec::new();
    for block in points.chunks(BLOCK) {
        let new: Vec<RecordPlace> = block
            .par_iter()
            .filter(|p| !serves(settings, &cover, &places, p))
            .map(|p| RecordPlace {
                position: p.position,
                normal: p.normal,
                radius: density.radius(p, range),
            })
            .collect();
        for place in new {
            let point = SurfacePoint {
                position: place.position,
                normal: place.normal,
            };
            // An earlier one of the block may have come to serve it.
            if places.len() < most && !serves(settings, &cover, &places, &point) {
                cover.add(places.len() as u32, place.position, place.radius);
                places.push(place);
            }
        }
    }
    (places, cover)
}

/// Whether some record serves a point already.
fn serves(
    settings: &Settings,
    cover: &Cover,
    places: &[RecordPlace],
    point: &SurfacePoint,
) -> bool {
    let mut served = false;
    cover.near(point.position, |i| {
        let place = &places[i as usize];
        let reach = settings.validity * place.radius;
        served = place.position.distance_squared(point.position) < reach * reach
            && place.normal.dot(point.normal) > SAME_SIDE;
        served
    });
    served
}

/// Photons of the first batch.
struct Density<'a> {
    tree: KdTree,
    photons: &'a [Photon],
    wanted: usize,
}

impl Density<'_> {
    /// Distance within which as many photons as wanted landed on surfaces that face the same way.
    fn radius(&self, point: &SurfacePoint, [least, most]: [f32; 2]) -> f32 {
        // The nearest so far, the farthest of them first.
        let mut nearest = std::collections::BinaryHeap::with_capacity(self.wanted + 1);
        self.tree.visit(point.position, most * most, |slot, d| {
            let photon = &self.photons[self.tree.order()[slot] as usize];
            if photon.normal.dot(point.normal) > SAME_SIDE {
                // Distances are not negative: their bits are in order.
                nearest.push(d.to_bits());
                if nearest.len() > self.wanted {
                    nearest.pop();
                }
            }
            match nearest.peek() {
                Some(&d) if nearest.len() >= self.wanted => f32::from_bits(d),
                _ => most * most,
            }
        });
        match nearest.peek() {
            Some(&d) if nearest.len() >= self.wanted => f32::from_bits(d).sqrt().clamp(least, most),
            _ => most,
        }
    }
}
