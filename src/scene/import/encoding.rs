//! How text files begin and end their lines, whatever the format.

use std::borrow::Cow;

/// The byte order mark that editors of Windows put before UTF-8.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Where a text begins: behind its byte order mark, if it has one.
pub(super) fn start(text: &[u8]) -> usize {
    if text.starts_with(MARK) {
        MARK.len()
    } else {
        0
    }
}

/// What is wrong with a text in UTF-16 or UTF-32, which its byte order mark gives away.
pub(super) fn wide(text: &[u8]) -> Option<&'static str> {
    (text.starts_with(b"\xff\xfe") || text.starts_with(b"\xfe\xff"))
        .then_some("is text in UTF-16: save it as UTF-8")
}

/// The text with lines that end as ours do. Those of old Macintosh files end with a carriage return
/// alone; every byte keeps its place.
pub(super) fn lines(text: &[u8]) -> Cow<'_, [u8]> {
    if memchr::memchr(b'\n', text).is_some() || memchr::memchr(b'\r', text).is_none() {
        return Cow::Borrowed(text);
    }
    let newline = |b: &u8| if *b == b'\r' { b'\n' } else { *b };
    Cow::Owned(text.iter().map(newline).collect())
}
