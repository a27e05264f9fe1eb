//! What light comes from.

use super::{EmitterId, Incoming, Lights, Shining, Source};
use crate::math::{Rgb, Vec3};

/// What light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// An emitter.
    Emitter(EmitterId),
    /// All that shines from outside the scene in this unit direction.
    Sky(Vec3),
}

impl From<Shining> for LightSource {
    fn from(light: Shining) -> Self {
        match light {
            Shining::Sky(dir) => Self::Sky(dir),
            Shining::Shape(emitter) => Self::Emitter(emitter),
        }
    }
}

impl Lights {
    /// What the light of a sample comes from, which was drawn in direction `dir`.
    pub fn source_of(&self, incoming: &Incoming, dir: Vec3) -> LightSource {
        match &incoming.0 {
            Source::Here(_, emitter) => LightSource::Emitter(*emitter),
            Source::Mixed(_) => LightSource::Sky(dir),
            Source::Distant(number, _) => LightSource::Emitter(self.distant[*number as usize].0),
        }
    }

    /// What each emitter sends from outside the scene along the ray direction `dir`, in parts: an
    /// emitter may be there more than once.
    pub fn environment_by_emitter(&self, dir: Vec3) -> impl Iterator<Item = (EmitterId, Rgb)> + '_ {
        let radiance =
            move |(emitter, light): &(EmitterId, super::Distant)| (*emitter, light.radiance(dir));
        self.distant.iter().map(radiance)
    }
}
