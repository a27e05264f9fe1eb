//! What is printed about scenes and renders: the only place that turns measurements into text.

pub mod accel;
pub mod compare;
pub mod field;
pub mod left_out;
pub mod names;
pub mod scale;
pub mod scale_plot;
pub mod scene;
pub mod stats;
pub mod sweep;
pub mod table;
pub mod table1;
pub mod totals;
pub mod words;

/// Indented JSON with a line's end. Numbers that are not finite become `null`.
fn json(value: &impl serde::Serialize) -> String {
    // Structs of numbers and strings: nothing here can refuse.
    serde_json::to_string_pretty(value).unwrap_or_default() + "\n"
}
