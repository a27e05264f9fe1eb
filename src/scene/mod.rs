//! Scenes: first as data ([`Description`]), as an importer leaves them, then built for rendering.

pub mod description;
pub mod import;

pub use description::{Description, Geometry, Mesh, Shape};
