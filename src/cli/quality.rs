//! `--quality`: a few settings under one name. Options that are typed win over it.
//!
//! [`manual::render`](crate::manual::render) has the table of what they stand for;
//! `twintree sweep` finds what suits a scene.

use super::args::{Cli, Command};
use super::guide_args::Guide;
use super::help::abridged;
use super::idle::Typed;
use super::render_args::{Preset, RenderArgs};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::parser::ValueSource;
use clap::{ArgMatches, CommandFactory, FromArgMatches};
use std::ffi::OsString;

/// What a quality stands for.
struct Settings {
    /// Stop at this noise,
    noise: f32,
    /// or at this number of samples.
    spp: u64,
    photons: u64,
    paths: u64,
}

const fn settings(preset: Preset) -> Settings {
    match preset {
        Preset::Draft => Settings {
            noise: 0.25,
            spp: 256,
            photons: 100_000,
            paths: 500_000,
        },
        Preset::Normal => Settings {
            noise: 0.08,
            spp: 1024,
            photons: 500_000,
            paths: 2_000_000,
        },
        Preset::Final => Settings {
            noise: 0.02,
            spp: 16_384,
            photons: 500_000,
            paths: 8_000_000,
        },
    }
}

impl Cli {
    /// Reads the command line. What is wrong with it is printed, and the program ends.
    pub fn read() -> Self {
        Self::read_from(std::env::args_os()).unwrap_or_else(|e| e.exit())
    }

    /// Reads words, the program's name before them.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn read_from(words: impl IntoIterator<Item = OsString>) -> Result<Self, clap::Error> {
        let command = abridged(with_plain_errors(Self::command()));
        let matches = command.try_get_matches_from(words);
        let matches = matches.map_err(with_successor)?;
        let mut cli = Self::from_arg_matches(&matches)?;
        if let (Command::Render(args), Some(matches)) =
            (&mut cli.command, matches.subcommand_matches("render"))
        {
            leave_shards_unguided(args, matches);
            apply(args, matches);
        }
        if let Some((_, matches)) = matches.subcommand() {
            cli.idle = Typed(matches).of(&cli.command);
        }
        Ok(cli)
    }
}

/// A negative number behind an option is its value, which the option's own words refuse: otherwise
/// clap takes it for another option, and speaks of that.
fn with_plain_errors(command: clap::Command) -> clap::Command {
    let takes_numbers = |arg: clap::Arg| {
        let plain = !arg.get_action().takes_values()
            || arg.is_positional()
            || arg.is_allow_hyphen_values_set();
        match plain {
            true => arg,
            false => arg.allow_negative_numbers(true),
        }
    };
    command
        .mut_args(takes_numbers)
        .mut_subcommands(with_plain_errors)
}

/// Options that there were once, and what does the same.
const FORMER: [(&str, &str); 5] = [
    ("--tiled", "large EXRs are written in tiles by themselves"),
    (
        "--half-textures",
        "--texture-memory 2G:half keeps textures in 16 bits",
    ),
    ("--robust", "--accel embree:robust lets no ray slip through"),
    ("--sample", "--pixel X,Y,SAMPLE names a sample"),
    (
        "--any-scene",
        "any:FILE in the place of the field's name takes any scene's",
    ),
];

/// An option that there was once is told apart from one that is mistyped.
fn with_successor(mut error: clap::Error) -> clap::Error {
    let unknown = match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(name)) if error.kind() == ErrorKind::UnknownArgument => name,
        _ => return error,
    };
    if let Some((_, tip)) = FORMER.iter().find(|(name, _)| name == unknown) {
        error.remove(ContextKind::SuggestedArg);
        error.remove(ContextKind::TrailingArg);
        let tip = ContextValue::StyledStrs(vec![(*tip).into()]);
        error.insert(ContextKind::Suggested, tip);
    }
    error
}

/// Each shard would learn the same field anew: they are guided where that is typed.
fn leave_shards_unguided(args: &mut RenderArgs, matches: &ArgMatches) {
    let typed = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
    if args.parts.shard.is_some() && !typed("guide") && !typed("field") {
        args.guide.guide = Some(Guide::None);
    }
}

/// Puts the settings of the quality where nothing was typed.
fn apply(args: &mut RenderArgs, matches: &ArgMatches) {
    let Some(preset) = args.stop.quality else {
        return;
    };
    let typed = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
    let settings = settings(preset);
    if !["spp", "time", "noise"].into_iter().any(typed) {
        args.stop.noise = Some(settings.noise);
        args.stop.spp = Some(settings.spp);
    }
    if !typed("photons") {
        args.guide.learn.photons = Some(settings.photons);
    }
    if !typed("paths") {
        args.guide.learn.paths = settings.paths;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(words: &str) -> RenderArgs {
        let line = format!("twintree render scene.xml {words}");
        let matches = Cli::command().try_get_matches_from(line.split_whitespace());
        let matches = matches.unwrap();
        let Command::Render(mut args) = Cli::from_arg_matches(&matches).unwrap().command else {
            panic!("another command");
        };
        apply(&mut args, matches.subcommand_matches("render").unwrap());
        *args
    }

    #[test]
    fn what_is_typed_wins_over_a_quality() {
        let args = read("--quality normal");
        let expected = settings(Preset::Normal);
        assert_eq!(args.stop.noise, Some(expected.noise));
        assert_eq!(args.guide.learn.photons, Some(expected.photons));
        let args = read("--quality normal --time 3s --photons 7 --guide none");
        assert_eq!((args.stop.noise, args.stop.spp), (None, None));
        assert_eq!(args.guide.learn.photons, Some(7));
        assert_eq!(args.guide.guide, Some(Guide::None));
        // The default, when typed, is typed.
        let args = read("--quality draft --paths 2000000");
        assert_eq!(args.guide.learn.paths, 2_000_000);
        assert_eq!(read("").stop.noise, None);
    }

    #[test]
    fn negative_numbers_are_refused_as_numbers() {
        for (line, part) in [
            ("render a.xml --spp -1", "-1"),
            ("render a.xml --time -3", "a time above 0"),
            ("render a.xml --width -5", "-5 is not in 1..=131072"),
            ("render a.xml --photons -100", "-100"),
            ("render a.xml --crop -1,0,5,5", "four whole numbers"),
            ("render a.xml --pixel -1,5", "two whole numbers"),
            ("compare a.exr -r b.exr --data-range -1", "above 0"),
            (
                "make mesh --kind terrain -o a.ply --triangles -5",
                "above 0",
            ),
            ("check a.xml --texture-memory -5", "amount of memory"),
            ("check a.xml -j -5", "-5 is not in 1..=65535"),
        ] {
            let command = with_plain_errors(Cli::command());
            let line = format!("twintree {line}");
            let e = command.try_get_matches_from(line.split_whitespace());
            let text = e.unwrap_err().to_string();
            assert!(
                text.contains("invalid value") && text.contains(part),
                "{text}"
            );
        }
    }

    #[test]
    fn a_field_that_is_given_is_used() {
        assert_eq!(read("--quality final --field a.field").guide.guide, None);
    }

    #[test]
    fn a_better_quality_is_less_noise() {
        let all = [Preset::Draft, Preset::Normal, Preset::Final].map(settings);
        assert!(all.windows(2).all(|w| w[0].noise > 2.0 * w[1].noise));
    }
}
