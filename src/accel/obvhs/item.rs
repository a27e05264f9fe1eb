//! What the leaves of a tree hold.

/// What a leaf holds. Parts are the geometries of [`super::tree::Tree::parts`].
#[derive(Clone, Copy, Debug)]
pub enum Item {
    /// Triangle `prim` of part `part`.
    Triangle {
        /// Index into the tree's parts.
        part: u32,
        /// Index into the mesh.
        prim: u32,
    },
    /// The exact shape of a part.
    Analytic {
        /// Index into the tree's parts.
        part: u32,
    },
    /// An instance, by its index in the world.
    Instance(u32),
    /// Several items that share one box: so many from there on in the tree's list of bundled ones.
    Bundle {
        /// The first.
        start: u32,
        /// How many.
        count: u32,
    },
}
