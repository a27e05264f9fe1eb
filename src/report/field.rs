//! What is in a learned field: `twintree field`.

use super::words;
use crate::guide::{FieldFile, ModelKind, SampleRanges, Source, Stats};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// What is in a field. The field names are the keys of `twintree field --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldReport {
    /// The file.
    pub field: String,
    /// Fingerprint of the scene, hexadecimal.
    pub scene: String,
    /// Lower corner of the scene.
    pub min: [f32; 3],
    /// Upper corner of the scene.
    pub max: [f32; 3],
    /// What describes the directions of a cell.
    pub model: ModelKind,
    /// Which records carry the estimates.
    pub source: Source,
    /// Which records are in it.
    pub sample_ranges: SampleRanges,
    /// Sizes, depths and counts.
    pub stats: Stats,
    /// Bytes when rendering.
    pub frozen_bytes: u64,
    /// Mean share of samples that the field draws, over its cells.
    pub mean_fraction: f64,
}

impl FieldReport {
    /// The report on a field that was read from `path`.
    pub fn of(path: &Path, file: &FieldFile) -> Self {
        let settings = file.trainer.settings();
        let (field, fractions) = file.freeze();
        let cells = field.cell_count();
        let sum: f64 = (0..cells)
            .map(|c| f64::from(fractions.chances(c).field))
            .sum();
        Self {
            field: path.display().to_string(),
            scene: format!("{:016x}", settings.scene_hash),
            min: settings.min.into(),
            max: settings.max.into(),
            model: settings.model,
            source: settings.source,
            sample_ranges: file.sample_ranges.clone(),
            stats: file.trainer.stats(),
            frozen_bytes: field.bytes(),
            mean_fraction: sum / f64::from(cells.max(1)),
        }
    }

    /// The JSON of `twintree field --json`.
    pub fn to_json(&self) -> String {
        super::json(self)
    }

    /// A table for people.
    pub fn to_table(&self) -> String {
        let (s, l) = (&self.stats, &self.sample_ranges);
        let i = &s.intakes;
        let mut rows = vec![
            ("field", self.field.clone()),
            ("scene", self.scene.clone()),
            ("bounds", format!("{:?} to {:?}", self.min, self.max)),
            ("model", name(&self.model)),
            ("source", name(&self.source)),
            ("recipe", l.recipe.clone()),
            (
                "photons",
                format!("{}, {} landings used", l.photons.count(), i.photons),
            ),
            (
                "paths",
                format!("{}, {} vertices used", l.paths.count(), i.paths),
            ),
            (
                "dropped",
                format!("{}", i.dropped_non_finite + i.dropped_direction),
            ),
            (
                "batches",
                format!("{}, {} rounds of refining", i.batches, i.rounds),
            ),
            (
                "space",
                format!("{} nodes, {} cells", s.space_nodes, s.space_cells),
            ),
            (
                "links",
                format!(
                    "{} of {} nodes, {:.1} a cell",
                    s.links, s.product_nodes, s.links_per_cell
                ),
            ),
            (
                "bytes",
                format!(
                    "{} when learning, {} when rendering",
                    words::bytes(s.training_bytes),
                    words::bytes(self.frozen_bytes)
                ),
            ),
            (
                "fraction",
                format!("{:.3} of all samples, mean over cells", self.mean_fraction),
            ),
            ("cells by depth in space", list(&s.space_depths)),
            ("links by depth in space", list(&s.link_space_depths)),
            (
                "links by depth in direction",
                list(&s.link_direction_depths),
            ),
        ];
        if let Some(missing) = l.missing() {
            rows.push(("missing", missing));
        }
        let mut text = String::new();
        for (name, value) in rows {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name:<29}{value}");
        }
        text
    }
}

/// The name that a file gives a choice.
fn name(choice: &impl Serialize) -> String {
    let json = serde_json::to_string(choice).unwrap_or_default();
    json.trim_matches('"').to_owned()
}

/// Counts of depths 0, 1, 2, ...
fn list(counts: &[u64]) -> String {
    let words: Vec<String> = counts.iter().map(u64::to_string).collect();
    words.join(" ")
}
