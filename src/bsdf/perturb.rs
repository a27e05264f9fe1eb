//! Frames turned by bump and normal maps.
//!
//! As in Mitsuba 3: a normal that would face away from the viewer is mirrored about the surface's
//! own (Schuessler et al., "Microfacet-based Normal Mapping", 2017), directions whose side differs
//! between the two frames carry nothing, and the hard edge that this leaves is softened by the
//! shadowing term of Estevez et al., "A Microfacet-Based Shadowing Function to Solve the Bump
//! Terminator Problem" (Ray Tracing Gems, 2019). A scene can do without the first and the last.

use super::lobes::{Lobe, weighted};
use super::{BsdfSample, Transport, normal_correction};
use crate::math::{Frame, Rgb, Vec2, Vec3};

/// What is done about normals that a map turns so far that light comes from behind them (Mitsuba
/// 3's `flip_invalid_normals` and `use_shadowing_function`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidNormals {
    /// A normal that faces away from the viewer is mirrored about the surface's own.
    pub flip: bool,
    /// Light at a slant to a turned normal is softened.
    pub shadow: bool,
}

impl Default for InvalidNormals {
    fn default() -> Self {
        Self {
            flip: true,
            shadow: true,
        }
    }
}

/// A frame in the coordinates of the frame it turns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Perturbation {
    frame: Frame,
    shadow: bool,
}

/// Squared tangent of the angle to +z.
#[inline]
fn tan2(w: Vec3) -> f32 {
    let z2 = w.z * w.z;
    (1.0 - z2).max(0.0) / z2.max(1e-12)
}

impl Perturbation {
    /// The frame around the local normal `n` (any length; zero or not-a-number leaves the surface
    /// as it is) seen from the local direction `wo`.
    pub fn new(n: Vec3, wo: Vec3, invalid: InvalidNormals) -> Self {
        let mut n = n;
        if invalid.flip && wo.z * wo.dot(n) <= 0.0 {
            n = Vec3::new(-n.x, -n.y, n.z);
        }
        let n = n.try_normalize().unwrap_or(Vec3::Z);
        let s = (Vec3::X - n * n.x).try_normalize().unwrap_or(Vec3::Y);
        let t = n.cross(s);
        Self {
            frame: Frame { s, t, n },
            shadow: invalid.shadow,
        }
    }

    /// The frame itself.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Shadowing of the light, which arrives from `wi` on camera paths and from `wo` on photon
    /// paths, and for the latter the factor by which a turned normal makes scattering asymmetric.
    fn factor(&self, wo: Vec3, wi: Vec3, transport: Transport) -> f32 {
        let light = match transport {
            Transport::Radiance => wi,
            Transport::Importance => wo,
        };
        let alpha2 = (0.125 * tan2(self.frame.n)).min(1.0);
        let shadow = match self.shadow {
            true => 2.0 / (1.0 + (1.0 + alpha2 * tan2(light)).sqrt()),
            false => 1.0,
        };
        match transport {
            Transport::Radiance => shadow,
            Transport::Importance => shadow * normal_correction(wo, wi, self.frame.n, Vec3::Z),
        }
    }

    /// Value and density of the model `inner` in the turned frame.
    pub fn eval_pdf(
        &self,
        inner: &impl Lobe,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Rgb, f32) {
        let (o, i) = (self.frame.to_local(wo), self.frame.to_local(wi));
        if wi.z * i.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let (value, pdf) = inner.eval_pdf(o, i, transport);
        (value * self.factor(wo, wi, transport), pdf)
    }

    /// A direction from the model `inner` in the turned frame.
    pub fn sample(
        &self,
        inner: &impl Lobe,
        wo: Vec3,
        (u_lobe, u): (f32, Vec2),
        transport: Transport,
    ) -> Option<BsdfSample> {
        let o = self.frame.to_local(wo);
        let s = inner.sample(o, u_lobe, u, transport)?;
        let wi = self.frame.to_world(s.wi);
        if wi.z * s.wi.z <= 0.0 {
            return None;
        }
        let weight = s.weight * self.factor(wo, wi, transport);
        weighted(wi, weight, s.pdf, s.eta, s.lobe)
    }
}

/// The local normal that a displacement with the given gradient in (u, v) makes of a surface with
/// shading frame `frame` (Blinn 1978; the change of the base normal is left out, as in Mitsuba).
/// Zero where the parameterisation is degenerate.
pub(super) fn bumped_normal(
    frame: &Frame,
    ng: Vec3,
    (dp_du, dp_dv): (Vec3, Vec3),
    gradient: Vec2,
) -> Vec3 {
    let n = frame.n;
    let du = dp_du + n * (gradient.x - n.dot(dp_du));
    let dv = dp_dv + n * (gradient.y - n.dot(dp_dv));
    let bumped = du.cross(dv);
    let oriented = if bumped.dot(ng) < 0.0 {
        -bumped
    } else {
        bumped
    };
    frame.to_local(oriented.normalize_or_zero())
}
