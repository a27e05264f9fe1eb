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
mod turning;

pub use build::{BuildError, Scene};
pub use description::{Description, Geometry, Mesh, Shape};
