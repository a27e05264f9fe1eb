//! `twintree compare`: numbers, limits, drawings.

use super::support::{Place, Ran};

/// Pictures that other programs compared as well: see `tests/vectors/metrics/metrics.py`.
const VECTORS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vectors/metrics");

/// Runs `twintree compare <words>` in a directory with the pictures of the vectors.
fn compare(place: &Place, words: &str) -> Ran {
    for name in ["reference", "noisy", "biased", "tinted"] {
        let file = format!("{name}.exr");
        std::fs::copy(format!("{VECTORS}/{file}"), place.path(&file)).unwrap();
    }
    place.run(&format!("compare {words}"))
}

fn json(place: &Place, name: &str) -> serde_json::Value {
    serde_json::from_slice(&place.read(name)).unwrap()
}

#[test]
fn the_numbers_are_those_of_other_programs() {
    let place = Place::new();
    let words = "noisy.exr biased.exr tinted.exr --reference reference.exr --json out.json";
    let table = compare(&place, words).ok().out;
    let ours = json(&place, "out.json");
    let text = std::fs::read_to_string(format!("{VECTORS}/metrics.json")).unwrap();
    let theirs: serde_json::Value = serde_json::from_str(&text).unwrap();
    for (i, name) in ["noisy", "biased", "tinted"].into_iter().enumerate() {
        let image = &ours["images"][i];
        assert_eq!(image["image"], format!("{name}.exr"));
        for (key, as_theirs) in [
            ("l1", "l1"),
            ("rmse", "rmse"),
            ("relmse", "relmse"),
            ("relmse_trimmed", "relmse_trimmed"),
            ("relmse_4x4", "relmse_4x4"),
            ("relmse_16x16", "relmse_16x16"),
            ("ssim", "ssim"),
            ("psnr", "psnr"),
            ("flip", "flip_hdr"),
            ("mean_ratio", "mean_ratio"),
        ] {
            let value = image[key].as_f64().unwrap();
            let expected = theirs[name][as_theirs].as_f64().unwrap();
            let error = (value - expected).abs() / expected.abs().max(1.0);
            assert!(error < 1e-4, "{name} {key}: {value} is not {expected}");
        }
        assert!(image["z"].is_null(), "{image}");
    }
    assert_eq!(ours["images"][0]["fireflies"], 3);
    // A head, a rule and a row an image, all of one length.
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), 5, "{table}");
    assert!(lines.iter().all(|l| l.len() == lines[0].len()), "{table}");
    for (line, start) in lines
        .iter()
        .zip(["| image", "| --", "| noisy.exr", "| biased.exr"])
    {
        assert!(line.starts_with(start), "{table}");
    }
}

#[test]
fn a_range_makes_ssim_and_psnr_those_of_linear_numbers() {
    let place = Place::new();
    let words = "noisy.exr -r reference.exr --data-range 60 --json out.json";
    compare(&place, words).ok();
    let image = &json(&place, "out.json")["images"][0];
    assert!(
        (image["ssim"].as_f64().unwrap() - 0.92466).abs() < 1e-4,
        "{image}"
    );
    assert!(
        (image["psnr"].as_f64().unwrap() - 24.3599).abs() < 1e-3,
        "{image}"
    );
}

#[test]
fn limits_decide_the_exit_code() {
    let place = Place::new();
    let near = "tinted.exr -r reference.exr";
    let kept = "--max-relmse 0.005 --max-rmse 2 --max-flip 0.1 --min-ssim 0.9";
    compare(&place, &format!("{near} {kept}")).ok();
    for (limit, parts) in [
        ("--max-relmse 1e-5", ["tinted.exr: relMSE", "above 0.00001"]),
        ("--max-rmse 1e-5", ["tinted.exr: RMSE", "above"]),
        ("--max-flip 0.001", ["tinted.exr: FLIP", "above 0.001"]),
        ("--min-ssim 0.9999", ["tinted.exr: SSIM", "below 0.9999"]),
    ] {
        let ran = compare(&place, &format!("{near} {limit}")).fails(1, &parts);
        // The table is there for the one who wants to know how far off.
        assert!(ran.out.contains("| tinted.exr"), "{ran:#?}");
    }
    // One image of several is enough, and it is named.
    let ran = compare(
        &place,
        "tinted.exr noisy.exr -r reference.exr --max-relmse 1",
    );
    assert!(!ran.fails(1, &["noisy.exr"]).err.contains("tinted.exr"));
}

#[test]
fn what_cannot_be_compared_is_told_in_words() {
    let place = Place::new();
    place.run("render scene.xml -o small.exr --spp 1").ok();
    for (words, parts) in [
        (
            "small.exr -r reference.exr",
            ["small.exr", "24 x 18", "56 x 40"],
        ),
        ("nowhere.exr -r reference.exr", ["nowhere.exr", "", ""]),
        ("noisy.exr -r nowhere.exr", ["nowhere.exr", "", ""]),
        ("noisy.exr -r scene.xml", ["scene.xml", "", ""]),
        ("noisy.exr", ["--reference", "", ""]),
        ("-r reference.exr", ["IMAGE", "", ""]),
        (
            "noisy.exr -r reference.exr --max-flip -1",
            ["--max-flip", "", ""],
        ),
        (
            "noisy.exr -r reference.exr --data-range 0",
            ["--data-range", "above 0", ""],
        ),
    ] {
        compare(&place, words).fails(2, &parts);
    }
    compare(&place, "noisy.exr -r reference.exr --json nowhere/a.json")
        .fails(1, &["nowhere/a.json", "mkdir"]);
}

#[test]
fn errors_are_drawn_into_a_directory_or_onto_a_sheet() {
    let place = Place::new();
    let two = "noisy.exr biased.exr -r reference.exr";
    compare(&place, &format!("{two} -o drawn/errors")).ok();
    let mut drawn: Vec<String> = std::fs::read_dir(place.path("drawn/errors"))
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    drawn.sort();
    let expected = [
        "biased-difference",
        "biased-flip",
        "noisy-difference",
        "noisy-flip",
    ];
    assert_eq!(drawn, expected.map(|name| format!("{name}.png")));
    // The bias is upwards: red. The first firefly of the noise is bright in both pictures.
    let read = |name: &str| {
        let path = place.path("drawn/errors").join(name);
        twintree::image::read(&path).unwrap()
    };
    let biased = read("biased-difference.png");
    let sum = |c: usize| biased.rgb().iter().map(|p| f64::from(p[c])).sum::<f64>();
    assert!(sum(0) > 2.0 * sum(2), "red {}, blue {}", sum(0), sum(2));
    assert_eq!(read("noisy-difference.png").pixel(5, 5)[0], 1.0);
    let [here, away] = [(5, 5), (40, 38)].map(|(x, y)| read("noisy-flip.png").pixel(x, y)[0]);
    assert!(here > 0.9 && here > 2.0 * away, "{here} {away}");

    compare(&place, &format!("{two} -o sheet.png")).ok();
    let sheet = twintree::image::read(&place.path("sheet.png")).unwrap();
    assert_eq!((sheet.width, sheet.height), (3 * 56, 2 * 40));
    let right = sheet.pixel(2 * 56 + 5, 5);
    assert_eq!(right, read("noisy-flip.png").pixel(5, 5));
}

#[test]
fn two_renders_of_one_scene_differ_by_their_noise() {
    let place = Place::new();
    let render = |name: &str, seed: u32, more: &str| {
        let words = format!("render scene.xml -o {name} --seed {seed} --aov variance {more}");
        place.run(&words).ok();
    };
    render("a.exr", 1, "--spp 256");
    render("b.exr", 2, "--spp 1024");
    render("shallow.exr", 3, "--spp 256 --max-depth 1");
    place
        .run("compare a.exr shallow.exr -r b.exr --json z.json")
        .ok();
    let report = json(&place, "z.json");
    let inside = |i: usize| report["images"][i]["z"]["inside"].as_f64().unwrap();
    // 1296 numbers, of which 99.9 % are expected: 1.3 outside, and more than 13 hardly ever.
    assert!(inside(0) > 0.99, "{report:#}");
    assert!(inside(1) < 0.9, "{report:#}");
}

#[test]
fn pictures_of_eight_bits_are_compared_as_shown() {
    let place = Place::new();
    for (name, spp) in [("a.png", 4), ("b.png", 64)] {
        let words = format!("render scene.xml -o {name} --spp {spp}");
        place.run(&words).ok();
    }
    place.run("compare a.png -r b.png --json out.json").ok();
    let report = json(&place, "out.json");
    assert_eq!(report["flip_kind"], "ldr");
    let flip = report["images"][0]["flip"].as_f64().unwrap();
    assert!(flip > 0.0 && flip < 0.5, "{report:#}");
    place
        .run("compare b.png -r b.png --max-rmse 0 --max-flip 0 --min-ssim 1")
        .ok();
}

/// A crop is compared with the part of the whole where it lies, as an image or as the reference,
/// and not with another part of it.
#[test]
fn crops_are_compared_where_they_lie() {
    let place = Place::new();
    let render = |words: &str| {
        place
            .run(&format!("render scene.xml --format float --spp 4 {words}"))
            .ok();
    };
    render("-o all.exr");
    render("-o part.exr --crop 3,5,20,17");
    render("-o other.exr --crop 4,5,21,17");
    render("-o beyond.exr --crop 4,5,22,17");
    for words in [
        "part.exr --reference all.exr",
        "all.exr --reference part.exr",
    ] {
        place.run(&format!("compare {words} --json c.json")).ok();
        let rmse = json(&place, "c.json")["images"][0]["rmse"].as_f64();
        assert_eq!(rmse, Some(0.0), "{words}");
    }
    for other in ["other.exr", "beyond.exr"] {
        place
            .run(&format!("compare {other} --reference part.exr"))
            .fails(2, &["different parts", "from 3,5 of 24 x 18", "--crop"]);
    }
}
