//! Gradient noise (Perlin, "Improving Noise", SIGGRAPH 2002) and sums of it.

use crate::math::special::smoothstep;
use crate::math::{Vec2, Vec3};
use glam::FloatExt;

/// How much detail noise has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octaves {
    /// Number of them.
    pub count: u32,
    /// What each has of the one before, 0 to 1.
    pub roughness: f32,
}

impl Octaves {
    /// Sum of the amplitudes.
    pub fn sum(&self) -> f32 {
        (0..self.count).map(|i| self.roughness.powi(i as i32)).sum()
    }
}

/// Perlin's permutation of 0 to 255, from his reference implementation of 2002.
#[rustfmt::skip]
const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225,
    140, 36, 103, 30, 69, 142, 8, 99, 37, 240, 21, 10, 23, 190, 6, 148,
    247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32,
    57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175,
    74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83, 111, 229, 122,
    60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54,
    65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169,
    200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64,
    52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212,
    207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213,
    119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9,
    129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104,
    218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162, 241,
    81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157,
    184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93,
    222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78, 66, 215, 61, 156, 180,
];

/// Each octave is this much finer than the one before: not 2, so that their lattices never meet.
const FINER: f32 = 1.99;
/// Coordinates are taken modulo this: beyond it single precision has no fractions left.
const FARTHEST: f32 = 1e9;

/// Noise at a point, -1 to 1, 0 on the lattice of integers.
pub fn noise(p: Vec3) -> f32 {
    let p = Vec3::from_array(
        p.to_array()
            .map(|x| if x.is_finite() { x % FARTHEST } else { 0.0 }),
    );
    let cell = p.floor();
    let d = p - cell;
    let corner = |i: i32, j: i32, k: i32| {
        let at = cell.as_ivec3() + glam::IVec3::new(i, j, k);
        gradient(at.to_array(), d - glam::IVec3::new(i, j, k).as_vec3())
    };
    // Perlin's fade, 6 t^5 - 15 t^4 + 10 t^3.
    let w = d * d * d * (d * (d * 6.0 - 15.0) + 10.0);
    let edge = |j, k| corner(0, j, k).lerp(corner(1, j, k), w.x);
    let face = |k| edge(0, k).lerp(edge(1, k), w.y);
    face(0).lerp(face(1), w.z)
}

/// One of the twelve gradients of a lattice point, times the offset from it. Of the sixteen hashes
/// the last four repeat gradients; which ones is pbrt's choice.
fn gradient(at: [i32; 3], d: Vec3) -> f32 {
    let step = |hash: u8, i: i32| PERMUTATION[usize::from(hash.wrapping_add(i as u8))];
    let hash = step(step(PERMUTATION[usize::from(at[0] as u8)], at[1]), at[2]) & 15;
    let in_plane = hash == 12 || hash == 13;
    let u = if hash < 8 || in_plane { d.x } else { d.y };
    let v = if hash < 4 || in_plane { d.y } else { d.z };
    let sign = |bit: u8, x: f32| if hash & bit != 0 { -x } else { x };
    sign(1, u) + sign(2, v)
}

/// Octaves that something seen `width` wide shows: those that are coarser than twice that.
fn visible(width: f32, octaves: &Octaves) -> (u32, f32) {
    let most = octaves.count as f32;
    let n = (-1.0 - width.max(f32::MIN_POSITIVE).log2()).clamp(0.0, most);
    (n as u32, n - n.floor())
}

/// Fractional Brownian motion: octaves of noise, seen `width` wide.
pub fn fbm(p: Vec3, width: f32, octaves: &Octaves) -> f32 {
    let (whole, part) = visible(width, octaves);
    let (mut sum, mut finer, mut share) = (0.0, 1.0, 1.0);
    for _ in 0..whole {
        sum += share * noise(p * finer);
        finer *= FINER;
        share *= octaves.roughness;
    }
    sum + share * smoothstep(0.3, 0.7, part) * noise(p * finer)
}

/// Octaves of absolute values of noise, seen `width` wide. What is too fine to be seen counts as
/// its mean.
pub fn turbulence(p: Vec3, width: f32, octaves: &Octaves) -> f32 {
    const MEAN: f32 = 0.2;
    let (whole, part) = visible(width, octaves);
    let (mut sum, mut finer, mut share) = (0.0, 1.0, 1.0);
    for _ in 0..whole {
        sum += share * noise(p * finer).abs();
        finer *= FINER;
        share *= octaves.roughness;
    }
    let seen = smoothstep(0.3, 0.7, part);
    sum += share * MEAN.lerp(noise(p * finer).abs(), seen);
    for _ in whole..octaves.count {
        sum += share * MEAN;
        share *= octaves.roughness;
    }
    sum
}

/// Whether a place of the plane lies in one of pbrt's polka dots: two in five of the unit cells
/// around integers hold a dot of radius [`DOT`], moved so that it stays inside (the book, 3rd edition,
/// section 10.5.2).
pub fn in_polka_dot(st: Vec2) -> bool {
    let cell = (st + 0.5).floor();
    let at = |x: f32, y: f32| noise(Vec3::new(cell.x + x, cell.y + y, 0.5));
    if at(0.5, 0.5) <= 0.0 {
        return false;
    }
    let shift = Vec2::new(at(1.5, 2.8), at(4.5, 9.8)) * (0.5 - DOT);
    (st - cell - shift).length_squared() < DOT * DOT
}

/// Radius of a polka dot.
const DOT: f32 = 0.35;
/// Share of the plane that dots cover: in the middle of 39.6 % of all cells noise is above 0.
pub const DOTTED: f32 = 0.396 * std::f32::consts::PI * DOT * DOT;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    const FINE: Octaves = Octaves {
        count: 8,
        roughness: 0.5,
    };

    fn points() -> impl Iterator<Item = Vec3> {
        let mut rng = Pcg32::new(5, 1);
        (0..20_000)
            .map(move |_| Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 200.0 - 100.0)
    }

    #[test]
    fn noise_is_zero_on_the_lattice_and_continuous() {
        for p in points() {
            assert_eq!(noise(p.floor()), 0.0);
            let near = noise(p + Vec3::splat(1e-3));
            assert!((near - noise(p)).abs() < 0.02, "{p}");
            assert!(noise(p).abs() <= 1.0);
        }
    }

    /// Its mean is 0, and that of its absolute value about a fifth.
    #[test]
    fn noise_has_its_means() {
        let n = 20_000.0;
        let mean: f32 = points().map(noise).sum::<f32>() / n;
        let absolute: f32 = points().map(|p| noise(p).abs()).sum::<f32>() / n;
        assert!(mean.abs() < 0.01, "{mean}");
        assert!((absolute - 0.2).abs() < 0.03, "{absolute}");
    }

    /// By hand: at (0.5, 0.25, 0) between four lattice points of the plane z = 0, whose hashes
    /// follow from the permutation.
    #[test]
    fn noise_is_perlins() {
        let perm = |i: usize| usize::from(PERMUTATION[i & 255]);
        let hash = |x: usize, y: usize| perm(perm(perm(x) + y)) & 15;
        let dot = |h: usize, x: f32, y: f32| {
            // The gradient's x and y for each hash.
            let table = [
                (1., 1.),
                (-1., 1.),
                (1., -1.),
                (-1., -1.),
                (1., 0.),
                (-1., 0.),
                (1., 0.),
                (-1., 0.),
                (0., 1.),
                (0., -1.),
                (0., 1.),
                (0., -1.),
                (1., 1.),
                (-1., 1.),
                (0., 1.),
                (0., -1.),
            ];
            table[h].0 * x + table[h].1 * y
        };
        let fade = |t: f32| ((6.0 * t - 15.0) * t + 10.0) * t * t * t;
        let (x, y) = (0.5, 0.25);
        let row = |j: usize| {
            let dy = y - j as f32;
            let (a, b) = (dot(hash(0, j), x, dy), dot(hash(1, j), x - 1.0, dy));
            a + (b - a) * fade(x)
        };
        let expected = row(0) + (row(1) - row(0)) * fade(y);
        let found = noise(Vec3::new(x, y, 0.0));
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }

    /// Dots cover their share, none leaves its cell, and there is one where the book's formula says.
    #[test]
    fn polka_dots_cover_their_share() {
        const SIDE: u16 = 1000;
        let mut inside = 0;
        for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
            let at = Vec2::new(f32::from(i), f32::from(j)) * 0.1;
            inside += u32::from(in_polka_dot(at));
        }
        let share = inside as f32 / 1e6;
        assert!((share / DOTTED - 1.0).abs() < 0.01, "{share} for {DOTTED}");
        for (i, j) in (0..30u8).flat_map(|i| (0..30u8).map(move |j| (i, j))) {
            let cell = Vec2::new(f32::from(i), f32::from(j));
            let border = (0..20u8).map(|k| f32::from(k) / 20.0 - 0.5);
            assert!(
                border
                    .clone()
                    .all(|x| !in_polka_dot(cell + Vec2::new(x, 0.499)))
            );
            assert!(
                border
                    .clone()
                    .all(|y| !in_polka_dot(cell + Vec2::new(0.499, y)))
            );
            let present = noise(Vec3::new(cell.x + 0.5, cell.y + 0.5, 0.5)) > 0.0;
            assert_eq!(in_polka_dot(cell), present, "{cell}");
        }
    }

    #[test]
    fn sums_lose_their_details_with_the_distance() {
        for p in points().take(2000) {
            assert_eq!(fbm(p, 1.0, &FINE), 0.0);
            let flat = turbulence(p, 1.0, &FINE);
            let all: f32 = (0..9).map(|i| 0.2 * 0.5f32.powi(i)).sum();
            assert!((flat - all).abs() < 0.21, "{flat} {all}");
            assert!(fbm(p, 1e-9, &FINE).abs() < 2.0);
        }
        for odd in [f32::NAN, f32::INFINITY, 1e38, -1e38] {
            let p = Vec3::splat(odd);
            assert!(fbm(p, odd, &FINE).is_finite() && turbulence(p, odd, &FINE).is_finite());
        }
    }
}
