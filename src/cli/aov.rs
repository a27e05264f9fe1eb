//! The layers of an EXR beside the picture, as they can be typed.

use crate::bsdf::MaterialId;
use crate::film::{Extras, Layers, LightParts, Mattes};
use crate::scene::Description;
use clap::ValueEnum;

/// A layer beside the picture.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// Reflectance of the first rough surface, behind mirrors and glass: for denoisers
    Albedo,
    /// Its normal, world space
    Normal,
    /// Reflectance of the first surface
    #[value(name = "albedo.first")]
    FirstAlbedo,
    /// Its shading normal, world space
    #[value(name = "normal.first")]
    FirstNormal,
    /// Its geometric normal, without interpolation
    #[value(name = "normal.geometric")]
    GeometricNormal,
    /// Its distance
    Depth,
    /// Its position, world space
    Position,
    /// Its texture coordinates
    Uv,
    /// Mattes of objects and materials by their names
    Cryptomatte,
    /// Light that is seen directly or was scattered once
    Direct,
    /// All other light
    Indirect,
    /// Variance of each pixel's mean
    Variance,
    /// Noise like that of the picture, by which `compare` tells how wrong means over blocks may be
    Noise,
    /// Samples of each pixel
    Samples,
    /// Every layer
    All,
    /// The picture alone
    None,
}

impl Aov {
    /// Whether pixels have no sums for it unless it is asked for before the first sample: then
    /// parts have them, too, and others have not.
    pub fn is_extra(self) -> bool {
        matches!(
            self,
            Aov::GeometricNormal
                | Aov::Position
                | Aov::Uv
                | Aov::Cryptomatte
                | Aov::Direct
                | Aov::Indirect
                | Aov::All
        )
    }
}

/// Whether a layer was asked for.
pub fn has(asked: &[Aov], aov: Aov) -> bool {
    asked.contains(&aov) || asked.contains(&Aov::All)
}

/// What pixels of a scene carry for the layers of the first surface that were asked for.
pub fn extras(asked: &[Aov], scene: &Description) -> Extras {
    let has = |aov| has(asked, aov);
    let position = has(Aov::Position);
    Extras {
        position,
        origin: match position {
            true => scene.origin.to_array(),
            false => [0.0; 3],
        },
        uv: has(Aov::Uv),
        geometric_normal: has(Aov::GeometricNormal),
        alpha: false,
        light: LightParts::default(),
        mattes: has(Aov::Cryptomatte).then(|| mattes(scene)),
    }
}

/// The names of a scene's shapes and materials.
fn mattes(scene: &Description) -> Mattes {
    let materials = 0..scene.materials.len() as MaterialId;
    let materials: Vec<String> = materials.map(|id| scene.materials.name(id)).collect();
    let shapes = scene.shapes.iter();
    Mattes::new(shapes.map(|shape| [&*shape.name, &*materials[shape.material as usize]]))
}

/// Those of the layers that were asked for by name and that such pixels have no sums for.
pub fn missing(asked: &[Aov], extras: &Extras) -> Vec<Aov> {
    let lacks = |aov: &&Aov| match aov {
        Aov::GeometricNormal => !extras.geometric_normal,
        Aov::Position => !extras.position,
        Aov::Uv => !extras.uv,
        Aov::Cryptomatte => extras.mattes.is_none(),
        Aov::Direct | Aov::Indirect => !extras.light.direct,
        _ => false,
    };
    asked.iter().filter(lacks).copied().collect()
}

/// The layers that were asked for.
pub fn layers(asked: &[Aov]) -> Layers {
    let has = |aov| has(asked, aov);
    Layers {
        albedo: has(Aov::Albedo),
        normal: has(Aov::Normal),
        first_albedo: has(Aov::FirstAlbedo),
        first_normal: has(Aov::FirstNormal),
        depth: has(Aov::Depth),
        position: has(Aov::Position),
        uv: has(Aov::Uv),
        geometric_normal: has(Aov::GeometricNormal),
        direct: has(Aov::Direct),
        indirect: has(Aov::Indirect),
        cryptomatte: has(Aov::Cryptomatte),
        variance: has(Aov::Variance),
        noise: has(Aov::Noise),
        samples: has(Aov::Samples),
    }
}
