//! The statements of MTL that are known, and what their numbers may be.

/// What a statement holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// One number or three, each within the bounds.
    Color(f32, f32),
    /// One number within the bounds.
    Number(f32, f32),
    /// An image that is used.
    Image,
    /// Known, and told to be left out.
    LeftOut,
    /// Known, and of no effect on light.
    Harmless,
}

/// Statements in the spelling of the format.
#[rustfmt::skip]
const WORDS: [(&str, Kind); 50] = [
    ("Ka", Kind::Harmless), ("Kd", Kind::Color(0.0, 1.0)), ("Ks", Kind::Color(0.0, 1.0)),
    ("Ke", Kind::Color(0.0, f32::MAX)), ("Tf", Kind::Color(0.0, 1.0)),
    ("Ns", Kind::Number(0.0, f32::MAX)), ("Ni", Kind::Number(0.001, 10.0)),
    ("d", Kind::Number(0.0, 1.0)), ("Tr", Kind::Number(0.0, 1.0)),
    ("illum", Kind::Number(0.0, 10.0)), ("Pr", Kind::Number(0.0, 1.0)),
    ("Pm", Kind::Number(0.0, 1.0)), ("Ps", Kind::Number(0.0, 1.0)), ("Pc", Kind::Number(0.0, 1.0)),
    ("Pcr", Kind::Number(0.0, 1.0)), ("aniso", Kind::Number(0.0, 1.0)),
    ("anisor", Kind::Number(-1.0, 1.0)), ("sharpness", Kind::Harmless), ("map_aat", Kind::Harmless),
    ("map_Ka", Kind::Harmless), ("map_Kd", Kind::Image), ("map_Ke", Kind::Image),
    ("map_d", Kind::Image), ("map_Pr", Kind::Image), ("map_Pm", Kind::Image), ("norm", Kind::Image),
    ("map_Ks", Kind::LeftOut), ("map_Ns", Kind::LeftOut), ("map_Ni", Kind::LeftOut),
    ("map_Tr", Kind::LeftOut), ("map_Tf", Kind::LeftOut), ("map_Ps", Kind::LeftOut),
    ("map_Pc", Kind::LeftOut), ("map_Pcr", Kind::LeftOut), ("map_refl", Kind::LeftOut),
    ("map_RMA", Kind::LeftOut), ("map_ORM", Kind::LeftOut), ("map_opacity", Kind::LeftOut),
    ("map_aniso", Kind::LeftOut), ("map_anisor", Kind::LeftOut), ("map_illum", Kind::LeftOut),
    ("bump", Kind::Image), ("map_bump", Kind::Image), ("disp", Kind::LeftOut),
    ("map_disp", Kind::LeftOut), ("decal", Kind::LeftOut), ("map_decal", Kind::LeftOut),
    ("refl", Kind::LeftOut), ("map_norm", Kind::Image), ("map_Kn", Kind::Image),
];

/// The kind of a statement, in any case.
pub(super) fn kind(word: &str) -> Option<Kind> {
    let found = WORDS.iter().find(|w| w.0.eq_ignore_ascii_case(word));
    found.map(|w| w.1)
}

/// The statement that an unknown word is most like, if any.
pub(super) fn nearest(word: &str) -> Option<&'static str> {
    let word = word.to_ascii_lowercase();
    WORDS
        .iter()
        .map(|w| (strsim::jaro_winkler(&word, &w.0.to_ascii_lowercase()), w.0))
        .filter(|(likeness, _)| *likeness > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, word)| word)
}

#[cfg(test)]
mod tests {
    use super::WORDS;

    #[test]
    fn the_manual_names_every_statement_and_whether_it_is_left_out() {
        let page = include_str!("../../../../manual/models.md");
        let table = page.split("## MTL").nth(1).unwrap();
        let table = table.split("## PLY").next().unwrap();
        let lines: Vec<&str> = table.lines().filter(|l| l.starts_with("| `")).collect();
        for (word, kind) in WORDS {
            let named = |line: &&&str| {
                let names = line.split('|').nth(1).unwrap_or_default();
                names.split('`').any(|name| name == word)
            };
            let line = lines.iter().find(named);
            let line = line.unwrap_or_else(|| panic!("{word} is not in the manual"));
            let left_out = line.split('|').nth(2).unwrap().trim() == "left out";
            assert!(
                !left_out || kind == super::Kind::LeftOut || word == "anisor",
                "{word}"
            );
            assert!(left_out || kind != super::Kind::LeftOut, "{word}");
        }
    }
}
