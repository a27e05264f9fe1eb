//! Views of the displays of an OpenColorIO configuration, which `$OCIO` names.

#[cfg(feature = "oiio")]
use super::oiio::display::Display;
use std::sync::Arc;

/// What configurations call linear light with Rec. 709 primaries: OpenColorIO's built-in ones and
/// those of ACES 1.3 and newer (and what these list as aliases), ACES 1.0 to 1.2, Blender, Nuke.
#[cfg(feature = "oiio")]
const SPACES: [&str; 8] = [
    "Linear Rec.709 (sRGB)",
    "lin_rec709_scene",
    "lin_rec709",
    "lin_srgb",
    "Linear Rec.709",
    "Utility - Linear - sRGB",
    "Linear",
    "linear",
];

/// A view of a display.
#[derive(Clone, Debug)]
pub struct DisplayView(Arc<Display>);

impl DisplayView {
    /// The view `name` of the configuration in the environment variable `OCIO`: that of its first
    /// display, `DISPLAY/VIEW`, or, where the name is empty, its first view.
    ///
    /// # Errors
    /// Without the variable; what OpenColorIO says of the configuration; which views there are.
    pub fn open(name: &str) -> Result<Self, String> {
        let config = std::env::var("OCIO").unwrap_or_default();
        if config.is_empty() {
            return Err("the environment variable OCIO names no configuration".into());
        }
        let display = Display::open(&config, name, &SPACES);
        let display = display.map_err(|why| format!("OCIO={config}: {why}"))?;
        Ok(Self(Arc::new(display)))
    }

    /// Turns linear light into what the display is to show, in place.
    ///
    /// # Errors
    /// What OpenColorIO says.
    pub fn apply(&self, pixels: &mut [[f32; 3]]) -> Result<(), String> {
        self.0.apply(pixels)
    }
}

impl PartialEq for DisplayView {
    /// Whether both are the same opened view.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// In a build without OpenImageIO there is none.
#[cfg(not(feature = "oiio"))]
#[derive(Debug)]
enum Display {}

#[cfg(not(feature = "oiio"))]
const SPACES: [&str; 0] = [];

#[cfg(not(feature = "oiio"))]
impl Display {
    fn open(_: &str, _: &str, _: &[&str]) -> Result<Self, String> {
        Err("this build has no OpenColorIO: it was made without the feature `oiio`".into())
    }

    fn apply(&self, _: &mut [[f32; 3]]) -> Result<(), String> {
        match *self {}
    }
}
