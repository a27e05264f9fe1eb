//! What a smooth interface does to light: Fresnel's equations for dielectrics and conductors, and
//! the directions of mirror reflection and refraction.
//!
//! Conventions are Mitsuba's: `eta` is the interior over the exterior index of refraction,
//! "exterior" is the side of +z (or of the facet normal), and every direction points away from the
//! surface.

use crate::math::{Rgb, Vec3};

/// Indices of refraction that the equations bear without overflow.
pub(super) fn sane_eta(eta: f32) -> f32 {
    if eta.is_finite() {
        eta.clamp(1e-4, 1e4)
    } else {
        1.0
    }
}

/// Fresnel reflectance of a dielectric, with what refraction needs besides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interface {
    /// Reflectance, 0 to 1.
    pub r: f32,
    /// Cosine of the refracted direction, on the other side than the incident one.
    pub cos_t: f32,
    /// Index of refraction of the transmitted side over the incident side.
    pub eta_it: f32,
    /// Its inverse.
    pub eta_ti: f32,
}

/// Unpolarised reflectance of a dielectric for the signed cosine `cos_i`.
///
/// `eta = 1` reflects nothing, grazing incidence everything, as does total internal reflection.
#[inline]
pub(super) fn dielectric(cos_i: f32, eta: f32) -> Interface {
    let (eta_it, eta_ti) = if cos_i >= 0.0 {
        (eta, 1.0 / eta)
    } else {
        (1.0 / eta, eta)
    };
    let cos_t2 = cos2_transmitted(cos_i * cos_i, eta_it, eta_ti);
    let (ci, ct) = (cos_i.abs(), cos_t2.max(0.0).sqrt());
    let r = if eta == 1.0 {
        0.0
    } else if ci == 0.0 || cos_t2 <= 0.0 {
        1.0
    } else {
        let s = (ci - eta_it * ct) / (ci + eta_it * ct);
        let p = (ct - eta_it * ci) / (ct + eta_it * ci);
        (0.5 * (s * s + p * p)).min(1.0)
    };
    Interface {
        r,
        cos_t: if cos_i >= 0.0 { -ct } else { ct },
        eta_it,
        eta_ti,
    }
}

/// Contrast of an interface of relative index `eta`: its square is the reflectance at normal
/// incidence.
#[inline]
pub(super) fn contrast(eta: f32) -> f32 {
    (eta - 1.0) / (eta + 1.0)
}

/// Snell's law in squared cosines: `1 - (1 - cos^2) / eta^2`, negative on total reflection.
/// Multiplied out it keeps its digits at grazing angles with eta near 1; as it stands, at steep
/// ones with small eta.
#[inline]
fn cos2_transmitted(cos2: f32, eta_it: f32, eta_ti: f32) -> f32 {
    if eta_it < 0.5 {
        return 1.0 - (1.0 - cos2).max(0.0) * eta_ti * eta_ti;
    }
    ((eta_it - 1.0) * (eta_it + 1.0) + cos2) * eta_ti * eta_ti
}

/// Reflectance of a conductor with the complex index `eta + i k` relative to the outside, per
/// channel.
#[inline]
pub(super) fn conductor(cos_i: f32, eta: Rgb, k: Rgb) -> Rgb {
    Rgb::new(
        conductor_channel(cos_i, eta.x, k.x),
        conductor_channel(cos_i, eta.y, k.y),
        conductor_channel(cos_i, eta.z, k.z),
    )
}

/// Moeller, "Optics" (1988), for one channel.
#[inline]
fn conductor_channel(cos_i: f32, eta: f32, k: f32) -> f32 {
    let cos2 = (cos_i * cos_i).min(1.0);
    let sin2 = 1.0 - cos2;
    let t = eta * eta - k * k - sin2;
    let a2b2 = (t * t + 4.0 * k * k * eta * eta).sqrt();
    let a = (0.5 * (a2b2 + t)).max(0.0).sqrt();
    let s1 = a2b2 + cos2;
    let s2 = 2.0 * cos_i.abs() * a;
    let r_s = ratio(s1 - s2, s1 + s2);
    let p1 = a2b2 * cos2 + sin2 * sin2;
    let p2 = s2 * sin2;
    (0.5 * r_s * (1.0 + ratio(p1 - p2, p1 + p2))).clamp(0.0, 1.0)
}

/// `a / b`, or 1 where both vanish: eta = k = 0 at normal incidence, the limit of a perfect mirror.
#[inline]
fn ratio(a: f32, b: f32) -> f32 {
    if b > 0.0 { a / b } else { 1.0 }
}

/// What diffuse light from *inside* a dielectric of relative index `eta` > 1 gets out, of all that
/// arrives; it keeps its digits where nearly nothing does. The rest is reflected.
///
/// Up to 2 this is the fit of Egan and Hilgeman (1973) that Mitsuba uses, so that plastics agree
/// with it; above, where that fit is off by up to 10 %, the fit of d'Eon and Irving (2011) for
/// light from outside, carried inside by the conservation of etendue: `1 - Fi = (1 - Fe) / eta^2`.
#[inline]
pub(super) fn internal_diffuse_transmittance(eta: f32) -> f32 {
    if eta <= 2.0 {
        let e = 1.0 / eta;
        let reflected = 0.6681 + e * (0.7099 - 1.4399 * e) + 0.0636 * eta;
        return 1.0 - reflected.clamp(0.0, 0.999);
    }
    let e = 1.0 / eta;
    let outside =
        0.919_317 + e * (-3.4793 + e * (6.75335 + e * (-7.80989 + e * (4.98554 + e * -1.36881))));
    (1.0 - outside) / (eta * eta)
}

/// Mirror reflection of `w` about the unit normal `m`.
#[inline]
pub(super) fn reflect(w: Vec3, m: Vec3) -> Vec3 {
    m * (2.0 * w.dot(m)) - w
}

/// Refraction of `w` about the unit normal `m`; `i` is the result of [`dielectric`] for `w . m`.
#[inline]
pub(super) fn refract(w: Vec3, m: Vec3, i: &Interface) -> Vec3 {
    m * (w.dot(m) * i.eta_ti + i.cos_t) - w * i.eta_ti
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_reflectances() {
        assert!((dielectric(1.0, 1.5).r - 0.04).abs() < 1e-6);
        assert!((dielectric(-1.0, 1.5).r - 0.04).abs() < 1e-6);
        assert_eq!(dielectric(-0.1, 1.5).r, 1.0);
        assert_eq!(dielectric(0.0, 1.5).r, 1.0);
        assert_eq!(dielectric(0.3, 1.0).r, 0.0);
        // Brewster's angle: half of the light (p-polarised) is not reflected.
        let i = dielectric((1f32 / (1.0 + 2.25)).sqrt(), 1.5);
        let s = (1.5f32 * 1.5 - 1.0) / (1.5 * 1.5 + 1.0);
        assert!((i.r - 0.5 * s * s).abs() < 1e-6);
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        for cos in [1.0, 0.7, 0.3, 0.05] {
            let r = conductor(cos, Rgb::splat(1.5), Rgb::ZERO).x;
            assert!((r - dielectric(cos, 1.5).r).abs() < 1e-5, "{cos}");
        }
    }

    #[test]
    fn conductors_stay_between_zero_and_one() {
        for cos in [0.0, 1e-8, 1e-3, 0.5, 1.0] {
            for eta in [0.0, 1e-3, 0.2, 1.0, 1.5, 1e3] {
                for k in [0.0, 1e-3, 1.0, 3.9, 1e3] {
                    let r = conductor(cos, Rgb::splat(eta), Rgb::splat(k)).x;
                    assert!((0.0..=1.0).contains(&r), "{cos} {eta} {k}: {r}");
                }
            }
            assert!((conductor(cos, Rgb::ZERO, Rgb::ONE).x - 1.0).abs() < 1e-6);
        }
    }

    /// The fits against Fresnel's equations integrated over the hemisphere.
    #[test]
    fn internal_diffuse_reflectance_is_the_integral() {
        for (eta, tolerance) in [
            (1.1, 4e-3),
            (1.3, 2e-3),
            (1.5, 2e-3),
            (1.9, 4e-3),
            (2.5, 2e-3),
        ] {
            let n = 20_000;
            let exact: f64 = (0..n)
                .map(|i| {
                    let mu2 = (i as f64 + 0.5) / n as f64;
                    f64::from(dielectric(-(mu2.sqrt() as f32), eta).r) / n as f64
                })
                .sum();
            let fit = 1.0 - f64::from(internal_diffuse_transmittance(eta));
            assert!((fit - exact).abs() < tolerance, "{eta}: {fit} {exact}");
        }
    }

    #[test]
    fn refraction_obeys_snell() {
        let m = Vec3::new(0.1, -0.2, 1.0).normalize();
        let w = Vec3::new(0.6, 0.3, 0.5).normalize();
        let i = dielectric(w.dot(m), 1.5);
        let t = refract(w, m, &i);
        assert!((t.length() - 1.0).abs() < 1e-6);
        let sin = |v: Vec3| v.cross(m).length();
        assert!((sin(w) - 1.5 * sin(t)).abs() < 1e-6);
        assert!(t.dot(m) < 0.0);
    }
}
