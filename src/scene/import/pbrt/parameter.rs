//! Parameters: `"type name" value` or `"type name" [ values ]`.

use super::tokens::{Token, Tokens, Wrong, shown, unescaped};
use crate::scene::import::faults::At;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a parameter's type says of its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Whole numbers.
    Integer,
    /// Numbers.
    Float,
    /// Pairs: `point2`, `vector2`.
    Pair,
    /// Triples: `point3`, `vector3`, `normal`, and v3's `point` and `vector`.
    Triple,
    /// `rgb`, v3's `color`.
    Rgb,
    /// v3's `xyz`.
    Xyz,
    /// A temperature in kelvin.
    Blackbody,
    /// Wavelengths and values, or names.
    Spectrum,
    /// `true` or `false`.
    Bool,
    /// Text.
    Text,
    /// The name of a texture.
    Texture,
}

/// Every type by its name.
pub(super) const KINDS: &[(&str, Kind)] = &[
    ("integer", Kind::Integer),
    ("float", Kind::Float),
    ("point2", Kind::Pair),
    ("vector2", Kind::Pair),
    ("point3", Kind::Triple),
    ("point", Kind::Triple),
    ("vector3", Kind::Triple),
    ("vector", Kind::Triple),
    ("normal3", Kind::Triple),
    ("normal", Kind::Triple),
    ("rgb", Kind::Rgb),
    ("color", Kind::Rgb),
    ("xyz", Kind::Xyz),
    ("blackbody", Kind::Blackbody),
    ("spectrum", Kind::Spectrum),
    ("bool", Kind::Bool),
    ("string", Kind::Text),
    ("texture", Kind::Texture),
];

/// Values.
#[derive(Debug, PartialEq)]
pub(super) enum Values {
    Integers(Vec<i32>),
    Floats(Vec<f32>),
    Texts(Vec<String>),
    Bools(Vec<bool>),
}

impl Values {
    /// Words for messages.
    pub fn described(&self) -> &'static str {
        match self {
            Self::Integers(_) => "whole numbers",
            Self::Floats(_) => "numbers",
            Self::Texts(_) => "strings",
            Self::Bools(_) => "true or false",
        }
    }

    pub fn len(&self) -> usize {
        match self {
            Self::Integers(list) => list.len(),
            Self::Floats(list) => list.len(),
            Self::Texts(list) => list.len(),
            Self::Bools(list) => list.len(),
        }
    }
}

/// A parameter.
#[derive(Debug)]
pub(super) struct Parameter {
    pub kind: Kind,
    pub name: Box<str>,
    pub at: At,
    pub values: Values,
    /// Something asked for it.
    used: AtomicBool,
}

impl Parameter {
    pub fn is_used(&self) -> bool {
        self.used.load(Ordering::Relaxed)
    }

    pub fn set_used(&self) {
        self.used.store(true, Ordering::Relaxed);
    }
}

/// Parameters of one directive: they are looked for one by one.
const MOST_PARAMETERS: usize = 1000;

/// All parameters that come next.
pub(super) fn list(tokens: &mut Tokens) -> Result<Vec<Parameter>, Wrong> {
    let mut list = Vec::new();
    while let Some((Token::Quoted(raw), at)) = tokens.peek()? {
        if list.len() >= MOST_PARAMETERS {
            let message = format!("more than {MOST_PARAMETERS} parameters");
            return Err(tokens.wrong(at, message));
        }
        tokens.next()?;
        list.push(parameter(tokens, raw, at)?);
    }
    list.shrink_to_fit();
    Ok(list)
}

fn parameter(tokens: &mut Tokens, raw: &[u8], at: At) -> Result<Parameter, Wrong> {
    let declared = unescaped(raw).map_err(|message| tokens.wrong(at, message))?;
    let mut words = declared.split_whitespace();
    let (Some(word), Some(name), None) = (words.next(), words.next(), words.next()) else {
        let message = format!(
            "\"{}\" declares no parameter; one is declared as in \"float radius\"",
            shown(raw)
        );
        return Err(tokens.wrong(at, message));
    };
    let Some((_, kind)) = KINDS.iter().find(|(known, _)| *known == word) else {
        let known = KINDS.iter().map(|(known, _)| *known);
        let help = crate::scene::import::named::did_you_mean(word, known);
        let help = help.map_or(String::new(), |h| format!("; {h}"));
        let message = format!("there is no type \"{word}\" of parameters{help}");
        return Err(tokens.wrong(at, message));
    };
    Ok(Parameter {
        kind: *kind,
        name: name.into(),
        at,
        values: values(tokens, *kind)?,
        used: AtomicBool::new(false),
    })
}

/// The values behind a declaration.
fn values(tokens: &mut Tokens, kind: Kind) -> Result<Values, Wrong> {
    let Some((Token::Open, _)) = tokens.peek()? else {
        let mut collected = Collected::new(kind);
        let (token, at) = required(tokens)?;
        collected.add(tokens, token, at)?;
        return Ok(collected.finish());
    };
    tokens.next()?;
    if let Some(list) = fast(tokens, kind)? {
        return Ok(list);
    }
    let mut collected = Collected::new(kind);
    loop {
        match required(tokens)? {
            (Token::Close, _) => return Ok(collected.finish()),
            (token, at) => collected.add(tokens, token, at)?,
        }
    }
}

/// Lists of numbers, most of what files are made of: no token each. `None` where the list is of
/// something else.
fn fast(tokens: &mut Tokens, kind: Kind) -> Result<Option<Values>, Wrong> {
    let begin = tokens.place();
    let complete;
    let list = match kind {
        Kind::Bool | Kind::Text | Kind::Texture => return Ok(None),
        Kind::Integer => {
            let (mut list, mut whole) = (Vec::new(), true);
            complete = tokens.number_list(|x| {
                whole &= x.fract() == 0.0 && x.abs() <= f64::from(i32::MAX);
                list.push(x as i32);
            });
            if !whole {
                let message = "this list is of whole numbers between -2147483647 and 2147483647, \
                    and one of it is none";
                return Err(tokens.wrong(begin, message));
            }
            Values::Integers(shrunk(list))
        }
        _ => {
            let (mut list, mut finite) = (Vec::new(), true);
            complete = tokens.number_list(|x| {
                let x = x as f32;
                finite &= x.is_finite();
                list.push(x);
            });
            if !finite {
                let message = "a number of this list is beyond 3.4e38";
                return Err(tokens.wrong(begin, message));
            }
            Values::Floats(shrunk(list))
        }
    };
    if complete {
        return Ok(Some(list));
    }
    if list.len() > 0 || !matches!(kind, Kind::Spectrum) {
        let (token, at) = required(tokens)?;
        let message = match token {
            Token::Word(word) => format!("a number is expected here, not \"{}\"", shown(word)),
            Token::Quoted(word) => {
                format!(
                    "a number is expected here, not the string \"{}\"",
                    shown(word)
                )
            }
            Token::Open | Token::Close => "a number is expected here, not a bracket".into(),
        };
        return Err(tokens.wrong(at, message));
    }
    Ok(None)
}

/// A list that takes no more memory than it needs.
fn shrunk<T>(mut list: Vec<T>) -> Vec<T> {
    list.shrink_to_fit();
    list
}

fn required<'t>(tokens: &mut Tokens<'t>) -> Result<(Token<'t>, At), Wrong> {
    match tokens.next()? {
        Some(token) => Ok(token),
        None => Err(tokens.wrong(tokens.place(), "the file ends where a value is expected")),
    }
}

/// Values that are being collected one by one.
struct Collected {
    values: Values,
    kind: Kind,
}

impl Collected {
    fn new(kind: Kind) -> Self {
        let values = match kind {
            Kind::Integer => Values::Integers(Vec::new()),
            Kind::Bool => Values::Bools(Vec::new()),
            Kind::Text | Kind::Texture => Values::Texts(Vec::new()),
            _ => Values::Floats(Vec::new()),
        };
        Self { values, kind }
    }

    fn finish(self) -> Values {
        self.values
    }

    fn add(&mut self, tokens: &Tokens, token: Token, at: At) -> Result<(), Wrong> {
        let wrong = |expected: &str, found: &str| {
            let message = format!("{expected} is expected here, not {found}");
            Err(tokens.wrong(at, message))
        };
        match (&mut self.values, token) {
            (_, Token::Open | Token::Close) => wrong("a value", "a bracket"),
            (Values::Texts(list), Token::Quoted(raw)) => {
                let text = unescaped(raw).map_err(|message| tokens.wrong(at, message))?;
                list.push(text.into_owned());
                Ok(())
            }
            // v3 writes "true" and "false" in quotation marks.
            (Values::Bools(list), Token::Quoted(word) | Token::Word(word)) => match word {
                b"true" => {
                    list.push(true);
                    Ok(())
                }
                b"false" => {
                    list.push(false);
                    Ok(())
                }
                other => wrong("true or false", &format!("\"{}\"", shown(other))),
            },
            (Values::Floats(list), Token::Quoted(raw))
                if self.kind == Kind::Spectrum && list.is_empty() =>
            {
                let text = unescaped(raw).map_err(|message| tokens.wrong(at, message))?;
                self.values = Values::Texts(vec![text.into_owned()]);
                Ok(())
            }
            (Values::Floats(list), Token::Word(word)) => match whole(word) {
                Some(x) if (x as f32).is_finite() => {
                    list.push(x as f32);
                    Ok(())
                }
                _ => wrong("a number", &format!("\"{}\"", shown(word))),
            },
            (Values::Integers(list), Token::Word(word)) => match whole(word) {
                Some(x) if x.fract() == 0.0 && x.abs() <= f64::from(i32::MAX) => {
                    list.push(x as i32);
                    Ok(())
                }
                _ => wrong("a whole number", &format!("\"{}\"", shown(word))),
            },
            (_, Token::Quoted(word)) => wrong("a number", &format!("\"{}\"", shown(word))),
            (_, Token::Word(word)) => wrong(
                "a string in quotation marks",
                &format!("\"{}\"", shown(word)),
            ),
        }
    }
}

/// The number that a whole word is.
fn whole(word: &[u8]) -> Option<f64> {
    let (value, length) = super::number::decimal(word)?;
    (length == word.len()).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Vec<Parameter>, Wrong> {
        list(&mut Tokens::new(text.as_bytes(), 0, 0))
    }

    fn one(text: &str) -> Values {
        let mut list = parse(text).unwrap_or_else(|e| panic!("{text}: {}", e.message));
        assert_eq!(list.len(), 1, "{text}");
        list.remove(0).values
    }

    #[test]
    fn values_stand_alone_or_in_brackets() {
        assert_eq!(one("\"float x\" 1.5"), Values::Floats(vec![1.5]));
        assert_eq!(
            one("\"  float   x \" [1 2 -3e1]"),
            Values::Floats(vec![1.0, 2.0, -30.0])
        );
        assert_eq!(one("\"integer x\" [ 7 ]"), Values::Integers(vec![7]));
        assert_eq!(one("\"bool x\" true"), Values::Bools(vec![true]));
        assert_eq!(one("\"bool x\" [\"false\"]"), Values::Bools(vec![false]));
        assert_eq!(one("\"string x\" \"a\""), Values::Texts(vec!["a".into()]));
        assert_eq!(
            one("\"spectrum x\" \"metal-Au-eta\""),
            Values::Texts(vec!["metal-Au-eta".into()])
        );
        assert_eq!(
            one("\"spectrum x\" [\"a.spd\"]"),
            Values::Texts(vec!["a.spd".into()])
        );
        assert_eq!(
            one("\"spectrum x\" [400 1]"),
            Values::Floats(vec![400.0, 1.0])
        );
        assert_eq!(one("\"float x\" []"), Values::Floats(vec![]));
        assert_eq!(
            parse("\"float a\" 1\n\"rgb b\" [1 1 1] Shape")
                .unwrap()
                .len(),
            2
        );
    }

    #[test]
    fn what_is_wrong_is_named_at_its_place() {
        for (text, part, column) in [
            ("\"flot x\" 1", "did you mean \"float\"", 1),
            ("\"float\" 1", "declares no parameter", 1),
            ("\"float x\" \"1\"", "a number is expected", 11),
            ("\"float x\" [1 x]", "not \"x\"", 14),
            ("\"float x\" [1", "the file ends", 13),
            ("\"float x\"", "the file ends", 10),
            ("\"integer x\" 1.5", "whole number", 13),
            ("\"integer x\" [1 1e10]", "whole numbers", 14),
            ("\"float x\" 1e39", "number", 11),
            ("\"float x\" [1e39]", "3.4e38", 12),
            ("\"float x\" nan", "not \"nan\"", 11),
            ("\"bool x\" 1", "true or false", 10),
            ("\"string x\" 1", "quotation marks", 12),
            ("\"float x\" [[1]]", "bracket", 12),
        ] {
            let wrong = parse(text).err().unwrap_or_else(|| panic!("{text}"));
            assert!(wrong.message.contains(part), "{text}: {}", wrong.message);
            assert_eq!(wrong.at.column, column, "{text}: {}", wrong.message);
        }
    }
}
