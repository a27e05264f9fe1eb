//! Options that were typed and change nothing: said, for who types one means something by it.

use super::args::RenderArgs;
use super::field_args::{FieldArgs, Guide, LearnArgs, Teachers, TrainArgs};
use super::file_args::{Aov, FileArgs};
use super::part_args::MergeArgs;
use crate::image::Format;
use clap::ArgMatches;
use clap::parser::ValueSource;

/// What was typed of a subcommand.
pub struct Typed<'a>(pub &'a ArgMatches);

/// Options by the names of their fields.
type Names<'a> = &'a [&'a str];

const SHAPE_OF_EXR: Names = &["format", "compression", "tiled"];
const GUIDED: Names = &["mixture", "roulette", "reuse", "manifold", "adaptive"];
const LEARNED: Names = &[
    "photons",
    "paths",
    "train",
    "batches",
    "guide_memory",
    "guide_model",
];

impl Typed<'_> {
    fn is(&self, name: &str) -> bool {
        self.0.value_source(name) == Some(ValueSource::CommandLine)
    }

    /// A sentence for each of the options that was typed.
    fn without_effect(&self, names: Names, why: &str) -> Vec<String> {
        let typed = names.iter().filter(|name| self.is(name));
        typed
            .map(|name| format!("--{} has no effect: {why}", name.replace('_', "-")))
            .collect()
    }

    /// Of a render.
    pub fn of_render(&self, args: &RenderArgs) -> Vec<String> {
        if args.doubt.pixel.is_some() {
            let names = ["output", "stats", "reference", "preview", "checkpoint"];
            let mut list = self.without_effect(&names, "with --pixel nothing is written");
            list.extend(self.of_guide(args));
            return list;
        }
        let mut list = match args.parts.shard {
            Some(_) => {
                let names = [SHAPE_OF_EXR, &["aov"]].concat();
                self.without_effect(&names, "a part keeps all; give it to \"twintree merge\"")
            }
            None => self.of_files(&args.files),
        };
        list.extend(self.of_guide(args));
        list
    }

    /// Of a merge.
    pub fn of_merge(&self, args: &MergeArgs) -> Vec<String> {
        self.of_files(&args.files)
    }

    /// Of what is written and how.
    fn of_files(&self, files: &FileArgs) -> Vec<String> {
        let formats: Vec<_> = files.output.iter().map(|p| Format::of(p)).collect();
        // Without a name the output is an EXR. A name that is none is an error later.
        if formats.iter().any(Result::is_err) {
            return Vec::new();
        }
        let has_exr = formats.is_empty() || formats.contains(&Ok(Format::Exr));
        let has_layers = has_exr || formats.contains(&Ok(Format::Tiff));
        let mut list = Vec::new();
        if !has_layers && files.aov != [Aov::None] {
            list.extend(self.without_effect(&["aov"], "none of the outputs is an .exr"));
        }
        if !has_exr {
            list.extend(self.without_effect(SHAPE_OF_EXR, "none of the outputs is an .exr"));
        }
        let is_shown = |f: &Result<Format, _>| matches!(f, Ok(Format::Png | Format::Jpeg));
        if !formats.iter().any(is_shown) {
            let why =
                "none of the outputs is a .png or .jpg, and the others keep the light as it is";
            list.extend(self.without_effect(&["exposure"], why));
        }
        list
    }

    /// Of guiding.
    fn of_guide(&self, args: &RenderArgs) -> Vec<String> {
        let guide = &args.guide;
        match guide.way() {
            Guide::None => {
                let names = [GUIDED, LEARNED].concat();
                self.without_effect(&names, "no field guides; --guide double learns one")
            }
            Guide::Gmm => {
                let names = ["mixture", "manifold", "adaptive", "paths"];
                self.without_effect(&names, "that is for --guide double")
            }
            Guide::Double if guide.field.is_some() => {
                let why = "a field that was learned before is not taught by the first samples";
                self.without_effect(&["adaptive"], why)
            }
            Guide::Double => {
                let mut list = self.of_learning(&guide.learn);
                if guide.learn.train != Teachers::Paths && guide.learn.photons.is_none() {
                    let why = "without --photons their number and batches follow from the image";
                    list.extend(self.without_effect(&["batches"], why));
                }
                list
            }
        }
    }

    fn of_learning(&self, learn: &LearnArgs) -> Vec<String> {
        match learn.train {
            Teachers::Photons => self.without_effect(&["paths"], "--train photons takes none"),
            Teachers::Paths => self.without_effect(&["photons"], "--train paths takes none"),
            Teachers::Both => Vec::new(),
        }
    }

    /// Of learning without an image.
    pub fn of_train(&self, args: &TrainArgs) -> Vec<String> {
        let mut list = self.of_learning(&args.learn);
        let names = ["sampler", "hide_emitters"];
        list.extend(self.without_effect(&names, "it shapes an image, and none is made"));
        list
    }

    /// Of looking at a field.
    pub fn of_field(&self, args: &FieldArgs) -> Vec<String> {
        let mut list = Vec::new();
        if args.pixel.is_none() {
            let names = ["max_depth", "seed", "rows", "spp", "direct", "exposure"];
            list.extend(self.without_effect(&names, "it is for the picture of --pixel"));
        }
        if args.scene.is_none() {
            let names = ["define", "lenient", "any_scene", "width", "height"];
            list.extend(self.without_effect(&names, "no --scene is given"));
        } else if args.pixel.is_none() && args.tree.is_none() {
            let why = "nothing is drawn; --pixel and --tree do";
            list.extend(self.without_effect(&["scene"], why));
        }
        list
    }
}

#[cfg(test)]
mod tests {
    use super::super::args::{Cli, Command};
    use super::*;
    use clap::{CommandFactory, FromArgMatches};

    /// The options without effect, by their names.
    fn idle(line: &str) -> Vec<String> {
        let line = format!("twintree {line}");
        let matches = Cli::command().try_get_matches_from(line.split_whitespace());
        let matches = matches.unwrap();
        let typed = Typed(matches.subcommand().unwrap().1);
        let list = match &Cli::from_arg_matches(&matches).unwrap().command {
            Command::Render(args) => typed.of_render(args),
            Command::Merge(args) => typed.of_merge(args),
            Command::Train(args) => typed.of_train(args),
            Command::Field(args) => typed.of_field(args),
            _ => panic!("another command"),
        };
        let first = |s: &String| s.split(' ').next().unwrap().to_owned();
        list.iter().map(first).collect()
    }

    #[test]
    fn what_does_nothing_is_named_and_nothing_else() {
        for (line, expected) in [
            (
                "render a.xml --guide double --mixture 0.5 --aov all --exposure 1 -o a.exr -o b.png",
                "",
            ),
            ("render a.xml --aov none -o a.png", ""),
            ("render a.xml --field f --mixture 0.5 --reuse 4", ""),
            (
                "render a.xml --mixture learned --paths 5",
                "--mixture --paths",
            ),
            (
                "render a.xml --guide none --reuse 1 --guide-memory 64M",
                "--reuse --guide-memory",
            ),
            (
                "render a.xml --aov albedo --tiled -o a.png",
                "--aov --tiled",
            ),
            ("render a.xml --format float -o a.hdr", "--format"),
            ("render a.xml --exposure 1", "--exposure"),
            ("render a.xml --exposure 1 -o a.jpg", ""),
            ("render a.xml --shard 0/2 --aov all -o a.exr", "--aov"),
            (
                "render a.xml --pixel 1,2 -o a.exr --stats s.json",
                "--output --stats",
            ),
            ("render a.xml --guide gmm --mixture 0.5", "--mixture"),
            (
                "render a.xml --guide double --train photons --paths 9",
                "--paths",
            ),
            ("render a.xml --guide double --batches 3", "--batches"),
            ("render a.xml --guide double --batches 3 --photons 9", ""),
            (
                "train a.xml --train paths --photons 9 --sampler sobol",
                "--photons --sampler",
            ),
            ("train a.xml --photons 9 --batches 3", ""),
            ("merge a.exr --compression piz -o a.png", "--compression"),
            ("field a --rows 9 --lenient", "--rows --lenient"),
            ("field a --scene s.xml", "--scene"),
            ("field a --scene s.xml --pixel 1,2 -o a.exr --rows 9", ""),
        ] {
            let expected: Vec<_> = expected.split_whitespace().collect();
            assert_eq!(idle(line), expected, "{line}");
        }
    }
}
