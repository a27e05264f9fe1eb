//! Build times, memory and rays a second of the ray tracers: `twintree bench accel`.

use super::table::{markdown, number};
use super::words;
use serde::Serialize;

/// What is printed. The field names are the keys of `twintree bench accel --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AccelBench {
    /// Version of the program.
    pub version: String,
    /// The scene or mesh file.
    pub scene: String,
    /// Triangles, instances counted once.
    pub triangles: u64,
    /// Threads that built, and that traced where all did.
    pub threads: usize,
    /// Rays of each kind.
    pub rays: usize,
    /// Share of the shadow rays that something blocks.
    pub shadow_blocked: f64,
    /// Meshes without a border that stand in the world by themselves.
    pub closed_meshes: usize,
    /// Rays of each kind from inside them.
    pub rays_inside: usize,
    /// One entry for each ray tracer, quality and mode.
    pub tracers: Vec<Tracer>,
}

/// A ray tracer in one configuration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tracer {
    /// Its name and version.
    pub name: String,
    /// `fast`, `balanced` or `high`: how long it may build.
    pub quality: &'static str,
    /// `robust` (watertight at edges) or `fast`.
    pub mode: &'static str,
    /// Seconds to build the tree.
    pub build_seconds: f64,
    /// Bytes of the tree.
    pub memory_bytes: u64,
    /// Rays a second of one thread.
    pub single: Rates,
    /// Rays a second of all threads.
    pub all: Rates,
    /// Rays that left a closed mesh through no triangle; `null` if no mesh is closed.
    pub misses: Option<Misses>,
}

/// Rays a second.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rates {
    /// From the camera.
    pub camera: f64,
    /// Between points that the camera sees.
    pub shadow: f64,
    /// From there, in all directions.
    pub diffuse: f64,
}

/// Shares of the rays from inside closed meshes that meet nothing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Misses {
    /// Of rays in uniform directions.
    pub uniform: f64,
    /// Of rays aimed at points of edges.
    pub edges: f64,
    /// Of rays aimed at vertices.
    pub vertices: f64,
}

impl AccelBench {
    /// The file of `--json`.
    pub fn to_json(&self) -> String {
        super::json(self)
    }

    /// A sentence on what was measured, and the table.
    pub fn to_table(&self) -> String {
        let triangles = words::count(self.triangles as f64);
        let closed = match self.closed_meshes {
            0 => "no closed mesh".to_owned(),
            1 => "1 closed mesh".to_owned(),
            n => format!("{n} closed meshes"),
        };
        let threads = format!("x{}", self.threads);
        let of_all = ["camera", "shadow", "diffuse"].map(|kind| format!("{kind} {threads}"));
        let [camera, shadow, diffuse] = of_all.each_ref().map(String::as_str);
        let head = [
            "tracer",
            "quality",
            "mode",
            "build s",
            "MiB",
            "camera",
            "shadow",
            "diffuse",
            camera,
            shadow,
            diffuse,
            "missed",
            "at edges",
            "at vertices",
        ];
        let rows: Vec<Vec<String>> = self.tracers.iter().map(row).collect();
        format!(
            "{}: {triangles} triangles, {} rays of each kind, {:.0} % of the shadow rays blocked, {closed}; rates in M rays/s\n\n{}",
            self.scene,
            self.rays,
            100.0 * self.shadow_blocked,
            markdown(&head, &rows)
        )
    }
}

fn row(of: &Tracer) -> Vec<String> {
    let missed = |share: Option<f64>| share.map_or("-".into(), number);
    let mut cells = vec![
        of.name.clone(),
        of.quality.into(),
        of.mode.into(),
        format!("{:.3}", of.build_seconds),
        format!("{:.1}", of.memory_bytes as f64 / (1 << 20) as f64),
    ];
    for rates in [of.single, of.all] {
        let list = [rates.camera, rates.shadow, rates.diffuse];
        cells.extend(list.map(|r| format!("{:.2}", 1e-6 * r)));
    }
    let misses = of.misses;
    cells.push(missed(misses.map(|m| m.uniform)));
    cells.push(missed(misses.map(|m| m.edges)));
    cells.push(missed(misses.map(|m| m.vertices)));
    cells
}
