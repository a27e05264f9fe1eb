//! Values between voxels, against those of Mitsuba 3.9.1 in its variant `scalar_rgb`:
//! `mi.load_dict({'type': 'gridvolume', 'grid': mi.VolumeGrid(...), 'filter_type': ...,
//! 'wrap_mode': ..., 'raw': True}).eval_1(...)`. What is 0 beyond the grid it has not: those are sums
//! over eight voxels in double precision.

use super::*;

const RESOLUTION: [u32; 3] = [4, 3, 2];
const VALUES: [f32; 24] = [
    1.0, 8.0, 4.0, 11.0, 7.0, 3.0, 10.0, 6.0, 2.0, 9.0, 5.0, 1.0, //
    8.0, 4.0, 11.0, 7.0, 3.0, 10.0, 6.0, 2.0, 9.0, 5.0, 1.0, 8.0,
];
const POINTS: [[f32; 3]; 10] = [
    [0.1, 0.2, 0.3],
    [0.5, 0.5, 0.5],
    [0.02, 0.5, 0.9],
    [0.99, 0.99, 0.01],
    [0.7, 0.33, 0.6],
    [1.0, 1.0, 1.0],
    [1.1, 0.5, 0.5],
    [-0.1, 0.4, 0.3],
    [-0.3, 1.6, 2.2],
    [0.375, 0.4999, 0.75],
];
/// By filter and wrap mode, in the order of [`lookups`].
const EXPECTED: [[f32; 10]; 8] = [
    [
        2.19, 7.25, 3.0, 1.0, 7.371901, 8.0, 4.0, 5.130001, 8.999999, 9.9982,
    ],
    [
        2.981, 7.25, 3.78, 5.801736, 7.371901, 5.875, 4.9, 6.903, 6.999, 9.9982,
    ],
    [
        2.19, 7.25, 3.0, 1.0, 7.371901, 8.0, 4.0, 5.130001, 4.71, 9.9982,
    ],
    [
        1.971, 7.25, 1.218, 0.148824, 7.3719, 1.0, 0.4, 0.513, 0.0, 9.9982,
    ],
    [1.0, 6.0, 3.0, 1.0, 11.0, 8.0, 2.0, 7.0, 9.0, 10.0],
    [1.0, 6.0, 3.0, 1.0, 11.0, 1.0, 3.0, 6.0, 10.0, 10.0],
    [1.0, 6.0, 3.0, 1.0, 11.0, 8.0, 2.0, 7.0, 3.0, 10.0],
    [1.0, 6.0, 3.0, 1.0, 11.0, 0.0, 0.0, 0.0, 0.0, 10.0],
];

fn example(to_world: Affine3A, lookup: Lookup) -> Grid {
    let values = Arc::new(VALUES.to_vec());
    Grid::new(RESOLUTION, 1, values, to_world, lookup).unwrap()
}

fn is_close(a: f32, b: f32) -> bool {
    (a - b).abs() <= 3e-6 * b.abs()
}

#[test]
fn values_are_those_of_mitsuba_and_nothing_lies_beyond() {
    for (lookup, expected) in lookups().zip(EXPECTED) {
        let grid = example(Affine3A::IDENTITY, lookup);
        for (p, e) in POINTS.iter().zip(expected) {
            let value = grid.eval(Vec3::from_array(*p));
            assert!(is_close(value.x, e), "{lookup:?} {p:?}: {value} for {e}");
            assert_eq!(value, Rgb::splat(value.x));
        }
    }
}

#[test]
fn a_grid_lies_where_mitsuba_puts_it() {
    // Translate by (2, -1, 6), rotate by 40 degrees around (1, 2, 3), scale by (2, 3, 1.5).
    let axis = Vec3::new(1.0, 2.0, 3.0).normalize();
    let turn = Quat::from_axis_angle(axis, 40f32.to_radians());
    let size = Vec3::new(2.0, 3.0, 1.5);
    let place = Affine3A::from_scale_rotation_translation(size, turn, Vec3::new(2.0, -1.0, 6.0));
    let grid = example(place, Lookup::default());
    for (p, e) in [
        ([1.5, 0.4, 6.6], 6.648715),
        ([2.2, 0.3, 7.5], 5.627588),
        ([3.0, 0.9, 7.1], 4.479587),
        ([2.1, 2.2, 7.3], 3.764927),
    ] {
        let value = grid.eval(Vec3::from_array(p)).x;
        assert!(is_close(value, e), "{p:?}: {value} for {e}");
    }
}

#[test]
fn the_box_of_a_file_is_used_as_by_mitsuba() {
    let vol = crate::medium::grids::Vol {
        resolution: RESOLUTION,
        channels: 1,
        bbox: [Vec3::new(1.0, -2.0, 3.0), Vec3::new(3.0, 2.0, 8.0)],
        values: VALUES.to_vec(),
    };
    let own = Affine3A::from_translation(Vec3::Y) * Affine3A::from_scale(Vec3::splat(2.0));
    let place = own * vol.bbox_transform().unwrap();
    for (place, expected) in [(own, [7.0, 7.0, 8.0]), (place, [1.0, 5.05625, 4.05])] {
        let grid = Grid::from_vol(vol.clone(), place, Lookup::default()).unwrap();
        let points = [[2.5, -2.0, 8.0], [3.0, 0.5, 9.0], [5.0, 4.0, 12.0]];
        for (p, e) in points.into_iter().zip(expected) {
            let value = grid.eval(Vec3::from_array(p)).x;
            assert!(is_close(value, e), "{p:?}: {value} for {e}");
        }
    }
}

#[test]
fn channels_are_looked_up_apart() {
    let values = VALUES.iter().flat_map(|&v| [v, 2.0 * v + 1.0, 20.0 - v]);
    let values = Arc::new(values.collect());
    let lookup = Lookup::default();
    let grid = Grid::new(RESOLUTION, 3, values, Affine3A::IDENTITY, lookup).unwrap();
    for (p, e) in [
        ([0.1, 0.2, 0.3], [2.19, 5.38, 17.81]),
        ([0.7, 0.33, 0.6], [7.371901, 15.743802, 12.628099]),
    ] {
        let value = grid.eval(Vec3::from_array(p)).to_array();
        assert!((0..3).all(|c| is_close(value[c], e[c])), "{value:?}");
    }
}

#[test]
fn there_is_no_medium_outside_the_cube() {
    let medium = Heterogeneous::new(
        example(Affine3A::IDENTITY, Lookup::default()),
        2.0,
        Albedo::Constant(Rgb::splat(0.5)),
    );
    let medium = medium.unwrap();
    assert!(is_close(medium.sigma_t(Vec3::splat(0.5)).x, 14.5));
    assert_eq!(medium.sigma_t(Vec3::new(0.5, 1.01, 0.5)), Rgb::ZERO);
    let (org, away) = (Vec3::new(0.5, 1.5, 0.5), Vec3::Y);
    assert_eq!(medium.transmittance(org, away, 1e9, &mut || 0.5), Rgb::ONE);
    assert_eq!(medium.optical_depth(org, -away, 0.5), Rgb::ZERO);
}

#[test]
fn points_that_are_far_or_no_points_do_not_panic() {
    for lookup in lookups() {
        let grid = example(Affine3A::IDENTITY, lookup);
        for x in [1e30, -1e30, f32::INFINITY, f32::NAN] {
            let value = grid.eval(Vec3::new(x, 0.5, 0.5)).x;
            assert!(
                value.is_nan() || (0.0..=11.0).contains(&value),
                "{x}: {value}"
            );
        }
    }
}
