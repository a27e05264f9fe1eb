//! The parts that a picture's light is taken into: by how often it was scattered, and by what sent
//! it.
//!
//! Each way of taking it apart has a part for all light, so that its parts come to the picture.

use serde::{Deserialize, Serialize};

/// Lights that have a part together.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightGroup {
    /// What the part is called.
    pub name: String,
    /// Numbers of the emitters.
    pub emitters: Vec<u32>,
}

/// Into which parts light is taken.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LightParts {
    /// Light that is seen directly or was scattered once, and all other.
    pub direct: bool,
    /// Light of each group, and that of all other emitters; none without groups.
    pub groups: Vec<LightGroup>,
    /// Light that was scattered 0 times, once and so on up to this number, and all other.
    pub bounces: Option<u32>,
}

/// What the part is called that has the light of all other emitters.
pub const REST: &str = "rest";

impl LightParts {
    /// How many parts there are.
    pub fn count(&self) -> usize {
        self.of_directness() + self.of_groups() + self.of_bounces()
    }

    fn of_directness(&self) -> usize {
        if self.direct { 2 } else { 0 }
    }

    fn of_groups(&self) -> usize {
        match self.groups.len() {
            0 => 0,
            groups => groups + 1,
        }
    }

    fn of_bounces(&self) -> usize {
        self.bounces.map_or(0, |most| most as usize + 2)
    }

    /// The parts that light belongs to which was scattered so often and comes from this group, or
    /// from one beyond the last.
    #[inline]
    pub fn of(&self, group: usize, bounces: u32) -> impl Iterator<Item = usize> + use<> {
        let directness = self.direct.then_some(usize::from(bounces > 1));
        let begin = self.of_directness();
        let groups = self.groups.len();
        let group = (groups > 0).then_some(begin + group.min(groups));
        let begin = begin + self.of_groups();
        let bounces = self
            .bounces
            .map(|most| begin + bounces.min(most + 1) as usize);
        [directness, group, bounces].into_iter().flatten()
    }

    /// For each emitter of a scene that is in a group, the group's number, by the emitter's.
    pub fn groups_of_emitters(&self) -> Vec<usize> {
        let mut list = Vec::new();
        for (number, group) in self.groups.iter().enumerate() {
            for &emitter in &group.emitters {
                let emitter = emitter as usize;
                if list.len() <= emitter {
                    list.resize(emitter + 1, usize::MAX);
                }
                list[emitter] = number;
            }
        }
        list
    }

    /// What the parts' layers are called.
    pub fn names(&self) -> Vec<String> {
        let mut names = Vec::new();
        if self.direct {
            names.extend(["direct".to_owned(), "indirect".to_owned()]);
        }
        if !self.groups.is_empty() {
            let groups = self.groups.iter().map(|group| group.name.as_str());
            names.extend(groups.chain([REST]).map(|name| format!("light.{name}")));
        }
        if let Some(most) = self.bounces {
            names.extend((0..=most).map(|bounces| format!("bounces.{bounces}")));
            names.push("bounces.more".into());
        }
        names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_belongs_to_one_part_of_each_kind() {
        let group = |name: &str, emitters: &[u32]| LightGroup {
            name: name.into(),
            emitters: emitters.to_vec(),
        };
        let parts = LightParts {
            direct: true,
            groups: vec![group("key", &[1, 4]), group("sky", &[2])],
            bounces: Some(1),
        };
        let names = parts.names();
        assert_eq!(
            names.join(" "),
            "direct indirect light.key light.sky light.rest bounces.0 bounces.1 bounces.more"
        );
        assert_eq!(names.len(), parts.count());
        let groups = parts.groups_of_emitters();
        let of = |emitter: usize, bounces: u32| {
            let group = groups.get(emitter).copied().unwrap_or(usize::MAX);
            let parts = parts.of(group, bounces).map(|part| names[part].as_str());
            parts.collect::<Vec<_>>().join(" ")
        };
        assert_eq!(of(4, 0), "direct light.key bounces.0");
        assert_eq!(of(2, 1), "direct light.sky bounces.1");
        assert_eq!(of(3, 2), "indirect light.rest bounces.more");
        assert_eq!(of(99, u32::MAX), "indirect light.rest bounces.more");
        assert_eq!(LightParts::default().count(), 0);
    }
}
