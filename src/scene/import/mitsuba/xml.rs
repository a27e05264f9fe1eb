//! XML with places: text to a tree of elements, each knowing its line and column.
//!
//! `roxmltree` does the parsing. Of document type definitions, harmless entities are read
//! ([`entities`]). Comments are blanked before parsing, without moving lines or columns: some
//! renderers' readers accept `--` and `<!--` inside comments, XML does not, and scenes in
//! circulation have them.

use super::entities;
use crate::scene::import::faults::At;
use crate::scene::import::{ImportError, Location};
use std::path::Path;

/// Elements inside each other; scenes have fewer than ten.
const MAX_NESTING: usize = 50;
/// Elements and texts of one file.
const MAX_NODES: u32 = 20_000_000;

/// An element.
#[derive(Debug)]
pub(super) struct Element {
    /// Its name.
    pub tag: String,
    /// Its attributes.
    pub attributes: Vec<(String, String)>,
    /// Its place.
    pub at: At,
    /// The elements inside.
    pub children: Vec<Element>,
}

/// Parses `text`, which is file number `file`, at `path`.
pub(super) fn parse(text: &str, file: usize, path: &Path) -> Result<Element, ImportError> {
    let text = blank_comments(text);
    let options = roxmltree::ParsingOptions {
        allow_dtd: true,
        nodes_limit: MAX_NODES,
        ..Default::default()
    };
    let places = Places::new(&text);
    entities::check(&text).map_err(|refused| refused_entity(refused, &places, path))?;
    let document = roxmltree::Document::parse_with_options(&text, options)
        .map_err(|error| syntax_error(&error, path))?;
    element(document.root_element(), file, &places, 0).map_err(|at| ImportError {
        at: Some(Location {
            file: path.to_owned(),
            line: at.line,
            column: at.column,
        }),
        file: None,
        message: format!("elements are nested more than {MAX_NESTING} deep"),
        help: None,
    })
}

fn syntax_error(error: &roxmltree::Error, path: &Path) -> ImportError {
    let pos = error.pos();
    ImportError {
        at: Some(Location {
            file: path.to_owned(),
            line: pos.row,
            column: pos.col,
        }),
        file: None,
        message: format!("this is not well-formed XML: {error}"),
        help: None,
    }
}

fn refused_entity(refused: entities::Refused, places: &Places, path: &Path) -> ImportError {
    let (line, column) = places.of(refused.byte);
    ImportError {
        at: Some(Location {
            file: path.to_owned(),
            line,
            column,
        }),
        file: None,
        message: refused.message,
        help: Some(refused.help.into()),
    }
}

fn element(
    node: roxmltree::Node,
    file: usize,
    places: &Places,
    depth: usize,
) -> Result<Element, At> {
    let (line, column) = places.of(node.range().start);
    let at = At { file, line, column };
    if depth == MAX_NESTING {
        return Err(at);
    }
    let own = |a: roxmltree::Attribute| (a.name().to_owned(), a.value().to_owned());
    let children = node.children().filter(|c| c.is_element());
    Ok(Element {
        tag: node.tag_name().name().to_owned(),
        attributes: node.attributes().map(own).collect(),
        at,
        children: children
            .map(|c| element(c, file, places, depth + 1))
            .collect::<Result<_, _>>()?,
    })
}

/// Bytes between the marks of [`Places`].
const MARK: usize = 256;

/// From bytes of a text to lines and columns, in a bounded number of steps each: a whole scene may
/// stand in one line.
struct Places<'a> {
    text: &'a [u8],
    /// Where lines begin.
    starts: Vec<usize>,
    /// Characters before every byte that is a multiple of [`MARK`].
    marks: Vec<usize>,
}

impl<'a> Places<'a> {
    fn new(text: &'a str) -> Self {
        let text = text.as_bytes();
        let ends = text.iter().enumerate().filter(|(_, b)| **b == b'\n');
        let starts = std::iter::once(0).chain(ends.map(|(i, _)| i + 1)).collect();
        let mut marks = vec![0];
        for part in text.chunks(MARK) {
            marks.push(marks[marks.len() - 1] + characters(part));
        }
        Self {
            text,
            starts,
            marks,
        }
    }

    /// Characters before a byte.
    fn before(&self, byte: usize) -> usize {
        let mark = byte / MARK;
        self.marks[mark] + characters(&self.text[mark * MARK..byte])
    }

    /// Line and column (characters) of a byte.
    fn of(&self, byte: usize) -> (u32, u32) {
        let byte = byte.min(self.text.len());
        let line = self.starts.partition_point(|&s| s <= byte);
        let column = self.before(byte) - self.before(self.starts[line - 1]);
        (line as u32, column as u32 + 1)
    }
}

/// Characters that begin in a piece of UTF-8.
fn characters(text: &[u8]) -> usize {
    text.iter().filter(|b| **b & 0xc0 != 0x80).count()
}

/// Blanks what is inside comments, one space a character, keeping line ends. A comment ends at the
/// first `-->`, whatever stands before it.
fn blank_comments(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find("<!") {
        let (before, from) = rest.split_at(start);
        out.push_str(before);
        let (open, close) = if from.starts_with("<!--") {
            ("<!--", "-->")
        } else if from.starts_with("<![CDATA[") {
            ("<![CDATA[", "]]>")
        } else {
            ("<!", "")
        };
        let inside = &from[open.len()..];
        let Some(length) = inside.find(close) else {
            // Never closed: the parser says so.
            out.push_str(from);
            return out;
        };
        out.push_str(open);
        let content = &inside[..length];
        if open == "<!--" {
            let blank = |c| if c == '\n' || c == '\r' { c } else { ' ' };
            out.extend(content.chars().map(blank));
        } else {
            out.push_str(content);
        }
        out.push_str(close);
        rest = &inside[length + close.len()..];
    }
    out.push_str(rest);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Element, ImportError> {
        parse(text, 0, Path::new("scene.xml"))
    }

    #[test]
    fn places_are_lines_and_characters() {
        let root = parsed("<a>\n  <!-- é -->é<b x='1'/>\r\n\t<c/></a>").unwrap();
        assert_eq!(
            (root.children[0].at.line, root.children[0].at.column),
            (2, 14)
        );
        assert_eq!(
            (root.children[1].at.line, root.children[1].at.column),
            (3, 2)
        );
    }

    #[test]
    fn comments_may_hold_anything_and_move_nothing() {
        let text = "<a><!-- 1 -- 2 <!-- é\n--- --->\n<b/><![CDATA[<!-- x]]><!----><c/></a>";
        let root = parsed(text).unwrap();
        let tags: Vec<_> = root.children.iter().map(|c| c.tag.as_str()).collect();
        assert_eq!(tags, ["b", "c"]);
        assert_eq!(root.children[0].at.line, 3);
        assert_eq!(
            blank_comments(text).chars().count(),
            text.chars().count(),
            "columns must stay"
        );
    }

    #[test]
    fn errors_have_a_place() {
        let error = parsed("<a>\n<b></a>").unwrap_err();
        assert_eq!(error.at.as_ref().map(|at| at.line), Some(2));
        assert!(parsed("<a><!-- never closed").is_err());
    }

    /// Columns are counted from marks: before, at and behind one, in one long line.
    #[test]
    fn long_lines_have_places_too() {
        let many = 700;
        let root = parsed(&format!("<\u{e9}>{}</\u{e9}>", "\u{e9}<b/>".repeat(many))).unwrap();
        assert_eq!(root.children.len(), many);
        for (i, child) in root.children.iter().enumerate() {
            assert_eq!((child.at.line, child.at.column as usize), (1, 5 + 5 * i));
        }
    }

    #[test]
    fn entities_are_read_and_bombs_and_abysses_refused() {
        let good = "<!DOCTYPE a [<!-- of -- mine --><!ENTITY r \"0.5\"><!ENTITY b '<b x=\"&r;\"/>'>]>\n<a>&b;<c y='&r;'/></a>";
        let root = parsed(good).unwrap();
        assert_eq!(root.children[0].attributes, [("x".into(), "0.5".into())]);
        assert_eq!(root.children[1].attributes, [("y".into(), "0.5".into())]);
        assert_eq!(root.children[1].at.line, 2);
        let mut bomb = "<!DOCTYPE l [<!ENTITY e0 'x'>".to_owned();
        for i in 1..9 {
            let ten = format!("&e{};", i - 1).repeat(10);
            bomb += &format!("<!ENTITY e{i} '{ten}'>");
        }
        let error = parsed(&(bomb + "]>\n<a>&e8;</a>")).unwrap_err();
        assert!(error.to_string().contains("scene.xml:2:4: "), "{error}");
        assert!(error.message.contains("1 MiB"), "{error}");
        let deep = "<a>".repeat(200) + &"</a>".repeat(200);
        let error = parsed(&deep).unwrap_err();
        assert!(error.message.contains("nested"), "{error}");
    }

    /// Nesting far beyond the limit must not overflow the stack on its way to the message.
    #[test]
    fn a_hundred_thousand_levels_are_an_error() {
        let deep = "<a>".repeat(100_000) + &"</a>".repeat(100_000);
        assert!(parsed(&deep).is_err());
    }
}
