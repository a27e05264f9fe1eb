//! What is read off the film.

use super::*;
use crate::film::{Features, FilmDescription, FilmKind, Sample, filter::Filter};
use crate::math::{Rgb, Vec3};

#[test]
fn layers_hold_what_the_samples_said() {
    let mut film = Film::new(&FilmDescription {
        width: 20,
        height: 17,
        crop: None,
        filter: Filter::Box { radius: 0.5 },
        kind: FilmKind::Hdr,
        exposure: 0.0,
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
                tile.add(i, sample, &s);
            }
        }
        tile.done = 2;
    }
    let image = film.image(Layers::ALL, &Metadata::default());
    assert_eq!(image.channels.len(), 23);
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
    assert_eq!([at("albedo.G"), at("normal.Z")], [0.5, 1.0]);
    assert_eq!(
        film.image(Layers::NONE, &Metadata::default())
            .channels
            .len(),
        3
    );
}
