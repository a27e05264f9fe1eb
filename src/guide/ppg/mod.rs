//! Practical path guiding: a rival to the double hierarchy, the SD-tree.
//!
//! Mueller, Gross and Novak, "Practical Path Guiding for Efficient Light-Transport Simulation"
//! (Computer Graphics Forum 36(4), 2017), with what Mueller added in 2019 (chapter 10 of the
//! course notes "Path guiding in production") and the target of Rath et al., "Variance-Aware Path
//! Guiding" (ACM Trans. Graph. 39(4), 2020).
//!
//! * **Space** is a binary tree: a node of depth d halves its box along axis d mod 3 (`space`). A
//!   leaf of an iteration with N records is divided when it has met more than c sqrt(N / 2^20) of
//!   them ([`Settings::threshold`] is c). That is the paper's c sqrt(2^k) for iterations that
//!   double, independent of how large the first one is.
//! * **Directions** of a leaf are a quadtree over an equal-area map of the sphere (`quadtree`). A
//!   cell is divided while it holds more than a share rho of the leaf's energy
//!   ([`Settings::share`]), and joined where it does not.
//! * **Iterations.** Records of one iteration fill a tree whose shape the iteration before it has
//!   left; then the tree is frozen ([`SdTree`]), guides the next iteration, and is reshaped
//!   ([`PpgTrainer`]). What is known counts half in the next ([`Settings::kept`]).
//! * **Filters.** A record is spread over a box of directions as large as the cell that it falls
//!   into. It can go to the spatial leaf of a place nearby, drawn in a box of its leaf's size
//!   ([`Settings::spatial_filter`]); that is off, for it costs more than it gains here.
//!
//! What the settings do is measured in `EXPERIMENTS.md`, one folder up.
//!
//! # The target
//!
//! A record is an estimate L of the light from direction w, drawn with density p; n is the normal.
//! Of a cell of directions with solid angle A that N records of a leaf could have hit, the guide's
//! share is in proportion to
//!
//! ```text
//! Radiance:      1/N sum L / p                               (2017)
//! SecondMoment:  sqrt(A 1/N sum (L |n.w|)^2 / p)             (2020)
//! ```
//!
//! The first is the integral of the mean of L. The second is A times the root of the mean square of
//! what the surface sends on, which minimises the variance where L itself is noisy: where a
//! direction brings light seldom, but then much, samples are worth more than its mean tells. Rath
//! et al. have the whole product with the BSDF there; a record tells the cosine, so surfaces are
//! taken as diffuse, of any albedo.
//!
//! # What differs from the papers
//!
//! * Directions lie on the octahedral map of [`crate::math::equal_area`] instead of on cylinder
//!   coordinates. Both keep areas; this one has no poles. The box of the directional filter is
//!   folded at the map's rim as the map is.
//! * Space may begin with eight trees, one for each octant of the surface normal
//!   ([`Settings::normals`]), as the double hierarchy's does.
//! * Directions below the horizon of an opaque surface are mirrored to above it: the density above
//!   is p(w) + p(mirrored w), exactly, and 0 below.
//! * One direction in a hundred is uniform ([`Settings::defensive`]).
//! * Sums of earlier iterations are discounted, not dropped: the image's passes double, but the
//!   paths that teach do not when they are many.
//! * When memory gets short, c and rho double.
//!
//! # Order
//!
//! A leaf's records are added in their order, in runs of one length, the runs' sums in theirs; the
//! numbers of the filter come from the record alone. So the same records give the same bits on any
//! number of threads. No record is sorted: they are counted by leaf and put in place.

mod leaf;
mod quadtree;
mod random;
mod sd_tree;
mod settings;
mod space;
mod train;

pub use sd_tree::{LocalTree, SdTree};
pub use settings::{Settings, Target};
pub use train::PpgTrainer;

#[cfg(test)]
mod tests;
