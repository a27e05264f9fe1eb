//! `twintree render --pixel x,y,sample`: one sample, traced again and printed vertex by vertex.

use super::input::Input;
use super::render_args::{PixelSample, RenderArgs};
use super::{Failure, console, learning, settings};
use super::{field_file, load};
use crate::camera::Camera;
use crate::film::FilmDescription;
use crate::integrate::View;
use crate::integrate::camera_sample::PathNumber;
use crate::integrate::debug::inspect::{MOST_STEPS, Step, Traced, trace_sample, train_until};
use crate::math::{Rgb, Vec3};
use std::fmt::Write as _;

/// Traces the sample and prints its path. A guided render learns while it draws: then all is done
/// again that was learned before the sample was taken.
///
/// # Errors
/// When the scene cannot be used, or the pixel is not on the film.
pub fn run(args: &RenderArgs, PixelSample { pixel, sample }: PixelSample) -> Result<(), Failure> {
    let input = Input::of(&args.scene)?;
    let mut loaded = load::load(&args.scene, &input, Some(load::Picture::of(args)))?;
    let field = field_file::wanted_file(&args.guide)?;
    if let Some(field) = &field {
        field.check(loaded.fingerprint()?)?;
    }
    settings::apply_to_film(args, &mut loaded.description)?;
    check_pixel(&loaded.description.film, pixel)?;
    let shapes = loaded.description.shapes.iter();
    let names: Vec<String> = shapes.map(|s| s.name.clone()).collect();
    if !loaded.description.media.is_empty() {
        return Err(Failure::wrong(
            "--pixel cannot follow a path through the media of this scene",
            "\"twintree info\" lists them; without their shapes' \"interior\" and \"exterior\" it can",
        ));
    }
    let scene = loaded.build(&args.rays)?;
    let description = &loaded.description;
    let film = &description.film;
    let settings = settings::of_render(args, &description.render);
    let limits = settings::limits(&args.stop, &description.render);
    let camera = Camera::new(&description.camera, film.width, film.height);
    let plain = View {
        scene: &scene,
        camera: &camera,
        film,
        settings: &settings,
        guide: None,
    };
    let way = learning::decide(&args.guide, &plain, &limits);
    let mut guiding = learning::guiding((&args.guide, way), (field, None), &plain, &limits)?;
    let path = match &mut guiding.learner {
        Some(learner) => train_until(&plain, learner, limits.spp, pixel, sample),
        None => PathNumber::plain(sample),
    };
    let view = View {
        guide: match &guiding.learner {
            Some(learner) => learner.worthwhile_guide(),
            None => guiding.prepared(),
        },
        ..plain
    };
    let traced = trace_sample(&view, pixel, path);
    let mut text = text(pixel, sample, &traced, &names);
    if traced.steps.len() >= MOST_STEPS {
        tracing::warn!(
            "the path goes on after {MOST_STEPS} edges, and was left there: --max-depth ends it"
        );
    }
    if view.guide.is_some() && settings.guided.reuse > 1 {
        // Writing to a String does not fail.
        let _ = writeln!(
            text,
            "That is the path by itself: in the image it shares with others (--reuse {}).",
            settings.guided.reuse
        );
    }
    console::print_result(&text)
}

fn check_pixel(film: &FilmDescription, [x, y]: [u32; 2]) -> Result<(), Failure> {
    if x < film.width && y < film.height {
        return Ok(());
    }
    Err(Failure::wrong(
        format!(
            "--pixel {x},{y} is beyond the film of {} x {} pixels",
            film.width, film.height
        ),
        "x counts from the left and y from the top, both from 0, with the same --width and --height",
    ))
}

/// The path in words: a line for the sample, then three for each edge.
fn text([x, y]: [u32; 2], sample: u64, traced: &Traced, names: &[String]) -> String {
    let Traced {
        steps,
        radiance,
        weight,
        ..
    } = traced;
    let mut out = format!(
        "sample {sample} of pixel {x},{y}: radiance {}, filter weight {weight}\n",
        rgb(*radiance)
    );
    let mut sum = Rgb::ZERO;
    for (i, step) in steps.iter().enumerate() {
        sum += step.gained();
        // Writing to a String does not fail.
        let _ = write!(out, "{}", edge(i + 1, step, sum, names));
    }
    out
}

fn edge(number: usize, step: &Step, sum: Rgb, names: &[String]) -> String {
    let (org, dir) = (vector(step.ray.org), vector(step.ray.dir));
    let met = match step.position() {
        None => "nothing".to_owned(),
        Some(p) => format!(
            "\"{}\" (triangle {}) at {}, distance {:e}",
            names
                .get(step.hit.shape as usize)
                .map_or("?", String::as_str),
            step.hit.prim,
            vector(p),
            step.hit.t
        ),
    };
    let way = match step.way {
        0 => String::new(),
        way => format!(" (way {way})"),
    };
    let light = match step.light {
        None => "no light sample".to_owned(),
        Some(l) if l.blocked => format!("light {} blocked", rgb(l.radiance)),
        Some(l) => format!("light {}", rgb(l.radiance)),
    };
    let manifold = match step.manifold {
        Rgb::ZERO => String::new(),
        sun => format!(", by a specular chain {}", rgb(sun)),
    };
    format!(
        "edge {number}{way}: from {org} along {dir} meets {met}\n  throughput {}, pdf {:e}\n  emission {}, {light}{manifold}, sum {}\n",
        rgb(step.throughput),
        step.pdf,
        rgb(step.met),
        rgb(sum)
    )
}

fn rgb(c: Rgb) -> String {
    format!("[{:e} {:e} {:e}]", c.x, c.y, c.z)
}

fn vector(v: Vec3) -> String {
    format!("({}, {}, {})", v.x, v.y, v.z)
}
