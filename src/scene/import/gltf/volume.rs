//! What is inside of a transmitting body: `KHR_materials_volume`.

use super::Importer;
use super::extension::Extension;
use super::materials::name_of;
use super::schema;
use crate::math::Rgb;
use crate::medium::{Boundary, Medium};

fn extension(material: &schema::Material) -> Option<Extension<'_>> {
    Extension::of(&material.extensions, "KHR_materials_volume")
}

/// Thickness of the body below the surface, which tells thin surfaces (0) from closed ones: rays
/// find the true one by themselves.
pub(super) fn thickness(material: &schema::Material) -> f32 {
    extension(material).map_or(0.0, |volume| volume.number("thicknessFactor", 0.0))
}

/// The colour that light is left in, and after which distance. `None` where nothing is absorbed.
fn attenuation(material: &schema::Material) -> Option<(Rgb, f32)> {
    let volume = extension(material)?;
    let color = volume.color("attenuationColor", Rgb::ONE);
    let distance = volume.number("attenuationDistance", f32::INFINITY);
    let absorbs = color != Rgb::ONE && distance > 0.0 && distance.is_finite();
    absorbs.then_some((color, distance))
}

impl Importer<'_> {
    /// What a primitive of that material encloses; `None` where it encloses nothing that absorbs.
    pub(super) fn boundary(&mut self, index: Option<usize>) -> Option<Boundary> {
        if let Some((_, boundary)) = self.only_material {
            return boundary;
        }
        let index = index?;
        let material = self.container.document.materials.get(index)?;
        let transmission = Extension::of(&material.extensions, "KHR_materials_transmission")?;
        let opaque = transmission.number("transmissionFactor", 0.0) <= 0.0;
        if opaque || thickness(material) <= 0.0 {
            return None;
        }
        let (color, distance) = attenuation(material)?;
        let name = name_of(material, Some(index));
        let list = &mut self.parts.media;
        let interior = *self
            .media
            .entry(index)
            .or_insert_with(|| list.push(Medium::absorbing(name, color, distance)));
        Some(Boundary::in_vacuum(interior))
    }
}
