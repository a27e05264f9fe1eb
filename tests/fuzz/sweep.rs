//! Every hostile value in every place of a scene, and structures that blow up.

use super::mutate::Reproduce;
use super::{assert_memory, corpus, targets};
use std::fmt::Write as _;

const VALUES: [&str; 14] = [
    "nan",
    "inf",
    "-inf",
    "1e39",
    "1e400",
    "-1",
    "0",
    "1e-46",
    "1e19",
    "4294967296",
    "1e18",
    "",
    "$size",
    "a b c",
];

/// Where the values of a text's attributes stand, those of `value`, `x`, `y`, `z`, `angle`,
/// `origin`, `target`, `up`.
fn places(text: &str) -> Vec<(usize, usize)> {
    let mut list = Vec::new();
    for name in [
        "value", "x", "y", "z", "angle", "origin", "target", "up", "type", "id", "name",
    ] {
        let pattern = format!(" {name}=\"");
        for (at, _) in text.match_indices(&pattern) {
            let start = at + pattern.len();
            let length = text[start..].find('"').expect("the attribute ends");
            list.push((start, start + length));
        }
    }
    list
}

#[test]
fn every_hostile_value_everywhere() {
    for (path, seed) in corpus("xml") {
        let text = String::from_utf8(seed).expect("text");
        let mut loaded = 0;
        let mut round = 0;
        for (start, end) in places(&text) {
            for value in VALUES {
                let mut changed = text.clone();
                changed.replace_range(start..end, value);
                let guard = Reproduce::new("sweep", &path, round, changed.as_bytes());
                loaded += u32::from(targets::xml(changed.as_bytes()));
                guard.survived();
                round += 1;
            }
        }
        println!("{}: {loaded} of {round} loaded", path.display());
        assert!(loaded > 100 && u64::from(loaded) < round);
    }
    assert_memory();
}

fn refused(what: &str, text: &str) {
    let guard_path = std::path::PathBuf::from(what);
    let guard = Reproduce::new(
        "structure",
        &guard_path,
        0,
        &text.as_bytes()[..text.len().min(1000)],
    );
    assert!(!targets::xml(text.as_bytes()), "{what} was accepted");
    guard.survived();
}

fn scene(inside: &str) -> String {
    format!("<scene version=\"3.0.0\">{inside}</scene>")
}

#[test]
fn structures_that_blow_up_are_refused() {
    let mut laughs = String::from("<!DOCTYPE scene [<!ENTITY a0 \"ha\">");
    for i in 1..40 {
        // Writing to a String does not fail.
        let _ = write!(
            laughs,
            "<!ENTITY a{i} \"{}\">",
            format!("&a{};", i - 1).repeat(10)
        );
    }
    refused("entities", &format!("{laughs}]>{}", scene("&a39;")));

    let mut defaults = String::from("<default name=\"a0\" value=\"haha\"/>");
    for i in 1..60 {
        let _ = write!(
            defaults,
            "<default name=\"a{i}\" value=\"$a{0}$a{0}\"/>",
            i - 1
        );
    }
    refused(
        "defaults",
        &scene(&format!(
            "{defaults}<shape type=\"sphere\"><float name=\"radius\" value=\"$a59\"/></shape>"
        )),
    );

    for deep in [60, 1000, 100_000] {
        let open = "<bsdf type=\"twosided\">".repeat(deep);
        let close = "</bsdf>".repeat(deep);
        refused("nesting", &scene(&format!("{open}{close}")));
        refused("nesting without end", &scene(&open));
    }

    let mut chain = String::new();
    for i in 0..100_000 {
        let _ = write!(
            chain,
            "<bsdf type=\"twosided\" id=\"b{i}\"><ref id=\"b{}\"/></bsdf>",
            i + 1
        );
    }
    let chain = scene(&format!(
        "{chain}<bsdf type=\"diffuse\" id=\"b100000\"/><shape type=\"sphere\"><ref id=\"b0\"/></shape>"
    ));
    refused("a chain of references", &chain);

    // Each holds the next one twice: 2^60 materials if each were made anew.
    let mut doubled = String::new();
    for i in 0..60 {
        let next = i + 1;
        let _ = write!(
            doubled,
            "<bsdf type=\"blendbsdf\" id=\"b{i}\"><float name=\"weight\" value=\"0.5\"/><ref id=\"b{next}\"/><ref id=\"b{next}\"/></bsdf>"
        );
    }
    let shared = scene(&format!(
        "{doubled}<bsdf type=\"diffuse\" id=\"b60\"/><shape type=\"sphere\"><ref id=\"b0\"/></shape>"
    ));
    // Refused or shared: both are answers, endless work is none.
    targets::xml(shared.as_bytes());

    let circle = "<bsdf type=\"twosided\" id=\"a\"><ref id=\"b\"/></bsdf><bsdf type=\"twosided\" id=\"b\"><ref id=\"a\"/></bsdf><shape type=\"sphere\"><ref id=\"a\"/></shape>";
    refused("a circle", &scene(circle));
    let own = "<shape type=\"shapegroup\" id=\"g\"><shape type=\"instance\"><ref id=\"g\"/></shape></shape>";
    refused("a group in itself", &scene(own));
    refused(
        "a scene that includes itself",
        &scene("<include filename=\"scene.xml\"/>"),
    );
    assert_memory();
}

/// A film of any size may be asked for; one that no memory holds is refused before it is made.
#[test]
fn films_beyond_memory_are_refused() {
    let film = |w: &str, h: &str| {
        scene(&format!(
            "<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"width\" value=\"{w}\"/><integer name=\"height\" value=\"{h}\"/></film></sensor>"
        ))
    };
    for (w, h) in [
        ("4294967296", "1"),
        ("-1", "8"),
        ("0", "8"),
        ("1048577", "1"),
        ("99999999999999999999", "1"),
    ] {
        refused("a film", &film(w, h));
    }
}
