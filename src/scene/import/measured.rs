//! The files of measured materials: those of the RGL's database, in colours (`*_rgb.bsdf`) and in
//! spectra (`*_spec.bsdf`), which become colours.

use super::spectrum::{Weighting, integrate, interpolate};
use super::tensor_file::TensorFile;
use crate::bsdf::{MeasuredBrdf, MeasuredTables};
use crate::image::mapped;
use crate::math::Rgb;
use crate::math::piecewise_linear::Size;
use std::path::Path;

/// Reads a measured material. The same file gives the same one.
///
/// # Errors
/// When the file cannot be read, or holds no such tables.
pub(crate) fn read(path: &Path) -> Result<&'static MeasuredBrdf, String> {
    let bytes = mapped::open(path).map_err(|e| format!("cannot be read: {e}"));
    let brdf = bytes.and_then(|bytes| MeasuredBrdf::new(tables(&bytes)?));
    brdf.map_err(|why| format!("the measured material {}: {why}", path.display()))
}

fn tables(bytes: &[u8]) -> Result<MeasuredTables, String> {
    let file = TensorFile::parse(bytes)?;
    let ([_], azimuths) = file.floats("phi_i")?;
    let ([_], elevations) = file.floats("theta_i")?;
    let single = |name: &str| {
        let ([rows, columns], values) = file.floats(name)?;
        Ok::<_, String>(([columns, rows], values))
    };
    let pairs = [azimuths.len(), elevations.len()];
    let for_pairs = |name: &str| {
        let ([a, e, rows, columns], values) = file.floats(name)?;
        agree(name, [a, e], pairs)?;
        Ok::<_, String>(([columns, rows], values))
    };
    let luminance = for_pairs("luminance")?;
    let colors = colors(&file, pairs)?;
    if colors.0 != luminance.0 {
        return Err("its colours and its \"luminance\" have different resolutions".into());
    }
    Ok(MeasuredTables {
        normals: single("ndf")?,
        areas: single("sigma")?,
        visible: for_pairs("vndf")?,
        luminance,
        colors,
        relative: file
            .list_of_bytes("jacobian")?
            .first()
            .is_some_and(|j| *j != 0),
        azimuths,
        elevations,
    })
}

/// That an array is for as many azimuths and elevations as there are.
fn agree(name: &str, has: [usize; 2], pairs: [usize; 2]) -> Result<(), String> {
    if has == pairs {
        return Ok(());
    }
    let ([a, e], [azimuths, elevations]) = (has, pairs);
    Err(format!(
        "\"{name}\" is for {a} x {e} directions; \"phi_i\" and \"theta_i\" have {azimuths} x {elevations}"
    ))
}

/// Colours, which lie beside each other in the file as a table for each channel or wavelength.
fn colors(file: &TensorFile, pairs: [usize; 2]) -> Result<(Size, Vec<Rgb>), String> {
    let name = if file.has("rgb") { "rgb" } else { "spectra" };
    let ([a, e, channels, rows, columns], values) = file.floats(name)?;
    agree(name, [a, e], pairs)?;
    let weights = match name {
        "rgb" => vec![Rgb::X, Rgb::Y, Rgb::Z],
        _ => wavelength_colors(&file.floats::<1>("wavelengths")?.1)?,
    };
    if channels != weights.len() {
        let needs = weights.len();
        return Err(format!(
            "\"{name}\" has {channels} channels where {needs} are needed"
        ));
    }
    if values.is_empty() {
        return Err(format!("\"{name}\" is empty"));
    }
    let table = rows * columns;
    let mut colors = Vec::with_capacity(values.len() / channels);
    for tables in values.chunks_exact(table * channels) {
        colors.extend((0..table).map(|i| {
            let channels = tables.iter().skip(i).step_by(table);
            let parts = channels.zip(&weights).map(|(value, color)| *color * *value);
            parts.sum::<Rgb>()
        }));
    }
    Ok(([columns, rows], colors))
}

/// The colour of each wavelength: of the curve that is 1 there, 0 at the others and linear in
/// between. Beyond the first and the last one reflectances stay as they are there.
fn wavelength_colors(wavelengths: &[f32]) -> Result<Vec<Rgb>, String> {
    /// More than any instrument tells apart; each takes an integral.
    const MOST: usize = 4096;
    let increase = wavelengths.windows(2).all(|pair| pair[0] < pair[1]);
    let finite = wavelengths.iter().all(|w| w.is_finite());
    if wavelengths.is_empty() || wavelengths.len() > MOST || !increase || !finite {
        return Err(format!(
            "\"wavelengths\" must be 1 to {MOST} increasing numbers"
        ));
    }
    let at = |i: usize| wavelengths.get(i).map(|w| f64::from(*w));
    let color = |i: usize| {
        let before = i.checked_sub(1).and_then(at);
        let (before, here, after) = (before, f64::from(wavelengths[i]), at(i + 1));
        let mut curve = vec![before.map_or((f64::MIN, 1.0), |w| (w, 0.0))];
        curve.push((here, 1.0));
        curve.push(after.map_or((f64::MAX, 1.0), |w| (w, 0.0)));
        integrate(Weighting::Reflectance, |w| interpolate(&curve, w))
    };
    Ok((0..wavelengths.len()).map(color).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Material, Materials, Transport};
    use crate::math::{Pcg32, Vec2, Vec3};
    use crate::texture::SurfacePoint;

    /// An array of a file: its name, its shape, and numbers or bytes.
    type Array<'a> = (&'a str, Vec<u64>, Result<Vec<f32>, Vec<u8>>);

    fn file(arrays: &[Array]) -> Vec<u8> {
        let mut head = b"tensor_file\0\x01\x00".to_vec();
        head.extend((arrays.len() as u32).to_le_bytes());
        let size: usize = arrays
            .iter()
            .map(|(n, s, _)| 13 + n.len() + 8 * s.len())
            .sum();
        let start = head.len() + size;
        let mut data: Vec<u8> = Vec::new();
        for (name, shape, values) in arrays {
            let bytes = match values {
                Ok(floats) => bytemuck::cast_slice(floats),
                Err(bytes) => bytes.as_slice(),
            };
            head.extend((name.len() as u16).to_le_bytes());
            head.extend(name.as_bytes());
            head.extend((shape.len() as u16).to_le_bytes());
            head.push(if values.is_ok() { 10 } else { 1 });
            head.extend(((start + data.len()) as u64).to_le_bytes());
            head.extend(shape.iter().flat_map(|n| n.to_le_bytes()));
            data.extend(bytes);
        }
        head.extend(data);
        head
    }

    /// Facets that are equally dense everywhere, of a spectrum at four wavelengths.
    fn spectral(spectrum: [f32; 4]) -> Vec<Array<'static>> {
        let ones = |n| Ok(vec![1.0; n]);
        vec![
            ("phi_i", vec![1], Ok(vec![0.0])),
            ("theta_i", vec![2], Ok(vec![0.0, 1.5])),
            ("ndf", vec![2, 2], ones(4)),
            ("sigma", vec![2, 2], ones(4)),
            ("vndf", vec![1, 2, 2, 2], ones(8)),
            ("luminance", vec![1, 2, 3, 3], ones(18)),
            ("wavelengths", vec![4], Ok(vec![400.0, 500.0, 600.0, 700.0])),
            (
                "spectra",
                vec![1, 2, 4, 3, 3],
                Ok((0..72).map(|i| spectrum[i / 9 % 4]).collect()),
            ),
            ("jacobian", vec![1], Err(vec![1])),
        ]
    }

    /// The colour by which a spectrum scatters, without the facets' quarter.
    fn scattered(spectrum: [f32; 4]) -> Rgb {
        let brdf = MeasuredBrdf::new(tables(&file(&spectral(spectrum))).unwrap()).unwrap();
        let mut materials = Materials::default();
        let id = materials.push(Material::from(crate::bsdf::material::Measured { brdf }));
        let wo = Vec3::new(0.6, 0.0, 0.8);
        let bsdf = materials.resolve(id, &SurfacePoint::at_uv(Vec2::ZERO), wo);
        bsdf.eval(wo, Vec3::Z, Transport::Radiance) * 4.0
    }

    #[test]
    fn spectra_become_the_colours_that_reflectances_have() {
        let white = scattered([1.0; 4]);
        assert!((white - 1.0).abs().max_element() < 2e-3, "{white}");
        let curve = [
            (-1e9, 0.1),
            (400.0, 0.1),
            (500.0, 0.2),
            (600.0, 0.9),
            (700.0, 0.6),
            (1e9, 0.6),
        ];
        let expected = integrate(Weighting::Reflectance, |w| interpolate(&curve, w));
        let red = scattered([0.1, 0.2, 0.9, 0.6]);
        assert!(
            (red - expected).abs().max_element() < 1e-3,
            "{red} for {expected}"
        );
    }

    /// Refused in words, or taken and harmless.
    fn take(bytes: &[u8]) -> bool {
        match tables(bytes).and_then(MeasuredBrdf::new) {
            Err(why) => {
                assert!(why.len() > 10 && why.len() < 400, "{why}");
                false
            }
            Ok(_) => true,
        }
    }

    fn refused(name: &str, change: impl FnOnce(&mut Array), says: &str) {
        let mut arrays = spectral([0.5; 4]);
        change(arrays.iter_mut().find(|a| a.0 == name).expect("an array"));
        let told = tables(&file(&arrays))
            .and_then(MeasuredBrdf::new)
            .expect_err(name);
        assert!(told.contains(says), "{name}: {told}");
    }

    #[test]
    fn tables_that_cannot_be_used_are_refused_in_words() {
        refused("ndf", |a| a.0 = "nfd", "no \"ndf\"");
        refused(
            "ndf",
            |a| a.2 = Ok(vec![1.0, f32::NAN, 1.0, 1.0]),
            "\"ndf\" holds NaN",
        );
        refused("sigma", |a| a.2 = Ok(vec![-1.0; 4]), "\"sigma\" holds -1");
        refused("sigma", |a| a.1 = vec![1, 4], "at least 2 x 2");
        refused(
            "vndf",
            |a| a.2 = Ok(vec![0.0; 8]),
            "\"vndf\" is 0 everywhere",
        );
        refused(
            "vndf",
            |a| a.1 = vec![2, 1, 2, 2],
            "\"phi_i\" and \"theta_i\" have 1 x 2",
        );
        refused("vndf", |a| a.1 = vec![2, 2, 2], "3 dimensions");
        refused(
            "vndf",
            |a| a.1 = vec![1, 2, 1 << 40, 1 << 40],
            "beyond its end",
        );
        refused("luminance", |a| a.1[3] = 200, "beyond its end");
        refused("luminance", |a| a.1[2] = 2, "different resolutions");
        refused("spectra", |a| a.1[2] = 3, "3 channels where 4");
        refused(
            "spectra",
            |a| a.2 = Ok(vec![f32::INFINITY; 72]),
            "not finite",
        );
        refused("wavelengths", |a| a.2 = Ok(vec![4.0; 4]), "increasing");
        refused("theta_i", |a| a.2 = Ok(vec![0.0; 2]), "increasing angles");
        refused("theta_i", |a| a.2 = Ok(vec![0.0, f32::NAN]), "no angle");
        refused("phi_i", |a| a.1 = vec![0], "is for 1 x 2 directions");
        refused("jacobian", |a| a.2 = Ok(vec![1.0]), "not 1 of U8");
        for rubbish in [&b""[..], b"tensor_file", b"tensor_file\0\x02\x00\0\0\0\0"] {
            assert!(!take(rubbish));
        }
    }

    #[test]
    fn cut_and_changed_files_are_refused_or_read() {
        let whole = file(&spectral([0.5, 0.2, 0.3, 0.4]));
        assert!(take(&whole));
        for end in 0..whole.len() {
            assert!(!take(&whole[..end]), "cut at {end}");
        }
        let mut rng = Pcg32::new(6, 1);
        let mut taken = 0;
        for _ in 0..3000 {
            let mut bytes = whole.clone();
            for _ in 0..=rng.next_u32() % 3 {
                let at = rng.next_u32() as usize % bytes.len();
                bytes[at] = [0, 0xff, 0x7f, rng.next_u32() as u8][rng.next_u32() as usize % 4];
            }
            taken += usize::from(take(&bytes));
        }
        assert!(taken > 100 && taken < 2900, "{taken}");
    }
}
