//! Options that were typed and change nothing: said, for who types one means something by it.

use super::aov::Aov;
use super::args::Command;
use super::field::{FieldArgs, ProbeArgs};
use super::file_args::{ExrArgs, FileArgs, OidnArgs};
use super::guide_args::{Guide, GuidedArgs, LearnArgs, Teachers};
use super::help::options_of;
use super::picture_args::SizeArgs;
use super::render_args::RenderArgs;
use super::scene_args::ReadArgs;
use super::train::TrainArgs;
use crate::image::Format;
use clap::parser::ValueSource;
use clap::{ArgMatches, Args};

/// What was typed of a subcommand.
pub struct Typed<'a>(pub &'a ArgMatches);

impl Typed<'_> {
    fn is(&self, name: &str) -> bool {
        self.0.value_source(name) == Some(ValueSource::CommandLine)
    }

    /// A sentence for each of a group's options that was typed.
    fn group_without_effect<A: Args>(&self, why: &str) -> Vec<String> {
        let options = options_of::<A>();
        let names: Vec<_> = options.iter().map(|arg| arg.get_id().as_str()).collect();
        self.without_effect(&names, why)
    }

    /// A sentence for each of the options that was typed, by the names of their fields.
    fn without_effect(&self, names: &[&str], why: &str) -> Vec<String> {
        let typed = names.iter().filter(|name| self.is(name));
        typed
            .map(|name| format!("--{} has no effect: {why}", name.replace('_', "-")))
            .collect()
    }

    /// Of a command.
    pub fn of(&self, command: &Command) -> Vec<String> {
        match command {
            Command::Render(args) => self.of_render(args),
            Command::Merge(args) => self.of_files(&args.files),
            Command::Train(args) => self.of_train(args),
            Command::Field(args) => self.of_field(args),
            _ => Vec::new(),
        }
    }

    fn of_render(&self, args: &RenderArgs) -> Vec<String> {
        if args.doubt.pixel.is_some() {
            let names = [
                "output",
                "denoise",
                "oidn",
                "stats",
                "reference",
                "preview",
                "checkpoint",
            ];
            let mut list = self.without_effect(&names, "with --pixel nothing is written");
            list.extend(self.of_guide(args));
            return list;
        }
        let mut list = match args.parts.shard {
            Some(_) => {
                let why = "a part keeps all; give it to \"twintree merge\"";
                let mut list = self.group_without_effect::<ExrArgs>(why);
                list.extend(self.without_effect(&["denoise", "oidn"], why));
                if !args.files.aov.iter().any(|aov| aov.is_extra()) {
                    list.extend(self.without_effect(&["aov"], why));
                }
                list
            }
            None => {
                let mut list = self.of_files(&args.files);
                if !has_layers(&args.files) {
                    let names = ["light_groups", "light_bounces"];
                    list.extend(self.without_effect(&names, "none of the outputs is an .exr"));
                }
                list
            }
        };
        list.extend(self.of_guide(args));
        list
    }

    /// Of what is written and how.
    fn of_files(&self, files: &FileArgs) -> Vec<String> {
        let formats: Vec<_> = files.output.iter().map(|p| Format::of(p)).collect();
        // Without a name the output is an EXR. A name that is none is an error later.
        if formats.iter().any(Result::is_err) {
            return Vec::new();
        }
        let has_exr = formats.is_empty() || formats.contains(&Ok(Format::Exr));
        let mut list = Vec::new();
        if !has_layers(files) && files.aov != [Aov::None] {
            list.extend(self.without_effect(&["aov"], "none of the outputs is an .exr"));
        }
        if !has_exr {
            list.extend(self.group_without_effect::<ExrArgs>("none of the outputs is an .exr"));
        }
        if !files.denoise {
            list.extend(self.group_without_effect::<OidnArgs>("there is no --denoise"));
        }
        let is_shown = |f: &Result<Format, _>| matches!(f, Ok(Format::Png | Format::Jpeg));
        if !formats.iter().any(is_shown) {
            let why =
                "none of the outputs is a .png or .jpg, and the others keep the light as it is";
            list.extend(self.without_effect(&["exposure", "view"], why));
        }
        list
    }

    /// Of guiding.
    fn of_guide(&self, args: &RenderArgs) -> Vec<String> {
        let guide = &args.guide;
        match guide.way() {
            Guide::None => {
                let why = "no field guides";
                let mut list = self.group_without_effect::<GuidedArgs>(why);
                list.extend(self.group_without_effect::<LearnArgs>(why));
                list
            }
            Guide::Gmm => {
                let names = ["mixture", "manifold", "adaptive", "paths"];
                self.without_effect(&names, "that is for --guide double")
            }
            Guide::Ppg => {
                let names = ["photons", "batches", "train", "guide_model"];
                self.without_effect(&names, "--guide ppg learns from camera paths alone")
            }
            Guide::Double if guide.field.is_some() => {
                let why = "a field that was learned before is not taught by the first samples";
                self.without_effect(&["adaptive", "trial"], why)
            }
            Guide::Auto | Guide::Double => {
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
    fn of_train(&self, args: &TrainArgs) -> Vec<String> {
        let mut list = self.of_learning(&args.learn);
        let names = ["sampler", "hide_emitters"];
        list.extend(self.without_effect(&names, "it shapes an image, and none is made"));
        list
    }

    /// Of looking at a field.
    fn of_field(&self, args: &FieldArgs) -> Vec<String> {
        let mut list = Vec::new();
        if args.pixel.is_none() {
            list.extend(self.group_without_effect::<ProbeArgs>("it is for the picture of --pixel"));
        }
        if args.scene.is_none() {
            let why = "no --scene is given";
            list.extend(self.group_without_effect::<ReadArgs>(why));
            list.extend(self.group_without_effect::<SizeArgs>(why));
        } else if args.pixel.is_none() && args.tree.is_none() {
            let why = "nothing is drawn; --pixel and --tree do";
            list.extend(self.without_effect(&["scene"], why));
        }
        list
    }
}

/// Whether one of the outputs holds layers beside the picture. Without a name the output is an EXR,
/// and a name that is none is an error later.
fn has_layers(files: &FileArgs) -> bool {
    let mut formats = files.output.iter().map(|path| Format::of(path));
    let holds = |format| matches!(format, Ok(Format::Exr | Format::Tiff) | Err(_));
    files.output.is_empty() || formats.any(holds)
}

#[cfg(test)]
mod tests {
    use super::super::args::Cli;
    use super::*;
    use clap::{CommandFactory, FromArgMatches};

    /// The options without effect, by their names.
    fn idle(line: &str) -> Vec<String> {
        let line = format!("twintree {line}");
        let matches = Cli::command().try_get_matches_from(line.split_whitespace());
        let matches = matches.unwrap();
        let typed = Typed(matches.subcommand().unwrap().1);
        let list = typed.of(&Cli::from_arg_matches(&matches).unwrap().command);
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
            ("render a.xml --mixture learned --paths 5", ""),
            ("render a.xml --batches 3", "--batches"),
            (
                "render a.xml --guide none --reuse 1 --trial never --guide-memory 64M",
                "--reuse --trial --guide-memory",
            ),
            (
                "render a.xml --aov albedo --compression piz -o a.png",
                "--aov --compression",
            ),
            ("render a.xml --format float -o a.hdr", "--format"),
            (
                "render a.xml --light-groups each --alpha -o a.png",
                "--light-groups",
            ),
            ("render a.xml --light-bounces 3 -o a.png -o a.tif", ""),
            ("render a.xml --exposure 1", "--exposure"),
            ("render a.xml --exposure 1 -o a.jpg", ""),
            (
                "render a.xml --shard 0/2 --aov albedo --denoise -o a.exr",
                "--denoise --aov",
            ),
            (
                "render a.xml --shard 0/2 --aov albedo,position -o a.exr",
                "",
            ),
            ("render a.xml --oidn lib", "--oidn"),
            ("render a.xml --denoise --oidn lib -o a.png", ""),
            (
                "render a.xml --pixel 1,2 -o a.exr --stats s.json",
                "--output --stats",
            ),
            ("render a.xml --guide gmm --mixture 0.5", "--mixture"),
            (
                "render a.xml --guide ppg --mixture 0.5 --paths 9 --photons 9 --train paths",
                "--photons --train",
            ),
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
