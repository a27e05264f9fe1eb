//! Where the field may speak for a surface.

use crate::bsdf::material::{Diffuse, Distribution, Plastic, RoughConductor, Roughness};
use crate::bsdf::{Material, Materials, Rest, Transport};
use crate::integrate::guided_vertex::is_matt;
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::{SurfacePoint, Texture};

fn matt(material: Material) -> bool {
    matt_beside(material, false)
}

/// Whether it is matt, or what is left of it beside a delta lobe.
fn matt_beside(material: Material, delta: bool) -> bool {
    let mut materials = Materials::default();
    let id = materials.push(material);
    let wo = Vec3::new(0.6, 0.0, 0.8);
    let bsdf = materials.resolve(id, &SurfacePoint::at_uv(Vec2::ZERO), wo);
    let apart = bsdf.split_delta(wo, Transport::Radiance).filter(|_| delta);
    is_matt(&bsdf, apart.map_or(Rest::ALL, |a| a.rest))
}

fn metal(alpha: f32) -> Material {
    let grey = |v| Texture::Constant(Rgb::splat(v));
    Material::RoughConductor(RoughConductor {
        eta: grey(0.2),
        k: grey(3.9),
        roughness: Roughness {
            distribution: Distribution::Ggx,
            alpha_u: grey(alpha),
            alpha_v: grey(alpha),
        },
        specular_reflectance: grey(1.0),
    })
}

/// Irradiance says what a wall reflects, not what a floor mirrors.
#[test]
fn irradiance_speaks_for_matt_surfaces_alone() {
    let wall = Material::Diffuse(Diffuse {
        reflectance: Texture::Constant(Rgb::splat(0.5)),
    });
    assert!(matt(wall));
    assert!(matt(metal(0.7)));
    assert!(!matt(metal(0.1)));
    let grey = |v| Texture::Constant(Rgb::splat(v));
    let varnish = || {
        Material::Plastic(Plastic {
            eta: 1.5,
            diffuse_reflectance: grey(0.5),
            specular_reflectance: grey(1.0),
            nonlinear: false,
        })
    };
    assert!(!matt(varnish()));
    assert!(matt_beside(varnish(), true));
}
