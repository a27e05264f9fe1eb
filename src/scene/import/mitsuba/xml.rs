//! XML with places: text to a tree of elements, each knowing its line and column.
//!
//! `roxmltree` does the parsing. Document type definitions are refused (a scene needs none, and entity
//! definitions that name each other can blow up a small file). Comments are blanked before parsing,
//! without moving lines or columns: some renderers' readers accept `--` and `<!--` inside comments, XML
//! does not, and scenes in circulation have them.

use crate::scene::import::{ImportError, Location};
use std::path::Path;

/// Elements inside each other; scenes have fewer than ten.
const MAX_NESTING: usize = 50;
/// Elements and texts of one file.
const MAX_NODES: u32 = 20_000_000;

/// A place in one of the files of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct At {
    /// Index of the file.
    pub file: usize,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

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
        allow_dtd: false,
        nodes_limit: MAX_NODES,
        ..Default::default()
    };
    let document = roxmltree::Document::parse_with_options(&text, options)
        .map_err(|error| syntax_error(&error, path))?;
    let lines = LineStarts::new(&text);
    element(document.root_element(), file, &lines, 0).map_err(|at| ImportError {
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
    let (message, help) = match error {
        roxmltree::Error::DtdDetected => (
            "document type definitions (<!DOCTYPE ...>) are not accepted".into(),
            Some("delete the DOCTYPE declaration and write its entities out".into()),
        ),
        _ => (format!("this is not well-formed XML: {error}"), None),
    };
    ImportError {
        at: Some(Location {
            file: path.to_owned(),
            line: pos.row,
            column: pos.col,
        }),
        file: None,
        message,
        help,
    }
}

fn element(
    node: roxmltree::Node,
    file: usize,
    lines: &LineStarts,
    depth: usize,
) -> Result<Element, At> {
    let (line, column) = lines.place(node.range().start);
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
            .map(|c| element(c, file, lines, depth + 1))
            .collect::<Result<_, _>>()?,
    })
}

/// Where lines begin: finds places without counting from the start for each.
struct LineStarts<'a> {
    text: &'a str,
    starts: Vec<usize>,
}

impl<'a> LineStarts<'a> {
    fn new(text: &'a str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, b)| *b == b'\n');
        let starts = std::iter::once(0).chain(ends.map(|(i, _)| i + 1)).collect();
        Self { text, starts }
    }

    /// Line and column (characters) of a byte.
    fn place(&self, byte: usize) -> (u32, u32) {
        let line = self.starts.partition_point(|&s| s <= byte);
        let start = self.starts[line - 1];
        let before = self.text.get(start..byte).unwrap_or("");
        (line as u32, before.chars().count() as u32 + 1)
    }
}

/// Blanks what is inside comments, one space a character, keeping line ends. A comment ends at the first
/// `-->`, whatever stands before it.
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

    #[test]
    fn definitions_and_abysses_are_refused() {
        let bomb = r#"<!DOCTYPE l [<!ENTITY a "x"><!ENTITY b "&a;&a;">]><a>&b;</a>"#;
        let error = parsed(bomb).unwrap_err();
        assert!(error.message.contains("DOCTYPE"), "{error}");
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
