//! `twintree field`: what is in a field, in numbers and pictures.

use super::field_file::Opened;
use super::guide_args::{FieldName, field_name};
use super::input::Input;
use super::light_args::{Depth, LightArgs};
use super::load::{self, Loaded};
use super::picture_args::SizeArgs;
use super::ray_args::RayArgs;
use super::scene_args::{ReadArgs, SceneArgs};
use super::targets::{check_distinct, named, try_target};
use super::{Failure, console, output, settings, values};
use crate::camera::Camera;
use crate::guide::{FieldFile, LevelShare};
use crate::image::{Image, WriteOptions};
use crate::integrate::debug::cells;
use crate::integrate::debug::probe::{self, LatLong, Place, Sight, Stretch};
use crate::integrate::guiding::Guide;
use crate::integrate::training::extend::to_guide;
use crate::integrate::{GuidedSettings, View};
use crate::math::Vec2;
use crate::report::field::FieldReport;
use crate::scene::Scene;
use clap::Args;
use std::f32::consts::PI;
use std::fmt::Write as _;
use std::ops::Bound::Excluded;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Arguments of `twintree field`.
#[derive(Args, Debug)]
#[command(next_help_heading = "What to show")]
pub struct FieldArgs {
    /// Field that "twintree train" made; any:FILE may be that of another scene or camera than --scene
    #[arg(value_name = "[any:]FIELD", value_parser = field_name(), help_heading = None)]
    pub field: FieldName,
    /// Print what is in it: records, nodes, links, depths, bytes. The default, if nothing else is
    /// asked for
    #[arg(long)]
    pub stats: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Draw where light comes from at the point that a pixel sees: left as the field has it, right
    /// as unguided paths find it; and print at which levels of space its links hang
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, requires_all = ["scene", "output"])]
    pub pixel: Option<ProbedPixel>,
    /// Do so inside of a medium, so far from the camera along the pixel's ray, in the scene's unit;
    /// without it at the first surface, behind index-matched ones
    #[arg(long, value_name = "D", requires = "pixel", allow_negative_numbers = true,
          value_parser = values::number((Excluded(0.0), Excluded(f32::INFINITY)), "expected a distance above 0 such as 2.5"))]
    pub distance: Option<f32>,
    /// File for that: directions, the scene's z axis up, as densities, 1 is the mean over the
    /// sphere
    #[arg(short, long, value_name = "FILE", requires = "pixel")]
    pub output: Option<PathBuf>,
    /// Draw the cells of space that the camera sees, each in a colour of its own; and say how many
    /// its paths meet
    #[arg(long, value_name = "FILE", requires = "scene")]
    pub tree: Option<PathBuf>,
    /// The scene that it was learned for
    #[arg(long, value_name = "FILE", help_heading = "Scene")]
    pub scene: Option<PathBuf>,
    /// How it is read.
    #[command(flatten)]
    pub read: ReadArgs,
    /// Size of the camera's picture.
    #[command(flatten)]
    pub size: SizeArgs,
    /// The picture of directions.
    #[command(flatten)]
    pub probe: ProbeArgs,
}

/// How the picture of directions is made.
#[derive(Args, Debug)]
#[command(next_help_heading = "Picture")]
pub struct ProbeArgs {
    /// Longest path, in edges, or "unlimited" [default: the scene's]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub max_depth: Option<Depth>,
    /// Seed of the paths
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Rows of the picture of directions
    #[arg(long, value_name = "N", default_value_t = 96, value_parser = clap::value_parser!(u32).range(2..=2048))]
    pub rows: u32,
    /// Paths a pixel of that picture
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub spp: u32,
    /// Include light straight from emitters, which next-event estimation finds without a field
    #[arg(long)]
    pub direct: bool,
    /// Brightness of .png and .jpg, as a power of two
    #[arg(long, value_name = "STOPS", default_value_t = -3.0, value_parser = values::stops,
          allow_negative_numbers = true)]
    pub exposure: f32,
}

impl ProbeArgs {
    /// How light is traced for it.
    pub fn light(&self) -> LightArgs {
        LightArgs {
            max_depth: self.max_depth,
            rr_depth: None,
            sampler: None,
            seed: self.seed,
            hide_emitters: !self.direct,
            strict_normals: false,
        }
    }
}

/// A pixel of a film: column from the left, row from the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbedPixel {
    x: u32,
    y: u32,
}

impl FromStr for ProbedPixel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some([x, y]) = values::list(text) else {
            return Err("expected two whole numbers x,y such as 160,90".into());
        };
        Ok(Self { x, y })
    }
}

impl std::fmt::Display for ProbedPixel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{},{}", self.x, self.y)
    }
}

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
    let opened = Opened::named(&args.field)?;
    let pictures = args.pixel.is_some() || args.tree.is_some();
    if args.stats || args.json || !pictures {
        let report = FieldReport::of(&args.field.path, &opened.file);
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
        ("the field", Some(&args.field.path)),
        ("the scene", args.scene.as_deref()),
    ]);
    check_distinct(&written, &read)
}

/// Draws with the scene.
fn look(args: &FieldArgs, scene: &Path, opened: &Opened) -> Result<(), Failure> {
    let (loaded, scene) = read(args, scene, opened)?;
    let description = &loaded.description;
    let film = &description.film;
    let light = args.probe.light();
    let settings = settings::path_settings(&light, &description.render, GuidedSettings::PLAIN);
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
        let met = cells::met(&view, &guide.field);
        tracing::info!(
            "the camera sees {seen} cells of {}; its paths meet {}, and nine tenths of their \
             vertices lie in {}",
            guide.field.cell_count(),
            met.all,
            met.most_vertices
        );
    }
    match (args.pixel, &args.output) {
        (Some(pixel), Some(path)) => probe(args, &view, (&guide, &opened.file), pixel, path),
        _ => Ok(()),
    }
}

/// Reads and builds the scene of a field.
fn read(args: &FieldArgs, scene: &Path, opened: &Opened) -> Result<(Loaded, Scene), Failure> {
    let named = SceneArgs::of(scene, &args.read);
    let mut loaded = load::load(&named, &Input::of(&named)?, None)?;
    settings::resize(&mut loaded.description.film, args.size);
    opened.check(loaded.fingerprint()?)?;
    let scene = loaded.build(&RayArgs::default())?;
    Ok((loaded, scene))
}

/// Draws the distribution at the point that a pixel sees, and prints it in numbers.
fn probe(
    args: &FieldArgs,
    view: &View,
    (guide, file): (&Guide, &FieldFile),
    pixel: ProbedPixel,
    path: &Path,
) -> Result<(), Failure> {
    let (width, height) = (view.film.width, view.film.height);
    if pixel.x >= width || pixel.y >= height {
        return Err(Failure::wrong(
            format!("--pixel {pixel} lies beyond the film of {width} x {height} pixels"),
            format!("x may be up to {} and y up to {}", width - 1, height - 1),
        ));
    }
    let place = place(args, view, pixel)?;
    if place.medium().is_some() && !file.trainer.settings().media {
        return Err(Failure::wrong(
            format!("{} knows no media", args.field.path.display()),
            "\"twintree train\" with this scene makes a field that does",
        ));
    }
    let (rows, spp) = (args.probe.rows, args.probe.spp);
    let learned = probe::learned(guide, &place, rows);
    let traced = probe::brute_force(view.scene, view.settings, &place, rows, spp);
    let local = place.ask(guide);
    let point = place.point.p;
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "pixel         {pixel}");
    let _ = writeln!(text, "point         {point}");
    let _ = match place
        .medium()
        .and_then(|id| view.scene.media.list().get(id))
    {
        Some(medium) => writeln!(text, "medium        {}", medium.name),
        None => writeln!(text, "normal        {}", place.side),
    };
    let _ = writeln!(text, "cell          {}", local.cell());
    let _ = writeln!(text, "links         {}", local.links().len());
    let levels = file.trainer.irradiance_by_level(point, place.side);
    let _ = writeln!(text, "hang at       {}", words_of(&levels));
    let chances = guide.fractions.chances(local.cell());
    let _ = writeln!(text, "fraction      {:.3}", chances.field);
    let _ = writeln!(text, "light         {:.3}", chances.light);
    // In a medium the fluence.
    let _ = writeln!(text, "learned       {} W/m^2", local.irradiance());
    let _ = writeln!(text, "brute force   {} W/m^2", traced.integral());
    console::print_result(&text)?;
    write(path, &beside(&learned, &traced), args.probe.exposure)
}

/// The place that a pixel sees, or that lies so far on the way there.
fn place<'a>(args: &FieldArgs, view: &View<'a>, pixel: ProbedPixel) -> Result<Place<'a>, Failure> {
    let centre = Vec2::new(pixel.x as f32 + 0.5, pixel.y as f32 + 0.5);
    let sight = probe::sight(view.scene, view.camera, centre);
    let media = media_before(&sight);
    let Some(distance) = args.distance else {
        let seen = sight.surface.map(|(_, place)| place);
        return seen.ok_or_else(|| {
            let help = match media {
                Some(media) => format!("give a --distance in a medium: {media}"),
                None => "choose a pixel that shows a surface".into(),
            };
            Failure::wrong(format!("pixel {pixel} sees nothing"), help)
        });
    };
    sight.in_medium(distance).ok_or_else(|| {
        let help = match media {
            Some(media) => format!("there are media at {media}"),
            None => "without --distance it shows the first surface".into(),
        };
        let what = format!("pixel {pixel} sees no medium at --distance {distance}");
        Failure::wrong(what, help)
    })
}

/// Between which distances there are media before the first surface.
fn media_before(sight: &Sight) -> Option<String> {
    let stretch = |s: &Stretch| match s.to.is_finite() {
        true => format!("{} to {}", s.from, s.to),
        false => format!("{} and beyond", s.from),
    };
    let words: Vec<_> = sight.media.iter().take(MOST_LISTED).map(stretch).collect();
    (!words.is_empty()).then(|| words.join(", "))
}

/// Media on a pixel's ray that a message lists.
const MOST_LISTED: usize = 8;

/// Levels of R at which links hang, with how many there are and their share of the light.
fn words_of(levels: &[LevelShare]) -> String {
    let sum = |share: &LevelShare| share.irradiance.element_sum();
    let all: f32 = levels.iter().map(sum).sum();
    let word = |share: &LevelShare| {
        let part = if all > 0.0 {
            100.0 * sum(share) / all
        } else {
            0.0
        };
        format!("level {} ({} links, {part:.1} %)", share.level, share.links)
    };
    levels.iter().map(word).collect::<Vec<_>>().join(", ")
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
