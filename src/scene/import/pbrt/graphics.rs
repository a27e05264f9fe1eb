//! The graphics state: what a directive finds set by those before it.

use super::color_space::ColorSpace;
use super::parameter::Parameter;
use super::statement::{Directive, Plugin};
use crate::math::{Affine3A, DAffine3, DMat4};
use crate::scene::import::faults::At;
use std::rc::Rc;

/// What `Attribute` directives give to those that follow.
#[derive(Clone, Debug, Default)]
pub(super) struct Attributes<'s> {
    pub shape: Vec<&'s Parameter>,
    pub light: Vec<&'s Parameter>,
    pub material: Vec<&'s Parameter>,
    pub medium: Vec<&'s Parameter>,
    pub texture: Vec<&'s Parameter>,
}

/// What `Attribute` can be for.
pub(super) const TARGETS: &[&str] = &["shape", "light", "material", "medium", "texture"];

impl<'s> Attributes<'s> {
    pub fn target(&mut self, name: &str) -> Option<&mut Vec<&'s Parameter>> {
        Some(match name {
            "shape" => &mut self.shape,
            "light" => &mut self.light,
            "material" => &mut self.material,
            "medium" => &mut self.medium,
            "texture" => &mut self.texture,
            _ => return None,
        })
    }

    fn of(&self, directive: Directive) -> &[&'s Parameter] {
        match directive {
            Directive::Shape => &self.shape,
            Directive::LightSource | Directive::AreaLightSource => &self.light,
            Directive::Material | Directive::MakeNamedMaterial => &self.material,
            Directive::MakeNamedMedium => &self.medium,
            Directive::Texture => &self.texture,
            _ => &[],
        }
    }
}

/// The material that shapes get.
#[derive(Clone, Debug)]
pub(super) enum Chosen<'s> {
    /// None was named.
    Default,
    /// That of a `Material`.
    Own(Definition<'s>),
    /// That of a `NamedMaterial`, and the place of that.
    Named(&'s str, At),
}

/// The graphics state.
#[derive(Clone, Debug)]
pub(super) struct Graphics<'s> {
    /// Object space to world space when the shutter opens and when it closes; before `WorldBegin`
    /// world space to camera space.
    pub to_world: [DMat4; 2],
    /// Which of the two directives change.
    pub active: [bool; 2],
    pub reverse: bool,
    pub material: Chosen<'s>,
    pub area_light: Option<Definition<'s>>,
    /// Names of the media inside and outside of shapes.
    pub media: [&'s str; 2],
    pub color_space: ColorSpace,
    pub attributes: Rc<Attributes<'s>>,
}

impl Default for Graphics<'_> {
    fn default() -> Self {
        Self {
            to_world: [DMat4::IDENTITY; 2],
            active: [true; 2],
            reverse: false,
            material: Chosen::Default,
            area_light: None,
            media: [""; 2],
            color_space: ColorSpace::Srgb,
            attributes: Rc::default(),
        }
    }
}

impl<'s> Graphics<'s> {
    /// Changes the active transforms.
    pub fn change(&mut self, change: impl Fn(DMat4) -> DMat4) {
        for (transform, active) in self.to_world.iter_mut().zip(self.active) {
            if active {
                *transform = change(*transform);
            }
        }
    }

    /// Whether the transforms differ: something moves.
    pub fn moves(&self) -> bool {
        self.to_world[0] != self.to_world[1]
    }

    /// A plugin with all that holds where it stands.
    pub fn define(&self, plugin: &'s Plugin, at: At) -> Definition<'s> {
        Definition {
            plugin,
            at,
            color_space: self.color_space,
            attributes: self.attributes.clone(),
            transform: self.to_world[0],
        }
    }
}

/// A plugin with all that holds where it stands.
#[derive(Clone, Debug)]
pub(super) struct Definition<'s> {
    pub plugin: &'s Plugin,
    pub at: At,
    pub color_space: ColorSpace,
    pub attributes: Rc<Attributes<'s>>,
    pub transform: DMat4,
}

/// What two definitions share that are the same one.
pub(super) type Identity = (usize, ColorSpace, usize);

impl<'s> Definition<'s> {
    /// Parameters that `Attribute` directives give it.
    pub fn inherited(&self) -> &[&'s Parameter] {
        self.attributes.of(self.plugin.directive)
    }

    pub fn identity(&self) -> Identity {
        let plugin = std::ptr::from_ref(self.plugin).addr();
        let inherited = self.inherited();
        let attributes = match inherited.is_empty() {
            true => 0,
            false => Rc::as_ptr(&self.attributes).addr(),
        };
        (plugin, self.color_space, attributes)
    }

    /// Its transform, if that is affine.
    pub fn affine(&self) -> Option<DAffine3> {
        affine(self.transform)
    }
}

/// A matrix without perspective.
pub(super) fn affine(m: DMat4) -> Option<DAffine3> {
    let last = m.row(3);
    let is_affine = last.truncate().abs().max_element() < 1e-9 * last.w.abs() && m.is_finite();
    is_affine.then(|| DAffine3::from_mat4(m * (1.0 / last.w)))
}

/// A map in single precision.
pub(super) fn single(m: DAffine3) -> Affine3A {
    Affine3A::from_mat3_translation(m.matrix3.as_mat3(), m.translation.as_vec3())
}
