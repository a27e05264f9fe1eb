//! Filters: vectors and numbers of fewer bits, brought back to what accessors read.

use std::f32::consts::FRAC_1_SQRT_2;

/// Unit vectors folded onto an octahedron, the third number standing for 1; signed bytes.
pub(super) fn octahedral_8(elements: &mut [u8]) {
    for element in elements.chunks_exact_mut(4) {
        let [x, y, one] = [0, 1, 2].map(|i| f32::from(element[i] as i8));
        let unit = unfold(x, y, one, 127.0);
        for (byte, value) in element.iter_mut().zip(unit) {
            *byte = value as i8 as u8;
        }
    }
}

/// The same of 16 bits.
pub(super) fn octahedral_16(elements: &mut [u8]) {
    for element in elements.chunks_exact_mut(8) {
        let [x, y, one, _] = words(element).map(f32::from);
        for (i, value) in unfold(x, y, one, 32767.0).into_iter().enumerate() {
            element[2 * i..2 * i + 2].copy_from_slice(&(value as i16).to_le_bytes());
        }
    }
}

/// The unit vector times `largest`, in whole numbers.
fn unfold(x: f32, y: f32, one: f32, largest: f32) -> [f32; 3] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    let below = z.min(0.0).abs();
    let (x, y) = (x - below.copysign(x), y - below.copysign(y));
    let scale = largest / (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|v| (v * scale).round())
}

/// Quaternions without their largest component, which the lowest two bits of the last number name.
pub(super) fn quaternion(elements: &mut [u8]) {
    for element in elements.chunks_exact_mut(8) {
        let values = words(element);
        let range = FRAC_1_SQRT_2 / f32::from(values[3] | 3);
        let [x, y, z] = [0, 1, 2].map(|i| f32::from(values[i]) * range);
        let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
        let largest = (values[3] & 3) as usize;
        for (i, value) in [w, x, y, z].into_iter().enumerate() {
            let at = 2 * ((largest + i) % 4);
            let number = (value * 32767.0).round() as i16;
            element[at..at + 2].copy_from_slice(&number.to_le_bytes());
        }
    }
}

/// Numbers of an exponent of 8 bits and a mantissa of 24.
pub(super) fn exponential(elements: &mut [u8]) {
    for element in elements.chunks_exact_mut(4) {
        let word = i32::from_le_bytes([element[0], element[1], element[2], element[3]]);
        let (exponent, mantissa) = (word >> 24, word << 8 >> 8);
        let value = (f64::from(mantissa) * f64::from(exponent).exp2()) as f32;
        element.copy_from_slice(&value.to_le_bytes());
    }
}

/// Colours as luma and two chromas, of as many bits as the highest bit of the fourth number says;
/// bytes.
pub(super) fn color_8(elements: &mut [u8]) {
    for element in elements.chunks_exact_mut(4) {
        let chroma = |i: usize| i32::from(element[i] as i8);
        let parts = [element[0].into(), chroma(1), chroma(2), element[3].into()];
        let color = rgba(parts, 255.0);
        element.copy_from_slice(&color.map(|v| v as u8));
    }
}

/// The same of 16 bits.
pub(super) fn color_16(elements: &mut [u8]) {
    for element in elements.chunks_exact_mut(8) {
        let [y, co, cg, a] = words(element);
        let parts = [(y as u16).into(), co.into(), cg.into(), (a as u16).into()];
        for (i, value) in rgba(parts, 65535.0).into_iter().enumerate() {
            element[2 * i..2 * i + 2].copy_from_slice(&(value as u16).to_le_bytes());
        }
    }
}

/// Red, green, blue and opacity up to `largest`, in whole numbers.
fn rgba([y, co, cg, a]: [i32; 4], largest: f32) -> [f32; 4] {
    let scale = (2 << a.max(1).ilog2()) - 1;
    // Opacity has one bit less: its last one stands twice.
    let a = a & (scale >> 1);
    let opacity = a << 1 | a & 1;
    let color = [y + co - cg, y + cg, y - co - cg, opacity];
    color.map(|v| {
        (v as f32 * (largest / scale as f32))
            .round()
            .clamp(0.0, largest)
    })
}

/// Four numbers of 16 bits.
fn words(element: &[u8]) -> [i16; 4] {
    [0, 2, 4, 6].map(|at| i16::from_le_bytes([element[at], element[at + 1]]))
}
