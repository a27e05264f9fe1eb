//! What makes a render that render and no other: the record of its parts and checkpoints.
//!
//! Every option of `render` is in it under its name, so that the refusal of a part that does not fit
//! can say what differs. What shapes no pixel (threads, file names, everything about how the image
//! is written) says so where it is defined, with `#[serde(skip)]` in
//! [`RenderArgs`]: an option that nobody thought of is part of the
//! identity.

use super::guide_args::Guide;
use super::help::options_of;
use super::part_args::PartArgs;
use super::render_args::RenderArgs;
use super::{Failure, settings};
use crate::film::part::{Identity, Origin, Record};
use crate::film::{Extras, Film, FilmDescription, Shard};
use crate::integrate::View;
use crate::integrate::progress::Limits;
use crate::photon::schedule::Budget;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Debug;

/// Fingerprints of what a render reads.
#[derive(Clone, Copy, Debug)]
pub struct Fingerprints {
    /// Of the scene.
    pub scene: u64,
    /// Of the field, if it comes from a file.
    pub field: Option<u64>,
}

/// The record of a render that begins with this view, of so many triangles. What guides it is
/// decided.
pub fn record(
    (args, way): (&RenderArgs, Guide),
    view: &View,
    limits: &Limits,
    of: Fingerprints,
    triangles: u64,
) -> Record {
    let film = view.film;
    let endless = limits.time.is_some() || limits.noise.is_some();
    Record {
        identity: Identity {
            scene: of.scene,
            field: of.field,
            settings: settings((args, way), view, limits).into_iter().collect(),
        },
        region: film.region(),
        frame: Some([film.width, film.height]),
        goal: (!endless).then_some(limits.spp),
        shard: args.parts.shard.unwrap_or(Shard::ALL),
        extras: (*film.extras).clone(),
        origin: Origin {
            scene: args.scene.title(),
            words: words(),
            accel: view.scene.rays.name(),
            seed: args.light.seed,
            exposure: film.exposure,
            triangles,
            threads: super::threads::count(),
            seconds: 0.0,
            rays: 0,
        },
    }
}

/// Settings that shape pixels, by the names of their options.
pub fn settings(
    (args, way): (&RenderArgs, Guide),
    view: &View,
    limits: &Limits,
) -> BTreeMap<String, String> {
    let mut settings = options(args);
    let guide = &args.guide;
    let guides = way != Guide::None;
    // A field from a file has its own fingerprint, whatever it was learned with.
    let learns = guides && guide.field.is_none();
    let mut forget =
        |options: BTreeMap<_, _>| settings.retain(|name, _| !options.contains_key(name));
    if !guides {
        forget(options(&guide.guided));
    }
    if !learns {
        forget(options(&guide.learn));
    }
    settings.extend(options(&in_effect(way, view)));
    if let (true, Budget::AsNeeded { samples, time }) =
        (learns, settings::photons_for(guide, view.film, limits))
    {
        // What a clock decides is not the same twice in any case.
        let samples = time.map_or(samples.to_string(), |_| "any".into());
        settings.insert("--photons, for samples of the image".into(), samples);
    }
    let program = format!("twintree {}", env!("CARGO_PKG_VERSION"));
    settings.insert("the program".into(), program);
    // With its version: two of them round differently.
    settings.insert("the ray tracer".into(), view.scene.rays.name());
    settings
}

/// What options come to that are not all there is to say: a scene of some width is as good as
/// `--width`.
fn in_effect(way: Guide, view: &View) -> Value {
    let (film, path, built) = (view.film, view.settings, view.scene.rays.settings());
    json!({
        "width": film.width,
        "height": film.height,
        "crop": film.crop,
        "rfilter": format!("{:?}", film.filter),
        "max_depth": path.max_depth,
        "rr_depth": path.rr_depth,
        "hide_emitters": path.hide_emitters,
        "alpha": film.extras.alpha,
        "strict_normals": path.strict_normals,
        "sampler": path.sampler,
        "guide": format!("{way:?}"),
        "aov": carried(&film.extras),
        "light_groups": groups(&film.extras),
        "light_bounces": film.extras.light.bounces,
        "accel": built.robust.then_some("robust"),
        // Trees built otherwise round their hits otherwise.
        "accel_build": format!("{:?}", (built.quality, built.compact)),
    })
}

/// The layers that pixels carry because they were asked for; of others parts have the sums in any
/// case.
fn carried(extras: &Extras) -> Option<String> {
    let list = [
        ("position", extras.position),
        ("uv", extras.uv),
        ("normal.geometric", extras.geometric_normal),
        ("cryptomatte", extras.mattes.is_some()),
        ("direct", extras.light.direct),
    ];
    let names = list.iter().filter(|layer| layer.1).map(|layer| layer.0);
    let names: Vec<&str> = names.collect();
    (!names.is_empty()).then(|| names.join(","))
}

/// The groups of emitters, by numbers: the same ids may stand for others in another scene.
fn groups(extras: &Extras) -> Option<String> {
    let groups = extras.light.groups.iter();
    let groups: Vec<String> = groups
        .map(|g| format!("{}={:?}", g.name, g.emitters))
        .collect();
    (!groups.is_empty()).then(|| groups.join(","))
}

/// Options with their values as text; without those that have none.
fn options(of: &(impl Serialize + Debug)) -> BTreeMap<String, String> {
    // What cannot be told one by one is told as a whole.
    let whole = |_| json!({ "options": format!("{of:?}") });
    let Value::Object(fields) = serde_json::to_value(of).unwrap_or_else(whole) else {
        return BTreeMap::new();
    };
    let option = |(name, value): (String, Value)| {
        let text = match value {
            Value::Null => return None,
            Value::String(text) => text,
            other => other.to_string(),
        };
        Some((format!("--{}", name.replace('_', "-")), text))
    };
    fields.into_iter().filter_map(option).collect()
}

/// The command line, without what makes this part differ from the others.
fn words() -> String {
    let own = options_of::<PartArgs>();
    let mut kept: Vec<String> = Vec::new();
    let mut skip = false;
    for word in std::env::args_os().skip(1) {
        let word = word.to_string_lossy();
        if std::mem::take(&mut skip) {
            continue;
        }
        let name = word.strip_prefix("--").map(|w| w.split('=').next());
        match own.iter().find(|arg| name == Some(arg.get_long())) {
            Some(arg) => skip = arg.get_action().takes_values() && !word.contains('='),
            None => kept.push(word.into_owned()),
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

#[cfg(test)]
mod tests {
    use super::super::args::{Cli, Command};
    use super::*;
    use clap::{CommandFactory, Parser};
    use std::collections::BTreeSet;

    #[test]
    fn what_shapes_pixels_is_told_by_the_names_of_the_options() {
        let Command::Render(args) = Cli::parse_from(["twintree", "render", "a.xml"]).command else {
            panic!("another command");
        };
        let Value::Object(fields) = serde_json::to_value(&*args).unwrap() else {
            panic!("no fields");
        };
        let told: BTreeSet<String> = fields.keys().map(|name| name.replace('_', "-")).collect();
        let command = Cli::command();
        let render = command.find_subcommand("render").unwrap();
        let options: BTreeSet<String> = render
            .get_arguments()
            .filter_map(|arg| arg.get_long().map(str::to_owned))
            .collect();
        assert!(told.is_subset(&options), "{told:?}");
        // All that is left out: a new option is told, unless it is put here, too.
        let left_out: Vec<_> = options.difference(&told).map(String::as_str).collect();
        let expected = "accel aov aperture at camera checkpoint compression define denoise envmap exposure field \
                        focus format fov frames ground lenient light-bounces light-groups limit-decoded look-at \
                        material noise oidn output pixel preview projection quality reference resume shard sky \
                        spp stats strict time up variant view";
        assert_eq!(left_out.join(" "), expected);
    }
}
