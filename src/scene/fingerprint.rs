//! A number that tells scenes apart: two parts of an image, or a checkpoint and the render that
//! goes on from it, must show the same scene.
//!
//! It covers everything that can change a pixel: geometry, materials, emitters, camera, and the
//! contents of the image files that they use. Film and render settings are not in it, since the
//! command line has the last word on them, and neither are names and directories: a scene may lie
//! elsewhere on another machine. 64 bits of XXH3 are enough against accidents, and it keeps up with
//! the disk.

use super::description::{Description, Geometry, Mesh, Shape};
use crate::camera::CameraDescription;
use crate::light::Emitter;
use crate::medium::Extinction;
use crate::texture::Bitmap;
use rayon::prelude::*;
use std::fmt::Write as _;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;
use xxhash_rust::xxh3::Xxh3;

/// The fingerprint of a scene that has not been built yet, with the textures that its importer
/// opened.
///
/// # Errors
/// When the file of an environment map cannot be read.
pub fn fingerprint(scene: &Description, textures: &[Arc<Bitmap>]) -> io::Result<u64> {
    print(scene, textures, Some(&scene.camera))
}

/// The same of all but the camera: whether a scene can be rendered again from another place.
///
/// # Errors
/// As [`fingerprint`].
pub fn world_fingerprint(scene: &Description, textures: &[Arc<Bitmap>]) -> io::Result<u64> {
    print(scene, textures, None)
}

fn print(
    scene: &Description,
    textures: &[Arc<Bitmap>],
    camera: Option<&CameraDescription>,
) -> io::Result<u64> {
    let mut print = Print(Xxh3::new());
    print.text(format_args!(
        "{} groups {:?} {camera:?}",
        scene.groups, scene.instances
    ));
    for shape in &scene.shapes {
        print.shape(shape);
    }
    for id in 0..scene.materials.len() {
        print.text(format_args!("{:?}", scene.materials.get(id as u32)));
    }
    for emitter in &scene.emitters {
        print.emitter(emitter)?;
    }
    if !scene.media.is_empty() {
        print.media(scene);
    }
    // Importers open textures from many threads: their order says nothing.
    let mut images: Vec<u64> = textures.par_iter().map(|t| of_bitmap(t)).collect();
    images.sort_unstable();
    print.bytes(bytemuck::cast_slice(&images));
    Ok(print.0.digest())
}

/// The fingerprint of a texture: of its file, or of its texels where it comes from no file of its
/// own.
fn of_bitmap(bitmap: &Bitmap) -> u64 {
    let mut print = Print(Xxh3::new());
    print.text(format_args!("{bitmap:?}"));
    if print.file(&bitmap.settings().path).is_err() {
        for y in 0..bitmap.height() {
            for x in 0..bitmap.width() {
                let texel: [f32; 3] = bitmap.texel(x, y).into();
                print.0.update(bytemuck::bytes_of(&texel));
            }
        }
    }
    print.0.digest()
}

/// A fingerprint in the making.
struct Print(Xxh3);

/// Text goes into the hash as it is formatted.
impl std::fmt::Write for Print {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}

impl Print {
    /// Adds a text and an end that no text holds.
    fn text(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a hash cannot fail.
        let _ = self.write_fmt(text);
        self.0.update(&[0xff]);
    }

    /// Adds bytes and how many they are.
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(&(bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    fn shape(&mut self, shape: &Shape) {
        self.text(format_args!(
            "{} {:?} {} {:?}",
            shape.material, shape.emitter, shape.flip_normals, shape.group
        ));
        match &shape.geometry {
            Geometry::Mesh(mesh) => self.mesh(mesh),
            Geometry::Analytic(exact) => self.text(format_args!("{exact:?}")),
        }
    }

    /// Adds media, and where they are.
    fn media(&mut self, scene: &Description) {
        for medium in &scene.media.list {
            self.text(format_args!("{:?} {:?}", medium.extinction, medium.phase));
            if let Extinction::Heterogeneous(medium) = &medium.extinction {
                for grid in medium.grids() {
                    self.bytes(bytemuck::cast_slice(grid.values()));
                }
            }
        }
        for shape in &scene.shapes {
            self.text(format_args!("{:?}", shape.boundary));
        }
        self.text(format_args!("{:?}", scene.camera_medium));
    }

    fn mesh(&mut self, mesh: &Mesh) {
        self.bytes(bytemuck::cast_slice(mesh.triangles.positions()));
        self.bytes(bytemuck::cast_slice(mesh.triangles.triangles()));
        let normals = mesh.normals.as_deref().unwrap_or(&[]);
        self.bytes(bytemuck::cast_slice(normals));
        let tangents = mesh.tangents.as_deref().unwrap_or(&[]);
        self.bytes(bytemuck::cast_slice(tangents));
        let uvs = mesh.uvs.as_ref().map_or(&[][..], |uvs| uvs);
        self.bytes(bytemuck::cast_slice(uvs));
        for attribute in &mesh.attributes.list {
            self.text(format_args!("{} {}", attribute.name, attribute.per_face));
            self.bytes(bytemuck::cast_slice(&attribute.values));
        }
    }

    fn emitter(&mut self, emitter: &Emitter) -> io::Result<()> {
        let image = match emitter {
            Emitter::EnvironmentMap {
                image,
                scale,
                to_world,
            } => {
                let (gamma, layout) = (image.gamma(), image.layout());
                self.text(format_args!(
                    "environment {scale} {to_world:?} {gamma:?} {layout:?}"
                ));
                image
            }
            Emitter::Goniometric {
                image,
                intensity,
                to_world,
            } => {
                let (layout, grey) = (image.layout(), image.is_grey());
                self.text(format_args!(
                    "goniometric {intensity} {to_world:?} {layout:?} {grey}"
                ));
                image
            }
            other => {
                self.text(format_args!("{other:?}"));
                return Ok(());
            }
        };
        self.file(image.path())
    }

    /// Adds the contents of a file.
    fn file(&mut self, path: &Path) -> io::Result<()> {
        let mut file = crate::image::regular::open(path)?;
        let mut buffer = vec![0; 1 << 18];
        loop {
            let n = file.read(&mut buffer)?;
            if n == 0 {
                return Ok(());
            }
            self.0.update(&buffer[..n]);
        }
    }
}
