//! Tiles and pixels as rows of 64-bit numbers, and those as EXR's 32-bit ones.

use crate::film::mattes::{ShapeSum, ShapeSums};
use crate::film::{FeatureSums, Late, Pixel, Tile};
use xxhash_rust::xxh3::Xxh3;

/// What is stored of a pixel. EXR sorts channels by name: so is this list, and `.high` stays before
/// `.low`.
pub const PIXEL: [&str; 31] = [
    "albedo.b",
    "albedo.g",
    "albedo.r",
    "count",
    "depth",
    "features.albedo.b",
    "features.albedo.g",
    "features.albedo.r",
    "features.normal.x",
    "features.normal.y",
    "features.normal.z",
    "features.weight",
    "late.b",
    "late.from",
    "late.g",
    "late.r",
    "late.worth",
    "late.worth_squares",
    "met",
    "normal.x",
    "normal.y",
    "normal.z",
    "radiance.b",
    "radiance.g",
    "radiance.r",
    "squares.b",
    "squares.g",
    "squares.r",
    "weight",
    "worth",
    "worth_squares",
];

/// What is stored of a shape that a pixel sees, sorted too: where and which, and how much of it.
pub const SHAPE: [&str; 2] = ["place", "weight"];

/// What is stored of a tile, sorted too.
pub const TILE: [&str; 9] = [
    "check",
    "done",
    "dropped",
    "first.known",
    "first.sample",
    "first.x",
    "first.y",
    "index",
    "shapes",
];

/// The halves of a 64-bit number, in the order of their channels.
pub const HALVES: [&str; 2] = ["high", "low"];

/// The numbers of a pixel, in the order of [`PIXEL`].
pub type PixelNumbers = [u64; PIXEL.len()];

/// Those of a pixel.
pub fn of_pixel(p: &Pixel) -> PixelNumbers {
    let [ar, ag, ab] = p.albedo.map(f64::to_bits);
    let [nx, ny, nz] = p.normal.map(f64::to_bits);
    let [rr, rg, rb] = p.radiance.map(f64::to_bits);
    let [sr, sg, sb] = p.squares.map(f64::to_bits);
    let [depth, weight, worth, ws] =
        [p.depth, p.weight, p.worth, p.worth_squares].map(f64::to_bits);
    let [far, fag, fab] = p.features.albedo.map(f64::to_bits);
    let [fnx, fny, fnz] = p.features.normal.map(f64::to_bits);
    let fw = p.features.weight.to_bits();
    let late = &p.late;
    let [lr, lg, lb] = late.radiance.map(f64::to_bits);
    let [late_worth, late_ws] = [late.worth, late.worth_squares].map(f64::to_bits);
    [
        ab, ag, ar, p.count, depth, fab, fag, far, fnx, fny, fnz, fw, lb, late.from, lg, lr,
        late_worth, late_ws, p.met, nx, ny, nz, rb, rg, rr, sb, sg, sr, weight, worth, ws,
    ]
}

/// The pixel of the numbers.
pub fn to_pixel(n: &PixelNumbers) -> Pixel {
    let real = |i: usize| f64::from_bits(n[i]);
    Pixel {
        radiance: [real(24), real(23), real(22)],
        squares: [real(27), real(26), real(25)],
        weight: real(28),
        worth: real(29),
        worth_squares: real(30),
        count: n[3],
        albedo: [real(2), real(1), real(0)],
        normal: [real(19), real(20), real(21)],
        depth: real(4),
        met: n[18],
        features: FeatureSums {
            albedo: [real(7), real(6), real(5)],
            normal: [real(8), real(9), real(10)],
            weight: real(11),
        },
        late: Late {
            from: n[13],
            radiance: [real(15), real(14), real(12)],
            worth: real(16),
            worth_squares: real(17),
        },
    }
}

/// Those of a tile, in the order of [`TILE`].
pub type TileNumbers = [u64; TILE.len()];

/// Those of a shape that a pixel sees, in the order of [`SHAPE`].
pub type ShapeNumbers = [u64; SHAPE.len()];

/// The shapes that the pixels of a tile see. The number of a shape is one more here: what is 0
/// only fills a row.
pub fn of_shapes(tile: &Tile) -> Vec<ShapeNumbers> {
    let numbers = |(pixel, sum): (u32, ShapeSum)| {
        let place = (u64::from(pixel) << 32) | (u64::from(sum.shape) + 1);
        [place, sum.weight.to_bits()]
    };
    tile.all_shapes().map(numbers).collect()
}

/// The shapes that so many pixels see. None if they are not in order, or of other pixels, or more
/// shapes than that.
pub fn to_shapes(list: &[ShapeNumbers], pixels: usize, shapes: usize) -> Option<Vec<ShapeSums>> {
    let mut sums = vec![ShapeSums::new(); pixels];
    let mut last = 0;
    for &[place, weight] in list {
        let (pixel, shape) = ((place >> 32) as usize, (place as u32).checked_sub(1)?);
        if place <= last || shape as usize >= shapes {
            return None;
        }
        last = place;
        sums.get_mut(pixel)?.push(ShapeSum {
            shape,
            weight: f64::from_bits(weight),
        });
    }
    Some(sums)
}

/// The numbers of tile number `index` in the order of [`TILE`]; `seal` is that of the record.
pub fn of_tile(index: usize, tile: &Tile, seal: u64) -> TileNumbers {
    let (x, y, sample) = tile.first_invalid.unwrap_or_default();
    let known = u64::from(tile.first_invalid.is_some());
    let shapes = tile.all_shapes().count() as u64;
    let mut row = [0, tile.done, tile.invalid, known, sample, 0, 0, 0, shapes];
    (row[5], row[6], row[7]) = (u64::from(x), u64::from(y), index as u64);
    row[0] = check(&row, tile, seal);
    row
}

/// Number of a tile on the film, from its row.
pub fn index_of(row: &TileNumbers) -> u64 {
    row[7]
}

/// How many shapes the pixels of a tile see together, from its row.
pub fn shapes_of(row: &TileNumbers) -> usize {
    usize::try_from(row[8]).unwrap_or(usize::MAX)
}

/// Puts a row into the tile that it is about, whose sums are those of the file. `false` if the
/// checksum is wrong.
pub fn to_tile(row: &TileNumbers, seal: u64, tile: &mut Tile) -> bool {
    tile.done = row[1];
    tile.invalid = row[2];
    tile.first_invalid = (row[3] != 0).then_some((row[5] as u32, row[6] as u32, row[4]));
    check(row, tile, seal) == row[0]
}

/// The checksum that a record gives to all tiles.
pub fn seal(record: &str) -> u64 {
    xxhash_rust::xxh3::xxh3_64(record.as_bytes())
}

/// The checksum of a tile: everything in the row but itself, and the sums.
fn check(row: &TileNumbers, tile: &Tile, seal: u64) -> u64 {
    let mut hash = Xxh3::new();
    hash.update(&seal.to_le_bytes());
    let mut add = |numbers: &[u64]| {
        for number in numbers {
            hash.update(&number.to_le_bytes());
        }
    };
    add(&row[1..]);
    tile.pixels.iter().for_each(|pixel| add(&of_pixel(pixel)));
    tile.extras.iter().for_each(|sum| add(&[sum.to_bits()]));
    of_shapes(tile).iter().for_each(|numbers| add(numbers));
    hash.digest()
}

/// The half of a number that channel `channel` of a row holds.
pub fn half(numbers: &[u64], channel: usize) -> u32 {
    let number = numbers[channel / 2];
    if channel % 2 == 0 {
        (number >> 32) as u32
    } else {
        number as u32
    }
}

/// The same of one of several reals.
pub fn half_of(reals: &[f64], channel: usize) -> u32 {
    half(&[reals[channel / 2].to_bits()], channel % 2)
}

/// Puts a half into its number.
pub fn put_half(numbers: &mut [u64], channel: usize, half: u32) {
    let shift = if channel % 2 == 0 { 32 } else { 0 };
    numbers[channel / 2] |= u64::from(half) << shift;
}
