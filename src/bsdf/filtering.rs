//! Where a texture may be read as its average over a pixel.
//!
//! Mip levels save noise and memory, but the light of an average is the average of the light only
//! where it follows the texture linearly: colours of lobes do, normals, displacements, roughnesses
//! and cut-outs do not. (A bumpy wall seen from afar came out a tenth too bright.) Nor does the
//! product of two textures, which may have to do with each other: mortar is dark where it is deep.
//! Such materials are read at the finest level everywhere, and the samples of a pixel average what
//! they scatter.

use super::{Material, MaterialId, Materials};
use crate::texture::Texture;

impl Materials {
    /// Whether the light that material `id` scatters is linear in all that it reads of textures.
    pub fn filters(&self, id: MaterialId) -> bool {
        !self.any(id, &|m| bends(m) || self.multiplies(m))
    }

    /// Whether a texture of the material weighs another one of a material inside.
    fn multiplies(&self, material: &Material) -> bool {
        let weight = match material {
            Material::Blend { weight, .. } => weight,
            Material::Mask { opacity, .. } => opacity,
            _ => return false,
        };
        let read = |m: &Material| m.textures().all().any(varies);
        varies(weight) && material.inner().any(|id| self.any(id, &read))
    }
}

fn varies(texture: &Texture) -> bool {
    texture.constant().is_none()
}

/// Whether a material's own light does not follow its textures linearly.
fn bends(material: &Material) -> bool {
    let own = material.textures();
    own.all().any(|t| !t.averages()) || own.nonlinear.into_iter().any(varies)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::material::{Diffuse, InvalidNormals, Null, Plastic, white};
    use crate::math::Rgb;
    use std::sync::Arc;

    /// A texture that varies.
    fn image() -> Texture {
        Texture::MeshAttribute("vertex_color".into())
    }

    fn filters(make: impl FnOnce(&mut Materials) -> Material) -> bool {
        let mut materials = Materials::default();
        let material = make(&mut materials);
        let id = materials.push(material);
        materials.filters(id)
    }

    fn colored(reflectance: Texture) -> Material {
        Material::Diffuse(Diffuse { reflectance })
    }

    fn plastic(nonlinear: bool) -> Material {
        Material::Plastic(Plastic {
            eta: 1.5,
            diffuse_reflectance: image(),
            specular_reflectance: white(),
            nonlinear,
        })
    }

    #[test]
    fn colours_are_averaged() {
        assert!(filters(|_| colored(image())));
        assert!(filters(|_| colored(image().scaled(Rgb::splat(0.5)))));
        assert!(filters(|_| plastic(false)));
        assert!(filters(|m| {
            let side = m.push(colored(image()));
            let back = m.push(plastic(false));
            Material::TwoSided { front: side, back }
        }));
        assert!(filters(|m| {
            let inner = m.push(colored(white()));
            let second = m.push(Material::Null(Null));
            Material::Blend {
                weight: image(),
                first: inner,
                second,
            }
        }));
    }

    #[test]
    fn what_bends_light_is_not() {
        let under = |m: &mut Materials| m.push(colored(white()));
        assert!(!filters(|m| Material::NormalMap {
            normals: image(),
            invalid_normals: InvalidNormals::default(),
            inner: under(m),
        }));
        assert!(!filters(|m| {
            let bumped = Material::BumpMap {
                displacement: image(),
                scale: 1.0,
                invalid_normals: InvalidNormals::default(),
                inner: under(m),
            };
            let id = m.push(bumped);
            Material::TwoSided {
                front: id,
                back: id,
            }
        }));
        assert!(!filters(|_| plastic(true)));
        let cut = Texture::Threshold(Arc::new((image(), 0.5)));
        assert!(!filters(|_| colored(cut)));
    }

    #[test]
    fn products_are_not() {
        assert!(!filters(|_| colored(image().times(image()))));
        assert!(!filters(|m| {
            let inner = m.push(colored(image()));
            Material::Mask {
                opacity: image(),
                inner,
            }
        }));
    }
}
