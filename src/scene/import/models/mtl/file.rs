//! Wavefront MTL as text: statements to entries.
//!
//! What makes no sense is left out and told: the format is so old and its writers are so many that
//! nothing stricter would read them all.

use super::map::{self, Map};
use super::words::{self, Kind};
use crate::math::Rgb;
use crate::scene::import::encoding;
use rustc_hash::FxHashMap;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// What an MTL file says about a material.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Entry {
    /// The MTL file.
    pub file: PathBuf,
    /// Where the material begins: its line, from 1.
    pub line: usize,
    /// Numbers by statement in lower case: one, or three for colours.
    numbers: HashMap<String, Rgb>,
    /// Images by statement in lower case.
    maps: HashMap<String, Map>,
}

impl Entry {
    /// A colour.
    pub fn color(&self, name: &str) -> Option<Rgb> {
        self.numbers.get(name).copied()
    }

    /// A number.
    pub fn number(&self, name: &str) -> Option<f32> {
        self.color(name).map(|c| c.x)
    }

    /// An image.
    pub fn map(&self, name: &str) -> Option<&Map> {
        self.maps.get(name)
    }
}

/// An MTL file.
#[derive(Debug, Default)]
pub(super) struct MtlFile {
    /// Its materials by name.
    pub entries: HashMap<String, Entry>,
    /// What was odd, a line for each kind, with where it was first.
    pub warnings: Vec<String>,
}

/// Reads the bytes of the file `path`.
pub(super) fn parse(bytes: &[u8], path: &Path) -> MtlFile {
    let mut reader = Reader::new(path);
    if let Some(wrong) = encoding::wide(bytes) {
        reader.tell("", wrong.into());
        return reader.finish();
    }
    let bytes = encoding::lines(&bytes[encoding::start(bytes)..]);
    let text = String::from_utf8_lossy(&bytes);
    let mut whole = String::new();
    for line in text.lines() {
        reader.line += 1;
        let line = line.trim();
        if let Some(continued) = line.strip_suffix('\\') {
            whole.push_str(continued);
            whole.push(' ');
            continue;
        }
        if whole.is_empty() {
            reader.statement(line);
            continue;
        }
        whole.push_str(line);
        reader.statement(&std::mem::take(&mut whole));
    }
    reader.statement(&whole);
    reader.finish()
}

/// The line without its comment: a `#` begins one at the start and behind a blank.
fn without_comment(line: &str) -> &str {
    let mut before = ' ';
    for (at, c) in line.char_indices() {
        if c == '#' && before.is_whitespace() {
            return line[..at].trim();
        }
        before = c;
    }
    line.trim()
}

/// Something told, and how often more.
struct Told {
    message: String,
    more: usize,
}

/// What Blender (4 and 5) writes as `Pc` of a whole coat.
const BLENDERS_COAT: f32 = 4.0;

struct Reader<'a> {
    path: &'a Path,
    line: usize,
    entries: HashMap<String, Entry>,
    current: Option<String>,
    /// Blender wrote the file.
    blender: bool,
    told: Vec<Told>,
    known: FxHashMap<String, usize>,
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path) -> Self {
        Self {
            path,
            line: 0,
            entries: HashMap::new(),
            current: None,
            blender: false,
            told: Vec::new(),
            known: FxHashMap::default(),
        }
    }

    /// Notes a warning with its place; another one of the same `kind` is counted alone.
    fn tell(&mut self, kind: &str, message: String) {
        if let Some(&at) = self.known.get(kind) {
            self.told[at].more += 1;
            return;
        }
        self.known.insert(kind.to_owned(), self.told.len());
        let message = format!("{}:{}: {message}", self.path.display(), self.line.max(1));
        self.told.push(Told { message, more: 0 });
    }

    fn statement(&mut self, line: &str) {
        self.blender |= line.starts_with("# Blender") && line.contains("MTL File");
        let line = without_comment(line);
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if word.is_empty() {
            return;
        }
        if word.eq_ignore_ascii_case("newmtl") {
            return self.begin(rest);
        }
        if self.current.is_none() {
            let message = format!("`{word}` stands before the first `newmtl` and is left out");
            return self.tell("before", message);
        }
        match words::kind(word) {
            Some(Kind::Image) => self.image(word, rest),
            Some(Kind::Color(least, most)) => self.value(word, rest, 3, [least, most]),
            Some(Kind::Number(least, most)) => self.value(word, rest, 1, [least, most]),
            Some(Kind::LeftOut) => self.tell(word, format!("`{word}` is not read and left out")),
            Some(Kind::Harmless) => {}
            None => self.unknown(word),
        }
    }

    fn begin(&mut self, name: &str) {
        let entry = Entry {
            file: self.path.to_owned(),
            line: self.line,
            ..Entry::default()
        };
        if self.entries.insert(name.to_owned(), entry).is_some() {
            let message = format!("material \"{name}\" stands here again: the last one counts");
            self.tell("again", message);
        }
        self.current = Some(name.to_owned());
    }

    fn entry(&mut self) -> Option<&mut Entry> {
        self.entries.get_mut(self.current.as_ref()?)
    }

    fn unknown(&mut self, word: &str) {
        let shown: String = word.chars().take(40).collect();
        let hint =
            words::nearest(&shown).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
        let shown = shown.escape_debug();
        self.tell(
            &word.to_ascii_lowercase(),
            format!("`{shown}` is no statement of MTL and is left out{hint}"),
        );
    }

    fn image(&mut self, word: &str, rest: &str) {
        let mut told = Vec::new();
        let map = map::read(rest, &mut |message| told.push(message));
        for message in told {
            self.tell(&message.clone(), format!("{word}: {message}"));
        }
        let word = match word.to_ascii_lowercase().as_str() {
            "map_norm" | "map_kn" => "norm".to_owned(),
            "bump" => "map_bump".to_owned(),
            word => word.to_owned(),
        };
        if let (Some(map), Some(entry)) = (map, self.entry()) {
            entry.maps.insert(word, map);
        }
    }

    fn value(&mut self, word: &str, rest: &str, count: usize, [least, most]: [f32; 2]) {
        let mut words = rest.split_whitespace();
        if rest.starts_with("-halo") {
            words.next();
            self.tell(
                "-halo",
                format!("`{word} -halo` is left out: it is the same at all angles"),
            );
        }
        let color = match map::numbers(words).as_deref() {
            Ok([one]) => Rgb::splat(*one),
            Ok([r, g, b]) if count == 3 => Rgb::new(*r, *g, *b),
            Ok(_) => {
                let message = match count {
                    3 => format!("`{word} {rest}`: one number or three are expected"),
                    _ => format!("`{word} {rest}`: one number is expected"),
                };
                return self.tell(
                    &format!("{word} count"),
                    format!("{message}; it is left out"),
                );
            }
            Err(odd) => {
                let odd = odd.escape_debug();
                let message = format!("{word}: `{odd}` is no number; the statement is left out");
                return self.tell(&format!("{word} number"), message);
            }
        };
        let whole = if self.blender && word == "Pc" {
            BLENDERS_COAT
        } else {
            1.0
        };
        let color = color / whole;
        let within = color.clamp(Rgb::splat(least), Rgb::splat(most));
        if within != color {
            let bounds = match most {
                f32::MAX => format!("{least} or more"),
                _ => format!("{least} to {most}"),
            };
            let message =
                format!("`{word} {rest}` is out of range: the nearest of {bounds} instead");
            self.tell(&format!("{word} range"), message);
        }
        let word = word.to_ascii_lowercase();
        if let Some(entry) = self.entry() {
            entry.numbers.insert(word, within);
        }
    }

    fn finish(self) -> MtlFile {
        let whole = |told: Told| match told.more {
            0 => told.message,
            more => format!("{} (and {more} more like it)", told.message),
        };
        MtlFile {
            entries: self.entries,
            warnings: self.told.into_iter().map(whole).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;

    fn read(text: &str) -> MtlFile {
        parse(text.as_bytes(), Path::new("a.mtl"))
    }

    #[test]
    fn statements_belong_to_the_material_before_them() {
        let text = "# made by hand\nnewmtl a b\n Kd 0.1 0.2 0.3 # dark\nNs 10\n\
            newmtl c\r\nKd 0.5\r\nmap_Kd -s 2 3 1 -o 0.5 -clamp on tex\\my wood#2.png\r\n";
        for text in [
            text.to_owned(),
            format!("\u{feff}{text}"),
            text.replace("\r\n", "\n").replace('\n', "\r"),
            text.replace("0.1 0.2", "0.1\\\n0.2")
                .replace("-o 0.5", "\\  \n -o 0.5"),
        ] {
            let MtlFile { entries, warnings } = read(&text);
            assert_eq!(warnings, Vec::<String>::new(), "{text}");
            assert_eq!(entries.len(), 2);
            let a = &entries["a b"];
            assert_eq!(a.color("kd"), Some(Rgb::new(0.1, 0.2, 0.3)));
            assert_eq!(a.number("ns"), Some(10.0));
            let c = &entries["c"];
            assert_eq!(c.color("kd"), Some(Rgb::splat(0.5)));
            let map = c.map("map_kd").unwrap();
            assert_eq!(map.file, "tex\\my wood#2.png");
            assert_eq!(
                (map.scale, map.offset),
                (Vec2::new(2.0, 3.0), Vec2::new(0.5, 0.0))
            );
            assert!(map.clamp);
        }
    }

    #[test]
    fn a_coat_by_blender_is_a_quarter_of_its_number() {
        let coat = |head: &str, number: f32| {
            let file = read(&format!("{head}newmtl a\nPc {number}\n"));
            assert_eq!(file.warnings, Vec::<String>::new());
            file.entries["a"].number("pc")
        };
        let head = "# Blender 5.0.1 MTL File: 'scene.blend'\n# www.blender.org\n";
        assert_eq!((coat(head, 4.0), coat(head, 2.0)), (Some(1.0), Some(0.5)));
        assert_eq!(coat("# by hand\n", 0.5), Some(0.5));
    }

    /// Each line by itself: what is told of it, and what remains.
    #[test]
    fn odd_statements_are_told_with_their_line() {
        for (line, word) in [
            ("Kd red", "`red` is no number"),
            ("Kd 0,8 0,1 0,1", "`0,8` is no number"),
            ("Kd nan", "no number"),
            ("Kd 0.8 0.1", "one number or three"),
            ("Ns 10 20", "one number is expected"),
            ("Kd", "one number or three"),
            ("Kd spectral a.rfl", "`spectral` is no number"),
            ("Kd 2 0 0", "out of range"),
            ("Kd -0.5", "out of range"),
            ("Ke -1", "0 or more"),
            ("d 1.5", "0 to 1"),
            ("illum 11", "0 to 10"),
            ("Pr 7", "0 to 1"),
            ("Kdd 1 1 1", "did you mean `Kd`?"),
            ("mapKd a.png", "did you mean `map_Kd`?"),
            ("map_Ks a.png", "left out"),
            ("disp a.png", "left out"),
            ("d -halo 0.5", "-halo"),
            ("map_Kd", "no name"),
            ("map_Kd -s 2", "makes no sense"),
            ("map_Kd -s two a.png", "makes no sense"),
            ("map_Kd -cc on a.png", "left out"),
            ("map_Kd -warp 1 a.png", "no option"),
        ] {
            let warnings = read(&format!("newmtl m\n{line}\n")).warnings;
            assert_eq!(warnings.len(), 1, "{line}: {warnings:?}");
            let told = &warnings[0];
            assert!(
                told.starts_with("a.mtl:2: ") && told.contains(word),
                "{told}"
            );
        }
        let one = read("newmtl m\nKd 2 0 0.5\nd -halo 0.5\n").entries;
        assert_eq!(one["m"].color("kd"), Some(Rgb::new(1.0, 0.0, 0.5)));
        assert_eq!(one["m"].number("d"), Some(0.5));
        assert!(read("Kd 1\nnewmtl a\nnewmtl a\n").warnings.len() == 2);
    }

    #[test]
    fn the_same_fault_a_thousand_times_is_one_line() {
        let warnings = read(&"newmtl m\nKdd 1\n".repeat(1000)).warnings;
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(
            warnings[0].ends_with("(and 999 more like it)"),
            "{warnings:?}"
        );
    }

    #[test]
    fn values_of_images_are_stretched_and_taken_of_one_channel() {
        let text = "newmtl m\nmap_Pr -mm 0.25 0.5 -imfchan g a.png\nmap_Kn -bm 2 n.png\n";
        let MtlFile { entries, warnings } = read(text);
        assert_eq!(warnings, Vec::<String>::new());
        let map = entries["m"].map("map_pr").unwrap();
        assert_eq!((map.range, map.channel), ([0.25, 0.5], Some("g")));
        assert_eq!(entries["m"].map("norm").unwrap().file, "n.png");
    }
}
