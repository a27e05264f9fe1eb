//! The double hierarchy: a learned field of where light comes from.
//!
//! The method is Bus and Boubekeur, "Double Hierarchies for Efficient Sampling in Monte Carlo
//! Rendering" (SIGGRAPH Talks 2017). This module knows positions, directions and powers, and
//! nothing of scenes, rays or materials: any renderer can use it.
//!
//! # The idea
//!
//! A path tracer that leaves a surface point x should prefer directions w from which much light
//! L(x, w) arrives. The field learns that from photons. It subdivides the product of space and
//! directions:
//!
//! * **R**, an octree over space; a node is r, the nodes from the root to the cell of x are r_0 ..
//!   r_k.
//! * **Q**, a quadtree over the sphere of directions on an [equal-area
//!   map](crate::math::equal_area); it is implicit, a cell q is a number and a level.
//! * **P**, a tree over their product. Each node is a *link* (r, q); it is divided either in space
//!   into eight or in direction into four. Leaf links carry the flux that landed in them and a
//!   local model. R exists only where links need it.
//!
//! For a point x the leaf links on r_0 .. r_k have pairwise disjoint direction cells that cover the
//! sphere. Light that varies little over space hangs high in R and is shared by all cells below: in
//! the benchmark's field 34 000 cells see 1268 links each (43 million pairs) out of 423 000 stored.
//!
//! # The four primitives, and freezing
//!
//! ```
//! use twintree::guide::{Photon, Settings, SurfacePoint, Trainer};
//! use twintree::math::{Rgb, Vec2, Vec3};
//!
//! // A floor in the plane z = 0, lit from straight above.
//! let grid = |i: usize| Vec3::new((i % 100) as f32 + 0.5, (i / 100) as f32 + 0.5, 0.0) / 100.0;
//! let photons: Vec<Photon> = (0..10_000)
//!     .map(|i| Photon {
//!         position: grid(i),
//!         direction: Vec3::Z,
//!         power: Rgb::ONE,
//!         distance: f32::INFINITY,
//!         normal: Vec3::Z,
//!     })
//!     .collect();
//! let floor: Vec<SurfacePoint> = (0..10_000)
//!     .map(|i| SurfacePoint { position: grid(i), normal: Vec3::Z })
//!     .collect();
//!
//! let mut trainer = Trainer::build(Settings::new(Vec3::ZERO, Vec3::ONE))?; // build
//! trainer.set_surface(&floor, 1.0);
//! for _ in 0..4 {
//!     trainer.train(&photons, photons.len() as u64); // train
//!     trainer.refine_rounds(4); // refine
//! }
//! let field = trainer.freeze();
//!
//! let local = field.at(Vec3::new(0.3, 0.6, 0.0), Some(Vec3::Z), Rgb::ONE);
//! let s = local.sample(Vec2::new(0.5, 0.5), Vec2::new(0.2, 0.8)); // sample
//! assert!(s.direction.z > 0.99 && s.pdf > 100.0);
//! assert!((local.pdf(s.direction) / s.pdf - 1.0).abs() < 1e-5);
//! // One watt a photon, shared by as many photons, on one square metre.
//! assert!((local.irradiance().x - 1.0).abs() < 0.01);
//! # Ok::<(), twintree::guide::GuideError>(())
//! ```
//!
//! A [`Trainer`] holds exact sums and grows; a [`Field`] is immutable, compact and made for
//! queries. [`Field::at`] gives a handle for one path vertex, which samples and evaluates
//! densities. `tests/examples/guide_field.rs` is a whole program.
//!
//! # Decisions that the paper leaves open
//!
//! What was measured for each, and what was tried and not kept, is in `EXPERIMENTS.md` beside this
//! file.
//!
//! * **Flux is divided by area.** A photon of power phi in the link (r, q) says that F = phi / A(r)
//!   W/m^2 arrive through q. Only F of different levels of R may be compared and added along a
//!   path. A(r) comes from points spread uniformly over the scene's surfaces, kept as sorted keys,
//!   so that the count of any cell is two binary searches. A cell with light but no point counts as
//!   half a point. Without any points A(r) is the cell's face.
//! * **Which split.** Each leaf link keeps a table of its flux over its 8 octants times 4
//!   quadrants. The gain of a split is the KL divergence that it removes, less the bias of finite
//!   counts, taken only where it exceeds chance by [`Settings::significance`] deviations; best gain
//!   per byte first, until [`Settings::memory`] is used.
//! * **After a split** a child has its share of the parent's flux, which the table knows, to the
//!   last quantum. Its own table starts empty; [`Trainer::refine_rounds`] shows it the batch again,
//!   without counting that twice.
//! * **Empty children are dim, not black.** When freezing, each node of P spreads one photon's
//!   worth of its flux over its children by measure (a Polya tree), and 1 % of all samples are
//!   uniform on the sphere.
//! * **The normal.** A field trained on flux already contains the cosine of the surfaces in the
//!   cell. [`Product::Horizon`] removes base cells below the shading normal's horizon and damps
//!   those whose centre lies below. [`Product::Cosine`] multiplies by the cosine once more;
//!   [`Target::Radiance`] trains on radiance. [`Settings::normal_split`] first divides R by the
//!   octant of the surface normal, which keeps the sides of thin walls apart.
//! * **Media.** Photons collide in a medium as they land on a surface; there is no normal and no
//!   cosine. A medium's A(r) is its extinction cross-section, the integral of sigma_t over its
//!   volume, from points spread as sigma_t is: so F is the fluence. With [`Settings::media`] R's
//!   first level tells media from surfaces: a wall beside fog is not blurred by it.
//! * **Colour.** Links and cells keep RGB sums; a query weights the channels by its path's
//!   throughput at every choice, in `sample` and `pdf` alike.
//! * **The model.** [`ModelKind::Constant`] is the paper's. [`ModelKind::Gauss`] and
//!   [`ModelKind::Vmf`] keep eight lobes in each cell of R, fitted by expectation maximisation, and
//!   let P divide space alone. A cell of Gaussians draws one direction in twenty from the narrow
//!   lobes of the cells around it (`model/neighbour_lobes.rs`).
//! * **Exact sums.** Fluxes are 128-bit integers in quanta of 2^-60 of a typical photon
//!   ([`crate::math::sum`]), everything else trained is an integer, too. So the same records give
//!   the same bits for any number of threads and any cut into batches, and shards
//!   ([`Trainer::emptied`], [`Trainer::merge`]) add up to the same bits as one long run.
//! * **Camera paths** ([`Trainer::train_paths`]) estimate the same F as the mean of radiance *
//!   cosine / pdf over the vertices in r: no area is needed, vertices are counted instead. With
//!   [`Source::Both`] the two estimates are averaged where a cell has 32 vertices.
//! * **Light samples** are taken only as often as they bring light, and of the lamps that are seen
//!   from the cell: [`Fractions`] learns that per cell, beside the share of directions that the
//!   field draws.
//!
//! # Beside the tree
//!
//! * [`Fractions`] learns for each cell of R how often to sample the field instead of the BSDF,
//!   how often to sample a light, and which.
//! * [`FieldFile`] keeps sums, not densities, so that a field can be trained further elsewhere, and
//!   a [`SampleRanges`] of what it has learned from, so that nothing is counted twice; damaged and
//!   foreign files are refused with a reason and a place.
//! * [`Trainer::set_importance`] confines refinement to cells that camera paths meet.
//! * [`Field::random`] knows nothing: a renderer must draw the same mean with it.
//! * [`Trainer::stats`] counts what there is.
//!
//! # Cost
//!
//! At 423 000 links, one thread of a shared two-core machine: [`Field::at`] 75 ns, then
//! [`LocalField::pdf`] 90 ns and [`LocalField::sample`] 220 ns; training 0.4 microseconds a photon
//! on two threads; 58 bytes a link frozen, 305 while training (of which R's look-up tables are a
//! part).

mod adam;
mod bytes;
mod cells;
mod content;
mod field;
mod file;
mod fraction;
mod freeze;
mod gaussian;
pub mod gmm;
mod habits;
mod importance;
mod intake;
mod levels;
mod light_chance;
mod light_clusters;
mod link_index;
mod links;
mod measure;
mod merge;
mod model;
pub mod ppg;
mod quantise;
mod query;
mod random;
mod recent;
mod record;
mod refine;
mod replay;
mod sample_ranges;
mod settings;
mod sides;
mod space;
mod stats;
mod tally;
mod train;

pub use cells::Cells;
pub use field::Field;
pub use file::FieldFile;
pub use fraction::Fractions;
pub use habits::{Chances, FLOOR, FractionRecord};
pub use levels::LevelShare;
pub use light_chance::LEAST_LIGHT;
pub use light_clusters::{LearnedSelection, LightChoice};
pub use model::ModelKind;
pub use query::{GuideSample, LocalField};
pub use record::{PathSample, Photon, SurfacePoint};
pub use refine::Refined;
pub use replay::BATCH;
pub use sample_ranges::{Numbers, SampleRanges};
pub use settings::{GuideError, Product, Settings, Source, Target};
pub use stats::Stats;
pub use train::{Intakes, Trainer};

#[cfg(test)]
mod tests;
