//! What is read off the film.

use super::*;
use crate::film::filter::Filter;
use crate::film::{
    ExtraSample, Extras, Features, FilmDescription, FilmKind, FirstPoint, LightParts, Mattes,
    Sample,
};
use crate::math::{Rgb, Vec2, Vec3};

#[test]
fn layers_hold_what_the_samples_said() {
    let extras = Extras {
        position: true,
        origin: [1e9, 0.0, -3.0],
        uv: true,
        geometric_normal: true,
        alpha: true,
        light: LightParts {
            bounces: Some(0),
            ..LightParts::default()
        },
        mattes: Some(Mattes::new([["cube", "blue"], ["ball", "blue"]])),
    };
    let mut film = Film::new(&FilmDescription {
        width: 20,
        height: 17,
        crop: None,
        filter: Filter::Box { radius: 0.5 },
        kind: FilmKind::Hdr,
        exposure: 0.0,
        extras: extras.clone().into(),
    });
    for tile in film.tiles_mut() {
        for i in 0..tile.pixels.len() {
            let x = (tile.x0 + i as u32 % tile.width) as f32;
            let y = (tile.y0 + i as u32 / tile.width) as f32;
            for (sample, radiance) in [(0, 1.0), (1, 3.0)] {
                let s = Sample {
                    radiance: Rgb::new(x, y, radiance),
                    weight: 1.0,
                    worth: 1.0,
                    albedo: Rgb::splat(0.25),
                    normal: Vec3::Y,
                    depth: 7.0,
                    features: Some(Features {
                        albedo: Rgb::splat(0.5),
                        normal: Vec3::Z * 0.5,
                        weight: 0.5,
                    }),
                };
                // The second of them sees a place of another texture, and two coordinates that
                // are no numbers.
                let (u, odd) = [(0.25, 2.0), (0.75, f32::NAN)][sample as usize];
                let first = FirstPoint {
                    position: Vec3::new(x, odd, 0.5),
                    uv: Vec2::new(u, odd),
                    normal: Vec3::X,
                    shape: sample as u32,
                };
                let extra = ExtraSample {
                    first: Some(first),
                    light: &[Rgb::new(1.0, 0.0, 0.0), Rgb::new(0.0, radiance, odd)],
                };
                tile.add_with(i, sample, (&s, &extra), &extras);
            }
        }
        tile.done = 2;
    }
    let image = film.image(Layers::ALL, &Metadata::default());
    assert_eq!(image.channels.len(), 32 + 24 + 6);
    let pixel = image.pixel(18, 16);
    let at = |name: &str| pixel[image.channel(name).expect(name)];
    assert_eq!([at("R"), at("G"), at("B")], [18.0, 16.0, 2.0]);
    // Two samples 1 and 3: variance 2, of the mean 1.
    assert_eq!([at("variance.R"), at("variance.B")], [0.0, 1.0]);
    // The two halves are the two samples: the contrast is half their difference.
    assert_eq!([at("noise.R"), at("noise.B")], [0.0, -1.0]);
    assert_eq!(
        [
            at("albedo.first.G"),
            at("normal.first.Y"),
            at("depth.Z"),
            at("samples.Y")
        ],
        [0.25, 1.0, 7.0, 2.0]
    );
    let position = ["position.X", "position.Y", "position.Z"].map(at);
    assert_eq!(position, [(1e9 + 18.0) as f32, 1.0, -2.5]);
    assert_eq!([at("uv.U"), at("uv.V")], [0.5, 1.0]);
    assert_eq!(at("normal.geometric.X"), 1.0);
    let shares = ["CryptoObject00.g", "CryptoObject00.a", "CryptoMaterial00.g"].map(at);
    assert_eq!(shares, [0.5, 0.5, 1.0]);
    assert_eq!([at("albedo.G"), at("normal.Z")], [0.5, 1.0]);
    let light = ["bounces.0.R", "bounces.more.G", "bounces.more.B"].map(at);
    assert_eq!(light, [1.0, 2.0, 1.0]);
    assert_eq!(at("A"), 1.0);
    let bare = film.image(Layers::NONE, &Metadata::default());
    assert_eq!(
        bare.channel_names(),
        [
            "R",
            "G",
            "B",
            "A",
            "bounces.0.R",
            "bounces.0.G",
            "bounces.0.B",
            "bounces.more.R",
            "bounces.more.G",
            "bounces.more.B"
        ]
    );
}
