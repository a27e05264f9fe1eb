//! PNG by a view of an OpenColorIO configuration.

use super::support::{Place, Ran};

/// Two displays. `Dim` shows half of the light, `Swapped` has red and blue exchanged; the second
/// display's view has a slash in its name.
const CONFIG: &str = "ocio_profile_version: 2
roles: {default: plain, scene_linear: wide}
file_rules: [!<Rule> {name: Default, colorspace: default}]
displays:
  Screen:
    - !<View> {name: Dim, colorspace: dim}
    - !<View> {name: Swapped, colorspace: swapped}
  Projector:
    - !<View> {name: a/b, colorspace: dim}
colorspaces:
  - !<ColorSpace>
    name: wide
    to_scene_reference: !<MatrixTransform> {matrix: [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]}
  - !<ColorSpace> {name: plain, aliases: [lin_srgb]}
  - !<ColorSpace>
    name: dim
    from_scene_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}
  - !<ColorSpace>
    name: swapped
    from_scene_reference: !<MatrixTransform> {matrix: [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1]}
";

fn run(place: &Place, view: &str, config: &str) -> Ran {
    let mut command = place.command("render scene.xml --seed 1 -o a.png");
    command.args(["--view", view]).env("OCIO", config);
    Ran::of(command.output().unwrap())
}

/// Bytes of the picture.
fn shown(place: &Place, view: &str) -> Vec<[u8; 3]> {
    run(place, view, "config.ocio").ok();
    let image = twintree::image::read(&place.path("a.png")).unwrap();
    let bytes: Vec<u8> = image
        .pixels
        .iter()
        .map(|x| (x * 255.0).round() as u8)
        .collect();
    bytes.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect()
}

#[test]
fn a_png_shows_what_the_configuration_says() {
    let place = Place::new();
    std::fs::write(place.path("config.ocio"), CONFIG).unwrap();
    let plain = shown(&place, "raw");
    assert!(plain.iter().any(|p| p[0] > p[2] && p[0] < 255));
    for view in ["ocio", "ocio:Dim", "ocio:Screen/Dim", "ocio:Projector/a/b"] {
        for (dim, plain) in shown(&place, view).iter().zip(&plain) {
            for (dim, plain) in dim.iter().zip(plain) {
                let half = f32::from(*plain) / 2.0;
                // Light above white, of the lamp, is halved before it is cut off.
                let close = (f32::from(*dim) - half).abs() <= 1.0;
                assert!(close || *plain == 255, "{view}: {dim}, not {half}");
            }
        }
    }
    for (swapped, plain) in shown(&place, "ocio:Swapped").iter().zip(&plain) {
        assert_eq!(*swapped, [plain[2], plain[1], plain[0]]);
    }
}

#[test]
fn what_is_wrong_with_a_configuration_is_said_before_the_work() {
    let place = Place::new();
    std::fs::write(place.path("config.ocio"), CONFIG).unwrap();
    std::fs::write(place.path("broken.ocio"), "displays: [").unwrap();
    let odd = CONFIG.replace("name: plain, aliases: [lin_srgb]", "name: plain");
    std::fs::write(place.path("odd.ocio"), odd).unwrap();
    for (view, config, said) in [
        ("ocio", "", "the environment variable OCIO names no"),
        ("ocio", "missing.ocio", "missing.ocio"),
        ("ocio", "broken.ocio", "broken.ocio"),
        (
            "ocio:Bright",
            "config.ocio",
            "Screen/Dim, Screen/Swapped, Projector/a/b",
        ),
        ("ocio", "odd.ocio", "lin_srgb"),
        ("ocioo", "config.ocio", "possible values: srgb"),
    ] {
        run(&place, view, config).fails(2, &[said]);
        assert!(!place.path("a.png").exists());
    }
}
