//! Lines of an OBJ file that are not read: they are counted, and told in a sentence a kind.

use crate::scene::import::mesh::text::line_of;

/// Words that change nothing about a surface of triangles, or name what has no counterpart here.
const HARMLESS: [&[u8]; 20] = [
    b"",
    b"o",
    b"g",
    b"mg",
    b"s",
    b"usemtl",
    b"mtllib",
    b"usemap",
    b"maplib",
    b"lod",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"shadow_obj",
    b"trace_obj",
    b"ctech",
    b"stech",
    b"call",
    b"csh",
    b"end",
];
const LINES: [&[u8]; 2] = [b"l", b"p"];
const CURVES: [&[u8]; 17] = [
    b"vp", b"cstype", b"deg", b"bmat", b"step", b"curv", b"curv2", b"surf", b"parm", b"trim",
    b"hole", b"scrv", b"sp", b"con", b"bzp", b"bsp", b"res",
];

/// What lies in a block and is not read.
#[derive(Clone, Debug, Default)]
pub(super) struct Skipped {
    lines: usize,
    curves: usize,
    unknown: usize,
    /// The first unknown word, and its byte.
    first: Option<(usize, String)>,
}

impl Skipped {
    /// Notes the word at byte `offset` that begins a line.
    pub fn meet(&mut self, word: &[u8], offset: usize) {
        if word.first().is_none_or(|b| *b == b'#') || HARMLESS.contains(&word) {
            return;
        }
        if LINES.contains(&word) {
            self.lines += 1;
        } else if CURVES.contains(&word) {
            self.curves += 1;
        } else {
            self.unknown += 1;
            let shown = || String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned();
            self.first.get_or_insert_with(|| (offset, shown()));
        }
    }
}

/// What is said about all blocks together.
pub(super) fn warnings<'a>(data: &[u8], blocks: impl Iterator<Item = &'a Skipped>) -> Vec<String> {
    let mut all = Skipped::default();
    for block in blocks {
        all.lines += block.lines;
        all.curves += block.curves;
        all.unknown += block.unknown;
        all.first = all.first.or_else(|| block.first.clone());
    }
    let mut warnings = Vec::new();
    if all.lines > 0 {
        let count = all.lines;
        warnings.push(format!(
            "{count} statements of lines and points are left out"
        ));
    }
    if all.curves > 0 {
        let count = all.curves;
        warnings.push(format!(
            "{count} statements of free-form curves and surfaces are left out: export them as triangles"
        ));
    }
    if let Some((offset, word)) = all.first {
        let (line, count) = (line_of(data, offset), all.unknown);
        warnings.push(format!(
            "{count} lines begin with no word of the format and are left out, the first is line {line} (`{}`)",
            word.escape_debug()
        ));
    }
    warnings
}
