//! What textures read of a mesh, so that nothing else is kept.

use super::Texture;
use std::collections::BTreeSet;
use std::sync::Arc;

/// What is read of a mesh beside its triangles and normals.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reads {
    /// Texture coordinates.
    pub uvs: bool,
    /// Attributes, by name.
    pub attributes: BTreeSet<Arc<str>>,
}

impl Texture {
    /// Adds what the texture reads.
    pub fn add_reads(&self, reads: &mut Reads) {
        match self {
            Texture::Constant(_) => {}
            Texture::Bitmap(_) | Texture::Grid(_) => reads.uvs = true,
            Texture::Checkerboard(board) => {
                reads.uvs = true;
                board.color0.add_reads(reads);
                board.color1.add_reads(reads);
            }
            Texture::Scale(scaled) => scaled.0.add_reads(reads),
            Texture::Affine(affine) => affine.0.add_reads(reads),
            Texture::Product(both) => {
                both.0.add_reads(reads);
                both.1.add_reads(reads);
            }
            Texture::Threshold(step) => step.0.add_reads(reads),
            Texture::Limited(inner) => inner.add_reads(reads),
            Texture::Computed(formula) => {
                reads.uvs |= formula.reads_uvs();
                for inner in formula.inner() {
                    inner.add_reads(reads);
                }
            }
            Texture::MeshAttribute(name) => {
                reads.attributes.insert(name.clone());
            }
        }
    }
}
