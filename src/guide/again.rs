//! Several rounds of refining over one batch.
//!
//! A split's children know their share of the flux but not how it is spread inside them, so a round
//! can only go one level deeper. Showing the batch that was just trained again to the new links fills
//! their tables without counting anything twice, and the next round can go on.

use super::record::{Origin, PathSample, Photon};
use super::refine::Refined;
use super::settings::Source;
use super::train::{CHUNK, Trainer};
use rayon::prelude::*;

/// The batch that is shown again.
#[derive(Clone, Copy)]
enum Shown<'a> {
    Photons(&'a [Photon]),
    Paths(&'a [PathSample]),
}

impl Trainer {
    /// *Refine* in up to `rounds` rounds over the photons that were just trained. They are not counted
    /// again; they only tell new links how their share is spread. A field that is refined by paths
    /// ([`Source::Paths`]) takes one round, without them.
    pub fn refine_with(&mut self, photons: &[Photon], rounds: u32) -> Refined {
        if self.settings.source == Source::Paths {
            return self.refine();
        }
        self.refine_shown(Shown::Photons(photons), rounds)
    }

    /// The same for the camera paths that were just trained; a field of [`Source::Photons`] takes one
    /// round, without them.
    pub fn refine_with_paths(&mut self, samples: &[PathSample], rounds: u32) -> Refined {
        if self.settings.source == Source::Photons {
            return self.refine();
        }
        self.refine_shown(Shown::Paths(samples), rounds)
    }

    fn refine_shown(&mut self, shown: Shown, rounds: u32) -> Refined {
        let mut sum = self.refine();
        let mut last = sum;
        for _ in 1..rounds {
            if last.space + last.direction == 0 || last.refused > 0 {
                break;
            }
            let fresh = self.show_again(shown);
            last = self.divide(Some(&fresh));
            sum.space += last.space;
            sum.direction += last.direction;
            sum.refused = last.refused;
            sum.gain += last.gain;
        }
        if last.space + last.direction > 0 {
            // What was made last starts with filled tables, too.
            self.show_again(shown);
        }
        sum
    }

    /// Fills the tables of links that have seen nothing yet; returns which they were.
    fn show_again(&mut self, shown: Shown) -> Vec<bool> {
        let origin = match shown {
            Shown::Photons(_) => Origin::Photon,
            Shown::Paths(_) => Origin::Path,
        };
        let fresh: Vec<bool> = self
            .tallies
            .iter()
            .map(|t| t.squares[origin as usize] == 0)
            .collect();
        match (shown, self.photon_unit, self.path_unit) {
            (Shown::Photons(photons), Some(unit), _) => {
                for chunk in photons.chunks(CHUNK) {
                    let intake = self.intake(unit);
                    let deposits: Vec<_> = chunk.par_iter().map(|p| intake.photon(p)).collect();
                    self.deposit(deposits, unit, origin, Some(&fresh));
                }
            }
            (Shown::Paths(samples), _, Some(unit)) => {
                let new: Vec<bool> = self
                    .space
                    .nodes
                    .iter()
                    .map(|n| n.first == 0 && n.visits == [0; 8])
                    .collect();
                for chunk in samples.chunks(CHUNK) {
                    let intake = self.intake(unit);
                    let deposits: Vec<_> = chunk.par_iter().map(|s| intake.path(s)).collect();
                    for (leaf, octant) in self.visited(chunk, &deposits).into_iter().flatten() {
                        if !new[leaf as usize] {
                            continue;
                        }
                        // Known before the cell was made, now also by octant.
                        let node = &mut self.space.nodes[leaf as usize];
                        if node.visits_before > 0 {
                            node.visits_before -= 1;
                            node.visits[octant as usize] += 1;
                        }
                    }
                    self.deposit(deposits, unit, origin, Some(&fresh));
                }
            }
            _ => {}
        }
        fresh
    }
}
