//! Tests of chains apart from scenes.

use super::follow::LONGEST;
use super::*;
use crate::bsdf::LobeFlags;

#[test]
fn a_chain_is_the_same_from_both_ends() {
    let lobes = [
        LobeFlags::REFLECTION,
        LobeFlags::TRANSMISSION,
        LobeFlags::TRANSMISSION | LobeFlags::NULL,
    ];
    let from_vertex = lobes.iter().fold(Kinds::EMPTY, |k, &l| k.then(l));
    let from_light = lobes.iter().rev().fold(Kinds::EMPTY, |k, &l| k.before(l));
    assert_eq!(from_vertex, from_light);
    assert_eq!(from_vertex.len(), 3);
    assert!(Kinds::EMPTY.is_empty() && !from_vertex.is_empty());
    let other = Kinds::EMPTY.then(lobes[0]).then(lobes[2]).then(lobes[1]);
    assert_ne!(other, from_vertex);
}

#[test]
fn chains_that_are_too_long_are_no_chain_that_a_seed_has() {
    let mut kinds = [Kinds::EMPTY; 2];
    for _ in 0..LONGEST {
        kinds = [
            kinds[0].then(LobeFlags::REFLECTION),
            kinds[1].before(LobeFlags::REFLECTION),
        ];
    }
    assert_eq!(kinds[0], kinds[1]);
    assert_eq!(kinds[0].len(), LONGEST);
    for _ in 0..3 {
        kinds = [
            kinds[0].then(LobeFlags::REFLECTION),
            kinds[1].before(LobeFlags::REFLECTION),
        ];
        assert_eq!(kinds, [Kinds::LOST; 2]);
    }
}
