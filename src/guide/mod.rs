//! Double hierarchies (draft head).
mod field;
mod file;
mod fraction;
mod freeze;
mod links;
mod merge;
mod model;
mod random;
mod record;
mod refine;
mod settings;
mod space;
mod stats;
mod tally;
mod train;

pub use field::{Field, GuideSample, LocalField};
pub use fraction::{FLOOR, FractionRecord, Fractions};
pub use model::ModelKind;
pub use record::{PathSample, Photon, SurfacePoint};
pub use refine::Refined;
pub use settings::{GuideError, Product, Settings, Source, Target};
pub use stats::Stats;
pub use train::{Intakes, Trainer};

#[cfg(test)]
mod tests;
