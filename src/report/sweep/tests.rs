//! Sweeps whose curves are known.

use super::analysis::Findings;
use super::curve::{Curve, Scale};
use super::*;

/// Runs with an error of `scale` / seconds.
fn stats(scale: f64, build: f64) -> RunStats {
    let point = |i: i32| {
        let seconds = 0.1 * 2f64.powi(i);
        ErrorPoint {
            seconds,
            cpu_seconds: Some(2.0 * seconds),
            spp: 1 << i,
            rays: 100 << i,
            rmse: 0.0,
            relmse: 2.0 * scale / (seconds + build),
            relmse_trimmed: scale / (seconds + build),
            relmse_4x4: Some(scale / 16.0 / (seconds + build)),
            relmse_16x16: None,
        }
    };
    RunStats {
        threads: 2,
        accel: "none".into(),
        spp: 64,
        samples: 6400,
        rays: 6400,
        load_seconds: 0.1,
        build_seconds: build,
        train_seconds: 0.64,
        render_seconds: 6.4,
        peak_memory_bytes: Some(1 << 20),
        accel_memory_bytes: 1,
        field_memory_bytes: 2,
        texture_memory_bytes: 3,
        errors: (0..7).map(point).collect(),
        field: None,
        trial: None,
    }
}

/// A sweep of configurations with the given scale in each round; `None` failed.
fn sweep(list: &[(&str, &[Option<f64>])]) -> Sweep {
    let configurations = list.iter().map(|(name, _)| Configuration {
        name: (*name).into(),
        knob: (*name).into(),
        options: vec![format!("--{name}")],
    });
    let mut runs = Vec::new();
    for (name, scales) in list {
        for (round, scale) in (0..).zip(*scales) {
            runs.push(Run {
                configuration: (*name).into(),
                round,
                command: format!("twintree render s.xml --{name}, 'x'"),
                failure: scale.is_none().then(|| "signal: 11, \"core\"".into()),
                wall_seconds: 7.0,
                stats: scale.map(|s| stats(s, 0.0)),
            });
        }
    }
    Sweep {
        setting: Setting {
            version: "0".into(),
            scene: "<s>.xml".into(),
            scene_fingerprint: "0".into(),
            reference: Reference {
                path: "r.exr".into(),
                fingerprint: "0".into(),
                width: 8,
                height: 8,
                relmse: Some(2e-4),
            },
            common: Vec::new(),
            clock: Clock::Wall,
            seconds: 6.4,
            rounds: 3,
            configurations: configurations.collect(),
        },
        command: "twintree sweep".into(),
        machine: Machine::default(),
        runs,
    }
}

#[test]
fn errors_of_blocks_are_findings_of_their_own() {
    let mut sweep = sweep(&[("a", &[Some(1.0)]), ("b", &[Some(0.5)])]);
    // Pixels say that b is twice as fast, blocks that it is as fast as a.
    for run in &mut sweep.runs {
        let stats = run.stats.as_mut().unwrap();
        for error in &mut stats.errors {
            error.relmse_4x4 = Some(0.1 / error.seconds);
        }
    }
    let findings = Findings::of(&sweep);
    let b = findings.get("b").unwrap();
    assert!((b.speed.unwrap().median - 2.0).abs() < 1e-9);
    assert_eq!(b.blocks.len(), 1, "there are no blocks of 16 x 16");
    assert_eq!(b.blocks[0].scale, Scale::Blocks4);
    assert!((b.blocks[0].speed.unwrap().median - 1.0).abs() < 1e-9);
    let sections = super::sections::knobs(&sweep, &findings);
    assert!(sections.contains("4x4 blocks") && !sections.contains("16x16 blocks"));
}

#[test]
fn curves_are_straight_between_points_on_log_axes() {
    let curve = Curve::of(&stats(1.0, 0.0), Clock::Wall, Scale::Pixels);
    for t in [0.1, 0.137, 1.0, 6.0, 6.4] {
        assert!((curve.at(t).unwrap() * t - 1.0).abs() < 1e-9, "{t}");
    }
    assert_eq!((curve.at(0.09), curve.at(6.5)), (None, None));
    let (t, measured) = curve.time_to(0.3).unwrap();
    assert!((t * 0.3 - 1.0).abs() < 1e-9 && measured);
    let (t, measured) = curve.time_to(0.01).unwrap();
    assert!((t * 0.01 - 1.0).abs() < 1e-9 && !measured);
    assert_eq!(curve.time_to(50.0), Some((0.1, true)));
}

#[test]
fn the_time_to_an_error_is_that_after_which_it_stays_below() {
    let curve = Curve(vec![[1.0, 0.1], [2.0, 0.4], [4.0, 0.1], [8.0, 0.05]]);
    let (t, _) = curve.time_to(0.2).unwrap();
    assert!((t - 8f64.sqrt()).abs() < 1e-9, "{t}");
}

#[test]
fn building_counts_and_reading_does_not() {
    let curve = Curve::of(&stats(1.0, 2.0), Clock::Wall, Scale::Pixels);
    assert_eq!(curve.0[0], [2.1, 1.0 / 2.1]);
    // Two threads, and twice the processor time in the points.
    let mut busy = stats(1.0, 0.0);
    busy.threads = 4;
    let curve = Curve::of(&busy, Clock::Processors, Scale::Pixels);
    assert!((curve.0[0][0] - 0.05).abs() < 1e-12);
}

#[test]
fn the_median_of_curves_is_taken_where_all_are_known() {
    let one = Curve(vec![[1.0, 8.0], [4.0, 2.0]]);
    let two = Curve(vec![[2.0, 8.0], [8.0, 2.0]]);
    let median = Curve::median(&[one, two]);
    assert_eq!((median.0[0][0], median.end().unwrap()[0]), (2.0, 4.0));
    // Between 8 / t and 16 / t.
    for [t, e] in &median.0 {
        assert!((e * t - 128f64.sqrt()).abs() < 1e-9, "{t} {e}");
    }
    assert_eq!(Curve::median(&[]), Curve::default());
    // One ends before the other begins: what it would have come to counts.
    let (early, late) = (Curve(vec![[1.0, 4.0]]), Curve(vec![[4.0, 1.0], [8.0, 0.5]]));
    assert_eq!(Curve::median(&[early, late]).0, [[4.0, 1.0]]);
}

#[test]
fn a_difference_is_clear_when_all_rounds_agree() {
    let sweep = sweep(&[
        ("base", &[Some(1.0), Some(1.2), Some(0.9)]),
        ("half", &[Some(0.5), Some(0.5), Some(0.5)]),
        ("mixed", &[Some(0.5), Some(1.5), Some(0.5)]),
        ("once", &[Some(0.1)]),
        ("broken", &[None, None]),
    ]);
    let findings = Findings::of(&sweep);
    let speed = |name: &str| findings.get(name).unwrap().speed.unwrap();
    assert!((speed("half").median - 2.0).abs() < 1e-9 && speed("half").clear);
    assert!((speed("half").least - 1.8).abs() < 1e-9);
    assert!(!speed("mixed").clear && !speed("once").clear && !speed("base").clear);
    assert!(findings.get("broken").is_none());
    assert!((findings.seconds - 6.4).abs() < 1e-9);
    assert_eq!(findings.processor_share, Some(1.0));
}

#[test]
fn the_front_holds_the_best_at_each_time() {
    let mut sweep = sweep(&[("slow", &[Some(0.1)]), ("quick", &[Some(0.2)])]);
    // The better one begins late.
    sweep.runs[0].stats = Some(stats(0.1, 1.0));
    let findings = Findings::of(&sweep);
    let names: Vec<&str> = findings.front.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names.first(), Some(&"quick"));
    assert_eq!(names.last(), Some(&"slow"));
    assert!(
        findings
            .front
            .windows(2)
            .all(|w| w[0].error > w[1].error && w[0].seconds <= w[1].seconds)
    );
}

#[test]
fn what_is_recommended_is_the_fastest_or_an_earlier_one_that_is_as_fast() {
    let sweep = sweep(&[
        ("base", &[Some(1.0), Some(1.0), Some(1.0)]),
        ("alike", &[Some(0.98), Some(0.97), Some(0.98)]),
        ("worse", &[Some(2.0), Some(2.0), Some(2.0)]),
    ]);
    let findings = Findings::of(&sweep);
    let of = |purpose: &str| {
        findings
            .advice
            .iter()
            .find(|a| a.purpose == purpose)
            .unwrap()
    };
    assert_eq!(of("draft").name, "base");
    // 25 % is a relMSE of 1/16: 16 s, beyond the runs.
    assert!((of("draft").seconds - 16.0).abs() < 0.1 && !of("draft").measured);
    // 2 % is a relMSE of 4e-4, which a reference of 2e-4 by itself does not tell from much less.
    assert!(of("normal").certain && !of("final").certain);
}

#[test]
fn reports_are_read_back_as_they_were_and_tables_keep_commas() {
    let sweep = sweep(&[("base", &[Some(1.0), None])]);
    let json = sweep.to_json(&Findings::of(&sweep));
    assert_eq!(serde_json::from_str::<Sweep>(&json).unwrap(), sweep);
    let csv = sweep.to_csv();
    let rows: Vec<csv::StringRecord> = csv::Reader::from_reader(csv.as_bytes())
        .records()
        .map(Result::unwrap)
        .collect();
    assert_eq!(rows.len(), 2);
    assert_eq!(&rows[0][18], "twintree render s.xml --base, 'x'");
    assert_eq!(&rows[1][2], "signal: 11, \"core\"");
}

#[test]
fn the_page_says_what_to_use_and_takes_no_markup_from_names() {
    let sweep = sweep(&[
        ("base", &[Some(1.0), Some(1.0), None]),
        ("b", &[Some(0.1), Some(0.1)]),
    ]);
    let findings = Findings::of(&sweep);
    let reference = crate::image::Image::from_rgb(8, 8, &[crate::math::Rgb::ONE; 64]);
    let pictures = pictures::Pictures::of(&sweep, &findings, &reference, 0.0, |_| {
        Some(reference.clone())
    });
    let page = page::page(&sweep, &findings, &pictures);
    assert!(
        page.contains("for a draft (noise 25 %) use <code>--b</code>"),
        "{page}"
    );
    assert!(page.contains("10.00 times as fast"));
    assert!(page.contains("&lt;s&gt;.xml") && !page.contains("<s>.xml"));
    assert!(page.contains("1 of 5 runs ended without measurements"));
    assert!(!page.contains("{{") && !page.contains("http"));
}
