//! Files that a render leaves.

use super::support::{Place, Ran, read_channels, read_exr, wait};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

#[test]
fn one_render_writes_several_formats() {
    let place = Place::new();
    place
        .run("render scene.xml -o a.exr -o b.png -o c.jpg -o d.hdr")
        .ok();
    assert_eq!(
        place.files(),
        ["a.exr", "b.png", "c.jpg", "d.hdr", "scene.xml"]
    );
    let (width, pixels) = read_exr(&place.path("a.exr"));
    assert_eq!((width, pixels.len()), (24, 24 * 18));
    assert!(
        pixels.iter().all(|p| p.iter().all(|c| *c > 0.0)),
        "the sky is everywhere"
    );
    assert!(place.read("b.png").starts_with(b"\x89PNG"));
    assert!(place.read("c.jpg").starts_with(b"\xff\xd8"));
    assert!(place.read("d.hdr").starts_with(b"#?"));
}

/// OpenImageIO is loaded beside the first tiles: that it is missing is known then, not hours later.
#[test]
fn a_render_that_cannot_write_its_image_ends_soon_and_a_shard_does_without() {
    let place = Place::new();
    // The linker's debugging output names the file that it opens, whatever the version.
    let output = place
        .command("render scene.xml --spp 1 -o a.png")
        .env("LD_DEBUG", "libs")
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    let mut names = told
        .split_whitespace()
        .filter_map(|word| word.split('/').next_back());
    let Some(name) = names.find(|name| name.starts_with("libOpenImageIO.so")) else {
        eprintln!("skipped: this build has no OpenImageIO, or its linker does not tell");
        return;
    };
    std::fs::create_dir(place.path("broken")).unwrap();
    std::fs::write(place.path("broken").join(name), "no library").unwrap();
    let with_broken = |words: &str| {
        let mut command = place.command(words);
        command.env("LD_LIBRARY_PATH", place.path("broken"));
        Ran::of(command.output().unwrap())
    };
    let start = Instant::now();
    with_broken("render scene.xml --time 2m -o b.png")
        .fails(1, &["OpenImageIO cannot be loaded", name]);
    assert!(start.elapsed() < Duration::from_secs(60));
    assert!(!place.path("b.png").exists());
    with_broken("render scene.xml --shard 1/2 --spp 2 -o c.exr").ok();
}

#[test]
fn without_a_name_the_image_is_called_after_the_scene() {
    let place = Place::new();
    std::fs::create_dir(place.path("sub")).unwrap();
    std::fs::rename(place.path("scene.xml"), place.path("sub/room.xml")).unwrap();
    place.run("render sub/room.xml --spp 1").ok();
    assert_eq!(place.files(), ["room.exr", "sub"]);
}

#[test]
fn an_existing_output_is_replaced_whole() {
    let place = Place::new();
    std::fs::write(place.path("a.exr"), vec![b'x'; 1 << 20]).unwrap();
    place.run("render scene.xml -o a.exr").ok();
    assert!(
        place.read("a.exr").len() < 1 << 20,
        "nothing of the old file is left"
    );
    place.run("render scene.xml -o b.exr").ok();
    let [a, b] = ["a.exr", "b.exr"].map(|name| read_channels(&place.path(name)));
    assert_eq!(a, b);
    assert_eq!(place.files(), ["a.exr", "b.exr", "scene.xml"]);
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    let place = Place::new();
    for sampler in ["independent", "sobol"] {
        let render = |threads: u32, seed: u32| {
            let words = format!(
                "render scene.xml -o {threads}.exr -D size=70 --spp 7 --seed {seed} -j {threads} \
                 --sampler {sampler} --format float --aov all"
            );
            place.run(&words).ok();
            read_channels(&place.path(&format!("{threads}.exr")))
        };
        let one = render(1, 5);
        assert!(one == render(2, 5) && one == render(3, 5), "{sampler}");
        assert!(
            one != render(1, 6),
            "{sampler}: another seed is another image"
        );
    }
}

#[test]
fn all_paths_take_sobol_points_unless_told_otherwise() {
    let place = Place::new();
    let guided = "--guide double --photons 2000 --batches 2";
    for guide in [guided, "--guide none"] {
        let render = |sampler: &str| {
            let words =
                format!("render scene.xml -o a.exr --spp 4 {guide} {sampler} --format float");
            place.run(&words).ok();
            read_channels(&place.path("a.exr"))
        };
        let unasked = render("");
        assert!(unasked == render("--sampler sobol"), "{guide}");
        assert!(unasked != render("--sampler independent"), "{guide}");
    }
}

#[test]
fn a_crop_holds_the_same_pixels_as_the_whole() {
    let place = Place::new();
    place.run("render scene.xml -o all.exr --format float").ok();
    place
        .run("render scene.xml -o part.exr --format float --crop 3,5,20,17")
        .ok();
    let (width, all) = read_exr(&place.path("all.exr"));
    let (part_width, part) = read_exr(&place.path("part.exr"));
    assert_eq!((part_width, part.len()), (17, 17 * 12));
    for (i, pixel) in part.iter().enumerate() {
        let (x, y) = (i % part_width + 3, i / part_width + 5);
        assert_eq!(*pixel, all[y * width + x], "{x},{y}");
    }
}

/// Data and display window: x, y, width, height.
fn windows(path: &Path) -> [[i32; 4]; 2] {
    let meta = exr::prelude::MetaData::read_from_file(path, false).unwrap();
    let header = &meta.headers[0];
    let (data, display) = (
        header.own_attributes.layer_position,
        header.shared_attributes.display_window,
    );
    let of = |x: i32, y: i32, size: exr::math::Vec2<usize>| {
        [x, y, size.width() as i32, size.height() as i32]
    };
    [
        of(data.x(), data.y(), header.layer_size),
        of(display.position.x(), display.position.y(), display.size),
    ]
}

/// With all layers, in one piece or merged, a crop says where in the picture it lies.
#[test]
fn a_crop_has_the_window_of_its_place() {
    let place = Place::new();
    let crop = "render scene.xml --crop 3,5,20,17 --spp 2 --aov all";
    place.run(&format!("{crop} -o part.exr")).ok();
    let expected = [[3, 5, 17, 12], [0, 0, 24, 18]];
    assert_eq!(windows(&place.path("part.exr")), expected);
    for i in 0..2 {
        place.run(&format!("{crop} --shard {i}/2 -o {i}.exr")).ok();
    }
    place.run("merge 0.exr 1.exr --aov all -o merged.exr").ok();
    assert_eq!(windows(&place.path("merged.exr")), expected);
    let of = |name: &str| read_channels(&place.path(name));
    assert!(of("merged.exr") == of("part.exr"));
    place.run("render scene.xml --spp 1 -o all.exr").ok();
    assert_eq!(windows(&place.path("all.exr")), [[0, 0, 24, 18]; 2]);
}

#[test]
fn one_side_alone_keeps_the_proportions() {
    let place = Place::new();
    place
        .run("render scene.xml -o a.exr --width 48 --spp 1")
        .ok();
    let (width, pixels) = read_exr(&place.path("a.exr"));
    assert_eq!((width, pixels.len()), (48, 48 * 36));
    place
        .run("render scene.xml -o a.exr --height 9 --spp 1")
        .ok();
    let (width, pixels) = read_exr(&place.path("a.exr"));
    assert_eq!((width, pixels.len()), (12, 12 * 9));
}

#[test]
fn layers_are_in_the_file_that_was_asked_for_them() {
    let place = Place::new();
    let names = |words: &str| {
        place
            .run(&format!("render scene.xml -o a.exr --spp 2 {words}"))
            .ok();
        let channels = read_channels(&place.path("a.exr")).into_iter();
        let mut names: Vec<String> = channels.map(|c| c.0).collect();
        names.sort();
        names.join(" ")
    };
    let plain = names("");
    for channel in ["R", "G", "B"] {
        assert!(plain.split(' ').any(|c| c == channel), "{plain}");
    }
    assert!(!plain.contains('.'), "{plain}");
    let some = names("--aov albedo,normal");
    assert!(
        some.contains("albedo.") && some.contains("normal."),
        "{some}"
    );
    assert!(!some.contains("variance"), "{some}");
    let all = names("--aov all");
    for layer in [
        "albedo.",
        "normal.",
        "albedo.first.",
        "normal.first.",
        "depth",
        "variance",
        "samples",
    ] {
        assert!(all.to_lowercase().contains(layer), "{layer} in {all}");
    }
}

#[test]
fn exposure_and_view_shape_a_png_and_leave_the_exr() {
    let place = Place::new();
    place.run("render scene.xml -o a.exr -o a.png").ok();
    let mut pictures = vec![place.read("a.png")];
    let views = ["neutral", "agx", "filmic", "raw"].map(|view| format!("--view {view}"));
    for words in views.iter().map(String::as_str).chain(["--exposure -2"]) {
        place
            .run(&format!("render scene.xml -o b.exr -o b.png {words}"))
            .ok();
        let [a, b] = ["a.exr", "b.exr"].map(|name| read_channels(&place.path(name)));
        assert_eq!(a, b, "{words}");
        let picture = place.read("b.png");
        assert!(!pictures.contains(&picture), "{words}");
        pictures.push(picture);
    }
    place
        .run("render scene.xml --view vivid")
        .fails(2, &["vivid", "neutral", "agx"]);
    place
        .run("render scene.xml -o a.exr --view agx")
        .ok()
        .says(&["--view has no effect"]);
}

#[test]
fn stats_hold_every_documented_key() {
    let place = Place::new();
    place
        .run("render scene.xml -o a.exr --stats s.json --seed 3 -j 2 --spp 5")
        .ok();
    let stats: serde_json::Value = serde_json::from_slice(&place.read("s.json")).unwrap();
    let stats = stats.as_object().unwrap();
    let manual = include_str!("../../src/manual/stats.md");
    for key in stats.keys() {
        assert!(
            manual.contains(&format!("| `{key}` |")),
            "{key} is not in src/manual/stats.md"
        );
    }
    for key in [
        "samples_per_second",
        "load_seconds",
        "build_seconds",
        "render_seconds",
        "write_seconds",
        "peak_memory_bytes",
        "stopped_by",
        "spp",
        "samples",
        "rays",
        "rays_per_second",
        "noise",
        "threads",
        "seed",
        "width",
        "height",
        "scene",
        "version",
        "accel",
        "accel_memory_bytes",
        "texture_memory_bytes",
        "triangles",
        "invalid_samples",
        "warnings",
    ] {
        assert!(stats.contains_key(key), "{key}");
    }
    assert_eq!(stats["stopped_by"], "samples");
    assert_eq!(stats["spp"], 5);
    assert_eq!(stats["samples"], 5 * 24 * 18);
    assert_eq!((&stats["seed"], &stats["threads"]), (&3.into(), &2.into()));
    assert!(stats["rays"].as_u64() > stats["samples"].as_u64());
    let rate = stats["samples"].as_f64().unwrap() / stats["render_seconds"].as_f64().unwrap();
    let told = stats["samples_per_second"].as_f64().unwrap();
    assert!((told / rate - 1.0).abs() < 1e-6, "{told} {rate}");
}

#[test]
fn an_image_whose_directory_has_gone_is_kept_elsewhere() {
    let place = Place::new();
    std::fs::create_dir(place.path("pictures")).unwrap();
    std::fs::create_dir(place.path("temporary")).unwrap();
    let mut child = place
        .command("render scene.xml -o pictures/a.exr --time 2s")
        .env("TMPDIR", place.path("temporary"))
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut messages = BufReader::new(child.stderr.take().unwrap());
    let mut text = String::new();
    while !text.contains(" samples/s") {
        assert_ne!(messages.read_line(&mut text).unwrap(), 0, "{text}");
    }
    std::fs::remove_dir(place.path("pictures")).unwrap();
    messages.read_to_string(&mut text).unwrap();
    assert_eq!(wait(child).code, Some(1), "{text}");
    assert!(
        text.contains("error: pictures/a.exr: ") && text.contains("kept in"),
        "{text}"
    );
    let kept = std::fs::read_dir(place.path("temporary")).unwrap();
    let kept: Vec<_> = kept.map(|f| f.unwrap().path()).collect();
    assert_eq!(kept.len(), 1, "{kept:?}");
    assert_eq!(read_exr(&kept[0]).0, 24);
}

#[cfg(feature = "embree")]
#[test]
fn both_ray_tracers_show_the_same_scene() {
    let place = Place::new();
    let [a, b] = ["embree", "obvhs"].map(|accel| {
        place
            .run(&format!(
                "render scene.xml -o a.exr --format float --accel {accel}"
            ))
            .ok();
        read_exr(&place.path("a.exr")).1
    });
    // The same random numbers meet the same surfaces: a pixel differs only where a ray passes an
    // edge within rounding. One in a hundred is allowed to.
    let differ = |(a, b): (&[f32; 3], &[f32; 3])| (a[0] - b[0]).abs() > 1e-3 * a[0].abs();
    let count = a.iter().zip(&b).filter(|&pair| differ(pair)).count();
    assert!(
        count <= a.len() / 100,
        "{count} of {} pixels differ",
        a.len()
    );
}
