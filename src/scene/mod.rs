//! Scenes: first as data ([`Description`]), as an importer leaves them, then built for rendering.

pub mod area;
pub mod build;
pub mod description;
mod exact;
pub mod fingerprint;
pub mod import;
pub mod precautions;
pub mod spare;
pub mod surface;
mod transform;
mod turning;

pub use build::{Scene, lights_of};
pub use description::{Description, Geometry, Mesh, Shape};
