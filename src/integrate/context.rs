//! What is rendered and how: what all paths of a render share.

use super::guiding::Guidance;
use super::settings::PathSettings;
use crate::camera::Camera;
use crate::film::FilmDescription;
use crate::scene::Scene;

/// What is rendered, and how.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// From where.
    pub camera: &'a Camera,
    /// Size and filter of the film.
    pub film: &'a FilmDescription,
    /// How paths are traced.
    pub settings: &'a PathSettings,
    /// A learned field, to guide by.
    pub guide: Option<Guidance<'a>>,
}

impl<'a> View<'a> {
    /// What its paths share.
    pub fn context(&self) -> PathContext<'a> {
        PathContext {
            scene: self.scene,
            settings: self.settings,
            guide: self.guide,
        }
    }
}

/// What all vertices of a render share.
#[derive(Clone, Copy)]
pub struct PathContext<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// How paths are traced.
    pub settings: &'a PathSettings,
    /// A learned field, to guide by.
    pub guide: Option<Guidance<'a>>,
}
