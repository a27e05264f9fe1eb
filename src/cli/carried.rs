//! What one frame of a sequence leaves to the next: where nothing but the camera has moved, the
//! scene as it was built, and the field as far as it was learned.

use super::Failure;
use super::load::Loaded;
use crate::integrate::training::Learner;
use crate::scene::Scene;

/// A scene that was rendered.
struct Known {
    /// Tells it from others, whatever the camera.
    world: u64,
    scene: Scene,
    learner: Option<Learner>,
}

/// What is carried from frame to frame.
#[derive(Default)]
pub struct Carried {
    wanted: bool,
    world: Option<u64>,
    known: Option<Known>,
}

impl Carried {
    /// For a sequence. (The default is for a single image, after which nothing comes.)
    pub fn wanted() -> Self {
        Self {
            wanted: true,
            ..Self::default()
        }
    }

    /// The scene and the field of the frame before, if they are those of this one, too. What is of
    /// another scene is let go of, and so are the new one's shapes where they are the same: two
    /// are not held at a time.
    ///
    /// # Errors
    /// When a file that the scene names cannot be read.
    pub fn take(
        &mut self,
        loaded: &mut Loaded,
    ) -> Result<Option<(Scene, Option<Learner>)>, Failure> {
        if !self.wanted {
            return Ok(None);
        }
        let world = loaded.world_fingerprint()?;
        self.world = Some(world);
        let known = self.known.take().filter(|known| known.world == world);
        if known.is_some() {
            tracing::debug!("only the camera has moved: the scene is kept");
            loaded.description.shapes = Vec::new();
        }
        Ok(known.map(|known| (known.scene, known.learner)))
    }

    /// Keeps the scene, and the field if it has proved worthwhile.
    pub fn keep(&mut self, scene: Scene, learner: Option<Learner>) {
        let learner = learner.filter(|l| l.worthwhile_guide().is_some());
        self.known = self.world.map(|world| Known {
            world,
            scene,
            learner,
        });
    }
}
