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
//! Cross-entropies below are in nats a photon, lower is better, measured on held-out photons of a
//! floor and a wall below a disk lamp, a point light and a constant sky after 1.02 million photons.
//!
//! * **Flux is divided by area.** A photon of power phi in the link (r, q) says that F = phi / A(r)
//!   W/m^2 arrive through q. Only F of different levels of R may be compared and added along a
//!   path. A(r) comes from points spread uniformly over the scene's surfaces, kept as sorted keys,
//!   so that the count of any cell, also of a later one, is two binary searches. A cell with light
//!   but no point counts as half a point. Without any points A(r) is the cell's face. The test is a
//!   slanted plane under a constant sky: the same density at every mix of levels.
//! * **Which split.** Each leaf link keeps a table of its flux over its 8 octants times 4
//!   quadrants. The gain of a split is the KL divergence it removes, less the bias of finite
//!   counts, taken only where it exceeds chance by [`Settings::significance`] deviations; best gain
//!   per byte first, until [`Settings::memory`] is used. The whole table, not only its margins, is
//!   kept, because a light that wanders across the cell as one moves shows in neither margin. Five
//!   deviations and 8 photons: -0.48; waiting for 64 photons: +0.01. Under a constant sky two
//!   deviations cost twice the divergence of five (0.016 against 0.009), splitting noise.
//! * **After a split.** A child starts with its share of the parent's flux, which the table knows,
//!   to the last quantum: no photon is forgotten, and estimates on trees of mixed levels stay
//!   right. Its own table starts empty. [`Trainer::refine_rounds`] therefore shows the batch again
//!   to new links (without counting it twice) and refines up to a few rounds a batch: four rounds
//!   instead of one, with batches that double, take the cross-entropy from +0.05 to -0.48; 16 equal
//!   batches reach -0.42.
//! * **Empty children are dim, not black.** When freezing, each node of P spreads one photon's
//!   worth of its flux over its children by measure (a Polya tree). On a shallower tree of 20 000
//!   links: 0.2010 against 0.2038 without, and 0.2006 with four photons' worth. On top, 1 % of all
//!   samples are uniform on the sphere.
//! * **The normal.** A field trained on flux already contains the cosine of the surfaces in the
//!   cell. [`Product::Horizon`] removes base cells (16 of them) below the shading normal's horizon
//!   and damps those whose centre lies below: better than no normal at all memory sizes (1.497
//!   against 1.514 at 0.1 MB, -0.4830 against -0.4827 at 45 MB), where multiplying by the cosine
//!   once more ([`Product::Cosine`]) loses 0.08. Training on radiance with the cosine product
//!   ([`Target::Radiance`]) loses 0.06: grazing photons weigh too much. Both stay for fields that
//!   serve glossy surfaces.
//! * **The position-normal product** the paper mentions: [`Settings::normal_split`] first divides R
//!   by the octant of the surface normal. It keeps the sides of thin walls and corners apart
//!   exactly (tests). It doubles the links along a path and gains nothing in the benchmark (-0.4834
//!   against -0.4830), so it is off by default here; a renderer whose scenes have thin walls
//!   switches it on, as this one does.
//! * **Colour.** Links and cells keep RGB sums; a query weights the channels by its path's
//!   throughput at every choice, in `sample` and `pdf` alike.
//! * **The model.** [`ModelKind::Constant`] is the paper's. [`ModelKind::Gauss`] and
//!   [`ModelKind::Vmf`] keep eight lobes in each cell of R, Gaussians over an equal-area map or von
//!   Mises-Fisher lobes with parallax, and let P divide space alone, also without a gain to be seen
//!   where records are plenty (two rooms built alike look like one whose halves are equal). Lobes
//!   are fitted by expectation maximisation, which looks at a batch several times, and a cell
//!   starts from its parent's. Relative variance of a sample (64 samples, learning from photons and
//!   paths), constants against Gaussians: veach-ajar 9.2, 6.8; a kitchen 16.6, 12.7; lux-pool 126,
//!   18; a glass caustic 4.7, 3.9; a Cornell box 0.46, 0.42; but a torus in glass under a small sun
//!   1.4, 2.0: light that comes from several needles at once, each seen from a part of the cell
//!   only. From one million photons alone: veach-ajar 13.3, 11.3; lux-pool 255, 30; the caustic
//!   6.1, 3.8. Learning takes up to 1.6 times as long. The default here is the paper's; the
//!   program's is the Gaussians, with which 60 seconds come to 0.96 (the torus) to 2.2 times
//!   (lux-pool) the efficiency. Cached mixtures ([`gmm`]) show what matters: round lobes have 1.2
//!   to 1.5 times the variance of slanted ones, one look at the records instead of several 3.6 to
//!   35 times. A lobe that has become useless is tried at a record chosen by chance: 2.1 against
//!   3.5 in the torus, 17 against 21 in lux-pool; at the record that surprises most it gains
//!   nothing. Nor does judging lobes by how much likelihood their loss would cost instead of by
//!   weight, nor weighing photons and paths by the flux that they find instead of by their number.
//!   Sixteen lobes: 5.8 against 6.3 in the torus, the same in lux-pool.
//! * **Needles that neighbours met.** The sun in a pane is seen in the same direction by a whole
//!   region, but a cell that has not met it yet draws it with the density of the dim light around.
//!   So a cell of Gaussians draws one direction in twenty from the narrow lobes of the cells around
//!   it: relative variance in the torus 3.5 instead of 5.9, worst pixels included 30 instead of 48,
//!   the same elsewhere (`guide/model/neighbour_lobes.rs`). From all cells of the scene instead of those
//!   below the cell three levels up: 5.3 against 4.7.
//! * **Exact sums.** Fluxes are 128-bit integers in quanta of 2^-60 of a typical photon
//!   ([`crate::math::sum`]), everything else trained is an integer, too. So the same records give
//!   the same bits for any number of threads and any cut into batches, and shards
//!   ([`Trainer::emptied`], [`Trainer::merge`]) add up to the same bits as one long run.
//! * **Camera paths** ([`Trainer::train_paths`]) estimate the same F as the mean of radiance *
//!   cosine / pdf over the vertices in r: no area is needed, vertices are counted instead. With
//!   [`Source::Both`] the two estimates are averaged where a cell has 32 vertices. Each by its
//!   number of records gains 3 to 5 % in veach-ajar and in a glass caustic, and adds half to the
//!   variance of evenly lit rooms; a share of 0.8 for photons: 10.0 against 9.3 in veach-ajar, of
//!   0.2: 6.5 against 4.7 in the caustic (relative variance, 64 samples).
//!
//! * **A render teaches its own field.** Photons find where light goes, camera paths find what the
//!   picture needs; so a render first traces some photons, and then its own first passes (1, 1, 2,
//!   4 .. samples a pixel) are both image and lesson. Nothing is thrown away: each pass is unbiased
//!   given those before. Relative error of veach-ajar, 64 samples, and error times processor
//!   seconds with training: 500 000 photons and as many paths before the render 0.164, 5.0; 500 000
//!   photons and the image's own paths up to 2 000 000 0.144, 3.8; with 250 000 photons 0.151, 4.1;
//!   with 2 000 000 photons 0.125, 5.9.
//! * **Roulette goes by the field, and by nothing else on the way.** A direction towards bright
//!   light is drawn with a high density, so its throughput is low. Roulette at a guided vertex
//!   therefore looks at what the path will bring, and roulette at vertices without a guide (glass,
//!   water) at the throughput relative to the last guided one. With the plain throughput there,
//!   paths that were aimed at the sun through water survived one time in a thousand: relative
//!   variance of lux-pool, 128 samples, 2000 instead of 200, of a glass caustic 76 instead of 7, of
//!   a torus in glass at 512 samples 163 instead of 18.
//! * **What the field expects speaks for matt surfaces alone, and splits, too.** Many of the
//!   brightest samples of veach-ajar were paths that the field had sent to a glossy floor which
//!   mirrors the gap of the door: by irradiance and albedo they would bring little, and up to nine
//!   in ten were ended. Without that, and without counting what a sample has already against the
//!   rest of it, its relative variance is 5.6 instead of 7.3, for 7.9 instead of 6.7 rays a path.
//!   Paths that bring more than was expected are split, and others ended a little sooner: 4.7 for
//!   8.0 rays; a kitchen 11.9 for 5.9 rays instead of 13.8 for 5.2. (A table of windows is in
//!   `integrate/roulette.rs`.)
//! * **A delta lobe and the rest are both followed.** A path aimed at the sun's image in varnish
//!   was one in twenty to meet it, and twenty times too bright. Relative variance, worst pixels
//!   included, of a glass caustic 5.3 instead of 18, of lux-pool 51 instead of 384, for up to half
//!   as many rays again; without the worst 0.1 % a kitchen 8.4 instead of 11.7
//!   (`integrate/lots.rs`).
//! * **Light samples only where they bring light.** [`Fractions`] learns per cell how often. The
//!   rays of a path fall from 7.5 to 6.9 in veach-ajar, 7.0 to 6.2 in lux-pool, 6.0 to 5.5 in a
//!   kitchen, and the variance stays.
//! * **Aimed photons.** A density over the five numbers that photons leave by, learned from which
//!   ones landed where camera paths go (a tree of boxes, the root of the mean square in each): 1.6
//!   to 2 times the landings from skies, 2 to 3.5 times the cells, nothing in closed rooms;
//!   variance 0.8 in the torus and in a kitchen's constants, 1.0 in its Gaussians, and the time it
//!   takes is lost again. Not kept.
//! * **What was tried and lost.** The share of the field as the best of nine tried ones, by second
//!   moment or by likelihood, with the mean of all surfaces as rough as the prior of each cell,
//!   instead of Adam: 5.6, 6.1 against 5.6 in veach-ajar (64 samples), 14.5, 12.9 against 13.1 in a
//!   kitchen. At a typical matt vertex there it would be better (relative variance of the next
//!   direction 0.37 instead of 0.45); the variance of the picture is made elsewhere. Lobes 1.3 and
//!   2 times as wide: 7.4, 8.2 against 7.3. Square roots of the second moment as the target of path
//!   records (Rath et al. 2020): 0.165 against 0.144 in veach-ajar, 0.489 against 0.547 in a
//!   caustic, the same elsewhere. A fixed share of 0.5, 0.7 or 0.9 for the field instead of the
//!   learned one: 0.195, 0.257, 0.478 against 0.144. Sorting the vertices of a wave by position
//!   before they ask the field: 3 to 8 % faster with a field, 8 to 19 % slower without. Laying out
//!   the links of each cell side by side: ten times the memory, no gain. Look-ups wait for memory,
//!   not for arithmetic.
//! * **Resampling by the BSDF.** Of one direction from the field and one from the BSDF, the one
//!   that the product of both prefers, as Cycles does: on surfaces that are not matt 8.55 against
//!   8.54 in a kitchen and 4.75 against 4.73 in veach-ajar; everywhere 8.30 and 4.86, for 6 and 4 %
//!   more rays. The variance is not made at glossy lobes. Not kept.
//! * **Lobes that move.** Means linear in the place within the cell, by weighted regression, so
//!   that one lobe follows a lamp, or the sun through a wave, across its cell. Cells may then be
//!   larger: with a quarter of them, relative variance 4.2 instead of 4.7 in veach-ajar, 30 instead
//!   of 32 in lux-pool, the same in a kitchen, 4.0 instead of 3.5 in the torus. From nine million
//!   photons alone, door: RMSE 1.02 instead of 1.09 of the cached mixtures'. Training state is two
//!   and a half times as large, and a record takes longer. Not kept so far.
//! * **Which lights to sample,** those in the scene or the sky, learned beside how often: 1.17
//!   instead of 1.25 in a room with a lamp and a window, 8.0 instead of 8.2 under a brighter sky.
//!   Paths that the field aims find the window by themselves. Not kept. Nor is Sobol's sequence of
//!   much use here: a kitchen 8.6 against 8.5, veach-ajar 4.5 against 4.7.
//! * **Tables that know the lobes.** With a mixture's table divided by lobe and side of the lobe
//!   instead of by 16 direction cells, and cells divided where that shows a gain, at the latest
//!   with 64 instead of 4 times the records: relative variance 4.55 instead of 4.73 in veach-ajar,
//!   1.62 instead of 1.84 in the caustic, but 33.2 instead of 32.2 in lux-pool and, of 128 samples,
//!   8.69 instead of 8.59 in a kitchen, 8.4 instead of 7.9 in the torus. Not kept. From nine
//!   million photons (door, RMSE over that of cached mixtures, 1.09 before large batches were
//!   learned in parts): 1.08; with a quarter of the memory 1.08, with four times as much 1.08;
//!   splits ranked by where camera paths go instead of by flux 1.08; records moved at random by
//!   half a cell's width or all of it, so that cells overlap, 1.09 and more.
//! * **What is left in a torus in glass** are paths whose last direction no cell has met: bent
//!   through the rounded edges of the glass, it is another one from every point. Needles of the
//!   whole scene beside those of the neighbours: 6.8 instead of 7.9, but 8.8 instead of 8.6 in a
//!   kitchen and every density takes longer. Lots also for paths that come from the camera: 12.1
//!   instead of 11.3 (256 samples) for more rays. Weighing an image's first passes, which know
//!   little, less than the later ones: 6.5 instead of 6.6, but 2.3 instead of 2.2 in the caustic.
//!   Needles with the tails of Student's t instead of a normal's: 4.8 to 5.0 instead of 4.2. A fine
//!   table of directions for the whole scene and each octant of normals: 6.8 to 8.2 instead of 7.7.
//!   40 million photons and 4 G of memory: 4.5 instead of 4.1. Half of the squared error is in
//!   points of the glass that see the sun through another edge, where the field's density is mostly
//!   below one a steradian. Of its brightest samples (64 a pixel, a field that knows eight million
//!   paths) a fifth to a half came from two dozen directions, in which flat faces show the sun,
//!   most of the others from edges, by a density of about 0.1. Cells facing the same way that draw
//!   3 % from up to 64 needles of the whole scene: 3.9 instead of 4.4, 3.5 instead of 3.6 in a
//!   kitchen, for 1.05 times the time. Lessons from all paths of all passes instead of half a
//!   million a pass: no difference. What does find them needs no field: photons tell where such
//!   chains begin, and Newton's method leads from there to the sun, from any point. (Not here but
//!   in the renderer: `integrate/chain`. Relative variance 0.5 instead of 2.3.)
//! * **More samples where the noise is.** Pixels that take samples by their own variance, in
//!   passes: variance times time 1.06 instead of 1.15 in the torus, 0.67 and 0.67 in the caustic;
//!   tiles by variance and cost: 0.77 to 0.81 instead of 0.72, 0.78 instead of 0.84. The noise is
//!   in few samples, not in few pixels. Not kept.
//! * **Practice.** A sixteenth of the image's samples traced first, to teach alone, so that fewer
//!   samples of the image are drawn by a field that knows little: relative variance 3.1 instead of
//!   3.6 in a kitchen, 1.47 instead of 1.52 in veach-ajar, the same in the torus, for 1.15, 1.1 and
//!   1.0 times the time. Not kept.
//! * **All paths of an image as pupils** (see `integrate/teach.rs`): four times as many lessons
//!   take 11 % off the kitchen's variance at 256 samples and 2 % off veach-ajar's, for half as much
//!   time again and twice the time.
//!
//! # Beside the tree
//!
//! * [`Fractions`] learns for each cell of R how often to sample the field instead of the BSDF, and
//!   how often to sample a light.
//! * [`FieldFile`] keeps sums, not densities, so that a field can be trained further elsewhere, and
//!   a [`SampleRanges`] of what it has learned from, so that nothing is counted twice; damaged and
//!   foreign files are refused with a reason and a place.
//! * [`Trainer::set_importance`] and [`Trainer::set_importance_sample`] confine refinement to cells
//!   that camera paths meet.
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
mod content;
mod field;
mod file;
mod fraction;
mod freeze;
mod gaussian;
pub mod gmm;
mod importance;
mod intake;
mod light_chance;
mod link_index;
mod links;
mod merge;
mod model;
mod quantise;
mod query;
mod random;
mod recent;
mod record;
mod refine;
mod replay;
mod sample_ranges;
mod settings;
mod space;
mod stats;
mod tally;
mod train;

pub use field::Field;
pub use file::FieldFile;
pub use fraction::{Chances, FLOOR, FractionRecord, Fractions};
pub use light_chance::LEAST as LEAST_LIGHT;
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
