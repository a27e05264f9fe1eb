//! Surfaces as light meets them, in scenes as they come from files, with both ray tracers.
//!
//! | file | what is held |
//! |---|---|
//! | `sides.rs` | lamps, photons, light samples, materials and normals agree on what is the front |
//! | `opacity.rs` | what is half there, with one wall or two |
//! | `sizes.rs` | textures that enter the light in another way than linearly, in few pixels and in many |

mod files;
mod opacity;
mod sides;
mod sizes;
#[path = "../support/mod.rs"]
mod support;

use std::path::Path;
use std::sync::Arc;
use support::Built;
use twintree::accel::{Backend, BuildSettings};
use twintree::camera::Camera;
use twintree::scene::import::{ImportOptions, mitsuba};
use twintree::scene::{Description, Scene};
use twintree::texture::TextureStore;

fn options() -> ImportOptions {
    ImportOptions::new(Arc::new(TextureStore::new(1 << 20)))
}

/// A scene in Mitsuba's language.
fn load(dir: &Path, text: &str) -> Description {
    let path = dir.join("scene.xml");
    std::fs::write(&path, format!("<scene version='3.0.0'>{text}</scene>")).unwrap();
    mitsuba::load(&path, &options()).unwrap_or_else(|e| panic!("{e}"))
}

fn backends() -> Vec<Backend> {
    match cfg!(feature = "embree") {
        true => vec![Backend::Embree, Backend::Obvhs],
        false => vec![Backend::Obvhs],
    }
}

/// A description as its own sensor sees it.
fn seen(mut description: Description, backend: Backend) -> Built {
    let film = description.film.clone();
    let camera = Camera::new(&description.camera, film.width, film.height);
    let scene = Scene::build(&mut description, BuildSettings::default(), backend);
    Built {
        scene: scene.unwrap_or_else(|e| panic!("{e}")),
        camera,
        film,
    }
}
