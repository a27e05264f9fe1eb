//! What guides where nothing is said.

use super::support::{Place, read_exr};

/// Guided, a picture has told whether that pays; unguided, it says why nothing was learned.
fn is_guided(place: &Place, words: &str) -> bool {
    let said = place
        .run(&format!("render scene.xml -o a.exr --stats s.json {words}"))
        .ok();
    let stats: serde_json::Value = serde_json::from_slice(&place.read("s.json")).unwrap();
    let learned = !stats["trial"].is_null();
    assert!(learned || !said.err.contains("learned from"), "{said:#?}");
    learned
}

/// A wall of metal: light may come by it that few paths find.
fn with_metal() -> Place {
    Place::replacing(
        r#"<bsdf type="diffuse">"#,
        r#"<bsdf type="roughconductor">"#,
    )
}

#[test]
fn a_field_is_learned_where_it_may_pay_unless_told_otherwise() {
    let place = with_metal();
    // 192 x 144 pixels: 276 480 samples of 10 a pixel.
    let image = "--width 192 --spp 10";
    assert!(is_guided(&place, image));
    assert!(!is_guided(&place, &format!("{image} --guide none")));
    assert!(!is_guided(&place, &format!("{image} --max-depth 2")));
    // Previews, however large, and tiny images, unless it is asked for.
    assert!(!is_guided(&place, "--width 384 --spp 7"));
    assert!(!is_guided(&place, "--spp 64"));
    assert!(is_guided(&place, "--spp 64 --guide double"));
    // Where every sample sees nearly the same light there is nothing to gain.
    assert!(!is_guided(&Place::new(), image));
    // A render that ends by the clock has no number of samples.
    assert!(is_guided(&place, "--width 96 --time 2s"));
}

#[test]
fn shards_are_guided_where_that_is_asked_for() {
    let place = with_metal();
    let shard = |words: &str| {
        let image = "--width 192 --spp 10 --shard 0/2";
        let words = format!("render scene.xml -o a.exr {image} {words}");
        let said = place.run(&words).ok();
        said.err.contains("learned from")
    };
    assert!(!shard(""));
    assert!(shard("--guide double"));
}

/// Learning, sharing and the choice of samples work around a fisheye's circle: the mean is that of
/// an unguided render, and the corners are black.
#[test]
fn a_guided_fisheye_has_the_same_mean() {
    let place = Place::replacing(
        "<sensor type=\"perspective\">\n    <float name=\"fov\" value=\"45\"/>",
        "<sensor type=\"fisheye\">\n    <float name=\"fov\" value=\"150\"/>",
    );
    let mean = |words: &str| {
        let words = format!("render scene.xml -D size=32 --spp 256 {words} -o out.exr");
        place.run(&words).ok();
        let (width, pixels) = read_exr(&place.path("out.exr"));
        for corner in [0, width - 1, pixels.len() - 1] {
            assert_eq!(pixels[corner], [0.0; 3]);
        }
        pixels.iter().map(|p| f64::from(p[1])).sum::<f64>() / pixels.len() as f64
    };
    let plain = mean("--guide none");
    let guided = mean("--guide double --photons 20k --paths 20k");
    // 147,000 samples in all, of a relative deviation of about 1: twice 0.26 %.
    assert!((guided / plain - 1.0).abs() < 0.01, "{guided} {plain}");
}
