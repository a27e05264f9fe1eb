//! Against meshoptimizer's own encoder, and against damage.

use super::*;
use crate::math::rng::Pcg32;

const TRIANGLES: [&[u8]; 2] = [
    include_bytes!("../../../../../tests/vectors/meshopt/triangles.enc"),
    include_bytes!("../../../../../tests/vectors/meshopt/triangles.raw"),
];
const VERTICES: [&[u8]; 2] = [
    include_bytes!("../../../../../tests/vectors/meshopt/vertices.enc"),
    include_bytes!("../../../../../tests/vectors/meshopt/vertices.raw"),
];
const VERTICES_1: [&[u8]; 2] = [
    include_bytes!("../../../../../tests/vectors/meshopt/vertices1.enc"),
    include_bytes!("../../../../../tests/vectors/meshopt/vertices1.raw"),
];
const COLORS: [&[u8]; 2] = [
    include_bytes!("../../../../../tests/vectors/meshopt/colors.enc"),
    include_bytes!("../../../../../tests/vectors/meshopt/colors.raw"),
];
const NORMALS: [&[u8]; 2] = [
    include_bytes!("../../../../../tests/vectors/meshopt/normals.enc"),
    include_bytes!("../../../../../tests/vectors/meshopt/normals.raw"),
];

fn how(mode: &str, count: usize, byte_stride: usize) -> Compression {
    Compression {
        count,
        byte_stride,
        mode: mode.into(),
        ..Compression::default()
    }
}

#[test]
fn triangles_and_vertices_come_back_byte_for_byte() {
    let [encoded, raw] = TRIANGLES;
    let count = raw.len() / 4;
    assert!(decode(encoded, &how("TRIANGLES", count, 4)).unwrap() == raw);
    let narrow = decode(encoded, &how("TRIANGLES", count, 2)).unwrap();
    assert!(
        narrow
            .chunks(2)
            .zip(raw.chunks(4))
            .all(|(n, w)| n == &w[..2])
    );
    for [encoded, raw] in [VERTICES, VERTICES_1] {
        assert!(decode(encoded, &how("ATTRIBUTES", 300, 20)).unwrap() == raw);
    }
}

#[test]
fn colors_come_back_within_their_bits() {
    let [filtered, raw] = COLORS;
    let mut elements = filtered.to_vec();
    filters::color_8(&mut elements);
    let floats = raw.chunks_exact(4);
    let floats = floats.map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    for (byte, wanted) in elements.iter().zip(floats) {
        let got = f32::from(*byte) / 255.0;
        assert!((got - wanted).abs() < 1.6 / 255.0, "{got} {wanted}");
    }
    // 16 bits, of which ten are used: y 700, co -100, cg 50, opacity 256 of 511.
    let parts = [700i16, -100, 50, 512 | 256];
    let mut element: Vec<u8> = parts.iter().flat_map(|v| v.to_le_bytes()).collect();
    filters::color_16(&mut element);
    let words = element.chunks(2);
    let got: Vec<u16> = words.map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
    let scaled = |v: f32| (v * 65535.0 / 1023.0).round() as u16;
    assert_eq!(got, [550.0, 750.0, 750.0, 512.0].map(scaled));
}

#[test]
fn sequences_have_two_baselines() {
    // 3 on the first baseline, 10 on the second, 2 on the first, 11 on the second.
    let bytes = [0xd1, 12, 41, 2, 5, 0, 0, 0, 0];
    let decoded = decode(&bytes, &how("INDICES", 4, 2)).unwrap();
    assert_eq!(decoded, [3, 0, 10, 0, 2, 0, 11, 0]);
}

#[test]
fn normals_unfold_to_where_they_pointed() {
    let [filtered, raw] = NORMALS;
    let mut elements = filtered.to_vec();
    filters::octahedral_8(&mut elements);
    for (element, expected) in elements.chunks_exact(4).zip(raw.chunks_exact(12)) {
        for (i, &byte) in element[..3].iter().enumerate() {
            let word = expected[4 * i..].first_chunk().copied().unwrap();
            let (got, wanted) = (f32::from(byte as i8) / 127.0, f32::from_le_bytes(word));
            // 8 bits on the octahedron and 8 more on the result.
            assert!((got - wanted).abs() < 0.016, "{got} {wanted}");
        }
    }
    // 16 bits, with 1 encoded as 511: the lower hemisphere, folded over.
    let mut element: Vec<u8> = [256i16, 511, 511, 7]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    filters::octahedral_16(&mut element);
    let (x, y): (f32, f32) = (256.0 / 511.0, 1.0);
    let z = 1.0 - x - y;
    let folded = [x + z, y + z, z];
    let length = folded.iter().map(|v| v * v).sum::<f32>().sqrt();
    let got: Vec<i16> = element
        .chunks(2)
        .map(|b| i16::from_le_bytes([b[0], b[1]]))
        .collect();
    for (got, wanted) in got.iter().zip(folded) {
        let wanted = wanted / length * 32767.0;
        assert!((f32::from(*got) - wanted).abs() <= 1.0, "{got} {wanted}");
    }
    assert_eq!(got[3], 7);
}

#[test]
fn quaternions_and_exponents_are_restored() {
    // (0.5, 0.5, 0.5, 0.5), the second left out: each other one is sqrt(1/2) of the range.
    let part = (std::f32::consts::FRAC_1_SQRT_2 * 2047.0).round() as i16;
    let mut element: Vec<u8> = [part, -part, part, 2044 | 1]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    filters::quaternion(&mut element);
    let got: Vec<f32> = element
        .chunks(2)
        .map(|b| f32::from(i16::from_le_bytes([b[0], b[1]])) / 32767.0)
        .collect();
    for (got, wanted) in got.iter().zip([0.5, 0.5, 0.5, -0.5]) {
        assert!((got - wanted).abs() < 1e-3, "{got} {wanted}");
    }
    let word = |exponent: i32, mantissa: i32| exponent << 24 | mantissa & 0xff_ffff;
    let mut element = word(-3, -5).to_le_bytes().to_vec();
    element.extend(word(10, 3).to_le_bytes());
    filters::exponential(&mut element);
    assert_eq!(element[..4], (-0.625f32).to_le_bytes());
    assert_eq!(element[4..], 3072f32.to_le_bytes());
}

#[test]
fn damage_is_an_error_or_other_numbers_but_never_a_panic() {
    let mut rng = Pcg32::new(1, 2);
    for ([encoded, _], how) in [
        (TRIANGLES, how("TRIANGLES", TRIANGLES[1].len() / 4, 4)),
        (VERTICES, how("ATTRIBUTES", 300, 20)),
        (VERTICES_1, how("ATTRIBUTES", 300, 20)),
    ] {
        for length in (0..encoded.len()).step_by(5) {
            assert!(decode(&encoded[..length], &how).is_err(), "{length}");
        }
        for _ in 0..200 {
            let mut bytes = encoded.to_vec();
            for _ in 0..4 {
                let at = rng.next_u32() as usize % bytes.len();
                bytes[at] = rng.next_u32() as u8;
            }
            let _ = decode(&bytes, &how).map(|d| d.len());
        }
        // A count beyond what the bytes can hold ends with an error, not with memory.
        let count = usize::MAX / 3 * 3;
        assert!(decode(encoded, &Compression { count, ..how }).is_err());
    }
}
