//! What can be typed about layers that take the picture's light apart.

use super::Failure;
use super::aov::{self, Aov};
use crate::film::light_parts::REST;
use crate::film::{LightGroup, LightParts};
use crate::scene::Description;
use clap::Args;
use std::collections::BTreeMap;
use std::str::FromStr;

/// Layers that take the picture's light apart.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Layers of light")]
pub struct LightLayerArgs {
    /// A layer for the light of each group of emitters, and one for the rest: NAME or NAME=A+B, by
    /// the ids of emitters, their shapes or lights in the scene; "each" is a group for every name
    #[arg(long, value_name = "GROUPS", value_delimiter = ',')]
    pub light_groups: Vec<GroupWord>,
    /// A layer for light that was scattered 0, 1 .. N times, and one for the rest
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=MOST_BOUNCES))]
    pub light_bounces: Option<u32>,
}

/// Most layers for numbers of bounces.
const MOST_BOUNCES: i64 = 64;
/// Most groups: each is a layer of three channels, and three sums of every pixel.
const MOST_GROUPS: usize = 64;

/// Longest name of a group.
const LONGEST_NAME: usize = 200;

/// A group as it is typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroupWord {
    name: String,
    members: Vec<String>,
}

impl FromStr for GroupWord {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, members) = match text.split_once('=') {
            Some((name, members)) => (name, members.split('+').collect()),
            None => (text, vec![text]),
        };
        if name.is_empty() || members.iter().any(|member| member.is_empty()) {
            return Err(
                "expected the name of an emitter, or a name and emitters such as \
                        key=lamp1+lamp2"
                    .into(),
            );
        }
        if name == REST {
            return Err(format!(
                "\"{REST}\" is the layer of all emitters in no group: choose another name"
            ));
        }
        Ok(Self {
            name: name.to_owned(),
            members: members.into_iter().map(str::to_owned).collect(),
        })
    }
}

/// The parts that a render takes its light into.
///
/// # Errors
/// When a group names what is no emitter, two groups have the same emitter or name, or there are
/// too many.
pub fn parts(
    args: &LightLayerArgs,
    aovs: &[Aov],
    scene: &Description,
) -> Result<LightParts, Failure> {
    Ok(LightParts {
        direct: aov::has(aovs, Aov::Direct) || aov::has(aovs, Aov::Indirect),
        groups: groups(&args.light_groups, scene)?,
        bounces: args.light_bounces,
    })
}

/// Emitters by their names: those that they have themselves, and those of the shapes that carry
/// them. The first name of each comes first.
fn named(scene: &Description) -> Vec<(&str, u32)> {
    let own = scene.emitter_names.iter();
    let mut list: Vec<(&str, u32)> = own.map(|(emitter, name)| (&**name, *emitter)).collect();
    let shapes = scene.shapes.iter();
    list.extend(shapes.filter_map(|shape| Some((&*shape.name, shape.emitter?))));
    list.sort_by_key(|(_, emitter)| *emitter);
    list
}

fn groups(words: &[GroupWord], scene: &Description) -> Result<Vec<LightGroup>, Failure> {
    let named = named(scene);
    let each = |word: &GroupWord| word.name == "each" && word.members == ["each"];
    let mut groups = Vec::new();
    for word in words {
        if each(word) {
            groups.extend(all(&named));
            continue;
        }
        let mut emitters = Vec::new();
        for member in &word.members {
            let before = emitters.len();
            let same = named.iter().filter(|(name, _)| name == member);
            emitters.extend(same.map(|(_, emitter)| *emitter));
            if emitters.len() == before {
                return Err(unknown(member, &named));
            }
        }
        emitters.sort_unstable();
        emitters.dedup();
        groups.push(LightGroup {
            name: word.name.clone(),
            emitters,
        });
    }
    check(&groups)?;
    Ok(groups)
}

/// A group for every name of an emitter, the first that each has.
fn all(named: &[(&str, u32)]) -> Vec<LightGroup> {
    let mut groups: Vec<LightGroup> = Vec::new();
    let mut last = None;
    for &(name, emitter) in named {
        if last.replace(emitter) == Some(emitter) {
            continue;
        }
        match groups.iter_mut().find(|group| group.name == name) {
            Some(group) => group.emitters.push(emitter),
            None => groups.push(LightGroup {
                name: name.to_owned(),
                emitters: vec![emitter],
            }),
        }
    }
    groups
}

fn check(groups: &[LightGroup]) -> Result<(), Failure> {
    if groups.len() > MOST_GROUPS {
        return Err(Failure::wrong(
            format!(
                "--light-groups makes {} groups, more than {MOST_GROUPS}",
                groups.len()
            ),
            "put emitters together, as in key=lamp1+lamp2: all others are in the layer light.rest",
        ));
    }
    // A channel's name has 255 characters at most: better refused now than when it is written.
    let odd = |g: &&LightGroup| g.name == REST || g.name.len() > LONGEST_NAME;
    if let Some(group) = groups.iter().find(odd) {
        return Err(Failure::wrong(
            format!(
                "--light-groups: \"{}\" cannot be the name of a layer",
                group.name
            ),
            "give the group another, as in lamp=EMITTER",
        ));
    }
    let mut known: BTreeMap<u32, &str> = BTreeMap::new();
    for (number, group) in groups.iter().enumerate() {
        if groups[..number]
            .iter()
            .any(|other| other.name == group.name)
        {
            return Err(Failure::wrong(
                format!("--light-groups has two groups \"{}\"", group.name),
                "give each a name of its own",
            ));
        }
        for emitter in &group.emitters {
            if let Some(other) = known.insert(*emitter, &group.name) {
                return Err(Failure::wrong(
                    format!(
                        "--light-groups: an emitter of \"{}\" is in \"{other}\" already",
                        group.name
                    ),
                    "put every emitter into one group, so that they come to the picture",
                ));
            }
        }
    }
    Ok(())
}

/// Names that are listed, at most.
const LISTED: usize = 12;

fn unknown(member: &str, named: &[(&str, u32)]) -> Failure {
    let mut names: Vec<String> = named
        .iter()
        .map(|(name, _)| format!("\"{name}\""))
        .collect();
    names.dedup();
    let further = names.len().saturating_sub(LISTED);
    names.truncate(LISTED);
    let mut list = names.join(", ");
    if further > 0 {
        list += &format!(" and {further} more");
    }
    let help = match list.is_empty() {
        true => "the scene has no emitter with a name".into(),
        false => format!("the scene has {list}"),
    };
    Failure::wrong(
        format!("--light-groups: no emitter is called \"{member}\""),
        help,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_have_a_name_and_emitters() {
        let group = |name: &str, members: &[&str]| GroupWord {
            name: name.into(),
            members: members.iter().map(|m| (*m).to_owned()).collect(),
        };
        assert_eq!("lamp".parse(), Ok(group("lamp", &["lamp"])));
        assert_eq!("key=a+b".parse(), Ok(group("key", &["a", "b"])));
        for text in ["", "=a", "key=", "key=a+", "rest", "rest=a"] {
            assert!(text.parse::<GroupWord>().is_err(), "{text}");
        }
    }

    #[test]
    fn every_emitter_is_in_one_group() {
        let named = [("key", 0), ("lamp", 0), ("sky", 1), ("lamp", 2)];
        let names = |groups: Vec<LightGroup>| -> Vec<String> {
            let word = |g: LightGroup| format!("{} {:?}", g.name, g.emitters);
            groups.into_iter().map(word).collect()
        };
        assert_eq!(names(all(&named)), ["key [0]", "sky [1]", "lamp [2]"]);
        let group = |name: &str, emitters: &[u32]| LightGroup {
            name: name.into(),
            emitters: emitters.to_vec(),
        };
        assert!(check(&[group("a", &[0, 2]), group("b", &[1])]).is_ok());
        assert!(check(&[group("a", &[0, 2]), group("b", &[2])]).is_err());
        assert!(check(&[group("a", &[0]), group("a", &[2])]).is_err());
        assert!(check(&[group("rest", &[0])]).is_err());
        assert!(check(&[group(&"a".repeat(201), &[0])]).is_err());
    }
}
