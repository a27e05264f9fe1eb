//! What panoramas and fisheyes show, where that is known without them.

mod support;

use support::{SceneMaker, settings};
use twintree::accel::Backend;
use twintree::camera::{FovAxis, Projection};
use twintree::film::Film;
use twintree::light::Emitter;
use twintree::math::{DVec3, Rgb, Vec3};

const FISHEYE: Projection = Projection::Fisheye {
    fov_degrees: 180.0,
    fov_axis: FovAxis::Smaller,
};

/// An empty scene seen from the origin along +z.
fn maker(projection: Projection, [width, height]: [u32; 2]) -> SceneMaker {
    let mut maker = SceneMaker::new(Vec3::ZERO, Vec3::Z, 90.0, 8);
    maker.description.camera.projection = projection;
    (maker.description.film.width, maker.description.film.height) = (width, height);
    maker
}

fn render(maker: SceneMaker, spp: u64) -> Film {
    maker.build(Backend::default()).render(&settings(), spp).0
}

/// The film's pixels, in green, with the place of their middle.
fn pixels(film: &Film) -> impl Iterator<Item = ([f64; 2], f64)> + '_ {
    let (width, height) = (film.width(), film.height());
    let places = (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)));
    places.map(|(x, y)| {
        let at = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        (at, film.pixel(x, y).mean()[1])
    })
}

#[test]
fn a_constant_sky_is_constant_all_around() {
    let mut maker = maker(Projection::Spherical, [64, 32]);
    maker.emitter(Emitter::Constant {
        radiance: Rgb::splat(0.75),
    });
    for (at, value) in pixels(&render(maker, 4)) {
        assert_eq!(value, 0.75, "{at:?}");
    }
}

/// Not even the sky is seen outside of a fisheye's circle, and all of it is inside.
#[test]
fn a_fisheye_is_black_outside_of_its_circle() {
    let mut maker = maker(FISHEYE, [60, 40]);
    maker.emitter(Emitter::Constant {
        radiance: Rgb::splat(0.75),
    });
    for ([x, y], value) in pixels(&render(maker, 4)) {
        let away = (x - 30.0).hypot(y - 20.0);
        // Pixels on the edge are a part of both: half a diagonal is 0.71.
        match away {
            _ if away < 19.28 => assert_eq!(value, 0.75, "{x} {y}"),
            _ if away > 20.72 => assert_eq!(value, 0.0, "{x} {y}"),
            _ => assert!((0.0..=0.75).contains(&value), "{x} {y}: {value}"),
        }
    }
}

/// The irradiance of a ball of radiance L, radius r and distance d is pi L (r / d)^2 cos: what the
/// pixels see, times their solid angles and cosines, sums up to it.
#[test]
fn pictures_of_all_directions_sum_up_to_the_irradiance() {
    let normal = DVec3::new(0.3, 0.5, 0.8).normalize();
    let towards = DVec3::new(-0.2, 0.4, 0.9).normalize();
    let expected = std::f64::consts::PI * 2.0 * 0.25 * towards.dot(normal);
    for projection in [Projection::Spherical, FISHEYE] {
        let mut maker = maker(projection, [256, 128]);
        let black = maker.diffuse(0.0);
        maker.sphere((towards * 3.0).as_vec3(), 1.5, black, Some(2.0), false);
        let built = maker.build(Backend::default());
        let film = built.render(&settings(), 64).0;
        let mut sum = 0.0;
        for ([x, y], radiance) in pixels(&film) {
            let ray = built
                .camera
                .ray([x as f32, y as f32].into(), [0.5; 2].into());
            let solid_angle = f64::from(ray.cone_spread).powi(2);
            let cos = normal.dot(ray.ray.dir.as_dvec3()).max(0.0);
            sum += radiance * solid_angle * cos;
        }
        // 64 samples in each of the 400 pixels on the ball's edge, which are a tenth of those
        // inside: 0.1 %.
        assert!(
            (sum / expected - 1.0).abs() < 4e-3,
            "{projection:?}: {sum} instead of {expected}"
        );
    }
}

/// The camera looks along +z with +x to the left: the middle of a small ball by the formulas of
/// longitude and latitude, and of the angle to the axis.
#[test]
fn a_known_direction_is_in_its_known_pixel() {
    let dir = DVec3::new(0.6, 0.45, 0.3).normalize();
    let longitude = 0.5 - dir.x.atan2(dir.z).to_degrees() / 360.0;
    let latitude = dir.y.acos().to_degrees() / 180.0;
    let angle = dir.z.acos().to_degrees() / 90.0;
    let across = dir.x.hypot(dir.y);
    for (projection, expected) in [
        (Projection::Spherical, [longitude * 256.0, latitude * 128.0]),
        (
            FISHEYE,
            [
                128.0 - 64.0 * angle * dir.x / across,
                64.0 - 64.0 * angle * dir.y / across,
            ],
        ),
    ] {
        let mut maker = maker(projection, [256, 128]);
        let black = maker.diffuse(0.0);
        maker.sphere((dir * 40.0).as_vec3(), 1.0, black, Some(1.0), false);
        let film = render(maker, 64);
        let sums = pixels(&film).fold([0.0; 3], |[x, y, all], (at, value)| {
            [x + at[0] * value, y + at[1] * value, all + value]
        });
        let middle = [sums[0] / sums[2], sums[1] / sums[2]];
        for axis in 0..2 {
            let off = middle[axis] - expected[axis];
            // The ball is four pixels wide; its middle moves by some hundredths when it is bent.
            assert!(off.abs() < 0.1, "{projection:?}: {middle:?}, {expected:?}");
        }
    }
}
