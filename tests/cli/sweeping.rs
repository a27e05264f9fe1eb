//! `render --reference`, `render --quality` and `twintree sweep`.

use super::support::{Place, read_channels, signal, wait};
use std::time::{Duration, Instant};

const REFERENCE: &str =
    "render scene.xml -o r.exr --spp 256 --seed 7 --aov variance --format float";

/// A place with a reference in it.
fn place() -> Place {
    let place = Place::new();
    place.run(REFERENCE).ok();
    place
}

fn json(place: &Place, name: &str) -> serde_json::Value {
    serde_json::from_slice(&place.read(name)).unwrap()
}

#[test]
fn errors_over_time_end_with_what_compare_says() {
    let place = place();
    let ran = place
        .run("render scene.xml -o a.exr --format float --spp 40 --reference r.exr --stats s.json");
    ran.ok().says(&["RMSE", "relMSE", "trimmed"]);
    place
        .run("compare a.exr --reference r.exr --json c.json")
        .ok();
    let (stats, compared) = (json(&place, "s.json"), json(&place, "c.json"));
    let points = stats["errors"].as_array().unwrap();
    let samples: Vec<u64> = points.iter().map(|p| p["spp"].as_u64().unwrap()).collect();
    assert_eq!((samples[0], *samples.last().unwrap()), (1, 40));
    assert!(samples.len() >= 6, "{samples:?}");
    for pair in points.windows(2) {
        assert!(pair[0]["seconds"].as_f64() < pair[1]["seconds"].as_f64());
        assert!(pair[0]["rays"].as_u64() < pair[1]["rays"].as_u64());
    }
    let last = points.last().unwrap();
    assert_eq!(last["rays"], stats["rays"]);
    for key in ["rmse", "relmse", "relmse_trimmed", "relmse_4x4"] {
        let (a, b) = (&last[key], &compared["images"][0][key]);
        let ratio = a.as_f64().unwrap() / b.as_f64().unwrap();
        assert!((ratio - 1.0).abs() < 1e-6, "{key}: {a} {b}");
    }
    // A fortieth of the samples of the first pass is left of its error.
    let error = |p: &serde_json::Value| p["relmse"].as_f64().unwrap();
    assert!(error(&points[0]) > 10.0 * error(last));
}

#[test]
fn measuring_changes_no_bit_and_its_time_does_not_count() {
    let place = place();
    let guided = "--guide double --photons 5000 --paths 5000 --spp 30 --format float";
    place
        .run(&format!("render scene.xml -o a.exr {guided}"))
        .ok();
    let measured = "--reference r.exr --stats s.json";
    place
        .run(&format!("render scene.xml -o b.exr {guided} {measured}"))
        .ok();
    let of = |name: &str| read_channels(&place.path(name));
    assert!(of("a.exr") == of("b.exr"));
    let stats = json(&place, "s.json");
    assert!(stats["field"]["links"].as_u64() > Some(0), "{stats}");
}

#[test]
fn a_reference_of_another_size_is_refused_with_both_sizes_and_crops_are_cut() {
    let place = place();
    place
        .run("render scene.xml -o a.exr --width 30 --height 20 --reference r.exr")
        .fails(2, &["24 x 18", "30 x 20", "--width 24"]);
    place
        .run("render scene.xml -o a.exr --shard 0/2 --reference r.exr")
        .fails(2, &["--reference"]);
    let crop = "render scene.xml -o a.exr --format float --crop 3,2,19,16";
    place
        .run(&format!("{crop} --reference r.exr --stats s.json --spp 8"))
        .ok();
    // The cropped reference by itself gives the same numbers.
    let cropped = REFERENCE.replace("r.exr", "c.exr");
    place.run(&format!("{cropped} --crop 3,2,19,16")).ok();
    place
        .run(&format!("{crop} --reference c.exr --stats t.json --spp 8"))
        .ok();
    let [s, t] = ["s.json", "t.json"].map(|name| json(&place, name)["errors"][3]["rmse"].clone());
    assert!(s.as_f64().unwrap() > 0.0);
    assert_eq!(s, t);
}

#[test]
fn qualities_stop_at_their_noise_and_options_win() {
    let place = Place::new();
    place
        .run("render scene.xml -o a.exr --quality draft")
        .ok()
        .says(&["noise"]);
    place
        .run("render scene.xml -o a.exr --quality final --spp 2 --guide none --stats s.json")
        .ok();
    let stats = json(&place, "s.json");
    assert_eq!(
        (&stats["spp"], &stats["stopped_by"]),
        (&2.into(), &"samples".into())
    );
}

const PLAN: &str = r#"{
    "base": "--spp 100000",
    "knobs": {"sampler": ["sobol"], "strict-normals": ["on"]},
    "combinations": {"broken": "--width 7", "guided": "--guide double --photons 3000 --paths 0"}
}"#;
const SWEEP: &str = "sweep scene.xml --reference r.exr --plan plan.json --time 40ms --rounds 2 --budget 1m -o report";

fn sweeping() -> Place {
    let place = place();
    std::fs::write(place.path("plan.json"), PLAN).unwrap();
    place
}

#[test]
fn a_sweep_measures_every_configuration_and_says_what_to_use() {
    let place = sweeping();
    let ran = place.run(SWEEP).ok();
    for part in [
        "for a draft",
        "for a normal render",
        "for a final render",
        "takes",
    ] {
        assert!(ran.out.contains(part), "{ran:#?}");
    }
    let report = json(&place, "report/report.json");
    let runs = report["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 10);
    for run in runs {
        let broken = run["configuration"] == "broken";
        assert_eq!(run["failure"].is_string(), broken, "{run}");
        assert_eq!(run["stats"].is_null(), broken);
        if broken {
            assert!(
                run["failure"].as_str().unwrap().contains("24 x 18"),
                "{run}"
            );
        }
    }
    let table = String::from_utf8(place.read("report/runs.csv")).unwrap();
    assert_eq!(table.lines().count(), 11, "{table}");
    // A command of the report is one that runs.
    let command = runs[0]["command"].as_str().unwrap();
    place.run(command.strip_prefix("twintree ").unwrap()).ok();

    let again = place.run(SWEEP).ok();
    again.says(&["10 of 10 runs are there"]);
    let after = json(&place, "report/report.json");
    assert_eq!(after["runs"], report["runs"], "nothing was run again");
}

#[test]
fn a_sweep_of_another_scene_or_plan_is_refused_with_what_differs() {
    let place = sweeping();
    place.run(&SWEEP.replace("--rounds 2", "--rounds 1")).ok();
    let kept = place.read("report/report.json");
    place
        .run(SWEEP)
        .fails(2, &["--rounds is 2 here and 1 there"]);
    std::fs::write(place.path("plan.json"), PLAN.replace("broken", "cropped")).unwrap();
    let once = SWEEP.replace("--rounds 2", "--rounds 1");
    place
        .run(&once)
        .fails(2, &["the plan has changed", "cropped", "broken"]);
    std::fs::write(place.path("plan.json"), PLAN).unwrap();
    let scene = String::from_utf8(place.read("scene.xml")).unwrap();
    std::fs::write(place.path("scene.xml"), scene.replace("0.2\"", "0.21\"")).unwrap();
    place.run(&once).fails(2, &["the scene has changed", "-o"]);
    assert_eq!(place.read("report/report.json"), kept);
}

#[test]
fn plans_that_make_no_sense_are_refused() {
    let place = sweeping();
    for (text, part) in [
        ("{", "plan.json"),
        (r#"{"knob": {}}"#, "knob"),
        (r#"{"knobs": {"photon": ["5"]}}"#, "--photon"),
        (r#"{"combinations": {"a b": ""}}"#, "a b"),
        (r#"{"combinations": {"base": ""}}"#, "twice"),
    ] {
        std::fs::write(place.path("plan.json"), text).unwrap();
        place.run(SWEEP).fails(2, &[part]);
    }
    assert!(!place.path("report").exists());
}

#[test]
fn a_dry_run_prints_the_commands_and_makes_nothing() {
    let place = sweeping();
    let before = place.files();
    let ran = place.run(&format!("{SWEEP} --dry-run")).ok();
    assert_eq!(ran.out.lines().count(), 10, "{}", ran.out);
    assert!(
        ran.out
            .lines()
            .all(|l| l.starts_with("twintree render scene.xml "))
    );
    let built_in = "sweep scene.xml --reference r.exr --dry-run -- --max-depth 3";
    let ran = place.run(built_in).ok();
    assert!(ran.out.lines().count() > 60);
    assert!(ran.out.lines().all(|l| l.contains("--max-depth 3")));
    assert_eq!(place.files(), before);
    // A crop as the reference: the runs are of the same part of the whole.
    place
        .run("render scene.xml -o crop.exr --width 48 --spp 1 --crop 6,10,40,34")
        .ok();
    let ran = place
        .run("sweep scene.xml --reference crop.exr --dry-run")
        .ok();
    let words = "--width 48 --height 36 --crop 6,10,40,34 ";
    assert!(ran.out.lines().all(|l| l.contains(words)), "{}", ran.out);
}

#[test]
fn an_interrupted_sweep_writes_what_there_is_and_goes_on() {
    let place = sweeping();
    let slow = SWEEP.replace("40ms", "400ms");
    let child = place.spawn(&slow);
    let start = Instant::now();
    let measured = |place: &Place| {
        let bytes = std::fs::read(place.path("report/report.json")).unwrap_or_default();
        let report: serde_json::Value = serde_json::from_slice(&bytes).unwrap_or_default();
        report["runs"].as_array().map_or(0, Vec::len)
    };
    while measured(&place) < 2 {
        assert!(start.elapsed() < Duration::from_secs(60), "no report");
        std::thread::sleep(Duration::from_millis(20));
    }
    signal(&child, "INT");
    let ran = wait(child);
    assert_eq!(ran.code, Some(130), "{ran:#?}");
    let runs = measured(&place);
    assert!((2..10).contains(&runs), "{runs}");
    assert!(place.path("report/index.html").exists());
    let quick = place.run(&slow).ok();
    quick.says(&[&format!("{runs} of 10 runs are there")]);
    assert_eq!(measured(&place), 10);
}

/// Opens the page in a browser, in frames of both widths, and asks it what it sees.
#[test]
fn the_page_shows_everything_in_a_browser() {
    let Some(browser) = browser() else {
        eprintln!("skipped: no chromium is installed");
        return;
    };
    let place = sweeping();
    place.run(&SWEEP.replace("--rounds 2", "--rounds 1")).ok();
    let page = String::from_utf8(place.read("report/index.html")).unwrap();
    assert!(
        !page.contains("http:") && !page.contains("https:"),
        "it needs no network"
    );
    let hook = "<script>window.wrong = []; addEventListener('error', \
                e => wrong.push(String(e.message)), true);</script>";
    let page = page.replacen("<head>", &format!("<head>{hook}"), 1);
    let page = page.replace('&', "&amp;").replace('"', "&quot;");
    let frames: String = [1280, 400]
        .iter()
        .map(|w| format!("<iframe width=\"{w}\" height=\"900\" srcdoc=\"{page}\"></iframe>"))
        .collect();
    let test = format!("<!DOCTYPE html><body>{frames}<script>{ASK}</script></body>");
    std::fs::write(place.path("test.html"), test).unwrap();
    let output = std::process::Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--enable-logging=stderr",
        ])
        .args(["--virtual-time-budget=10000", "--dump-dom"])
        .arg(format!(
            "--user-data-dir={}",
            place.path("browser").display()
        ))
        .arg(format!("file://{}", place.path("test.html").display()))
        .output()
        .unwrap();
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(!messages.contains("CONSOLE"), "{messages}");
    let dom = String::from_utf8_lossy(&output.stdout);
    let said = dom
        .split("<pre id=\"said\">")
        .nth(1)
        .and_then(|s| s.split("</pre>").next());
    let said = said.unwrap_or_else(|| panic!("the page did not answer: {messages}"));
    let said: Vec<serde_json::Value> = serde_json::from_str(said).unwrap();
    assert_eq!(said.len(), 2);
    for frame in said {
        assert_eq!(frame["wrong"], serde_json::json!([]), "{frame}");
        assert_eq!(frame["overflow"], 0, "{frame}");
        assert_eq!(frame["missing"], 0, "{frame}");
        // Reference, slider, and each configuration's image and errors.
        assert!(frame["images"].as_u64() >= Some(7), "{frame}");
        // The overview and, by pixels and blocks of two sizes, a drawing a knob: sampler,
        // strict-normals, combinations.
        assert_eq!(frame["plots"], 1 + 3 * 3, "{frame}");
        assert_eq!(frame["unlabelled"], 0, "{frame}");
        assert_eq!(frame["split"], "20%", "the slider moves");
        assert_eq!(frame["chosen"], true, "an image is chosen");
    }
}

/// Asks each frame, once all of them are there.
const ASK: &str = r#"
addEventListener("load", () => {
  const said = [...document.querySelectorAll("iframe")].map((frame) => {
    const page = frame.contentDocument;
    const images = [...page.images];
    const plots = [...page.querySelectorAll(".plot svg")].filter((svg) => svg.getBoundingClientRect().width > 200
      && svg.querySelectorAll("polyline").length > 2);
    const split = page.getElementById("split");
    split.value = 20;
    split.dispatchEvent(new frame.contentWindow.Event("input"));
    const left = page.getElementById("left");
    left.selectedIndex = 0;
    left.dispatchEvent(new frame.contentWindow.Event("change"));
    return {
      wrong: frame.contentWindow.wrong,
      overflow: Math.max(0, page.documentElement.scrollWidth - page.documentElement.clientWidth),
      images: images.length,
      missing: images.filter((image) => image.naturalWidth === 0).length,
      unlabelled: images.filter((image) => !image.alt).length
        + plots.filter((svg) => !svg.getAttribute("aria-label")).length,
      plots: plots.length,
      split: page.getElementById("slider").style.getPropertyValue("--split"),
      chosen: page.getElementById("slider-left").src === page.getElementById("picture-reference").src,
    };
  });
  const answer = document.createElement("pre");
  answer.id = "said";
  answer.textContent = JSON.stringify(said);
  document.body.append(answer);
});
"#;

/// A browser that can be asked without a screen.
fn browser() -> Option<&'static str> {
    ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| {
            let version = std::process::Command::new(name).arg("--version").output();
            version.is_ok_and(|output| output.status.success())
        })
}
