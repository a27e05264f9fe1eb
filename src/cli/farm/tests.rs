//! Words go where they belong, and every shell command means what was typed.

use super::args::FarmArgs;
use super::plan::{Plan, quote};
use super::words::{Words, sort};
use crate::cli::args::{Cli, Command};
use clap::Parser;

fn typed(line: &str) -> Vec<String> {
    line.split_whitespace().map(str::to_owned).collect()
}

fn farm(line: &str) -> FarmArgs {
    let words = ["twintree", "farm", "--format", "slurm"].into_iter();
    let cli = Cli::try_parse_from(words.chain(line.split_whitespace())).unwrap();
    match cli.command {
        Command::Farm(args) => args,
        other => panic!("{other:?}"),
    }
}

/// The order of options is clap's affair.
fn by_order(mut words: Words) -> Words {
    words.render.sort();
    words.merge.sort();
    words.train.iter_mut().for_each(|train| train.sort());
    words
}

#[test]
fn words_are_sorted_by_who_needs_them() {
    let line = "--spp 64 room.xml -o a.exr --guide double --photons 9 --seed 5 -D x=1 -D y=-2 --aov albedo,depth --lenient \
                --exposure -1.5 -o b.png --stats s.json --checkpoint 5m --resume -j 3 --quiet";
    let words = sort(&typed(line)).unwrap();
    let expected = Words {
        scene: vec!["room.xml".into()],
        train: Some(typed(
            "--define x=1 --define y=-2 --lenient --seed 5 --photons 9 --quiet",
        )),
        render: typed("--spp 64 --define x=1 --define y=-2 --lenient --seed 5 --quiet"),
        merge: typed("--aov albedo,depth --exposure=-1.5 --stats s.json"),
        outputs: typed("a.exr b.png"),
        checkpoint: Some("5m".into()),
        threads: Some("3".into()),
    };
    assert_eq!(by_order(words), by_order(expected));
    // What pixels have to carry is asked of the shards, too.
    let both = sort(&typed("room.xml --aov depth,uv --light-bounces 2")).unwrap();
    assert_eq!(both.merge, typed("--aov depth,uv"));
    assert_eq!(both.render, typed("--aov depth,uv --light-bounces 2"));
    let kept = sort(&typed("room.xml --field any:a.field")).unwrap();
    assert_eq!(kept.train, None);
    assert_eq!(kept.render, typed("--field any:a.field"));
}

/// What is sorted and put together again says what was said: clap itself is the judge.
#[test]
fn commands_of_shards_and_merge_parse_back() {
    let plan = Plan::new(
        &farm("--shards 3 room.xml --spp 9 --width 40 -o a.exr --format float"),
        Some(2),
    )
    .unwrap();
    let as_typed = |command: &str| -> Vec<String> {
        let command = command.replace("\"${TWINTREE:-twintree}\"", "twintree");
        command
            .split_whitespace()
            .map(|w| w.replace('"', ""))
            .collect()
    };
    let shard = Cli::try_parse_from(as_typed(&plan.shard("1", Some("2")))).unwrap();
    let Command::Render(render) = shard.command else {
        panic!()
    };
    assert_eq!(render.parts.shard.unwrap().to_string(), "1/3");
    assert_eq!(
        render.files.output,
        [std::path::PathBuf::from("a.exr.parts/1-of-3.exr")]
    );
    assert_eq!(
        (render.stop.spp, render.picture.size.width),
        (Some(9), Some(40))
    );
    assert!(render.parts.resume && render.parts.checkpoint.is_some());
    let merge = Cli::try_parse_from(as_typed(&plan.merge())).unwrap();
    let Command::Merge(merge) = merge.command else {
        panic!()
    };
    assert_eq!(
        merge.parts,
        [std::path::PathBuf::from("a.exr.parts/*-of-3.exr")]
    );
    assert_eq!(merge.files.output, [std::path::PathBuf::from("a.exr")]);
    assert_eq!((plan.threads.as_deref(), plan.slots), (Some("2"), 3));
}

#[test]
fn guided_shards_get_a_field_that_is_learned_once() {
    let plan = Plan::new(
        &farm("room.xml --guide double --paths 7 --spp 9 -o a.exr"),
        None,
    )
    .unwrap();
    let train = plan.train(None).unwrap();
    assert!(
        train.contains("train room.xml --paths 7 -o a.exr.parts/light.field"),
        "{train}"
    );
    let shard = plan.shard("2", None);
    assert!(
        shard.contains("--spp 9 --field a.exr.parts/light.field --shard"),
        "{shard}"
    );
    assert!(
        !shard.contains("--guide") && !shard.contains("--paths"),
        "{shard}"
    );
    let plain = Plan::new(&farm("room.xml --guide none"), None).unwrap();
    assert_eq!(plain.train(None), None);
}

#[test]
fn what_a_farm_cannot_do_is_refused_with_a_reason() {
    for (line, why) in [
        ("a.xml --time 3m", "--spp"),
        ("a.xml --noise 0.1", "--spp"),
        ("a.xml --shard 0/3", "--shards"),
        ("a.xml --preview tev", "no image to show"),
        ("a.xml --ssp 3", "--ssp"),
        ("--spp 3", "<SCENE"),
        ("a{{b}}.xml", "job file"),
    ] {
        let text = sort(&typed(line)).unwrap_err().text().unwrap();
        assert!(text.contains(why), "{line}: {text}");
    }
}

#[test]
fn odd_names_stay_one_word_in_a_shell() {
    let odd = [
        "a b.xml", "it's", "$HOME", "`x`", "\"", "*", "", "\\", "a;b", "é",
    ];
    let line: Vec<String> = odd.iter().map(|word| quote(word)).collect();
    let script = format!("for word in {}; do echo \"$word\"; done", line.join(" "));
    let shell = std::process::Command::new("sh")
        .args(["-c", &script])
        .output()
        .unwrap();
    // `echo` of some shells reads backslashes; a single one at the end is kept by all of them.
    let echoed = String::from_utf8(shell.stdout).unwrap();
    assert_eq!(echoed.lines().collect::<Vec<_>>(), odd);
}

#[test]
fn jobs_have_names_that_every_queue_takes() {
    for (image, name) in [("out/Küche 2.exr", "k-che-2"), ("out/---.exr", "twintree")] {
        let mut args = farm("scene.xml");
        args.render.extend(["-o".into(), image.into()]);
        assert_eq!(Plan::new(&args, None).unwrap().name, name);
    }
}

#[test]
fn models_and_what_is_around_them_reach_the_shards() {
    let words = "a.glb b.ply@scale=2 --ground --camera orbit:-30,20 --sky=white";
    let typed: Vec<String> = words.split(' ').map(str::to_owned).collect();
    let sorted = sort(&typed).unwrap();
    assert_eq!(sorted.scene, ["a.glb", "b.ply@scale=2"]);
    let line = sorted.render.join(" ");
    for part in ["--ground", "--camera orbit:-30,20", "--sky white"] {
        assert!(line.contains(part), "{line}");
    }
    let typed = ["a.glb", "--ground=mirror"].map(str::to_owned);
    assert_eq!(sort(&typed).unwrap().render, ["--ground=mirror"]);
}
