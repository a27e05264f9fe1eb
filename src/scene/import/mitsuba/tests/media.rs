//! Participating media.

use super::Stage;
use crate::math::Rgb;
use crate::medium::{Boundary, Extinction, Homogeneous, PhaseFunction, PhaseLobe, VACUUM};
use crate::scene::Description;

fn homogeneous(d: &Description, id: u32) -> Homogeneous {
    match &d.media.get(id).unwrap().extinction {
        Extinction::Homogeneous(medium) => *medium,
        other => panic!("{other:?}"),
    }
}

#[test]
fn media_are_read_where_shapes_and_the_sensor_name_them() {
    let text = "<scene version='3.0.0'>
         <medium type='homogeneous' id='fog'>
           <rgb name='sigma_t' value='0.5, 1, 2'/><float name='scale' value='3'/>
           <volume name='albedo' type='constvolume'><rgb name='value' value='0.1, 0.2, 0.3'/></volume>
           <phase type='hg'><float name='g' value='0.4'/></phase>
         </medium>
         <shape type='sphere'><ref name='exterior' id='fog'/>
           <medium name='interior' type='homogeneous'>
             <float name='sigma_a' value='1'/><float name='sigma_s' value='3'/>
           </medium>
         </shape>
         <shape type='sphere'><ref name='interior' id='fog'/></shape>
         <shape type='sphere'/>
         <sensor type='perspective'><ref id='fog'/></sensor></scene>";
    let d = Stage::new().load(text).unwrap_or_else(|e| panic!("{e}"));
    assert!(d.warnings.is_empty(), "{:?}", d.warnings);
    let boundaries: Vec<_> = d.shapes.iter().map(|s| s.boundary).collect();
    let fog = d.camera_medium.unwrap();
    let Some(Boundary { interior, exterior }) = boundaries[0] else {
        panic!("{boundaries:?}")
    };
    assert_eq!((exterior, d.media.list.len()), (fog, 2));
    let second = Boundary {
        interior: fog,
        exterior: VACUUM,
    };
    assert_eq!(boundaries[1..], [Some(second), None]);
    let read = homogeneous(&d, fog);
    assert_eq!(read.extinction, Rgb::new(1.5, 3.0, 6.0));
    assert_eq!(read.albedo, Rgb::new(0.1, 0.2, 0.3));
    let phase = PhaseFunction::from(PhaseLobe::henyey_greenstein(0.4));
    assert_eq!(d.media.get(fog).unwrap().phase, phase);
    let inner = homogeneous(&d, interior);
    assert_eq!(inner.extinction, Rgb::splat(4.0));
    assert_eq!(inner.albedo, Rgb::splat(0.75));
}

/// Mitsuba lets an emitter name the medium around it. Here that is found along its rays.
#[test]
fn a_lamp_may_name_its_medium() {
    let text = "<scene version='3.0.0'>
         <medium type='homogeneous' id='fog'/>
         <emitter type='point'><ref name='exterior' id='fog'/></emitter>
         <shape type='sphere'><ref name='exterior' id='fog'/>
           <emitter type='area'><ref name='medium' id='fog'/></emitter></shape>
         <sensor type='perspective'><ref id='fog'/></sensor></scene>";
    let d = Stage::new().load(text).unwrap_or_else(|e| panic!("{e}"));
    assert!(d.warnings.is_empty(), "{:?}", d.warnings);
    assert_eq!((d.emitters.len(), d.media.list.len()), (2, 1));
}

/// (what stands in a shape, words the message must have).
const MISTAKES: &[(&str, &[&str])] = &[
    (
        "<medium name='inside' type='homogeneous'/>",
        &["\"interior\" or \"exterior\", not \"inside\""],
    ),
    (
        "<medium name='interior' type='fog'/>",
        &["\"fog\" is not read", "homogeneous"],
    ),
    (
        "<medium name='interior' type='homogeneous'><float name='sigma_t' value='-1'/></medium>",
        &["sigma_t", "0 or more"],
    ),
    (
        "<medium name='interior' type='homogeneous'><float name='scale' value='-2'/></medium>",
        &["scale"],
    ),
    (
        "<medium name='interior' type='homogeneous'><string name='material' value='Milk'/></medium>",
        &["presets", "sigma_t"],
    ),
    (
        "<medium name='interior' type='homogeneous'><phase type='sggx'/></medium>",
        &["\"sggx\" is not read", "hg"],
    ),
    (
        "<medium name='interior' type='homogeneous'><phase type='blendphase'><phase type='hg'/></phase></medium>",
        &["two phase functions"],
    ),
    (
        "<medium name='interior' type='heterogeneous'><volume name='sigma_t' type='gridvolume'/></medium>",
        &["needs a \"filename\""],
    ),
    (
        "<medium name='interior' type='heterogeneous'><volume name='sigma_t' type='gridvolume'><string name='filename' value='none.vol'/></volume></medium>",
        &["none.vol"],
    ),
    (
        "<medium name='interior' type='heterogeneous'><volume name='sigma_t' type='gridvolume'><string name='filename' value='text.vol'/></volume></medium>",
        &["text.vol", "no .vol file"],
    ),
    (
        "<medium name='interior' type='heterogeneous'><volume name='sigma_t' type='gridvolume'><string name='filename' value='text.VDB'/></volume></medium>",
        &[
            "text.VDB",
            if cfg!(feature = "openvdb") {
                "not a VDB file"
            } else {
                "libopenvdb-dev and libboost-dev, and build it with `cargo build --release --features openvdb`"
            },
        ],
    ),
];

#[test]
fn mistakes_are_told_with_their_place() {
    for (inside, words) in MISTAKES {
        let stage = Stage::new();
        stage.file("text.vol", "a text");
        stage.file("text.VDB", "a text of some length");
        let shape = format!("<shape type='sphere'>{inside}</shape>");
        let said = stage.error(&shape).to_string();
        for word in *words {
            assert!(said.contains(word), "{inside}: {word}: {said}");
        }
        assert!(said.contains("scene.xml:1:"), "{said}");
    }
}
