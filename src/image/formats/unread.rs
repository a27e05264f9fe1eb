//! Images that only OpenImageIO reads, by how they begin.

use super::READ;

/// Bytes at the start of a file that are looked at.
pub const HEAD: usize = 32;

/// Place, bytes there, and the format.
const KNOWN: &[(usize, &[u8], &str)] = &[
    (0, b"II*\0", "TIFF"),
    (0, b"MM\0*", "TIFF"),
    (0, b"II+\0", "TIFF"),
    (0, b"MM\0+", "TIFF"),
    (0, b"GIF8", "GIF"),
    (8, b"WEBP", "WebP"),
    (0, b"8BPS", "Photoshop"),
    (0, b"DDS ", "DDS"),
    (0, b"\0\0\0\x0cjP  ", "JPEG 2000"),
    (0, b"\0\0\0\x0cJXL ", "JPEG XL"),
    (0, b"\xff\x0a", "JPEG XL"),
    (4, b"ftypavif", "AVIF"),
    (4, b"ftyphei", "HEIF"),
    (4, b"ftypmif1", "HEIF"),
    (0, b"\xabKTX ", "KTX"),
    (0, b"\x01\xda", "SGI"),
    (0, b"PF\n", "PFM"),
    (0, b"Pf\n", "PFM"),
    (0, b"P3", "PNM"),
    (0, b"P5", "PNM"),
    (0, b"P6", "PNM"),
    (0, b"BM", "BMP"),
];

/// Why a file that begins so is not read.
pub fn reason(head: &[u8]) -> String {
    let is = |&&(at, bytes, _): &&(usize, &[u8], &str)| {
        head.get(at..).is_some_and(|rest| rest.starts_with(bytes))
    };
    match KNOWN.iter().find(is) {
        Some((_, _, format)) => format!(
            "it is a {format} image, and this build reads {READ} only: one with OpenImageIO (the feature `oiio`) knows more"
        ),
        None if head.is_empty() => "the file is empty".into(),
        None => format!(
            "it is none of {READ}, which this build reads: one with OpenImageIO (the feature `oiio`) knows more"
        ),
    }
}
