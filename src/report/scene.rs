//! What is in a scene: `twintree info`.

use super::left_out::LeftOut;
use super::totals::{TextureTotals, geometry_bytes, meshes_of, triangles, triangles_placed};
use super::{names, words};
use crate::film::FilmKind;
use crate::math::Rgb;
use crate::medium::{Extinction, Homogeneous, Medium};
use crate::scene::description::SamplerKind;
use crate::scene::precautions::{Precaution, precautions};
use crate::scene::{Description, Geometry};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Counts by type.
type Counts = BTreeMap<&'static str, usize>;

/// What is in a scene. The field names are the keys of `twintree info --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneReport {
    /// The scene file.
    pub scene: String,
    /// Shapes by type, `mesh` among them.
    pub shapes: Counts,
    /// Triangles of all meshes, instances counted once.
    pub triangles: u64,
    /// Triangles that rays can meet: every instance counts.
    pub triangles_placed: u64,
    /// Vertices of all meshes, instances counted once.
    pub vertices: u64,
    /// Groups of shapes.
    pub groups: u32,
    /// Placements of groups.
    pub instances: usize,
    /// Memory of the meshes, bytes.
    pub geometry_memory_bytes: u64,
    /// Lights by type.
    pub lights: Counts,
    /// Materials by type, inner ones included.
    pub materials: Counts,
    /// Participating media, each in words.
    pub media: Vec<String>,
    /// Image textures.
    pub textures: usize,
    /// Memory of texels, bytes.
    pub texture_memory_bytes: u64,
    /// Type of the camera.
    pub camera: &'static str,
    /// The film.
    pub film: FilmReport,
    /// How the scene wants to be rendered.
    pub render: RenderReport,
    /// What is done against rounding, and why.
    pub precautions: Vec<Precaution>,
    /// What the scene does without.
    pub left_out: Vec<LeftOut>,
    /// What was odd: unsupported, unknown or replaced.
    pub warnings: Vec<String>,
}

/// The film of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilmReport {
    /// Full width in pixels.
    pub width: u32,
    /// Full height in pixels.
    pub height: u32,
    /// Part to render: x0, y0, x1, y1.
    pub crop: Option<[u32; 4]>,
    /// Type of the reconstruction filter.
    pub filter: &'static str,
    /// `hdr` or `ldr`.
    pub kind: &'static str,
}

/// How a scene wants to be rendered.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RenderReport {
    /// Longest path in edges; `null` is unlimited.
    pub max_depth: Option<u32>,
    /// Depth at which Russian roulette begins.
    pub rr_depth: u32,
    /// Samples a pixel.
    pub spp: u32,
    /// `independent` or `sobol`.
    pub sampler: &'static str,
}

impl SceneReport {
    /// Counts what is in a scene.
    pub fn of(scene: &str, description: &Description, textures: TextureTotals) -> Self {
        let meshes = meshes_of(description);
        let by_type = |names: &mut dyn Iterator<Item = &'static str>| {
            let mut counts = Counts::new();
            names.for_each(|name| *counts.entry(name).or_default() += 1);
            counts
        };
        let materials = &description.materials;
        let ids = 0..materials.len() as u32;
        Self {
            scene: scene.to_owned(),
            shapes: by_type(&mut description.shapes.iter().map(|s| match &s.geometry {
                Geometry::Mesh(_) => "mesh",
                Geometry::Analytic(exact) => names::shape(exact.kind),
            })),
            triangles: triangles(description),
            triangles_placed: triangles_placed(description),
            vertices: meshes
                .iter()
                .map(|m| m.triangles.positions().len() as u64)
                .sum(),
            groups: description.groups,
            instances: description.instances.len(),
            geometry_memory_bytes: geometry_bytes(description),
            lights: by_type(&mut description.emitters.iter().map(names::emitter)),
            materials: by_type(&mut ids.map(|id| materials.get(id).name())),
            media: description.media.list.iter().map(medium).collect(),
            textures: textures.count,
            texture_memory_bytes: textures.bytes,
            camera: names::camera(&description.camera.projection),
            film: film_report(description),
            render: render_report(description),
            precautions: precautions(description),
            left_out: Vec::new(),
            warnings: description.warnings.clone(),
        }
    }

    /// The JSON of `twintree info --json`.
    pub fn to_json(&self) -> String {
        super::json(self)
    }

    /// A table for people.
    pub fn to_table(&self) -> String {
        let crop = self.film.crop.map_or(String::new(), |[x0, y0, x1, y1]| {
            format!(", crop {x0},{y0},{x1},{y1}")
        });
        let depth = self.render.max_depth;
        let placed = if self.triangles_placed == self.triangles {
            String::new()
        } else {
            format!(" ({} with instances)", self.triangles_placed)
        };
        let rows = [
            ("scene", self.scene.clone()),
            ("shapes", list(&self.shapes)),
            ("triangles", format!("{}{placed}", self.triangles)),
            ("vertices", self.vertices.to_string()),
            (
                "instances",
                format!("{} of {} groups", self.instances, self.groups),
            ),
            ("geometry", words::bytes(self.geometry_memory_bytes)),
            ("lights", list(&self.lights)),
            ("materials", list(&self.materials)),
            (
                "textures",
                format!(
                    "{} images, {}",
                    self.textures,
                    words::bytes(self.texture_memory_bytes)
                ),
            ),
            ("camera", self.camera.to_owned()),
            (
                "film",
                format!(
                    "{} x {}, {}, filter {}{crop}",
                    self.film.width, self.film.height, self.film.kind, self.film.filter
                ),
            ),
            (
                "render",
                format!(
                    "{} spp, max depth {}, roulette from {}, sampler {}",
                    self.render.spp,
                    depth.map_or("unlimited".into(), |d| d.to_string()),
                    self.render.rr_depth,
                    self.render.sampler
                ),
            ),
            ("warnings", self.warnings.len().to_string()),
        ];
        let mut text = String::new();
        for (name, value) in rows {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name:<11}{value}");
        }
        for medium in &self.media {
            let _ = writeln!(text, "{:<11}{medium}", "medium");
        }
        for precaution in &self.precautions {
            let state = if precaution.on { "on" } else { "off" };
            let (name, why) = (precaution.name, &precaution.why);
            let _ = writeln!(text, "{:<11}{name} {state}: {why}", "precaution");
        }
        for (i, left) in self.left_out.iter().enumerate() {
            let name = if i == 0 { "without" } else { "" };
            let _ = writeln!(text, "{name:<11}{}", left.sentence());
        }
        text
    }
}

/// A medium in words: whether it scatters tells what it costs.
fn medium(medium: &Medium) -> String {
    let list = |c: Rgb| format!("{:.3}, {:.3}, {:.3}", c.x, c.y, c.z);
    let (extinction, alone) = match &medium.extinction {
        Extinction::Homogeneous(Homogeneous { extinction, albedo }) => {
            (list(*extinction), *albedo == Rgb::ZERO)
        }
        Extinction::Heterogeneous(grid) => {
            let [x, y, z] = grid.density().resolution();
            (format!("by {x} x {y} x {z} voxels"), grid.absorbs_alone())
        }
    };
    let does = if alone { "absorbs alone" } else { "scatters" };
    format!("{}: extinction {extinction}, {does}", medium.name)
}

fn film_report(description: &Description) -> FilmReport {
    let film = &description.film;
    FilmReport {
        width: film.width,
        height: film.height,
        crop: film.crop,
        filter: names::filter(&film.filter),
        kind: match film.kind {
            FilmKind::Hdr => "hdr",
            FilmKind::Ldr => "ldr",
        },
    }
}

fn render_report(description: &Description) -> RenderReport {
    let render = &description.render;
    RenderReport {
        max_depth: render.max_depth,
        rr_depth: render.rr_depth,
        spp: render.spp,
        sampler: match render.sampler {
            SamplerKind::Independent => "independent",
            SamplerKind::Sobol => "sobol",
        },
    }
}

/// `7: diffuse 5, plastic 2`
fn list(counts: &Counts) -> String {
    let total: usize = counts.values().sum();
    let parts: Vec<String> = counts
        .iter()
        .map(|(name, n)| format!("{name} {n}"))
        .collect();
    if parts.is_empty() {
        return "0".into();
    }
    format!("{total}: {}", parts.join(", "))
}
