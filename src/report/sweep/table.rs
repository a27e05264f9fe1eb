//! `runs.csv`: a row a run, for whoever wants to compute something else.

use super::{Run, Sweep};

/// Heads of the columns.
const HEAD: [&str; 19] = [
    "configuration",
    "round",
    "failure",
    "wall_seconds",
    "load_seconds",
    "build_seconds",
    "train_seconds",
    "render_seconds",
    "spp",
    "rays",
    "rmse",
    "relmse",
    "relmse_trimmed",
    "relmse_4x4",
    "relmse_16x16",
    "peak_memory_bytes",
    "field_memory_bytes",
    "accel_memory_bytes",
    "command",
];

impl Sweep {
    /// The file `runs.csv`.
    pub fn to_csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        // Into memory, and rows are as long as the head: nothing here can fail.
        let _ = writer.write_record(HEAD);
        for run in &self.runs {
            let _ = writer.write_record(row(run));
        }
        let bytes = writer.into_inner().unwrap_or_default();
        String::from_utf8(bytes).unwrap_or_default()
    }
}

fn row(run: &Run) -> [String; 19] {
    let stats = run.stats.as_ref();
    let number = |of: &dyn Fn(&super::RunStats) -> Option<f64>| {
        stats.and_then(of).map_or(String::new(), |x| x.to_string())
    };
    let error = |of: &dyn Fn(&super::ErrorPoint) -> f64| number(&|s| s.errors.last().map(of));
    [
        run.configuration.clone(),
        run.round.to_string(),
        run.failure.clone().unwrap_or_default(),
        run.wall_seconds.to_string(),
        number(&|s| Some(s.load_seconds)),
        number(&|s| Some(s.build_seconds)),
        number(&|s| Some(s.train_seconds)),
        number(&|s| Some(s.render_seconds)),
        number(&|s| Some(s.spp as f64)),
        number(&|s| Some(s.rays as f64)),
        error(&|e| e.rmse),
        error(&|e| e.relmse),
        error(&|e| e.relmse_trimmed),
        number(&|s| s.errors.last()?.relmse_4x4),
        number(&|s| s.errors.last()?.relmse_16x16),
        number(&|s| Some(s.peak_memory_bytes? as f64)),
        number(&|s| Some(s.field_memory_bytes as f64)),
        number(&|s| Some(s.accel_memory_bytes as f64)),
        run.command.clone(),
    ]
}
