//! The numbers of a sequence's frames, and names that hold one.

use std::collections::HashSet;
use std::str::FromStr;

/// Frames of a sequence, at most.
const MOST: usize = 1_000_000;

/// The numbers of frames, in the order in which they are rendered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameList(pub Vec<u32>);

impl FromStr for FrameList {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "expected frames such as 1-48, 1-48x2 for every second, or 1,5,10-20".into();
        let mut frames = Vec::new();
        let mut seen = HashSet::new();
        for part in text.split(',') {
            let (range, step) = part.split_once('x').unwrap_or((part, "1"));
            let (first, last) = range.split_once('-').unwrap_or((range, range));
            let number = |text: &str| text.trim().parse::<u32>().ok();
            let (Some(first), Some(last), Some(step)) = (number(first), number(last), number(step))
            else {
                return Err(wrong());
            };
            if last < first || step == 0 {
                return Err(wrong());
            }
            if (last - first) as usize / step as usize + frames.len() >= MOST {
                return Err(format!("these are more than {MOST} frames"));
            }
            let new = (first..=last).step_by(step as usize);
            frames.extend(new.filter(|frame| seen.insert(*frame)));
        }
        Ok(Self(frames))
    }
}

/// A name with the number in the place of each run of `#`; `None` if there is none.
pub fn numbered(name: &str, frame: u32) -> Option<String> {
    let mut out = String::with_capacity(name.len());
    let mut rest = name;
    while let Some(at) = rest.find('#') {
        let digits = rest[at..].bytes().take_while(|b| *b == b'#').count();
        out.push_str(&rest[..at]);
        out.push_str(&format!("{frame:0digits$}"));
        rest = &rest[at + digits..];
    }
    out.push_str(rest);
    name.contains('#').then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_names_frames_ranges_and_steps() {
        let of = |text: &str| text.parse::<FrameList>().map(|list| list.0);
        assert_eq!(of("7"), Ok(vec![7]));
        assert_eq!(of("1-4"), Ok(vec![1, 2, 3, 4]));
        assert_eq!(of("1-7x3"), Ok(vec![1, 4, 7]));
        assert_eq!(of("10-12,1,11-13"), Ok(vec![10, 11, 12, 1, 13]));
        for text in ["", "a", "4-1", "1-", "-3", "1-4x0", "1,,2", "1.5"] {
            assert!(of(text).is_err(), "{text}");
        }
        assert!(of("0-4000000000").is_err());
        assert_eq!(of("1-400000,1-400000x2,2-400001").unwrap().len(), 400_001);
    }

    #[test]
    fn number_signs_give_way_to_the_number() {
        assert_eq!(numbered("a.####.exr", 7).unwrap(), "a.0007.exr");
        assert_eq!(numbered("##/a#.exr", 123).unwrap(), "123/a123.exr");
        assert_eq!(numbered("a.exr", 7), None);
    }
}
