//! What makes a render that render and no other: the record of its parts and checkpoints.
//!
//! Every setting that can change a bit of a pixel is listed here by the name of its option, so that
//! the refusal of a part that does not fit can say what differs. Threads, file names, and
//! everything about how the image is written do not belong here.

use super::args::RenderArgs;
use super::field_args::Guide;
use super::{Failure, settings};
use crate::accel::BuildQuality;
use crate::film::part::{Identity, Origin, Record};
use crate::film::{Film, FilmDescription, Shard};
use crate::integrate::PathSettings;
use crate::integrate::View;
use crate::integrate::progress::Limits;
use crate::photon::schedule::Budget;
use std::fmt::Debug;

/// What a record is made of.
pub struct Subject<'a> {
    /// Fingerprint of the scene.
    pub scene: u64,
    /// Fingerprint of the field, if it comes from a file.
    pub field: Option<u64>,
    /// Name of the ray tracer, with its version: two of them round differently.
    pub accel: String,
    /// How its trees were built: quality, and whether they are compact.
    pub trees: (BuildQuality, bool),
    /// Triangles of the scene.
    pub triangles: u64,
    /// The film after all overrides.
    pub film: &'a FilmDescription,
    /// How paths are traced.
    pub path: &'a PathSettings,
}

impl<'a> Subject<'a> {
    /// A view of the scene with fingerprint `scene`, whose field is learned anew.
    pub fn new(view: &View<'a>, scene: u64, triangles: u64) -> Self {
        let built = view.scene.rays.settings();
        Self {
            scene,
            field: None,
            accel: view.scene.rays.name(),
            trees: (built.quality, built.compact),
            triangles,
            film: view.film,
            path: view.settings,
        }
    }
}

/// The record of a render.
pub fn record(args: &RenderArgs, subject: &Subject, limits: &Limits) -> Record {
    let film = subject.film;
    let endless = limits.time.is_some() || limits.noise.is_some();
    Record {
        identity: Identity {
            scene: subject.scene,
            field: subject.field,
            settings: settings(args, subject, limits),
        },
        region: film.crop.unwrap_or([0, 0, film.width, film.height]),
        goal: (!endless).then_some(limits.spp),
        shard: args.parts.shard.unwrap_or(Shard::ALL),
        origin: Origin {
            scene: args.scene.title(),
            words: words(),
            accel: subject.accel.clone(),
            seed: args.light.seed,
            exposure: film.exposure,
            triangles: subject.triangles,
            threads: super::threads::count(),
            seconds: 0.0,
            rays: 0,
        },
    }
}

/// Settings that shape pixels, by name.
fn settings(args: &RenderArgs, subject: &Subject, limits: &Limits) -> Vec<(String, String)> {
    let (film, path) = (subject.film, subject.path);
    let mut list = Vec::new();
    let mut add = |name: &str, value: &dyn Debug| list.push((name.into(), format!("{value:?}")));
    add(
        "the program",
        &format_args!("twintree {}", env!("CARGO_PKG_VERSION")),
    );
    add("the ray tracer", &subject.accel);
    add("--width", &film.width);
    add("--height", &film.height);
    add("--crop", &film.crop);
    add("--rfilter", &film.filter);
    add("--max-depth", &path.max_depth);
    add("--rr-depth", &path.rr_depth);
    add("--robust", &args.rays.robust);
    add("--hide-emitters", &path.hide_emitters);
    add("--strict-normals", &path.strict_normals);
    add("--sampler", &path.sampler);
    add("--seed", &path.seed);
    // Trees built otherwise round their hits otherwise.
    add("--accel-build", &subject.trees);
    // Textures beyond the budget take their coarser levels from the file: not the same texels.
    add("--texture-memory", &args.scene.texture_memory);
    add("--half-textures", &args.scene.half_textures);
    // A field from a file has its own fingerprint, whatever it was learned with.
    if subject.field.is_some() {
        add("--guide", &Guide::Double);
        add("--mixture", &args.guide.mixture.0);
        add("--roulette", &args.guide.roulette);
        add("--reuse", &args.guide.reuse);
        add("--manifold", &args.guide.manifold);
        return list;
    }
    let (guide, learn) = (args.guide.way(), &args.guide.learn);
    add("--guide", &guide);
    if guide != Guide::None {
        match settings::photons_for(learn, film, limits) {
            Budget::Exactly { photons, .. } => add("--photons", &photons),
            Budget::AsNeeded { samples, time } => {
                // What a clock decides is not the same twice in any case.
                let samples = time.is_none().then_some(samples);
                add("--photons, for samples of the image", &samples);
            }
        }
        add("--paths", &learn.paths);
        add("--train", &learn.train);
        add("--batches", &learn.batches);
        add("--guide-memory", &learn.guide_memory);
        add("--guide-model", &learn.guide_model);
        add("--mixture", &args.guide.mixture.0);
        add("--roulette", &args.guide.roulette);
        add("--reuse", &args.guide.reuse);
        add("--manifold", &args.guide.manifold);
        add("--adaptive", &args.guide.adaptive);
        add("--trial", &args.guide.trial);
    }
    list
}

/// The command line, without what makes this part differ from the others.
fn words() -> String {
    let mut kept: Vec<String> = Vec::new();
    let mut skip = false;
    for word in std::env::args_os().skip(1) {
        let word = word.to_string_lossy();
        if std::mem::take(&mut skip) {
            continue;
        }
        let own = ["--shard", "--checkpoint"];
        skip = own.contains(&&*word);
        let joined = own.iter().any(|o| word.starts_with(&format!("{o}=")));
        if !(skip || joined || word == "--resume") {
            kept.push(word.into_owned());
        }
    }
    kept.join(" ")
}

/// The film to render: that of the shard, if there is one.
///
/// # Errors
/// When there are more shards than tiles.
pub fn film(args: &RenderArgs, description: &FilmDescription) -> Result<Film, Failure> {
    let shard = args.parts.shard.unwrap_or(Shard::ALL);
    let film = Film::shard(description, shard);
    let tiles = film.tiles().len();
    if shard.count as usize <= tiles {
        return Ok(film);
    }
    Err(Failure::wrong(
        format!(
            "--shard {shard}: the film has {tiles} tiles, too few for {} shards",
            shard.count
        ),
        format!("render at most {tiles} shards"),
    ))
}
