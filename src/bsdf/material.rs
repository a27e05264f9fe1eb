//! Materials as data: what a scene file says about a surface.
//!
//! The names and meanings are those of Mitsuba's plugins; parameters that a scene may texture are
//! [`Texture`]s, the others plain numbers.

use super::MaterialId;
use super::facet_albedo::facet_albedo;
use super::lobes::either_lobe;
use super::model::{Lookup, Model, Textures};
use super::sheen::albedos;
use super::transmittance::RoughTransmittance;
use crate::texture::Texture;
use std::fmt::{self, Debug, Formatter};

pub use super::lobes::conductor::Conductor;
pub use super::lobes::dielectric::Dielectric;
pub use super::lobes::diffuse::Diffuse;
pub use super::lobes::diffuse_transmitter::DiffuseTransmitter;
pub use super::lobes::measured::Measured;
pub use super::lobes::metallic_roughness::{
    Anisotropy, DiffuseTransmission, Film, MetallicRoughness,
};
pub use super::lobes::null::Null;
pub use super::lobes::phong::Phong;
pub use super::lobes::plastic::Plastic;
pub use super::lobes::principled::Principled;
pub use super::lobes::principled_thin::PrincipledThin;
pub use super::lobes::rough_conductor::RoughConductor;
pub use super::lobes::rough_dielectric::RoughDielectric;
pub use super::lobes::rough_diffuse::RoughDiffuse;
pub use super::lobes::rough_plastic::RoughPlastic;
pub use super::lobes::thin_dielectric::ThinDielectric;
pub use super::lobes::ward::{Ward, WardVariant};
pub use super::microfacet::Distribution;
pub(crate) use super::parameters::Parameters;
pub use super::parameters::{Roughness, white};
pub use super::perturb::InvalidNormals;

/// Makes [`Material`] and [`Leaf`] of the list of models, and of the materials around others.
macro_rules! materials {
    (
        models { $($model:ident = $name:literal,)* }
        boxed { $($boxed:ident = $boxed_name:literal,)* }
        around {
            $(
                $(#[$doc:meta])*
                $around:ident = $around_name:literal {
                    $($(#[$field_doc:meta])* $field:ident: $type:ty,)*
                },
            )*
        }
    ) => {
        /// A material: a model and its parameters, or something around other materials.
        #[derive(Clone)]
        pub enum Material {
            $(#[doc = concat!("The model `", $name, "`.")] $model($model),)*
            $(#[doc = concat!("The model `", $boxed_name, "`.")] $boxed(Box<$boxed>),)*
            $($(#[$doc])* $around { $($(#[$field_doc])* $field: $type,)* },)*
        }

        either_lobe! {
            /// A model at a point.
            pub(super) enum Leaf {
                $($model(<$model as Model>::Lobe),)*
                $($boxed(<$boxed as Model>::Lobe),)*
            }
        }

        $(
            impl From<$model> for Material {
                fn from(model: $model) -> Self {
                    Self::$model(model)
                }
            }
        )*
        $(
            impl From<$boxed> for Material {
                fn from(model: $boxed) -> Self {
                    Self::$boxed(Box::new(model))
                }
            }
        )*

        impl Material {
            /// The name by which scene files call it.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$model(_) => $name,)*
                    $(Self::$boxed(_) => $boxed_name,)*
                    $(Self::$around { .. } => $around_name,)*
                }
            }

            /// The names that Mitsuba's scene files can ask for.
            pub(crate) fn plugins() -> Vec<&'static str> {
                let models = [
                    $(($model::is_plugin(), $name),)*
                    $(($boxed::is_plugin(), $boxed_name),)*
                ];
                let models = models.into_iter().filter(|(is_plugin, _)| *is_plugin);
                models.map(|(_, name)| name).chain([$($around_name),*]).collect()
            }

            /// Reads the model of that name; `None` if there is no such model.
            pub(crate) fn read(name: &str, p: &mut dyn Parameters) -> Option<Result<Self, String>> {
                Some(match name {
                    $($name => $model::read(p).map(Self::from),)*
                    $($boxed_name => $boxed::read(p).map(Self::from),)*
                    _ => return None,
                })
            }

            /// The model that it is, unless it is something around others.
            pub(super) fn model(&self) -> Option<&dyn Model> {
                match self {
                    $(Self::$model(model) => Some(model),)*
                    $(Self::$boxed(model) => Some(&**model),)*
                    $(Self::$around { .. })|* => None,
                }
            }

            /// The model at a point, unless it is something around others.
            #[inline]
            pub(super) fn leaf(&self, at: &Lookup) -> Option<Leaf> {
                Some(match self {
                    $(Self::$model(model) => Leaf::$model(model.lobe(at)),)*
                    $(Self::$boxed(model) => Leaf::$boxed(model.lobe(at)),)*
                    $(Self::$around { .. })|* => return None,
                })
            }

            /// Examples of all models, by name.
            #[cfg(test)]
            pub(super) fn examples() -> Vec<(&'static str, Self)> {
                fn of<M: Model + Into<Material>>() -> Vec<(&'static str, Material)> {
                    let examples = M::examples().into_iter();
                    examples.map(|(name, model)| (name, model.into())).collect()
                }
                [$(of::<$model>(),)* $(of::<$boxed>(),)*].concat()
            }
        }

        /// The fingerprint of a scene is made of this.
        impl Debug for Material {
            fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
                match self {
                    $(Self::$model(model) => model.fmt(f),)*
                    $(Self::$boxed(model) => f.debug_tuple(stringify!($boxed)).field(model).finish(),)*
                    $(Self::$around { $($field),* } => f
                        .debug_struct(stringify!($around))
                        $(.field(stringify!($field), $field))*
                        .finish(),)*
                }
            }
        }
    };
}

materials! {
    models {
        Diffuse = "diffuse",
        RoughDiffuse = "roughdiffuse",
        Dielectric = "dielectric",
        ThinDielectric = "thindielectric",
        RoughDielectric = "roughdielectric",
        Conductor = "conductor",
        RoughConductor = "roughconductor",
        Plastic = "plastic",
        RoughPlastic = "roughplastic",
        Phong = "phong",
        Ward = "ward",
        DiffuseTransmitter = "difftrans",
        Null = "null",
        Measured = "measured",
    }
    // Those with so many parameters that the others would be stored in as much space.
    boxed {
        Principled = "principled",
        PrincipledThin = "principledthin",
        MetallicRoughness = "metallic-roughness",
    }
    around {
        /// Opacity over a material. The ray queries resolve it (see [`crate::accel::Opacity`]):
        /// resolving the material at a hit yields the inner one.
        Mask = "mask" {
            /// Opacity, 0 to 1.
            opacity: Texture,
            /// The masked material.
            inner: MaterialId,
        },
        /// One-sided materials made to work from both sides.
        TwoSided = "twosided" {
            /// Seen from the side of the normal.
            front: MaterialId,
            /// Seen from the other side.
            back: MaterialId,
        },
        /// A displacement texture that turns the shading normal.
        BumpMap = "bumpmap" {
            /// Displacement, in world units after `scale`.
            displacement: Texture,
            /// Factor on the displacement.
            scale: f32,
            /// What is done about impossible normals.
            invalid_normals: InvalidNormals,
            /// The material under it.
            inner: MaterialId,
        },
        /// A tangent-space normal map.
        NormalMap = "normalmap" {
            /// Raw image: (x, y, z) * 0.5 + 0.5.
            normals: Texture,
            /// What is done about impossible normals.
            invalid_normals: InvalidNormals,
            /// The material under it.
            inner: MaterialId,
        },
        /// Linear interpolation: `(1 - weight) * first + weight * second`.
        Blend = "blendbsdf" {
            /// 0 is the first, 1 the second.
            weight: Texture,
            /// First material.
            first: MaterialId,
            /// Second material.
            second: MaterialId,
        },
        /// Weighted sum.
        Mixture = "mixturebsdf" {
            /// Weights (their sum at most 1) and materials.
            parts: Vec<(f32, MaterialId)>,
        },
        /// Smooth dielectric coating (Mitsuba 0.x `coating`).
        Coating = "coating" {
            /// Interior over exterior index of refraction.
            eta: f32,
            /// Thickness in units of `sigma_a`'s inverse.
            thickness: f32,
            /// Absorption inside the layer.
            sigma_a: Texture,
            /// Factor on the coat's reflection.
            specular_reflectance: Texture,
            /// The coated material.
            inner: MaterialId,
        },
        /// Rough dielectric coating (Mitsuba 0.x `roughcoating`).
        RoughCoating = "roughcoating" {
            /// Interior over exterior index of refraction.
            eta: f32,
            /// Microfacets of the coat (isotropic).
            roughness: Roughness,
            /// Thickness in units of `sigma_a`'s inverse.
            thickness: f32,
            /// Absorption inside the layer.
            sigma_a: Texture,
            /// Factor on the coat's reflection.
            specular_reflectance: Texture,
            /// The coated material.
            inner: MaterialId,
        },
        /// A clear varnish of index 1.5 (glTF's `KHR_materials_clearcoat`).
        ClearCoat = "clearcoat" {
            /// How much of the surface has it, 0 to 1.
            weight: Texture,
            /// Perceptual roughness, the square root of its facets' width.
            roughness: Texture,
            /// The coated material.
            inner: MaterialId,
        },
        /// Fibres that shine at grazing angles (glTF's `KHR_materials_sheen`).
        Sheen = "sheen" {
            /// Their colour.
            color: Texture,
            /// Perceptual roughness, the square root of the distribution's alpha.
            roughness: Texture,
            /// The material beneath.
            inner: MaterialId,
        },
    }
}

impl Material {
    /// The materials that it names.
    pub(super) fn inner(&self) -> impl Iterator<Item = MaterialId> + '_ {
        let (pair, parts): ([Option<MaterialId>; 2], &[(f32, MaterialId)]) = match self {
            Self::TwoSided { front, back } => ([Some(*front), Some(*back)], &[]),
            Self::Blend { first, second, .. } => ([Some(*first), Some(*second)], &[]),
            Self::Mixture { parts } => ([None, None], parts),
            Self::Mask { inner, .. }
            | Self::BumpMap { inner, .. }
            | Self::NormalMap { inner, .. }
            | Self::Coating { inner, .. }
            | Self::RoughCoating { inner, .. }
            | Self::ClearCoat { inner, .. }
            | Self::Sheen { inner, .. } => ([Some(*inner), None], &[]),
            _ => ([None, None], &[]),
        };
        let parts = parts.iter().map(|p| p.1);
        pair.into_iter().flatten().chain(parts)
    }

    /// The textures it looks up itself, without those of the materials that it names.
    pub(super) fn textures(&self) -> Textures<'_> {
        let (linear, nonlinear) = match self {
            Self::Mask { opacity: t, .. } | Self::Blend { weight: t, .. } => (vec![t], vec![]),
            Self::BumpMap {
                displacement: t, ..
            }
            | Self::NormalMap { normals: t, .. } => (vec![], vec![t]),
            Self::Coating {
                sigma_a,
                specular_reflectance,
                ..
            } => (vec![specular_reflectance], vec![sigma_a]),
            Self::RoughCoating {
                roughness,
                sigma_a,
                specular_reflectance,
                ..
            } => (
                vec![specular_reflectance],
                vec![&roughness.alpha_u, sigma_a],
            ),
            Self::ClearCoat {
                weight, roughness, ..
            } => (vec![], vec![weight, roughness]),
            Self::Sheen {
                color, roughness, ..
            } => (vec![], vec![color, roughness]),
            _ => return self.model().map(Model::textures).unwrap_or_default(),
        };
        Textures { linear, nonlinear }
    }

    /// Makes the tables that it needs, and returns the one of its rough coat.
    pub(super) fn prepare(&self) -> Option<&'static RoughTransmittance> {
        match self {
            Self::RoughCoating { eta, roughness, .. } => Some(roughness.coat_table(*eta)),
            Self::Sheen { .. } => {
                albedos();
                None
            }
            Self::ClearCoat { .. } => {
                facet_albedo();
                None
            }
            _ => self.model()?.prepare(),
        }
    }

    /// Whether it turns the shading normal.
    pub(super) fn turns_normal(&self) -> bool {
        matches!(self, Self::BumpMap { .. } | Self::NormalMap { .. })
    }

    /// Whether light of it goes on behind the surface in another direction.
    pub(crate) fn refracts(&self) -> bool {
        self.model().is_some_and(Model::refracts)
    }

    /// Whether light passes its surface. What it names may let it pass besides.
    pub(crate) fn transmits(&self) -> bool {
        matches!(self, Self::Mask { .. }) || self.model().is_some_and(Model::transmits)
    }
}
