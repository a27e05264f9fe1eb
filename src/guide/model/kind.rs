//! The names of the local models.

use serde::{Deserialize, Serialize};

/// Which local model a field uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModelKind {
    /// Uniform over the link's direction cell: the paper's model.
    #[default]
    Constant,
    /// A mixture of von Mises-Fisher lobes over the whole sphere, one a cell of R, with parallax.
    Vmf,
    /// A mixture of Gaussians over an equal-area map of the sphere, one a cell of R.
    Gauss,
}
