//! `twintree sweep`: which settings suit a scene?
//!
//! Every configuration of a plan (`plan`) is run several times as a child process (`child`), round
//! by round, so that a machine that is busy for a while slows all of them down and not one. After
//! each run `report.json` is there to go on from; at the end, or when Ctrl-C or the budget ends it,
//! the page is written from it ([`crate::report::sweep`]).

pub mod args;
mod child;
mod machine;
mod plan;
mod runs;
mod schedule;
mod state;

use self::args::SweepArgs;
use self::child::Outcome;
use self::plan::SceneTraits;
use self::runs::{Ended, Watch, go_through};
use self::schedule::{file, order, words_of};
use super::input::Input;
use super::waiting::Waiting;
use super::{Failure, console, load, output, targets};
use crate::image::Image;
use crate::image::windows::Place;
use crate::report::sweep::analysis::Findings;
use crate::report::sweep::pictures::Pictures;
use crate::report::sweep::{Reference, Setting, Sweep};
use crate::report::words;
use std::time::{Duration, Instant};

/// A run is this many times as long as learning.
const LEARNING: f64 = 3.0;
/// The shortest run: below it starting the program is all there is to measure.
const SHORTEST: f64 = 0.1;

/// What a sweep is about, beside its runs.
struct Subject {
    fingerprint: u64,
    size: (u32, u32),
    exposure: f32,
    traits: SceneTraits,
    reference: Image,
}

/// Runs the plan and writes the report.
///
/// # Errors
/// When scene, reference or plan cannot be used, the report cannot be written, or after an
/// interrupt.
pub fn run(args: &SweepArgs, threads: Option<u16>, watch: Watch) -> Result<(), Failure> {
    let start = Instant::now();
    let subject = Subject::load(args)?;
    let configurations = match &args.plan {
        Some(path) => plan::read(path)?,
        None => plan::built_in(subject.traits),
    };
    let common = common_words(args, &subject, threads);
    plan::check(&configurations, &common)?;
    let setting = Setting {
        version: env!("CARGO_PKG_VERSION").into(),
        scene: args.scene.title(),
        scene_fingerprint: format!("{:016x}", subject.fingerprint),
        reference: reference(args, &subject)?,
        common,
        clock: args.clock,
        seconds: args.time.map_or(0.0, |t| t.as_secs_f64()),
        rounds: args.rounds,
        configurations,
    };
    if args.dry_run {
        return print(&setting, args);
    }
    std::fs::create_dir_all(args.output.join("runs")).map_err(|e| {
        let help = "name a directory that can be made with -o";
        Failure::refused(
            format!("{} cannot be made: {e}", args.output.display()),
            help,
        )
    })?;
    targets::try_target(&args.output.join("index.html"))?;
    watch.1.be_patient();
    let mut sweep = match state::read(&args.output, &setting)? {
        Some(sweep) => sweep,
        None => begin(setting, args, watch)?,
    };
    sweep.command = child::typed(&std::env::args().skip(1).collect::<Vec<_>>());
    sweep.machine = machine::ask();
    let ended = go_through(&mut sweep, args, watch, start)?;
    write_page(&sweep, args, &subject)?;
    match ended {
        Ended::Complete => Ok(()),
        Ended::Interrupted => Err(Failure::Interrupted),
        Ended::BudgetSpent => {
            tracing::info!("the budget is spent: the same command goes on");
            Ok(())
        }
    }
}

impl Subject {
    fn load(args: &SweepArgs) -> Result<Self, Failure> {
        let input = Input::of(&args.scene)?;
        if matches!(input, Input::Models(_)) {
            let message = format!("{} is no scene", args.scene.title());
            return Err(Failure::wrong(message, "a sweep takes a scene file (.xml)"));
        }
        let loaded = load::load(&args.scene, &input, None)?;
        let film = &loaded.description.film;
        Ok(Self {
            fingerprint: loaded.fingerprint()?,
            size: (film.width, film.height),
            exposure: film.exposure,
            traits: SceneTraits {
                textures: loaded.textures().count > 0,
            },
            reference: crate::image::read_linear(&args.reference)?,
        })
    }
}

fn reference(args: &SweepArgs, subject: &Subject) -> Result<Reference, Failure> {
    let bytes = crate::image::regular::read(&args.reference)
        .map_err(|e| Failure::Wrong(format!("{} cannot be read: {e}", args.reference.display())))?;
    let relmse = crate::report::sweep::pictures::own_error(&subject.reference);
    if relmse.is_none() {
        tracing::warn!(
            "{} has no variance layer: how clean it is nobody knows (render it with --aov variance)",
            args.reference.display()
        );
    }
    Ok(Reference {
        path: args.reference.display().to_string(),
        fingerprint: format!("{:016x}", xxhash_rust::xxh3::xxh3_64(&bytes)),
        width: subject.reference.width,
        height: subject.reference.height,
        relmse,
    })
}

/// The words of every run. The reference decides about the size, unless the command line does.
fn common_words(args: &SweepArgs, subject: &Subject, threads: Option<u16>) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for definition in &args.scene.read.define {
        words.push("-D".into());
        words.push(format!("{}={}", definition.name, definition.value));
    }
    if args.scene.read.lenient {
        words.push("--lenient".into());
    }
    let Place { size, window } = subject.reference.place();
    let sized = args.render.iter().any(|w| {
        let sizes = ["--width", "--height", "--crop"];
        sizes
            .iter()
            .any(|s| w == s || w.starts_with(&format!("{s}=")))
    });
    let whole = (window.whole.width, window.whole.height);
    if !sized && whole != subject.size {
        let [width, height] = [whole.0, whole.1].map(|n| n.to_string());
        words.extend(["--width".into(), width, "--height".into(), height]);
    }
    if !sized && subject.reference.window.is_some() {
        let [x, y] = window.at.map(i64::from);
        let (x1, y1) = (x + i64::from(size.width), y + i64::from(size.height));
        words.extend(["--crop".into(), format!("{x},{y},{x1},{y1}")]);
    }
    words.extend(args.render.iter().cloned());
    if let Some(threads) = threads {
        words.extend(["--threads".into(), threads.to_string()]);
    }
    // Messages are read only where a run fails.
    words.push("--quiet".into());
    words
}

/// Tries the first configuration for a moment, which says early what is wrong and brings all files
/// into memory, and decides how long runs may take.
fn begin(mut setting: Setting, args: &SweepArgs, watch: Watch) -> Result<Sweep, Failure> {
    let (moment, first) = (SHORTEST, &setting.configurations[0]);
    let stats = file(args, first, "json");
    let mut words = words_of(&setting, args, first, 0);
    words.retain(|w| !w.starts_with("--time="));
    words.push(format!("--time={moment}"));
    let start = Instant::now();
    let longest = args.budget.max(Duration::from_secs(60));
    let waiting = Waiting::start(watch.0, |seconds| {
        format!("trying the first configuration, {}", words::time(seconds))
    });
    let ended = child::run((watch.2, &words), &stats, longest, watch.1);
    drop(waiting);
    let rendered = match ended {
        Outcome::Measured(stats) => stats.render_seconds,
        Outcome::Interrupted => return Err(Failure::Interrupted),
        Outcome::TooLate => {
            let seconds = longest.as_secs();
            let message = format!(
                "the first run did not end within {seconds} s\n  it was: {}",
                child::typed(&words)
            );
            return Err(Failure::Wrong(message));
        }
        Outcome::Failed(why) => {
            let message = format!(
                "the first run failed: {why}\n  it was: {}",
                child::typed(&words)
            );
            return Err(Failure::Wrong(message));
        }
    };
    if args.time.is_none() {
        let overhead = (start.elapsed().as_secs_f64() - rendered).max(0.0);
        let left = args.budget.as_secs_f64() - start.elapsed().as_secs_f64();
        setting.seconds = seconds_each(&setting, left, (overhead, rendered));
    }
    Ok(Sweep {
        setting,
        command: String::new(),
        machine: machine::ask(),
        runs: Vec::new(),
    })
}

/// Seconds of rendering that each run gets. What the first run did not spend on samples is
/// learning: a run that has no time for anything else says nothing about what was learned, so that
/// a short budget makes fewer runs and no shorter ones.
fn seconds_each(setting: &Setting, budget: f64, (overhead, learning): (f64, f64)) -> f64 {
    let runs = setting.configurations.len() as f64 * f64::from(setting.rounds);
    let least = (LEARNING * learning).max(SHORTEST);
    let seconds = (budget / runs - overhead).max(least);
    let needed = runs * (least + overhead);
    if needed > budget {
        tracing::warn!(
            "the budget is for {:.0} of the {runs} runs: learning alone takes {}. All of them take {} or \
             more, in one go or in several; --rounds or --plan make fewer",
            (budget / (least + overhead)).floor(),
            words::time(learning),
            words::time(needed),
        );
    }
    // Rounded, for it stands in every command.
    (seconds * 100.0).ceil() / 100.0
}

/// What would be run.
fn print(setting: &Setting, args: &SweepArgs) -> Result<(), Failure> {
    let mut setting = setting.clone();
    if args.time.is_none() {
        let runs = setting.configurations.len() as f64 * f64::from(setting.rounds);
        let seconds = args.budget.as_secs_f64() / runs;
        setting.seconds = (seconds * 100.0).floor().max(10.0) / 100.0;
        tracing::info!("the time of each run will be a little less: starting costs, too");
    }
    let mut text = String::new();
    for round in 0..setting.rounds {
        for configuration in order(&setting.configurations, round) {
            text += &child::typed(&words_of(&setting, args, configuration, round));
            text.push('\n');
        }
    }
    console::print_result(&text)
}

fn write_page(sweep: &Sweep, args: &SweepArgs, subject: &Subject) -> Result<(), Failure> {
    let findings = Findings::of(sweep);
    if findings.configurations.is_empty() {
        tracing::warn!("no run has measured anything: there is no page to write");
        return Ok(());
    }
    let image = |name: &str| -> Option<Image> {
        let path = args.output.join("runs").join(format!("{name}.exr"));
        crate::image::read_linear(&path).ok()
    };
    let pictures = Pictures::of(
        sweep,
        &findings,
        &subject.reference,
        subject.exposure,
        image,
    );
    let page = crate::report::sweep::page::page(sweep, &findings, &pictures);
    let path = args.output.join("index.html");
    output::write_file(&path, &page)?;
    output::write_file(&args.output.join("report.json"), sweep.to_json(&findings))?;
    tracing::info!("wrote {}", path.display());
    console::print_result(&(crate::report::sweep::page::conclusion(sweep, &findings) + "\n"))?;
    Ok(())
}
