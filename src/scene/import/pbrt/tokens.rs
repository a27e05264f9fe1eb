//! Text of a scene as tokens: words, quoted strings, brackets.

use super::number::decimal;
use crate::scene::import::faults::At;
use std::borrow::Cow;

/// A token.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'t> {
    /// `[`.
    Open,
    /// `]`.
    Close,
    /// What stands between quotation marks, as written.
    Quoted(&'t [u8]),
    /// A directive, a number, `true` or `false`.
    Word(&'t [u8]),
}

/// A place and what is wrong there.
#[derive(Debug)]
pub(super) struct Wrong {
    pub at: At,
    pub message: String,
}

/// Reads tokens one after the other; knows line and column.
pub(super) struct Tokens<'t> {
    text: &'t [u8],
    at: usize,
    file: usize,
    line: u32,
    line_start: usize,
    /// A token that was looked at and not taken.
    peeked: Option<(Token<'t>, At)>,
}

/// Whether a word ends before this byte.
#[inline(always)]
fn ends_word(byte: u8) -> bool {
    matches!(
        byte,
        b' ' | b'\t' | b'\n' | b'\r' | b'"' | b'[' | b']' | b'#' | 0
    )
}

/// What a message shows of a text that may be no text, or long.
pub(super) fn shown(bytes: &[u8]) -> String {
    const MOST: usize = 60;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(MOST)]);
    let rest = if bytes.len() > MOST { ".." } else { "" };
    text.chars().filter(|c| !c.is_control()).collect::<String>() + rest
}

impl<'t> Tokens<'t> {
    /// The tokens of `text`, which is file number `file`.
    pub fn new(text: &'t [u8], start: usize, file: usize) -> Self {
        Self {
            text,
            at: start,
            file,
            line: 1,
            line_start: start,
            peeked: None,
        }
    }

    /// The place of the next byte.
    pub fn place(&self) -> At {
        At {
            file: self.file,
            line: self.line,
            column: u32::try_from(self.at - self.line_start).map_or(u32::MAX, |c| c + 1),
        }
    }

    pub fn wrong(&self, at: At, message: impl Into<String>) -> Wrong {
        Wrong {
            at,
            message: message.into(),
        }
    }

    /// Skips blanks and comments.
    #[inline]
    fn skip_blanks(&mut self) {
        while let Some(&byte) = self.text.get(self.at) {
            match byte {
                b' ' | b'\t' | b'\r' | 0 => self.at += 1,
                b'\n' => {
                    self.at += 1;
                    self.line = self.line.saturating_add(1);
                    self.line_start = self.at;
                }
                b'#' => {
                    let rest = &self.text[self.at..];
                    self.at += memchr::memchr(b'\n', rest).unwrap_or(rest.len());
                }
                _ => return,
            }
        }
    }

    /// The next token, which stays the next one.
    pub fn peek(&mut self) -> Result<Option<(Token<'t>, At)>, Wrong> {
        if self.peeked.is_none() {
            self.peeked = self.read()?;
        }
        Ok(self.peeked)
    }

    /// The next token; `None` at the end.
    pub fn next(&mut self) -> Result<Option<(Token<'t>, At)>, Wrong> {
        match self.peeked.take() {
            Some(token) => Ok(Some(token)),
            None => self.read(),
        }
    }

    fn read(&mut self) -> Result<Option<(Token<'t>, At)>, Wrong> {
        self.skip_blanks();
        let place = self.place();
        let Some(&byte) = self.text.get(self.at) else {
            return Ok(None);
        };
        let token = match byte {
            b'[' => {
                self.at += 1;
                Token::Open
            }
            b']' => {
                self.at += 1;
                Token::Close
            }
            b'"' => self.quoted(place)?,
            _ => {
                let rest = &self.text[self.at..];
                let length = rest
                    .iter()
                    .position(|b| ends_word(*b))
                    .unwrap_or(rest.len());
                self.at += length;
                Token::Word(&rest[..length])
            }
        };
        Ok(Some((token, place)))
    }

    fn quoted(&mut self, place: At) -> Result<Token<'t>, Wrong> {
        self.at += 1;
        let start = self.at;
        loop {
            let rest = &self.text[self.at..];
            let Some(found) = memchr::memchr3(b'"', b'\\', b'\n', rest) else {
                self.at = self.text.len();
                return Err(self.wrong(place, "this string has no closing quotation mark"));
            };
            match rest[found] {
                b'"' => {
                    let inside = &rest[..found];
                    self.at += found + 1;
                    let end = self.at - 1;
                    debug_assert!(inside.len() <= end - start);
                    return Ok(Token::Quoted(&self.text[start..end]));
                }
                b'\\' => self.at = (self.at + found + 2).min(self.text.len()),
                _ => {
                    self.at += found;
                    let message = "this string does not end on its line";
                    return Err(self.wrong(place, message));
                }
            }
        }
    }

    /// A string that has to come next.
    pub fn string(&mut self, what: &str) -> Result<(String, At), Wrong> {
        match self.peek()? {
            Some((Token::Quoted(raw), at)) => {
                self.next()?;
                let text = unescaped(raw);
                let text = text.map_err(|message| self.wrong(at, message))?;
                Ok((text.into_owned(), at))
            }
            other => {
                let at = other.map_or_else(|| self.place(), |(_, at)| at);
                Err(self.wrong(at, format!("{what} is expected here, in quotation marks")))
            }
        }
    }

    /// A finite number that has to come next.
    pub fn number(&mut self) -> Result<f64, Wrong> {
        let next = self.peek()?;
        let at = next.map_or_else(|| self.place(), |(_, at)| at);
        let Some((Token::Word(word), _)) = next else {
            return Err(self.wrong(at, "a number is expected here"));
        };
        match decimal(word) {
            Some((value, length)) if length == word.len() && value.abs() < f64::from(f32::MAX) => {
                self.next()?;
                Ok(value)
            }
            _ => {
                let message = format!("a number is expected here, not \"{}\"", shown(word));
                Err(self.wrong(at, message))
            }
        }
    }

    /// So many numbers, with or without brackets around them.
    pub fn numbers<const N: usize>(&mut self) -> Result<[f64; N], Wrong> {
        let bracketed = matches!(self.peek()?, Some((Token::Open, _)));
        if bracketed {
            self.next()?;
        }
        let mut list = [0.0; N];
        for value in &mut list {
            *value = self.number()?;
        }
        if bracketed {
            match self.next()? {
                Some((Token::Close, _)) => {}
                other => {
                    let at = other.map_or_else(|| self.place(), |(_, at)| at);
                    return Err(
                        self.wrong(at, format!("{N} numbers and a \"]\" are expected here"))
                    );
                }
            }
        }
        Ok(list)
    }

    /// Reads numbers up to a `]`, which is taken, and gives each to `take`. `Ok(false)` where
    /// something else than a number comes first.
    #[inline]
    pub fn number_list(&mut self, mut take: impl FnMut(f64)) -> bool {
        debug_assert!(self.peeked.is_none());
        loop {
            self.skip_blanks();
            let rest = &self.text[self.at..];
            if rest.first() == Some(&b']') {
                self.at += 1;
                return true;
            }
            let Some((value, length)) = decimal(rest) else {
                return false;
            };
            if rest.get(length).is_some_and(|b| !ends_word(*b)) {
                return false;
            }
            self.at += length;
            take(value);
        }
    }
}

/// A string without its escapes.
pub(super) fn unescaped(raw: &[u8]) -> Result<Cow<'_, str>, String> {
    let text = String::from_utf8_lossy(raw);
    if !raw.contains(&b'\\') {
        return Ok(text);
    }
    let mut out = String::with_capacity(text.len());
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        if c != '\\' {
            out.push(c);
            continue;
        }
        out.push(match chars.next() {
            Some('b') => '\u{8}',
            Some('f') => '\u{c}',
            Some('n') => '\n',
            Some('r') => '\r',
            Some('t') => '\t',
            Some(c @ ('\\' | '\'' | '"')) => c,
            Some(c) => {
                return Err(format!(
                    "\"\\{c}\" stands for nothing; a backslash is written \"\\\\\""
                ));
            }
            None => return Err("a backslash stands for nothing at the end of a string".into()),
        });
    }
    Ok(Cow::Owned(out))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Vec<(Token<'_>, u32, u32)> {
        let mut tokens = Tokens::new(text.as_bytes(), 0, 0);
        let mut list = Vec::new();
        while let Some((token, at)) = tokens.next().unwrap() {
            list.push((token, at.line, at.column));
        }
        list
    }

    #[test]
    fn tokens_know_their_places() {
        let found = all("Shape \"a b\"[1 # c ]\r\n 2]x");
        assert_eq!(
            found,
            [
                (Token::Word(b"Shape"), 1, 1),
                (Token::Quoted(b"a b"), 1, 7),
                (Token::Open, 1, 12),
                (Token::Word(b"1"), 1, 13),
                (Token::Word(b"2"), 2, 2),
                (Token::Close, 2, 3),
                (Token::Word(b"x"), 2, 4),
            ]
        );
    }

    #[test]
    fn strings_have_escapes_and_end_on_their_line() {
        assert_eq!(all("\"a\\\"b\"")[0].0, Token::Quoted(b"a\\\"b"));
        assert_eq!(unescaped(b"a\\\"b\\\\\\n").unwrap(), "a\"b\\\n");
        assert!(unescaped(b"C:\\q").is_err() && unescaped(b"a\\").is_err());
        for bad in ["\"a\n\"", "\"a", "\"", "\"a\\"] {
            assert!(Tokens::new(bad.as_bytes(), 0, 0).next().is_err(), "{bad}");
        }
    }

    #[test]
    fn lists_end_at_their_bracket_or_at_what_is_no_number() {
        let mut sum = 0.0;
        let mut tokens = Tokens::new(b" 1\n2 # 3\n 4] 5", 0, 0);
        assert!(tokens.number_list(|x| sum += x));
        assert_eq!((sum, tokens.number().unwrap()), (7.0, 5.0));
        let mut tokens = Tokens::new(b" 1 2x]", 0, 0);
        assert!(!tokens.number_list(|_| {}));
    }
}
