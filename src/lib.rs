//! `twintree`: a physically based renderer that learns where light comes from before it renders.
//!
//! # From a scene file to a picture
//!
//! ```text
//!   scene.xml                                                              out.exr  out.png
//!      |                                                                       ^
//!      | scene::import          what the file says, as data                    | image
//!      v                        (nothing of it is looked at twice)             |
//!  Description                                                               Film
//!      |                                                                       ^  means, variances
//!      | scene::build           textures, lights, materials,                   |  pixel by pixel
//!      v                        the ray tracer's trees (accel)                 |
//!   Scene ----------------------------------------------------------------> integrate
//!      |                                                              camera paths, vertex by vertex:
//!      |  photon                power that leaves the emitters          hit      accel
//!      |  integrate::learn      the first camera paths                  material bsdf
//!      v                                                                light    light
//!   guide::Trainer ---> guide::Field ------- where light comes from --> direction: bsdf or field
//!      build, train, refine     frozen: sample and pdf at any point
//! ```
//!
//! The lower row is what `--guide double` adds. The field only shapes the densities that paths are
//! sampled from and each sample is divided by its density: a field that is empty or wrong costs
//! noise, and never changes the mean. Without it the upper row is a path tracer with next-event
//! estimation and multiple importance sampling.
//!
//! # Where to begin
//!
//! | to see | read |
//! |---|---|
//! | how the program is used | [`manual`] |
//! | a render from its command line to its files | [`cli::render`] |
//! | one path, one vertex at a time | [`integrate`] |
//! | the method, which knows nothing of scenes and rays | [`guide`], with an example that trains a field |
//! | what a scene is | [`scene::Description`], [`scene::Scene`] |
//! | how light scatters | [`bsdf`] |
//!
//! How to add a scattering model, a scene format or a model of the field is in CONTRIBUTING.md.
//!
//! # What holds everywhere
//!
//! * Modules depend on each other in one direction only: `cli` > `integrate` > `guide`, `photon` >
//!   `scene` > `bsdf`, `light`, `camera`, `film` > `texture` > `accel`, `image` > `math`.
//! * Directions point *away* from the surface point they belong to and are of unit length; local
//!   shading coordinates have the normal on +z.
//! * Radiance and reflectance are linear sRGB ([`math::Rgb`]).
//! * Geometry and radiance are `f32`, sums that grow are `f64`.
//! * Random numbers follow from seed, pixel and sample alone, and sums have a fixed order: the same
//!   seed gives the same bits on any number of threads.

pub mod accel;
pub mod bsdf;
pub mod camera;
pub mod cli;
pub mod film;
pub mod guide;
pub mod image;
pub mod integrate;
pub mod light;
pub mod make;
pub mod manual;
pub mod math;
pub mod medium;
pub mod photon;
pub mod report;
pub mod scene;
pub mod texture;
