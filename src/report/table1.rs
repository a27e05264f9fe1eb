//! Errors, memory and times of methods that guide: `twintree table1`.

use super::table::{markdown, number};
use serde::Serialize;
use std::fmt::Write as _;

/// What is printed. The field names are the keys of `twintree table1 --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table1 {
    /// Version of the program.
    pub version: String,
    /// Threads that learned and rendered.
    pub threads: usize,
    /// Samples a pixel.
    pub spp: u64,
    /// Batches of photons.
    pub batches: u32,
    /// Photon paths a batch.
    pub photons_per_batch: u64,
    /// How many pixels' paths shared what they found.
    pub reuse: u32,
    /// Times that everything was done.
    pub repeats: u32,
    /// Seed of the first time.
    pub seed: u64,
    /// The scenes.
    pub scenes: Vec<SceneTable>,
}

/// The methods on one scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneTable {
    /// The scene file.
    pub scene: String,
    /// Its name without its end.
    pub name: String,
    /// Width of the image.
    pub width: u32,
    /// Height of the image.
    pub height: u32,
    /// The image that errors are measured against.
    pub reference: String,
    /// A row a method.
    pub rows: Vec<Row>,
}

/// What a method came to: medians over the repeats.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The method.
    pub method: &'static str,
    /// Mean absolute difference.
    pub l1: f64,
    /// Root of the mean squared difference.
    pub rmse: f64,
    /// Mean of (I - R)^2 / (R^2 + 0.01).
    pub relmse: f64,
    /// The same without the worst 0.1 % of the pixels.
    pub relmse_trimmed: f64,
    /// Structural similarity of the pictures as shown; `null` below 7 x 7 pixels.
    pub ssim: Option<f64>,
    /// Mean of the image over the reference's.
    pub mean_ratio: f64,
    /// Bytes of the field.
    pub memory_bytes: u64,
    /// Bytes that it took while it was learned.
    pub training_bytes: u64,
    /// Seconds of learning.
    pub preprocessing_seconds: f64,
    /// Seconds of rendering.
    pub render_seconds: f64,
    /// Their sum.
    pub total_seconds: f64,
}

/// A row of the paper's table.
struct Paper {
    scene: &'static str,
    gauss: [f64; 7],
    double: [f64; 7],
}

/// Bus and Boubekeur 2017, Table 1: L1, RMSE, SSIM, memory, preprocessing, render, total.
const PAPER: [Paper; 2] = [
    Paper {
        scene: "Pool",
        gauss: [0.213967, 1.537650, 0.663241, 897.57, 444.0, 354.0, 805.0],
        double: [0.257429, 1.132270, 0.611492, 1456.75, 282.0, 282.0, 570.0],
    },
    Paper {
        scene: "Door",
        gauss: [0.000226, 0.002333, 0.997712, 938.51, 816.0, 528.0, 1341.0],
        double: [0.000255, 0.001881, 0.997360, 2299.05, 336.0, 510.0, 845.0],
    },
];

impl Row {
    /// The medians of repeats, of which there must be one at least. The total is the sum of the
    /// medians of its parts.
    pub fn median(rows: &[Row]) -> Row {
        let of = |value: fn(&Row) -> f64| {
            let mut values: Vec<f64> = rows.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            let (low, high) = ((values.len() - 1) / 2, values.len() / 2);
            0.5 * (values[low] + values[high])
        };
        let (preprocessing, render) = (of(|r| r.preprocessing_seconds), of(|r| r.render_seconds));
        let ssim = of(|r| r.ssim.unwrap_or(f64::NAN));
        Row {
            method: rows[0].method,
            l1: of(|r| r.l1),
            rmse: of(|r| r.rmse),
            relmse: of(|r| r.relmse),
            relmse_trimmed: of(|r| r.relmse_trimmed),
            ssim: Some(ssim).filter(|s| s.is_finite()),
            mean_ratio: of(|r| r.mean_ratio),
            memory_bytes: of(|r| r.memory_bytes as f64) as u64,
            training_bytes: of(|r| r.training_bytes as f64) as u64,
            preprocessing_seconds: preprocessing,
            render_seconds: render,
            total_seconds: preprocessing + render,
        }
    }

    /// The paper's columns.
    fn numbers(&self) -> [f64; 7] {
        [
            self.l1,
            self.rmse,
            self.ssim.unwrap_or(f64::NAN),
            self.memory_bytes as f64 / 1e6,
            self.preprocessing_seconds,
            self.render_seconds,
            self.total_seconds,
        ]
    }
}

impl Table1 {
    /// The file of `--json`.
    pub fn to_json(&self) -> String {
        super::json(self)
    }

    /// For each scene the table, then each double hierarchy's row divided by that of the mixtures
    /// beside the paper's.
    pub fn to_table(&self) -> String {
        let mut text = format!(
            "{} samples a pixel, {} x {} photons, {} threads, medians of {}\n",
            self.spp, self.batches, self.photons_per_batch, self.threads, self.repeats
        );
        if self.reuse > 1 {
            let _ = writeln!(text, "paths share what they find, {} a group", self.reuse);
        }
        for scene in &self.scenes {
            // Writing to a string cannot fail.
            let _ = write!(text, "\n{}", scene.to_table());
        }
        text
    }
}

impl SceneTable {
    fn to_table(&self) -> String {
        let title = format!("{}, {} x {}", self.name, self.width, self.height);
        let head = [
            &*title,
            "L1",
            "RMSE",
            "SSIM",
            "field, MB",
            "preprocessing, s",
            "render, s",
            "total, s",
        ];
        let row = |name: String, numbers: [f64; 7]| -> Vec<String> {
            std::iter::once(name).chain(numbers.map(number)).collect()
        };
        let rows: Vec<_> = self
            .rows
            .iter()
            .map(|r| row(r.method.into(), r.numbers()))
            .collect();
        let mut text = markdown(&head, &rows);
        let ratios = self.ratios();
        if !ratios.is_empty() {
            let head = [
                "divided by gmm",
                "L1",
                "RMSE",
                "SSIM",
                "field",
                "preprocessing",
                "render",
                "total",
            ];
            let rows = ratios.into_iter().map(|(name, numbers)| row(name, numbers));
            let _ = write!(text, "\n{}", markdown(&head, &rows.collect::<Vec<_>>()));
        }
        text
    }

    /// Each double hierarchy's numbers divided by those of the mixtures, then the paper's.
    fn ratios(&self) -> Vec<(String, [f64; 7])> {
        let divided = |a: [f64; 7], b: [f64; 7]| std::array::from_fn(|i| a[i] / b[i]);
        let Some(gmm) = self.rows.iter().find(|r| r.method == "gmm") else {
            return Vec::new();
        };
        let ours = self.rows.iter().filter(|r| r.method.starts_with("double"));
        let mut ratios: Vec<(String, [f64; 7])> = ours
            .map(|r| (r.method.to_owned(), divided(r.numbers(), gmm.numbers())))
            .collect();
        let paper = PAPER.iter().find(|p| p.scene.to_lowercase() == self.name);
        if let Some(paper) = paper {
            let name = format!("the paper's {}", paper.scene);
            ratios.push((name, divided(paper.double, paper.gauss)));
        }
        ratios
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(method: &'static str, x: f64) -> Row {
        Row {
            method,
            l1: x,
            rmse: 2.0 * x,
            relmse: x,
            relmse_trimmed: x,
            ssim: None,
            mean_ratio: 1.0,
            memory_bytes: (1e6 * x) as u64,
            training_bytes: 0,
            preprocessing_seconds: x,
            render_seconds: 10.0 - x,
            total_seconds: 10.0,
        }
    }

    #[test]
    fn medians_are_taken_number_by_number_and_totals_add_up() {
        let rows = [
            row("gmm", 1.0),
            row("gmm", 4.0),
            row("gmm", 2.0),
            row("gmm", 9.0),
        ];
        let median = Row::median(&rows);
        assert_eq!(
            (median.l1, median.rmse, median.memory_bytes),
            (3.0, 6.0, 3_000_000)
        );
        assert_eq!((median.total_seconds, median.ssim), (10.0, None));
        assert_eq!(Row::median(&rows[2..3]), rows[2]);
    }

    #[test]
    fn ratios_stand_beside_the_papers() {
        let table = SceneTable {
            scene: "scenes/door/door.xml".into(),
            name: "door".into(),
            width: 8,
            height: 8,
            reference: "r.exr".into(),
            rows: vec![row("none", 1.0), row("gmm", 2.0), row("double", 1.0)],
        };
        let ratios = table.ratios();
        assert_eq!(ratios.len(), 2);
        assert_eq!(ratios[0].0, "double");
        assert_eq!(ratios[0].1[..2], [0.5, 0.5]);
        let paper = ratios[1].1.map(|r| (100.0 * r).round() / 100.0);
        assert_eq!(paper, [1.13, 0.81, 1.0, 2.45, 0.41, 0.97, 0.63]);
        let text = table.to_table();
        assert!(
            text.contains("| the paper's Door |") && text.contains("| none "),
            "{text}"
        );
    }
}
