//! What a colour or texture of a scene file is for.

use crate::scene::import::spectrum::Weighting;

/// What a colour is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Role {
    /// A factor on scattered light: each channel in `[0, 1]`.
    Reflectance,
    /// Any number: an index of refraction, a roughness, a displacement.
    Number,
    /// Light.
    Light,
}

impl Role {
    pub fn weighting(self) -> Weighting {
        match self {
            Role::Light => Weighting::Emission,
            Role::Reflectance | Role::Number => Weighting::Reflectance,
        }
    }
}
