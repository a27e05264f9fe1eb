//! What an image file says about the render that made it.

use crate::image::Attribute;

/// What is written into the file beside the pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// The scene file.
    pub scene: String,
    /// The settings, as the command line would give them.
    pub settings: String,
    /// Samples a pixel.
    pub spp: u64,
    /// Seconds of rendering.
    pub seconds: f64,
}

impl Metadata {
    pub(super) fn attributes(&self) -> Vec<Attribute> {
        vec![
            Attribute::text("Software", concat!("twintree ", env!("CARGO_PKG_VERSION"))),
            Attribute::text("twintree:scene", &self.scene),
            Attribute::text("twintree:settings", &self.settings),
            Attribute::text("twintree:spp", self.spp.to_string()),
            Attribute::float("twintree:seconds", self.seconds as f32),
        ]
    }
}
