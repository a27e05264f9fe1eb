//! Scenes: first as data ([`Description`]), as an importer leaves them, then built for rendering.

mod analytic;
pub mod area;
pub mod build;
pub mod description;
pub mod fingerprint;
pub mod free_flight;
pub mod import;
pub mod interaction;
pub mod media;
mod medium_points;
mod normal_derivative;
pub mod path_medium;
pub mod precautions;
pub mod spare;
pub mod surface;
mod transform;
pub mod wavefront;

pub use build::{Scene, lights_of};
pub use description::{Description, Geometry, Mesh, Shape};
