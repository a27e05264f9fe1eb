//! The light that arrives at a place, by brute force: what a field should have learned.

use crate::arrays;
use crate::failure::Fault;
use crate::scene::Scene;
use crate::state::plain;
use crate::words::{self, words};
use crate::work;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::f32::consts::PI;
use twintree::camera::Camera;
use twintree::cli::args::Command;
use twintree::cli::field::FieldArgs;
use twintree::cli::load::Loaded;
use twintree::cli::ray_args::RayArgs;
use twintree::cli::settings;
use twintree::integrate::GuidedSettings;
use twintree::integrate::debug::probe::{LatLong, brute_force, sight};
use twintree::math::{Vec2, Vec3};

/// A place and the light that arrives there.
struct Incident {
    position: Vec3,
    normal: Vec3,
    radiance: LatLong,
}

fn found(scene: &Scene, args: &FieldArgs, [x, y]: [u32; 2]) -> Result<Incident, Fault> {
    let ready = scene.ready(plain(args.size), &RayArgs::default())?;
    let mut description = Loaded::clone(&ready.loaded).description;
    settings::resize(&mut description.film, args.size);
    let (width, height) = (description.film.width, description.film.height);
    if x >= width || y >= height {
        return Err(Fault::Value(format!(
            "pixel {x}, {y} lies beyond the film of {width} x {height} pixels"
        )));
    }
    let light = args.probe.light();
    let settings = settings::path_settings(&light, &description.render, GuidedSettings::PLAIN);
    let camera = Camera::new(&description.camera, width, height);
    let centre = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
    let seen = sight(&ready.scene, &camera, centre).surface;
    let Some((_, place)) = seen else {
        return Err(Fault::Value(format!(
            "pixel {x}, {y} sees nothing\n  help: choose one that shows a surface"
        )));
    };
    let (rows, spp) = (args.probe.rows, args.probe.spp);
    Ok(Incident {
        position: place.point.p,
        normal: place.side,
        radiance: brute_force(&ready.scene, &settings, &place, rows, spp),
    })
}

/// The direction in the middle of each pixel of a picture of directions.
fn directions(rows: u32) -> Vec<Vec3> {
    let angle = |i: u32, of: u32| (i as f32 + 0.5) / of as f32;
    let at = |y: u32, x: u32| {
        let (theta, phi) = (angle(y, rows) * PI, (2.0 * angle(x, 2 * rows) - 1.0) * PI);
        Vec3::new(
            theta.sin() * phi.cos(),
            theta.sin() * phi.sin(),
            theta.cos(),
        )
    };
    (0..rows)
        .flat_map(|y| (0..2 * rows).map(move |x| at(y, x)))
        .collect()
}

#[pymethods]
impl Scene {
    /// The light that arrives at what the pixel `x`, `y` sees, by brute force, without a field.
    /// Keywords are those of `twintree field`: `rows=96` of the picture of directions, `spp=64`
    /// paths for each of its pixels, `seed`, `max_depth`, `direct=True` to include light straight
    /// from lamps, `width` and `height` of the film.
    ///
    /// Returns "position" (3,), "normal" (3,), "directions" (rows, 2 rows, 3), "radiance" (rows, 2
    /// rows, 3), times the cosine to the normal, and "solid_angle" (rows, 2 rows) of each
    /// direction's pixel.
    #[pyo3(signature = (x, y, *, threads = None, **settings))]
    fn incident(
        &self,
        py: Python<'_>,
        x: u32,
        y: u32,
        threads: Option<u16>,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<PyDict>> {
        crate::messages::listen();
        crate::render::check_threads(threads)?;
        let mut keywords = words(settings)?;
        let other = [
            "output", "tree", "pixel", "distance", "json", "stats", "scene", "exposure",
        ];
        words::refuse(
            &keywords,
            &other,
            "rows, spp, seed, max_depth, direct, width and height are",
        )?;
        // The parser of the command wants a scene and a pixel beside them.
        keywords.extend([
            "--scene=scene".into(),
            format!("--pixel={x},{y}"),
            "--output=a.exr".into(),
        ]);
        let Command::Field(args) = words::read("field", &["field".into()], &keywords)? else {
            return Err(Fault::Runtime("another command was read".into()).into());
        };
        let found = work::run(py, threads, || found(self, &args, [x, y]))?;
        let (rows, columns) = (
            found.radiance.height as usize,
            found.radiance.width as usize,
        );
        let band = |y: usize| (y as f32 * PI / rows as f32).cos();
        let area = |y| (band(y) - band(y + 1)) * 2.0 * PI / columns as f32;
        let areas = (0..rows * columns).map(|i| area(i / columns)).collect();
        let ways = directions(found.radiance.height);
        let out = PyDict::new(py);
        let shape = [rows, columns, 3];
        out.set_item(
            "position",
            arrays::to_python(py, found.position.to_array().into(), &[3])?,
        )?;
        out.set_item(
            "normal",
            arrays::to_python(py, found.normal.to_array().into(), &[3])?,
        )?;
        out.set_item(
            "directions",
            arrays::to_python(py, arrays::flat(&ways), &shape)?,
        )?;
        out.set_item(
            "radiance",
            arrays::to_python(py, arrays::flat(&found.radiance.pixels), &shape)?,
        )?;
        out.set_item("solid_angle", arrays::to_python(py, areas, &shape[..2])?)?;
        Ok(out.unbind())
    }
}
