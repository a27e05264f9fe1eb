//! How cost grows with the size of a mesh: `twintree bench scale`.

use super::table::markdown;
use super::words;
use serde::Serialize;

/// What is printed. The field names are the keys of `twintree bench scale --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScaleBench {
    /// Version of the program.
    pub version: String,
    /// The shape of the meshes, as `twintree make mesh --kind` names it.
    pub shape: String,
    /// Threads that loaded, built and traced.
    pub threads: usize,
    /// One entry for each size, the smallest first.
    pub sizes: Vec<SizeRow>,
}

/// A mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SizeRow {
    /// Its triangles.
    pub triangles: u64,
    /// Its vertices.
    pub vertices: u64,
    /// Bytes of its file, a binary PLY.
    pub file_bytes: u64,
    /// Bytes of its vertices, normals and triangles in memory.
    pub mesh_bytes: u64,
    /// Seconds to read the file through once and to fill arrays of its vertices and triangles.
    pub floor_seconds: f64,
    /// Seconds to read the file into arrays, with indices checked.
    pub read_seconds: f64,
    /// Seconds to load the file: read, checked, and normals computed.
    pub load_seconds: f64,
    /// The ray tracers that fit into memory.
    pub tracers: Vec<TracerRow>,
}

/// A ray tracer over a mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TracerRow {
    /// Its name and version.
    pub name: String,
    /// Seconds to build its tree.
    pub build_seconds: f64,
    /// Bytes of its tree.
    pub memory_bytes: u64,
    /// Rays a second of all threads: from the camera.
    pub camera: f64,
    /// Between points that the camera sees.
    pub shadow: f64,
    /// From there, in all directions.
    pub diffuse: f64,
}

impl ScaleBench {
    /// The file of `--json`.
    pub fn to_json(&self) -> String {
        super::json(self)
    }

    /// A sentence on what was measured, and the table.
    pub fn to_table(&self) -> String {
        let head = [
            "triangles",
            "file MiB",
            "floor s",
            "read s",
            "load s",
            "B/triangle",
            "tracer",
            "build s",
            "B/triangle of tree",
            "camera",
            "shadow",
            "diffuse",
        ];
        let rows: Vec<Vec<String>> = self.sizes.iter().flat_map(rows_of).collect();
        format!(
            "{}, binary PLY, {} threads; floor: reading the file and filling arrays; rates in M rays/s\n\n{}",
            self.shape,
            self.threads,
            markdown(&head, &rows)
        )
    }

    /// Names of all ray tracers that were measured at some size.
    pub fn tracer_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for tracer in self.sizes.iter().flat_map(|s| &s.tracers) {
            if !names.contains(&tracer.name.as_str()) {
                names.push(&tracer.name);
            }
        }
        names
    }
}

/// A row for each ray tracer; the mesh's own cells stand in the first alone.
fn rows_of(size: &SizeRow) -> Vec<Vec<String>> {
    let per_triangle = |bytes: u64| format!("{:.1}", bytes as f64 / size.triangles.max(1) as f64);
    let own = [
        words::count(size.triangles as f64),
        format!("{:.1}", size.file_bytes as f64 / (1 << 20) as f64),
        format!("{:.4}", size.floor_seconds),
        format!("{:.4}", size.read_seconds),
        format!("{:.4}", size.load_seconds),
        per_triangle(size.mesh_bytes),
    ];
    if size.tracers.is_empty() {
        return vec![own.to_vec()];
    }
    let row = |(i, tracer): (usize, &TracerRow)| {
        let mut cells = match i {
            0 => own.to_vec(),
            _ => vec![String::new(); own.len()],
        };
        cells.push(tracer.name.clone());
        cells.push(format!("{:.4}", tracer.build_seconds));
        cells.push(per_triangle(tracer.memory_bytes));
        let rates = [tracer.camera, tracer.shadow, tracer.diffuse];
        cells.extend(rates.map(|r| format!("{:.2}", 1e-6 * r)));
        cells
    };
    size.tracers.iter().enumerate().map(row).collect()
}
