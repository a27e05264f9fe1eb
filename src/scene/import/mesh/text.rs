//! A cursor over text: words and numbers, each with its place in the file.
//!
//! Numbers take Clinger's fast path: up to 2^53 in the digits and a power of ten up to 22 are both
//! exact in `f64`, so one multiplication or division rounds correctly. All else goes to the
//! standard library, so the value is always the closest `f64`.

use super::Fault;
use crate::scene::import::Location;
use std::path::Path;

/// Line and column of a byte.
pub(super) fn location(data: &[u8], offset: usize, path: &Path) -> Location {
    let before = &data[..offset.min(data.len())];
    let line_start = before
        .iter()
        .rposition(|&b| b == b'\n')
        .map_or(0, |at| at + 1);
    let lines = before.iter().filter(|&&b| b == b'\n').count();
    let clamp = |n: usize| u32::try_from(n + 1).unwrap_or(u32::MAX);
    Location {
        file: path.to_owned(),
        line: clamp(lines),
        column: clamp(before.len() - line_start),
    }
}

/// The line of a byte, from 1.
pub(super) fn line_of(data: &[u8], offset: usize) -> usize {
    memchr::memchr_iter(b'\n', &data[..offset.min(data.len())]).count() + 1
}

const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// A place in a text.
#[derive(Clone)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    pos: usize,
}

impl<'a> Cursor<'a> {
    /// At byte `pos` of `bytes`.
    pub fn new(bytes: &'a [u8], pos: usize) -> Self {
        Self { bytes, pos }
    }

    /// Where it is.
    #[inline]
    pub fn offset(&self) -> usize {
        self.pos
    }

    /// The byte under the cursor.
    #[inline]
    pub fn peek(&self) -> Option<u8> {
        self.bytes.get(self.pos).copied()
    }

    /// Goes on by one byte.
    #[inline]
    pub fn step(&mut self) {
        self.pos += 1;
    }

    /// Over blanks, and over line ends that a backslash continues.
    #[inline]
    pub fn skip_blanks(&mut self) {
        loop {
            match self.peek() {
                Some(b) if is_blank(b) => self.pos += 1,
                Some(b'\\') => match self.continuation() {
                    Some(next) => self.pos = next,
                    None => return,
                },
                _ => return,
            }
        }
    }

    /// Over blanks and line ends.
    pub fn skip_white(&mut self) {
        while self.peek().is_some_and(|b| b.is_ascii_whitespace()) {
            self.pos += 1;
        }
    }

    /// The byte behind the line end that the backslash under the cursor continues. Blanks between
    /// the two are forgiven.
    fn continuation(&self) -> Option<usize> {
        let rest = self.bytes.get(self.pos + 1..)?;
        let blanks = rest.iter().take_while(|b| is_blank(**b)).count();
        (rest.get(blanks) == Some(&b'\n')).then_some(self.pos + blanks + 2)
    }

    /// Whether the word before the cursor ends here: at a blank, a line end or a continued line.
    #[inline]
    pub fn at_word_end(&self) -> bool {
        match self.peek() {
            None => true,
            Some(b'\\') => self.continuation().is_some(),
            Some(b) => b.is_ascii_whitespace(),
        }
    }

    /// Whether the line has nothing more (a comment counts as nothing).
    #[inline]
    pub fn at_line_end(&self) -> bool {
        matches!(self.peek(), None | Some(b'\n' | b'#'))
    }

    /// Whether the text has nothing more.
    pub fn at_end(&self) -> bool {
        self.pos >= self.bytes.len()
    }

    /// To the start of the next line. Continued lines count as one, comments too.
    pub fn next_line(&mut self) {
        loop {
            let rest = self.bytes.get(self.pos..).unwrap_or_default();
            let Some(end) = memchr::memchr(b'\n', rest) else {
                self.pos = self.bytes.len();
                return;
            };
            let line = &rest[..end];
            self.pos += end + 1;
            if !is_continued(line) {
                return;
            }
        }
    }

    /// The bytes up to the next blank or line end; empty at the end of a line.
    #[inline]
    pub fn word(&mut self) -> &'a [u8] {
        let start = self.pos;
        while self
            .peek()
            .is_some_and(|b| !b.is_ascii_whitespace() && b != b'\\')
        {
            self.pos += 1;
        }
        // Backslashes inside of words are rare: names of files from Windows.
        while !self.at_word_end() {
            self.pos += 1;
        }
        self.bytes.get(start..self.pos).unwrap_or_default()
    }

    /// What is left of the line as it stands; no backslash continues it.
    pub fn line(&self) -> &'a [u8] {
        let rest = self.bytes.get(self.pos..).unwrap_or_default();
        let end = rest.iter().position(|b| matches!(b, b'\n' | b'\r'));
        &rest[..end.unwrap_or(rest.len())]
    }

    /// What is left of the line without the blanks around it; continued lines are joined by a
    /// blank. A comment begins at a `#` behind a blank.
    pub fn rest_of_line(&mut self) -> Vec<u8> {
        self.skip_blanks();
        let (mut rest, mut kept) = (Vec::new(), 0);
        while !self.at_line_end() {
            rest.extend(self.word());
            kept = rest.len();
            let blanks = self.pos;
            self.skip_blanks();
            match self.bytes.get(blanks..self.pos) {
                Some(between) if !between.contains(&b'\n') => rest.extend(between),
                _ => rest.push(b' '),
            }
        }
        rest.truncate(kept);
        rest
    }

    /// The word under the cursor, for messages.
    fn shown(&self) -> String {
        let word = self.clone().word();
        if word.is_empty() {
            return "the end of the line".into();
        }
        let text = String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned();
        format!("`{}`", text.escape_debug())
    }

    #[inline]
    fn digits(&self, mut at: usize, value: &mut u64) -> usize {
        while let Some(d) = self.bytes.get(at).map(|b| b.wrapping_sub(b'0')) {
            if d > 9 {
                break;
            }
            *value = value.wrapping_mul(10).wrapping_add(u64::from(d));
            at += 1;
        }
        at
    }

    /// A signed whole number, ended by anything that is not a digit.
    #[inline]
    pub fn integer(&mut self) -> Result<i64, Fault> {
        let negative = self.peek() == Some(b'-');
        let start = self.pos + usize::from(matches!(self.peek(), Some(b'-' | b'+')));
        let mut value = 0;
        let end = self.digits(start, &mut value);
        if end == start || end - start > 18 {
            let message = format!("a whole number was expected, not {}", self.shown());
            return Err(Fault::new(self.pos, message));
        }
        self.pos = end;
        // At most 18 digits: below 2^63.
        Ok(if negative {
            -(value as i64)
        } else {
            value as i64
        })
    }

    /// A number, ended by a blank or a line end.
    #[inline]
    pub fn number(&mut self) -> Result<f64, Fault> {
        if let Some((value, end)) = self.short_number() {
            self.pos = end;
            return Ok(value);
        }
        self.long_number()
    }

    /// Clinger's fast path, where it holds.
    #[inline]
    fn short_number(&self) -> Option<(f64, usize)> {
        let negative = self.peek() == Some(b'-');
        let start = self.pos + usize::from(matches!(self.peek(), Some(b'-' | b'+')));
        let mut mantissa = 0;
        let mut end = self.digits(start, &mut mantissa);
        let mut count = end - start;
        let mut exponent = 0i64;
        if self.bytes.get(end) == Some(&b'.') {
            let fraction = end + 1;
            end = self.digits(fraction, &mut mantissa);
            count += end - fraction;
            exponent = -((end - fraction) as i64);
        }
        if count == 0 || count > 19 {
            return None;
        }
        if let Some(b'e' | b'E') = self.bytes.get(end) {
            let mut exponent_part = Self::new(self.bytes, end + 1);
            exponent += exponent_part.integer().ok()?;
            end = exponent_part.pos;
        }
        let ended = self.bytes.get(end).is_none_or(|b| b.is_ascii_whitespace());
        if !ended || mantissa > 1 << 53 || exponent.abs() > 22 {
            return None;
        }
        let power = POWERS[exponent.unsigned_abs() as usize];
        let value = mantissa as f64;
        let value = if exponent < 0 {
            value / power
        } else {
            value * power
        };
        Some((if negative { -value } else { value }, end))
    }

    #[cold]
    fn long_number(&mut self) -> Result<f64, Fault> {
        let start = self.pos;
        let shown = self.shown();
        std::str::from_utf8(self.word())
            .ok()
            .and_then(|word| word.parse().ok())
            .ok_or_else(|| Fault::new(start, format!("a number was expected, not {shown}")))
    }
}

/// Whether a backslash at the end of `line` continues it.
fn is_continued(line: &[u8]) -> bool {
    let last = line.iter().rfind(|b| !is_blank(**b));
    last == Some(&b'\\')
}

/// A blank inside of a line.
#[inline]
fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | 0x0b | 0x0c)
}
