//! Wavefront MTL as text: statements to entries.

use crate::math::{Rgb, Vec2};
use std::collections::HashMap;

/// An image and where it is laid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// The file as written.
    pub file: String,
    /// `-s`: factor on the texture coordinates.
    pub scale: Vec2,
    /// `-o`: offset of the texture coordinates.
    pub offset: Vec2,
    /// `-clamp on`.
    pub clamp: bool,
}

/// What an MTL file says about a material.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Entry {
    /// Numbers by statement in lower case: one, or three for colours.
    pub numbers: HashMap<String, Rgb>,
    /// Images by statement in lower case.
    pub maps: HashMap<String, Map>,
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

/// All materials of an MTL file, by name. What makes no sense is skipped: the format is so old and its
/// writers are so many that nothing else would read them all.
pub(super) fn parse(text: &str) -> HashMap<String, Entry> {
    let mut entries: HashMap<String, Entry> = HashMap::new();
    let mut current = None;
    for line in text.lines() {
        let line = line.split('#').next().unwrap_or_default().trim();
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let (word, rest) = (word.to_ascii_lowercase(), rest.trim());
        if word == "newmtl" {
            current = Some(rest.to_owned());
            entries.insert(rest.to_owned(), Entry::default());
            continue;
        }
        let Some(entry) = current.as_ref().and_then(|c| entries.get_mut(c)) else {
            continue;
        };
        if word.starts_with("map_") || matches!(word.as_str(), "norm" | "bump" | "disp" | "refl") {
            if let Some(map) = map(rest) {
                entry.maps.insert(word, map);
            }
        } else if let Some(value) = value(rest) {
            entry.numbers.insert(word, value);
        }
    }
    entries
}

fn value(rest: &str) -> Option<Rgb> {
    let parse = |t: &str| t.parse::<f32>().ok().filter(|x| x.is_finite());
    let numbers: Vec<f32> = rest.split_whitespace().map_while(parse).collect();
    match *numbers.as_slice() {
        [] => None,
        [one] | [one, _] => Some(Rgb::splat(one)),
        [r, g, b, ..] => Some(Rgb::new(r, g, b)),
    }
}

/// How many words at most follow an option of a map.
fn arguments(option: &str) -> usize {
    match option {
        "-s" | "-o" | "-t" => 3,
        "-mm" => 2,
        _ => 1,
    }
}

fn map(rest: &str) -> Option<Map> {
    let mut map = Map {
        file: String::new(),
        scale: Vec2::ONE,
        offset: Vec2::ZERO,
        clamp: false,
    };
    let mut rest = rest;
    while rest.starts_with('-') {
        let (option, behind) = rest.split_once(char::is_whitespace)?;
        rest = behind.trim_start();
        let mut words = Vec::new();
        for n in 0..arguments(option) {
            let (word, behind) = rest.split_once(char::is_whitespace)?;
            // Of the three numbers only the first must be there.
            if n > 0 && word.parse::<f32>().is_err() {
                break;
            }
            words.push(word);
            rest = behind.trim_start();
        }
        let number = |i: usize| words.get(i).and_then(|w| w.parse::<f32>().ok());
        let pair = |default: f32| {
            let u = number(0).unwrap_or(default);
            Vec2::new(u, number(1).unwrap_or(default))
        };
        match option {
            "-s" => map.scale = pair(1.0),
            "-o" => map.offset = pair(0.0),
            "-clamp" => map.clamp = words.first() == Some(&"on"),
            _ => {}
        }
    }
    map.file = rest.trim().replace('\\', "/");
    (!map.file.is_empty()).then_some(map)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_belong_to_the_material_before_them() {
        let text = "# made by hand\nKd 9 9 9\nnewmtl a b\n Kd 0.1 0.2 0.3 # dark\nNs 10\n\
            newmtl c\r\nKd 0.5\r\nmap_Kd -s 2 3 1 -o 0.5 -clamp on tex\\my wood.png\r\nd x\n";
        let entries = parse(text);
        assert_eq!(entries.len(), 2);
        let a = &entries["a b"];
        assert_eq!(a.color("kd"), Some(Rgb::new(0.1, 0.2, 0.3)));
        assert_eq!(a.number("ns"), Some(10.0));
        let c = &entries["c"];
        assert_eq!(c.color("kd"), Some(Rgb::splat(0.5)));
        assert_eq!(c.number("d"), None);
        let map = c.map("map_kd").unwrap();
        assert_eq!(map.file, "tex/my wood.png");
        assert_eq!(
            (map.scale, map.offset),
            (Vec2::new(2.0, 3.0), Vec2::new(0.5, 0.0))
        );
        assert!(map.clamp);
    }
}
