//! Entities of a document type definition: short texts under a name are read, all else is refused.
//!
//! Entities that name each other can make gigabytes of a small file, and others stand for files.
//! The length of everything that references stand for is added up before any of it is put in.

use std::collections::HashMap;

/// Most characters that all references of a file may stand for together.
const MOST_BYTES: u64 = 1 << 20;
/// Entities inside each other; the XML parser's own limit.
const MOST_NESTED: u32 = 10;

/// Something about the definitions that is refused.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Refused {
    /// Where, as a byte of the text.
    pub byte: usize,
    /// What.
    pub message: String,
    /// What to do.
    pub help: &'static str,
}

/// Holds the definitions of a file, in which comments are blanked, against what is harmless.
pub(super) fn check(text: &str) -> Result<(), Refused> {
    let Some(start) = text.find("<!DOCTYPE") else {
        return Ok(());
    };
    let mut entities = HashMap::new();
    let mut behind = start;
    let mut at = start;
    while let Some(found) = text[at..].find("<!ENTITY") {
        let byte = at + found;
        let (declaration, length) = declared(&text[byte + "<!ENTITY".len()..]);
        at = byte + "<!ENTITY".len() + length;
        behind = at;
        match declaration {
            Some((name, Some(value))) => {
                entities.entry(name).or_insert(value);
            }
            Some((name, None)) => refuse_files(text, name, at)?,
            None => {}
        }
    }
    let mut total: u64 = 0;
    for (name, byte) in references(&text[behind..]) {
        total = total.saturating_add(expanded(name, &entities, 0));
        if total > MOST_BYTES {
            return Err(Refused {
                byte: behind + byte,
                message: "the entities of the DOCTYPE stand for more than 1 MiB of text".into(),
                help: "write them out",
            });
        }
    }
    Ok(())
}

/// Name and value of an entity, and the length of its declaration; no value for one that names a
/// file.
fn declared(text: &str) -> (Option<(&str, Option<&str>)>, usize) {
    let end = text.find(['"', '\'', '>']).unwrap_or(text.len());
    let mut words = text[..end].split_whitespace();
    let name = words.next();
    let is_file = words.next().is_some();
    let quote = text[end..].chars().next().filter(|c| *c != '>');
    let (Some(name), Some(quote)) = (name.filter(|n| *n != "%"), quote) else {
        return (None, end);
    };
    let value = &text[end + 1..];
    let length = value.find(quote).unwrap_or(value.len());
    let value = (!is_file).then_some(&value[..length]);
    (Some((name, value)), (end + 1 + length + 1).min(text.len()))
}

fn refuse_files(text: &str, name: &str, from: usize) -> Result<(), Refused> {
    match references(&text[from..]).find(|(n, _)| *n == name) {
        None => Ok(()),
        Some((_, byte)) => Err(Refused {
            byte: from + byte,
            message: format!("the entity &{name}; stands for another file"),
            help: "name the file with <include filename=\"...\"/>",
        }),
    }
}

/// Names behind ampersands, with their places.
fn references(text: &str) -> impl Iterator<Item = (&str, usize)> {
    text.match_indices('&').filter_map(|(byte, _)| {
        let name = &text[byte + 1..];
        // Names are short: what has no end nearby is no reference.
        let end = name.bytes().take(256).position(|b| b == b';')?;
        Some((name.get(..end)?, byte))
    })
}

/// Bytes that a reference stands for; too many where definitions run in circles.
fn expanded(name: &str, entities: &HashMap<&str, &str>, depth: u32) -> u64 {
    let Some(value) = entities.get(name) else {
        return 1;
    };
    if depth == MOST_NESTED {
        return MOST_BYTES + 1;
    }
    let mut sum = value.len() as u64;
    for (inner, _) in references(value) {
        sum = sum.saturating_add(expanded(inner, entities, depth + 1));
        if sum > MOST_BYTES {
            break;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_texts_pass() {
        for text in [
            "<a/>",
            "<!DOCTYPE scene SYSTEM 'scene.dtd'><a/>",
            "<!DOCTYPE a [<!ENTITY r \"0.5\"><!ENTITY two '&r;&r;'>]><a b='&two;&lt;'/>",
            "<!DOCTYPE a [<!ENTITY unused SYSTEM 'x'><!ELEMENT a ANY>]><a/>",
        ] {
            assert_eq!(check(text), Ok(()), "{text}");
        }
    }

    #[test]
    fn bombs_circles_and_files_are_refused() {
        let mut bomb = "<!DOCTYPE a [<!ENTITY e0 'ha'>".to_owned();
        for i in 1..9 {
            let ten = format!("&e{};", i - 1).repeat(10);
            bomb += &format!("<!ENTITY e{i} '{ten}'>");
        }
        let long = format!(
            "<!DOCTYPE a [<!ENTITY e '{}'>]><a>{}</a>",
            "x".repeat(9999),
            "&e;".repeat(200)
        );
        for text in [
            &(bomb + "]><a>&e8;</a>"),
            &long,
            "<!DOCTYPE a [<!ENTITY b '&c;'><!ENTITY c '&b;'>]><a>&b;</a>",
        ] {
            let refused = check(text).unwrap_err();
            assert!(refused.message.contains("1 MiB"), "{refused:?}");
        }
        let refused = check("<!DOCTYPE a [<!ENTITY b SYSTEM '/etc/passwd'>]><a>&b;</a>");
        assert!(refused.unwrap_err().message.contains("another file"));
    }
}
