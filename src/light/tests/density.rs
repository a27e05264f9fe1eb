//! What is sampled against the density that is claimed.

use super::scenes::*;
use super::*;
use crate::math::warp::uniform_sphere;

/// Bins of the sphere: columns in longitude, rows of equal height.
const COLUMNS: usize = 48;
const ROWS: usize = 24;
/// Draws of a chi-square test.
const DRAWS: usize = 100_000;
/// Points on each side of a bin at which the density is integrated: where it is smooth and where it
/// is not.
const FINE: [usize; 2] = [12, 100];

fn bin(dir: Vec3) -> usize {
    let turn = dir.y.atan2(dir.x) / std::f32::consts::TAU;
    let x = (((turn - turn.floor()) * COLUMNS as f32) as usize).min(COLUMNS - 1);
    let y = (((1.0 - dir.z) * 0.5 * ROWS as f32) as usize).min(ROWS - 1);
    y * COLUMNS + x
}

/// Mean of the density over bin `i` at `fine` by `fine` jittered points, and its variation.
fn mean_over_bin(setup: &Setup, p: Vec3, n: Vec3, i: usize, fine: usize) -> (f64, f64) {
    let mut rng = Pcg32::new(17, i as u64);
    let (x, y) = ((i % COLUMNS) as f32, (i / COLUMNS) as f32);
    let (mut sum, mut squares) = (0.0, 0.0);
    for j in 0..fine * fine {
        // Jittered, so that edges of lights do not beat with the grid.
        let fx = ((j % fine) as f32 + rng.next_f32()) / fine as f32;
        let fy = ((j / fine) as f32 + rng.next_f32()) / fine as f32;
        let u = Vec2::new((y + fy) / ROWS as f32, (x + fx) / COLUMNS as f32);
        let pdf = f64::from(setup.pdf(p, n, uniform_sphere(u)));
        sum += pdf;
        squares += pdf * pdf;
    }
    let count = (fine * fine) as f64;
    let mean = sum / count;
    (mean, (squares / count - mean * mean).max(0.0).sqrt())
}

/// Expected share of each bin, from the density, and the standard error of that (at most: the
/// points are stratified).
fn shares(setup: &Setup, p: Vec3, n: Vec3, counts: &[u32]) -> Vec<[f64; 2]> {
    let size = 4.0 * std::f64::consts::PI / (ROWS * COLUMNS) as f64;
    (0..ROWS * COLUMNS)
        .map(|i| {
            let mut fine = FINE[0];
            let (mut mean, mut variation) = mean_over_bin(setup, p, n, i, fine);
            // An edge runs through: look closer.
            if variation > 0.2 * mean || (mean == 0.0 && counts[i] > 0) {
                fine = FINE[1];
                (mean, variation) = mean_over_bin(setup, p, n, i, fine);
            }
            [mean * size, variation * size / fine as f64]
        })
        .collect()
}

/// Compares draws with the density by chi-square, and each draw's own density with the one `pdf_*`
/// gives.
fn check(name: &str, setup: &Setup, p: Vec3, n: Vec3) {
    let mut counts = vec![0u32; ROWS * COLUMNS];
    let mut rng = Pcg32::new(7, 2);
    let mut lost = 0;
    for _ in 0..DRAWS {
        let u = [(); 3].map(|()| rng.next_f32());
        let Some(s) = setup.lights.sample(p, n, &mut (), u).filter(|s| !s.delta) else {
            lost += 1;
            continue;
        };
        counts[bin(s.dir)] += 1;
        if lost + counts[bin(s.dir)] < 400 {
            same_density(name, setup, p, n, &s);
        }
    }
    let shares = shares(setup, p, n, &counts);
    let drawn = 1.0 - f64::from(lost) / DRAWS as f64;
    let total: f64 = shares.iter().map(|s| s[0]).sum();
    assert!(
        (total - drawn).abs() < 0.003 + 3.0 / (DRAWS as f64).sqrt(),
        "{name} at {p}: the density holds {total}, but {drawn} was drawn"
    );
    let (mut statistic, mut freedom) = (0.0, 0.0);
    let (mut rare, mut rare_seen, mut rare_variance) = (0.0, 0.0, 10.0);
    for (share, &seen) in shares.iter().zip(&counts) {
        let [expected, error] = share.map(|s| s * DRAWS as f64);
        let variance = expected + error * error;
        if expected < 10.0 {
            rare += expected;
            rare_seen += f64::from(seen);
            rare_variance += variance;
            continue;
        }
        statistic += (f64::from(seen) - expected).powi(2) / variance;
        freedom += 1.0;
    }
    assert!(
        (rare - rare_seen).abs() < 5.0 * rare_variance.sqrt(),
        "{name} at {p}: {rare_seen} instead of {rare} in rare bins"
    );
    let limit = freedom + 6.0 * (2.0f64 * freedom).sqrt() + 6.0;
    assert!(
        statistic < limit,
        "{name} at {p}: chi-square {statistic} with {freedom} degrees of freedom"
    );
}

/// The density and radiance of a sample are those of the ray along it.
fn same_density(name: &str, setup: &Setup, p: Vec3, n: Vec3, s: &LightSample) {
    let met = setup.meet(p, s.dir);
    // Something in front of the sampled light, or an edge: another light's density counts there.
    if met.is_some_and(|m| (m.t - s.distance).abs() > 1e-3 * m.t)
        || met.is_none() != s.distance.is_infinite()
    {
        return;
    }
    let (pdf, grazing) = match met {
        Some(m) => (
            setup
                .lights
                .pdf_area((p, n), &(), (m.emitter, m.prim), (m.q, m.ng)),
            -m.ng.dot(s.dir),
        ),
        None => (setup.lights.environment_pdf(p, n, s.dir).1, 1.0),
    };
    // At a curved silhouette the density has a pole, 1 / cos: the rounding of the hit moves it.
    if grazing < 0.02 {
        return;
    }
    let allowed = 1e-3 + 3e-5 / (grazing * grazing);
    assert!(
        (pdf / s.pdf - 1.0).abs() < allowed,
        "{name} at {p}: sampled with {} along {}, but the density is {pdf}",
        s.pdf,
        s.dir
    );
    let radiance = setup.radiance(p, s.dir);
    assert!(
        (radiance - setup.lights.radiance(&s.incoming)).length() <= 2e-3 * radiance.length(),
        "{name}: {s:?}"
    );
}

/// Points around, beside and close to lights near the origin, with and without normals.
fn check_everywhere(name: &str, setup: &Setup) {
    for p in [
        Vec3::new(3.0, 1.0, 2.0),
        Vec3::new(-1.5, 0.4, 0.8),
        Vec3::new(0.2, -0.9, -1.4),
    ] {
        check(name, setup, p, Vec3::ZERO);
        check(name, setup, p, -p.normalize());
        check(name, setup, p, Vec3::new(0.3, 0.9, -0.3).normalize());
    }
}

fn one(shape: EmitterShape) -> Setup {
    setup(vec![(shape, constant(2.0))], vec![])
}

#[test]
fn spheres() {
    let at = Vec3::new(0.1, 0.2, 0.0);
    check_everywhere(
        "sphere",
        &one(exact(
            AnalyticKind::Sphere,
            placed(Vec3::splat(0.6), at),
            false,
        )),
    );
    let inside = one(exact(
        AnalyticKind::Sphere,
        placed(Vec3::splat(4.0), at),
        true,
    ));
    check_everywhere("inside of a sphere", &inside);
    let scale = Vec3::new(0.5, 0.8, 0.2);
    check_everywhere(
        "ellipsoid",
        &one(exact(AnalyticKind::Sphere, placed(scale, at), false)),
    );
}

#[test]
fn flat_and_round_shapes() {
    let map = placed(Vec3::new(0.8, 0.5, 1.0), Vec3::ZERO);
    check_everywhere("disk", &one(exact(AnalyticKind::Disk, map, false)));
    check_everywhere("rectangle", &one(exact(AnalyticKind::Rectangle, map, true)));
    let mirrored = placed(Vec3::new(0.8, -0.5, 0.6), Vec3::ZERO);
    check_everywhere(
        "mirrored rectangle",
        &one(exact(AnalyticKind::Rectangle, mirrored, false)),
    );
    check_everywhere(
        "cylinder",
        &one(exact(AnalyticKind::Cylinder, mirrored, false)),
    );
    check_everywhere(
        "cylinder, inside",
        &one(exact(AnalyticKind::Cylinder, mirrored, true)),
    );
}

#[test]
fn meshes() {
    let corner = Vec3::new(-0.5, -0.4, 0.1);
    let triangle = mesh(
        &[corner, Vec3::new(0.7, 0.0, -0.3), Vec3::new(0.0, 0.9, 0.5)],
        &[[0, 1, 2]],
    );
    check_everywhere("triangle", &one(triangle));
    let quad = quad_mesh(corner, Vec3::X, Vec3::Y * 1.3);
    check_everywhere("quad", &one(quad));
    let slanted = quad_mesh(corner, Vec3::X, Vec3::new(0.5, 1.0, 0.0));
    check_everywhere("parallelogram", &one(slanted));
    check_everywhere("strewn", &one(strewn(15, 0.5, 5)));
}

#[test]
fn environments() {
    let grey = Emitter::Constant {
        radiance: Rgb::splat(0.7),
    };
    check_everywhere("constant", &setup(vec![], vec![grey.clone()]));
    let quad = quad_mesh(Vec3::new(-0.5, -0.4, 0.1), Vec3::X, Vec3::Y);
    let parallel = Emitter::Directional {
        direction: Vec3::NEG_Y,
        irradiance: Rgb::ONE,
    };
    let mixed = setup(vec![(quad, constant(3.0))], vec![grey, parallel]);
    check_everywhere("mixed", &mixed);
}
