//! Training the field: from photons before rendering, from the image's first samples, and whether
//! that pays.

pub mod camera_paths;
mod count;
pub mod effort;
pub mod extend;
pub mod importance;
mod learner;
mod method;
pub mod mixtures;
mod passes;
mod photons;
pub mod prospect;
pub mod record;
mod settings;
pub mod trial;

pub use count::{expected, traced};
pub use learner::{Learned, Learner, garbage, garbage_sd_tree, learn, learn_until};
pub(super) use passes::train_passes;
pub use settings::LearnSettings;
