//! An image in MTL: its options and its name.

use crate::math::Vec2;
use std::str::SplitWhitespace;

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
    /// `-mm`: what is added to the values, and the factor on them before.
    pub range: [f32; 2],
    /// `-imfchan`: the one channel that is taken.
    pub channel: Option<&'static str>,
    /// `-bm`: how strong a map of bumps or normals is.
    pub strength: f32,
}

impl Default for Map {
    fn default() -> Self {
        Self {
            file: String::new(),
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
            clamp: false,
            range: [0.0, 1.0],
            channel: None,
            strength: 1.0,
        }
    }
}

/// How many words at least and at most follow an option.
fn arguments(option: &str) -> Option<(usize, usize)> {
    Some(match option {
        "-s" | "-o" | "-t" => (1, 3),
        "-mm" => (2, 2),
        "-clamp" | "-imfchan" | "-blendu" | "-blendv" | "-cc" | "-bm" | "-boost" | "-texres"
        | "-type" => (1, 1),
        _ => return None,
    })
}

fn number(word: &str) -> Option<f32> {
    word.parse().ok().filter(|x: &f32| x.is_finite())
}

/// Takes the first word of `rest`.
fn take<'a>(rest: &mut &'a str) -> Option<&'a str> {
    let (word, behind) = rest.split_once(char::is_whitespace)?;
    *rest = behind.trim_start();
    Some(word)
}

/// Reads what stands behind the statement's word; `tell` hears what is wrong or left out.
pub(super) fn read(mut rest: &str, tell: &mut impl FnMut(String)) -> Option<Map> {
    let mut map = Map::default();
    while rest.starts_with('-') {
        let mut ahead = rest;
        let Some(option) = take(&mut ahead) else {
            break;
        };
        let known = arguments(option);
        let (least, most) = known.unwrap_or((1, 1));
        rest = ahead;
        let mut words = Vec::new();
        while words.len() < most {
            let mut ahead = rest;
            let word = take(&mut ahead);
            // Of three numbers only the first must be there.
            let Some(word) = word.filter(|w| words.len() < least || number(w).is_some()) else {
                break;
            };
            words.push(word);
            rest = ahead;
        }
        let applied = match known {
            Some(_) => map.apply(option, &words),
            None => Err(format!("`{option}` is no option of an image")),
        };
        if let Err(why) = applied {
            tell(why);
        }
    }
    map.file = rest.trim().to_owned();
    if map.file.is_empty() {
        tell("the image has no name".into());
        return None;
    }
    Some(map)
}

impl Map {
    fn apply(&mut self, option: &str, words: &[&str]) -> Result<(), String> {
        let numbers: Vec<f32> = words.iter().filter_map(|w| number(w)).collect();
        let wrong = || format!("`{option} {}` makes no sense", words.join(" "));
        let pair = |default: f32| match *numbers.as_slice() {
            [] => Err(wrong()),
            [u] => Ok(Vec2::new(u, default)),
            [u, v, ..] => Ok(Vec2::new(u, v)),
        };
        let word = words.first().map(|w| w.to_ascii_lowercase());
        let word = word.as_deref().unwrap_or_default();
        match (option, word) {
            ("-s", _) => self.scale = pair(1.0)?,
            ("-o", _) => self.offset = pair(0.0)?,
            ("-mm", _) => {
                let range = numbers.first_chunk::<2>();
                self.range = *range.ok_or_else(wrong)?;
            }
            ("-bm", _) => self.strength = *numbers.first().ok_or_else(wrong)?,
            ("-clamp", "on") => self.clamp = true,
            ("-imfchan", "r") => self.channel = Some("r"),
            ("-imfchan", "g") => self.channel = Some("g"),
            ("-imfchan", "b") => self.channel = Some("b"),
            ("-imfchan", "m") => self.channel = Some("a"),
            // What is so anyway, or changes how an image is filtered alone.
            ("-clamp" | "-cc", "off") | ("-imfchan", "l") => {}
            ("-blendu" | "-blendv", "on" | "off") | ("-boost" | "-texres", _) => {}
            ("-t" | "-cc" | "-type" | "-imfchan", _) => {
                return Err(format!("`{option} {word}` of an image is left out"));
            }
            _ => return Err(wrong()),
        }
        Ok(())
    }
}

/// Numbers of a statement: all of them, or the first word that is none.
pub(super) fn numbers(words: SplitWhitespace) -> Result<Vec<f32>, String> {
    words
        .map(|w| number(w).ok_or_else(|| w.to_owned()))
        .collect()
}
