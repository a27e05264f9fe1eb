//! Lights whose radiance is a texture: a sample brings what a ray to the same place would.

use super::scenes::*;
use super::*;
use crate::texture::{Checkerboard, UvTransform};

fn checkered() -> Texture {
    let grey = |v: f32| Texture::Constant(Rgb::splat(v));
    Texture::Checkerboard(Arc::new(Checkerboard {
        color0: grey(0.5),
        color1: grey(4.0),
        to_uv: UvTransform(glam::Affine2::from_scale(Vec2::new(3.0, 2.0))),
        swaps_numbers: false,
    }))
}

/// Compares samples with [`Lights::emitted`] at the texture coordinates `uv` gives for a place.
fn compare(name: &str, s: &Setup, uv: impl Fn(Vec3) -> Vec2) {
    let p = Vec3::new(0.4, -0.3, 3.0);
    let mut rng = Pcg32::new(6, 6);
    let (mut same, mut bright) = (0, 0);
    for _ in 0..2000 {
        let u = [(); 3].map(|()| rng.next_f32());
        let Some(l) = s.lights.sample(p, Vec3::ZERO, &mut (), u) else {
            continue;
        };
        let q = p + l.dir * l.distance;
        let mut point = SurfacePoint::at_uv(uv(q));
        point.ng = -l.dir;
        same += usize::from(s.lights.emitted(0, &point, -l.dir) == s.lights.radiance(&l.incoming));
        bright += usize::from(s.lights.radiance(&l.incoming).x == 4.0);
    }
    // Rounding moves a few across the squares' edges.
    assert!(same >= 1990, "{name}: {same}");
    assert!((500..1500).contains(&bright), "{name}: {bright}");
}

#[test]
fn textures_lie_where_rays_see_them() {
    let map = Affine3A::from_scale_rotation_translation(
        Vec3::new(1.2, 0.7, 1.0),
        glam::Quat::from_rotation_y(0.3),
        Vec3::new(0.1, 0.2, 0.0),
    );
    let back = map.inverse();
    let rectangle = setup(
        vec![(exact(AnalyticKind::Rectangle, map, false), checkered())],
        vec![],
    );
    compare("rectangle", &rectangle, |q| {
        back.transform_point3(q).truncate() * 0.5 + 0.5
    });
    let disk = setup(
        vec![(exact(AnalyticKind::Disk, map, false), checkered())],
        vec![],
    );
    compare("disk", &disk, |q| {
        let l = back.transform_point3(q);
        let turn = l.y.atan2(l.x) / std::f32::consts::TAU;
        Vec2::new(l.truncate().length(), turn.rem_euclid(1.0))
    });
    let mut quad = quad_mesh(Vec3::ZERO, Vec3::X, Vec3::Y);
    quad.uvs = Some(Arc::new(vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]));
    let quad = setup(vec![(quad, checkered())], vec![]);
    compare("mesh", &quad, |q| q.truncate());
}
