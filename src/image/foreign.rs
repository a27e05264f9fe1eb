//! Files that are something else than what they are taken for, by how they begin.
//!
//! A texture that git-lfs has not fetched, a page that says "404" under the name of a mesh, a scene
//! of another program: each is named as what it is, with the way out.

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Bytes at the start of a file that are looked at.
const HEAD: usize = 512;

/// What a file turned out to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Foreign {
    /// What it is, with an article.
    pub what: &'static str,
    /// What to do with it.
    pub help: &'static str,
}

impl std::fmt::Display for Foreign {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "this is {}: {}", self.what, self.help)
    }
}

const EXPORT: &str = "export it there as glTF (.glb) or as a Mitsuba scene (.xml)";

const USD: Foreign = Foreign {
    what: "a USD file",
    help: "tests/usd/usd_to_gltf.py among twintree's sources turns it into a .glb (pip install usd-core numpy), and so does whatever program opens it",
};

/// Files known by their first bytes.
const BY_START: &[(&[u8], Foreign)] = &[
    (
        b"version https://git-lfs.github.com/spec/",
        Foreign {
            what: "a pointer of Git LFS, not the file itself",
            help: "fetch it with \"git lfs pull\"",
        },
    ),
    (
        &[0x1f, 0x8b],
        Foreign {
            what: "compressed by gzip",
            help: "unpack it with gunzip",
        },
    ),
    (
        &[0x28, 0xb5, 0x2f, 0xfd],
        Foreign {
            what: "compressed by zstd (Blender writes .blend files so)",
            help: "a .blend file is opened in Blender and exported as glTF (.glb); anything else is unpacked with unzstd",
        },
    ),
    (
        b"BZh",
        Foreign {
            what: "compressed by bzip2",
            help: "unpack it with bunzip2",
        },
    ),
    (
        &[0xfd, b'7', b'z', b'X', b'Z', 0],
        Foreign {
            what: "compressed by xz",
            help: "unpack it with unxz",
        },
    ),
    (
        b"7z\xbc\xaf\x27\x1c",
        Foreign {
            what: "a 7z archive",
            help: "unpack it first",
        },
    ),
    (
        b"PK\x03\x04",
        Foreign {
            what: "a ZIP archive",
            help: "unpack it first",
        },
    ),
    (
        b"BLENDER",
        Foreign {
            what: "a Blender file",
            help: EXPORT,
        },
    ),
    (
        b"Kaydara FBX Binary",
        Foreign {
            what: "an FBX file",
            help: EXPORT,
        },
    ),
    (
        b"; FBX",
        Foreign {
            what: "an FBX file",
            help: EXPORT,
        },
    ),
    (b"PXR-USDC", USD),
    (b"#usda", USD),
    (
        b"Ogawa",
        Foreign {
            what: "an Alembic file",
            help: EXPORT,
        },
    ),
    (
        b"%PDF-",
        Foreign {
            what: "a PDF",
            help: "name the file that it was taken for",
        },
    ),
];

const HTML: Foreign = Foreign {
    what: "a web page",
    help: "the download went wrong; open it in a browser to see what it says, and fetch the file anew",
};
const COLLADA: Foreign = Foreign {
    what: "a COLLADA file",
    help: EXPORT,
};
const PBRT: Foreign = Foreign {
    what: "a pbrt scene",
    help: "the name of one ends with .pbrt, or .pbrt.gz where it is packed",
};
const JSON: Foreign = Foreign {
    what: "JSON, as Tungsten's scenes and glTF files are",
    help: "a glTF file's name must end with .gltf; a Tungsten scene is converted to Mitsuba's XML by its tungsten converter",
};

/// Words that pbrt scenes begin with, comments aside.
const PBRT_WORDS: &[&str] = &[
    "LookAt",
    "Camera",
    "Film",
    "Sampler",
    "Integrator",
    "SurfaceIntegrator",
    "Renderer",
    "PixelFilter",
    "Scale",
    "Rotate",
    "Translate",
    "Transform",
    "ConcatTransform",
    "ColorSpace",
    "Option",
    "WorldBegin",
    "AttributeBegin",
];

/// What a file that begins with `head` is, if it is none that this program reads.
pub fn by_head(head: &[u8]) -> Option<Foreign> {
    let known = BY_START.iter().find(|(start, _)| head.starts_with(start));
    if let Some((_, foreign)) = known {
        return Some(*foreign);
    }
    let text = String::from_utf8_lossy(&head[..head.len().min(HEAD)]);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let lower = text.to_ascii_lowercase();
    if lower.starts_with("<!doctype html") || lower.starts_with("<html") {
        return Some(HTML);
    }
    if text.starts_with("<?xml") || text.starts_with('<') {
        if lower.contains("<html") {
            return Some(HTML);
        }
        return text.contains("<COLLADA").then_some(COLLADA);
    }
    None
}

/// The same, for a file that ought to be the XML of a scene: text that is not is named as well.
pub fn of_scene(path: &Path, head: &[u8]) -> Option<Foreign> {
    let ends = |end: &str| {
        path.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(end))
    };
    // A .usdz is a ZIP archive.
    if ends("usdz") {
        return Some(USD);
    }
    let by_head = by_head(head);
    if by_head.is_some() {
        return by_head;
    }
    let text = String::from_utf8_lossy(&head[..head.len().min(HEAD)]);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    if text.starts_with('{') {
        return Some(JSON);
    }
    let lines = text.lines().map(str::trim);
    let mut lines = lines.filter(|l| !l.is_empty() && !l.starts_with('#'));
    let word = lines.next()?.split_whitespace().next()?;
    PBRT_WORDS.contains(&word).then_some(PBRT)
}

/// What the file at `path` is, if it is none that this program reads. A file that cannot be read is
/// left to who reads it.
pub fn by_path(path: &Path) -> Option<Foreign> {
    // Opening a pipe waits for who writes into it.
    if !std::fs::metadata(path).is_ok_and(|m| m.is_file()) {
        return None;
    }
    let mut head = Vec::with_capacity(HEAD);
    let file = File::open(path).ok()?;
    file.take(HEAD as u64).read_to_end(&mut head).ok()?;
    by_head(&head)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(head: &[u8]) -> &'static str {
        of_scene(Path::new("a"), head).map_or("", |f| f.what)
    }

    #[test]
    fn files_of_others_are_named() {
        for (head, what) in [
            (&b"BLENDER-v300"[..], "Blender"),
            (b"Kaydara FBX Binary  \0", "FBX"),
            (b"; FBX 7.4.0 project file", "FBX"),
            (b"PXR-USDC\0", "USD"),
            (b"#usda 1.0\n", "USD"),
            (b"# made by hand\nLookAt 0 0 5  0 0 0  0 1 0\n", "pbrt"),
            (b"\x1f\x8b\x08\0", "gzip"),
            (
                b"version https://git-lfs.github.com/spec/v1\noid sha256:0",
                "Git LFS",
            ),
            (b"\n<!DOCTYPE HTML>\n<html>", "web page"),
            (b"<?xml version='1.0'?><html xmlns='x'>", "web page"),
            (b"{\"bsdfs\": []}", "JSON"),
            (
                b"<?xml version='1.0'?>\n<COLLADA version='1.4.1'>",
                "COLLADA",
            ),
            (b"PK\x03\x04", "ZIP"),
        ] {
            assert!(named(head).contains(what), "{what}: {:?}", named(head));
        }
    }

    #[test]
    fn a_stage_of_usd_is_sent_to_the_script_that_converts_it() {
        for (name, head) in [
            ("a.usdz", &b"PK\x03\x04"[..]),
            ("a.usd", b"PXR-USDC\0"),
            ("a.usda", b"#usda 1.0\n"),
        ] {
            let help = of_scene(Path::new(name), head).map_or("", |f| f.help);
            let script = help.split(' ').next().unwrap_or_default();
            assert!(script.ends_with(".py"), "{name}: {help}");
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(script);
            assert!(path.is_file(), "{}", path.display());
        }
    }

    #[test]
    fn our_own_are_not() {
        for head in [
            &b"<scene version='3.0.0'>"[..],
            b"\xef\xbb\xbf<?xml version='1.0'?><scene>",
            b"<!-- LookAt -->",
            b"",
            b"\xff\xfe<\0",
        ] {
            assert_eq!(of_scene(Path::new("a.xml"), head), None, "{head:?}");
        }
        for head in [
            &b"ply\nformat ascii 1.0"[..],
            b"# Blender\nmtllib a.mtl\n",
            b"solid a",
            b"\x89PNG\r\n",
            b"glTF\x02\0\0\0",
            b"{\"asset\":{}}",
            b"\x76\x2f\x31\x01",
        ] {
            assert_eq!(by_head(head), None, "{head:?}");
        }
    }
}
