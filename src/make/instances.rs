//! A scene of many instances of a few meshes, in the languages of pbrt and of Mitsuba: for trying
//! how scenes are read at the scale of production.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// A scene's language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// pbrt 4.
    Pbrt,
    /// Mitsuba 3's XML.
    Mitsuba,
}

/// So many instances of meshes, in rows on a plane, turned and scaled by their number.
#[derive(Clone, Copy, Debug)]
pub struct Instances<'n> {
    /// How many.
    pub count: u64,
    /// File names of the meshes that they show in turn, each about 2 wide.
    pub meshes: &'n [String],
}

/// Distance between neighbours.
const STEP: f64 = 2.2;
/// Turn from one to the next, degrees: the golden angle, which never comes back.
const TURN: f64 = 137.507_764;

/// Where an instance stands.
struct Place {
    at: [f64; 2],
    angle: f64,
    scale: f64,
}

impl Instances<'_> {
    /// Rows, and instances in each.
    fn side(&self) -> u64 {
        (self.count as f64).sqrt().ceil() as u64
    }

    fn place(&self, i: u64) -> Place {
        let side = self.side();
        let middle = 0.5 * (side as f64 - 1.0);
        let along = |k: u64| (k as f64 - middle) * STEP;
        Place {
            at: [along(i % side), along(i / side)],
            angle: (i as f64 * TURN) % 360.0,
            scale: 0.6 + 0.4 * ((i as f64 * 0.618_034) % 1.0),
        }
    }

    /// The camera's place, which sees all of them.
    fn eye(&self) -> [f64; 3] {
        let size = self.side() as f64 * STEP;
        [0.0, 0.5 * size + 2.0, -0.9 * size - 4.0]
    }

    /// Writes the scene to the file `path`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, dialect: Dialect, path: &Path) -> io::Result<()> {
        let mut out = BufWriter::new(File::create(path)?);
        match dialect {
            Dialect::Pbrt => self.pbrt(&mut out)?,
            Dialect::Mitsuba => self.mitsuba(&mut out)?,
        }
        out.flush()
    }

    fn pbrt(&self, out: &mut impl Write) -> io::Result<()> {
        let [x, y, z] = self.eye();
        writeln!(
            out,
            "LookAt {x} {y} {z}  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 45"
        )?;
        writeln!(
            out,
            "Film \"rgb\" \"integer xresolution\" 640 \"integer yresolution\" 360"
        )?;
        writeln!(
            out,
            "WorldBegin\nLightSource \"infinite\" \"rgb L\" [0.8 0.9 1]"
        )?;
        writeln!(
            out,
            "Material \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5]"
        )?;
        for (k, mesh) in self.meshes.iter().enumerate() {
            writeln!(
                out,
                "ObjectBegin \"{k}\"\nShape \"plymesh\" \"string filename\" \"{mesh}\"\nObjectEnd"
            )?;
        }
        for i in 0..self.count {
            let Place {
                at: [x, z],
                angle,
                scale: s,
            } = self.place(i);
            let k = i % self.meshes.len() as u64;
            writeln!(
                out,
                "AttributeBegin\nTranslate {x:.4} 0 {z:.4}\nRotate {angle:.4} 0 1 0\nScale {s:.4} \
                 {s:.4} {s:.4}\nObjectInstance \"{k}\"\nAttributeEnd"
            )?;
        }
        Ok(())
    }

    fn mitsuba(&self, out: &mut impl Write) -> io::Result<()> {
        let [x, y, z] = self.eye();
        writeln!(
            out,
            "<scene version=\"3.0.0\">\n<sensor type=\"perspective\"><float name=\"fov\" \
             value=\"45\"/><string name=\"fov_axis\" value=\"smaller\"/>"
        )?;
        // x is to the left there, and to the right in pbrt: mirrored, the pictures are the same.
        writeln!(
            out,
            "<float name=\"far_clip\" value=\"1e6\"/><transform name=\"to_world\"><scale \
             x=\"-1\"/><lookat origin=\"{x} {y} {z}\" target=\"0 0 0\" up=\"0 1 0\"/></transform>"
        )?;
        writeln!(
            out,
            "<film type=\"hdrfilm\"><integer name=\"width\" value=\"640\"/><integer \
             name=\"height\" value=\"360\"/></film></sensor>"
        )?;
        writeln!(
            out,
            "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"0.8 0.9 1\"/></emitter>"
        )?;
        writeln!(
            out,
            "<bsdf type=\"twosided\" id=\"grey\"><bsdf type=\"diffuse\"/></bsdf>"
        )?;
        for (k, mesh) in self.meshes.iter().enumerate() {
            writeln!(
                out,
                "<shape type=\"shapegroup\" id=\"g{k}\"><shape type=\"ply\"><string \
                 name=\"filename\" value=\"{mesh}\"/><boolean name=\"face_normals\" \
                    value=\"true\"/><ref id=\"grey\"/></shape></shape>"
            )?;
        }
        for i in 0..self.count {
            let Place {
                at: [x, z],
                angle,
                scale,
            } = self.place(i);
            let k = i % self.meshes.len() as u64;
            writeln!(
                out,
                "<shape type=\"instance\"><ref id=\"g{k}\"/><transform name=\"to_world\"><scale \
                 value=\"{scale:.4}\"/><rotate y=\"1\" angle=\"{angle:.4}\"/><translate \
                    x=\"{x:.4}\" z=\"{z:.4}\"/></transform></shape>"
            )?;
        }
        writeln!(out, "</scene>")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::make::{Kind, Pattern, write_ply};
    use crate::scene::Description;
    use crate::scene::import::{ImportOptions, mitsuba, pbrt};
    use crate::texture::TextureStore;
    use std::sync::Arc;

    /// Both languages say the same: instances, meshes and camera are equal up to six digits.
    #[test]
    fn both_languages_are_the_same_scene() {
        let dir = tempfile::tempdir().unwrap();
        let meshes = ["a.ply".to_owned(), "b.ply".to_owned()];
        for name in &meshes {
            let pattern = Pattern::new(Kind::TorusKnot, 500);
            write_ply(&pattern, &dir.path().join(name)).unwrap();
        }
        let instances = Instances {
            count: 100,
            meshes: &meshes,
        };
        let options = ImportOptions::new(Arc::new(TextureStore::new(1 << 20)));
        let load = |dialect, name: &str| -> Description {
            let path = dir.path().join(name);
            instances.write(dialect, &path).unwrap();
            let loaded = match dialect {
                Dialect::Pbrt => pbrt::load(&path, &options),
                Dialect::Mitsuba => mitsuba::load(&path, &options),
            };
            loaded.unwrap_or_else(|e| panic!("{e}"))
        };
        let [ours, theirs] = [
            load(Dialect::Pbrt, "a.pbrt"),
            load(Dialect::Mitsuba, "a.xml"),
        ];
        assert!(
            ours.warnings.is_empty() && theirs.warnings.is_empty(),
            "{:?} {:?}",
            ours.warnings,
            theirs.warnings
        );
        assert_eq!(
            (ours.instances.len(), ours.groups, ours.shapes.len()),
            (100, 2, 2)
        );
        for (a, b) in ours.instances.iter().zip(&theirs.instances) {
            assert!(a.0 == b.0 && a.1.abs_diff_eq(b.1, 1e-9));
        }
        assert!(
            ours.camera
                .to_world
                .abs_diff_eq(theirs.camera.to_world, 1e-9)
        );
    }
}
