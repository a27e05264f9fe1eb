//! `twintree field`: what is in a field, in numbers and pictures.

use super::field_args::FieldArgs;
use super::learning::Opened;
use super::light_args::LightArgs;
use super::load::{self, Input, Loaded};
use super::ray_args::RayArgs;
use super::scene_args::SceneArgs;
use super::targets::{check_distinct, named, try_target};
use super::values::Pixel;
use super::{Failure, console, output, settings};
use crate::camera::Camera;
use crate::image::{Image, WriteOptions};
use crate::integrate::View;
use crate::integrate::debug::cells;
use crate::integrate::debug::probe::{self, LatLong};
use crate::integrate::guiding::Guide;
use crate::integrate::training::extend::to_guide;
use crate::math::{Rgb, Vec2};
use crate::report::field::FieldReport;
use crate::scene::Scene;
use crate::scene::interaction::Interaction;
use std::f32::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

/// Prints and draws what is asked for.
///
/// # Errors
/// When the field or the scene cannot be used, the pixel sees nothing, or a picture cannot be
/// written.
pub fn run(args: &FieldArgs) -> Result<(), Failure> {
    for path in args.output.iter().chain(&args.tree) {
        output::check_format(path)?;
        try_target(path)?;
    }
    check_files(args)?;
    let opened = Opened::read(&args.field)?;
    let pictures = args.pixel.is_some() || args.tree.is_some();
    if args.stats || args.json || !pictures {
        let report = FieldReport::of(&args.field, &opened.file);
        console::print_result(&if args.json {
            report.to_json()
        } else {
            report.to_table()
        })?;
    }
    match &args.scene {
        Some(scene) => look(args, scene, &opened),
        None => Ok(()),
    }
}

/// Refuses pictures that would replace each other, the field or the scene.
fn check_files(args: &FieldArgs) -> Result<(), Failure> {
    let written = named(&[
        ("-o", args.output.as_deref()),
        ("--tree", args.tree.as_deref()),
    ]);
    let read = named(&[
        ("the field", Some(&args.field)),
        ("the scene", args.scene.as_deref()),
    ]);
    check_distinct(&written, &read)
}

/// Draws with the scene.
fn look(args: &FieldArgs, scene: &Path, opened: &Opened) -> Result<(), Failure> {
    let (loaded, scene) = read(args, scene, opened)?;
    let description = &loaded.description;
    let film = &description.film;
    let light = LightArgs {
        max_depth: args.max_depth,
        rr_depth: None,
        sampler: None,
        seed: args.seed,
        hide_emitters: !args.direct,
        strict_normals: false,
    };
    let settings = settings::path_settings(&light, &description.render);
    let guide = to_guide(&opened.file);
    let view = View {
        scene: &scene,
        camera: &Camera::new(&description.camera, film.width, film.height),
        film,
        settings: &settings,
        guide: Some((&guide).into()),
    };
    if let Some(path) = &args.tree {
        let (pixels, seen) = cells::seen(&view, &guide.field);
        let picture = Image::from_rgb(film.width, film.height, &pixels);
        write(path, &picture, 0.0)?;
        tracing::info!(
            "the camera sees {seen} cells of {}",
            guide.field.cell_count()
        );
    }
    match (args.pixel, &args.output) {
        (Some(pixel), Some(path)) => probe(args, &view, &guide, pixel, path),
        _ => Ok(()),
    }
}

/// Reads and builds the scene of a field.
fn read(args: &FieldArgs, scene: &Path, opened: &Opened) -> Result<(Loaded, Scene), Failure> {
    let named = SceneArgs::of(scene, &args.define, args.lenient);
    let mut loaded = load::load(&named, &Input::of(&named)?, None)?;
    let (width, height) = (args.size.width, args.size.height);
    settings::resize(&mut loaded.description.film, width, height);
    opened.check(loaded.fingerprint()?, args.any_scene)?;
    let scene = loaded.build(&RayArgs::default())?;
    Ok((loaded, scene))
}

/// Draws the distribution at the point that a pixel sees, and prints it in numbers.
fn probe(
    args: &FieldArgs,
    view: &View,
    guide: &Guide,
    pixel: Pixel,
    path: &Path,
) -> Result<(), Failure> {
    let (width, height) = (view.film.width, view.film.height);
    if pixel.x >= width || pixel.y >= height {
        return Err(Failure::wrong(
            format!("--pixel {pixel} lies beyond the film of {width} x {height} pixels"),
            format!("x may be up to {} and y up to {}", width - 1, height - 1),
        ));
    }
    let at = Vec2::new(pixel.x as f32 + 0.5, pixel.y as f32 + 0.5);
    let Some(Interaction { point, wo, .. }) = probe::seen_from(view.scene, view.camera, at) else {
        let help = "choose a pixel that shows a surface";
        return Err(Failure::wrong(format!("pixel {pixel} sees nothing"), help));
    };
    let normal = point.facing(wo);
    let learned = probe::learned(guide, &point, normal, args.rows);
    let settings = view.settings;
    let traced = probe::brute_force(view.scene, settings, &point, normal, args.rows, args.spp);
    let local = guide.field.at(point.p, Some(normal), Rgb::ONE);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "pixel         {pixel}");
    let _ = writeln!(text, "point         {}", point.p);
    let _ = writeln!(text, "normal        {normal}");
    let _ = writeln!(text, "cell          {}", local.cell());
    let _ = writeln!(text, "links         {}", local.links().len());
    let chances = guide.fractions.chances(local.cell());
    let _ = writeln!(text, "fraction      {:.3}", chances.field);
    let _ = writeln!(text, "light         {:.3}", chances.light);
    let _ = writeln!(text, "learned       {} W/m^2", local.irradiance());
    let _ = writeln!(text, "brute force   {} W/m^2", traced.integral());
    console::print_result(&text)?;
    write(path, &beside(&learned, &traced), args.exposure)
}

/// Two distributions side by side, each relative to the uniform density.
fn beside(learned: &LatLong, traced: &LatLong) -> Image {
    let whole = traced.integral().element_sum() / 3.0;
    let traced_scale = if whole > 0.0 { 4.0 * PI / whole } else { 0.0 };
    let mut pixels = Vec::with_capacity(2 * learned.pixels.len());
    let rows = learned.pixels.chunks(learned.width as usize);
    for (left, right) in rows.zip(traced.pixels.chunks(traced.width as usize)) {
        pixels.extend(left.iter().map(|p| *p * (4.0 * PI)));
        pixels.extend(right.iter().map(|p| *p * traced_scale));
    }
    Image::from_rgb(2 * learned.width, learned.height, &pixels)
}

fn write(path: &Path, picture: &Image, exposure: f32) -> Result<(), Failure> {
    let options = WriteOptions {
        exposure,
        ..WriteOptions::default()
    };
    crate::image::write(path, picture, &options).map_err(|e| Failure::Refused(e.to_string()))?;
    tracing::info!("wrote {}", path.display());
    Ok(())
}
