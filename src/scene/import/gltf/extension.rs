//! Material extensions: their numbers and textures, with defaults.

use super::schema::{Extensions, TextureInfo};
use crate::math::Rgb;
use serde_json::Value;

/// Extensions that are understood, if not always to the last of their parameters: what is left out
/// of them is told where it is met.
pub(super) const KNOWN: [&str; 28] = [
    "EXT_mesh_gpu_instancing",
    super::meshopt::NAMES[0],
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    super::meshopt::NAMES[1],
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
    "KHR_xmp",
];

/// An extension's object.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extension<'a>(&'a Value);

impl<'a> Extension<'a> {
    /// The extension `name`, if the object has it.
    pub fn of(extensions: &'a Extensions, name: &str) -> Option<Self> {
        extensions.get(name).map(Self)
    }

    /// A number.
    pub fn number(&self, key: &str, default: f32) -> f32 {
        let value = self.0.get(key).and_then(Value::as_f64);
        value.map_or(default, |v| v as f32)
    }

    /// A colour; a fourth component is left out.
    pub fn color(&self, key: &str, default: Rgb) -> Rgb {
        let list = self.0.get(key).and_then(Value::as_array);
        let part = |i: usize| list?.get(i)?.as_f64().map(|v| v as f32);
        match (part(0), part(1), part(2)) {
            (Some(r), Some(g), Some(b)) => Rgb::new(r, g, b),
            _ => default,
        }
    }

    /// The fourth component of a colour.
    pub fn alpha(&self, key: &str) -> f32 {
        let list = self.0.get(key).and_then(Value::as_array);
        let alpha = list.and_then(|l| l.get(3)?.as_f64());
        alpha.map_or(1.0, |v| v as f32)
    }

    /// Of `KHR_materials_specular`: whether it says other than that facets reflect as they do.
    pub fn changes_reflectance(&self) -> bool {
        let textures = ["specularTexture", "specularColorTexture"];
        self.number("specularFactor", 1.0) != 1.0
            || self.color("specularColorFactor", Rgb::ONE) != Rgb::ONE
            || textures.iter().any(|key| self.0.get(key).is_some())
    }

    /// A texture.
    pub fn texture(&self, key: &str) -> Option<TextureInfo> {
        let value = self.0.get(key)?.clone();
        serde_json::from_value(value).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::KNOWN;

    /// The names in the first column of a table of the manual.
    fn rows<'a>(page: &'a str, head: &str) -> Vec<&'a str> {
        let table = page.split(head).nth(1).unwrap();
        let table = table
            .split("\n\n")
            .find(|part| part.starts_with('|'))
            .unwrap();
        let first = |line: &'a str| line.split('|').nth(1).map(str::trim);
        let names = table.lines().skip(2).filter_map(first);
        names.map(|name| name.trim_matches('`')).collect()
    }

    #[test]
    fn the_manual_has_a_line_for_every_extension_and_no_others() {
        let page = include_str!("../../../manual/models.md");
        let mut known = KNOWN.to_vec();
        known.sort_unstable();
        let mut told = rows(page, "## glTF extensions");
        told.sort_unstable();
        assert_eq!(told, known);
    }
}
