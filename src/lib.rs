//! `twintree`: a physically based renderer that learns where light comes from before it renders.
//!
//! ```text
//!  scene file --import--> Description --build--> Scene ----------------------+
//!                                                  |                         |
//!                                     photons (photon/)            camera paths (integrate/)
//!                                                  |                         |
//!                                         field (guide/) ----- sample -----> Film --> EXR, PNG
//! ```
//!
//! Modules depend on each other in one direction only:
//! `cli` > `integrate` > `guide`, `photon` > `scene` > `bsdf`, `light`, `camera`, `film` > `texture` >
//! `accel`, `image` > `math`.
//!
//! Conventions used everywhere: directions point *away* from the surface point they belong to and are
//! of unit length; local shading coordinates have the normal on +z; radiance and reflectance are
//! linear sRGB ([`math::Rgb`]); geometry and radiance are `f32`, sums that grow are `f64`.

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
pub mod math;
pub mod photon;
pub mod report;
pub mod scene;
pub mod texture;
