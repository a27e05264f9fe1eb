//! From the bytes of a file to text: UTF-8, UTF-16 behind a byte order mark, and Latin-1 where the
//! XML declaration says so.

/// How far into a file its XML declaration is looked for, in bytes.
const DECLARATION: usize = 200;

/// Names of the encoding whose bytes are the first 256 code points, and of Windows's relative of
/// it.
const LATIN: [&str; 5] = [
    "iso-8859-1",
    "latin1",
    "latin-1",
    "windows-1252",
    "us-ascii",
];

/// The text of a file, without a byte order mark.
///
/// # Errors
/// What is wrong, in words.
pub(super) fn text(bytes: Vec<u8>) -> Result<String, String> {
    match bytes.as_slice() {
        [0xff, 0xfe, rest @ ..] => return utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => return utf16(rest, u16::from_be_bytes),
        _ => {}
    }
    let declared = declared(&bytes);
    match String::from_utf8(bytes) {
        Ok(text) => Ok(match text.strip_prefix('\u{feff}') {
            Some(rest) => rest.to_owned(),
            None => text,
        }),
        Err(error) if declared.is_some_and(|d| LATIN.contains(&d.as_str())) => {
            Ok(error.into_bytes().into_iter().map(char::from).collect())
        }
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            Err(format!(
                "is not UTF-8 text (byte {at}); save the scene as UTF-8"
            ))
        }
    }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<String, String> {
    let units: Vec<u16> = bytes.chunks_exact(2).map(|b| unit([b[0], b[1]])).collect();
    String::from_utf16(&units).map_err(|_| {
        "is not UTF-16 text, whose mark it begins with; save the scene as UTF-8".into()
    })
}

/// The encoding that an XML declaration names, in small letters.
fn declared(bytes: &[u8]) -> Option<String> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(DECLARATION)]).to_lowercase();
    let declaration = head
        .trim_start()
        .strip_prefix("<?xml")?
        .split("?>")
        .next()?;
    let value = declaration.split("encoding").nth(1)?.trim_start();
    let value = value.strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    value[1..].split(quote).next().map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_and_encodings_are_understood() {
        let utf16 = |swap: bool| {
            let units = "\u{feff}<a b='\u{e9}\u{1f600}'/>".encode_utf16();
            let order = |u: u16| {
                if swap {
                    u.to_be_bytes()
                } else {
                    u.to_le_bytes()
                }
            };
            units.flat_map(order).collect::<Vec<u8>>()
        };
        let expected = "<a b='\u{e9}\u{1f600}'/>";
        for bytes in [
            expected.as_bytes().to_vec(),
            format!("\u{feff}{expected}").into_bytes(),
            utf16(false),
            utf16(true),
        ] {
            assert_eq!(text(bytes).as_deref(), Ok(expected));
        }
        let latin = b"<?xml version='1.0' encoding=\"ISO-8859-1\"?><a b='\xe9'/>".to_vec();
        assert!(text(latin).unwrap().ends_with("<a b='\u{e9}'/>"));
        for bad in [
            &b"<?xml version='1.0' encoding='utf-8'?><a b='\xe9'/>"[..],
            b"<a b='\xe9'/>",
            b"\xff\xfe\x00\xd8\x00\xd8",
        ] {
            assert!(text(bad.to_vec()).unwrap_err().contains("UTF-8"));
        }
    }
}
