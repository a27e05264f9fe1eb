//! Shapes.

use super::importer::{Importer, Role};
use super::parameter::Kind;
use super::params::Params;
use super::pending::{
    Curve, Glow, Inline, InlineKind, PendingGeometry, PendingShape, Request, RoundKind, Vertices,
};
use crate::bsdf::{Material, MaterialId};
use crate::math::{DAffine3, Rgb, luminance};
use crate::medium::Boundary;
use crate::scene::import::faults::At;
use crate::scene::import::mesh::MeshOptions;
use crate::scene::import::{ImportError, named};
use crate::texture::{Reads, Texture};

/// The kinds of shapes that are read.
pub(super) const SHAPES: &[&str] = &[
    "plymesh",
    "trianglemesh",
    "sphere",
    "disk",
    "cylinder",
    "bilinearmesh",
    "loopsubdiv",
    "curve",
    "cone",
    "paraboloid",
];

/// Levels of subdivision: each has four times the triangles of the one before.
const MOST_LEVELS: u32 = 12;

impl<'s> Importer<'s> {
    /// A `Shape`.
    pub fn shape(&mut self, p: &Params<'_, 's>) -> Result<(), ImportError> {
        let to_world = self.standing(p.at(), "shape")?;
        let placed = self.place(to_world, self.group);
        let material = self.current_material();
        let boundary = self.boundary(material, p.at());
        let material = self.with_alpha(p, material);
        let glow = self.shape_glow(p)?;
        let textured = self.reads_uvs(material, glow.as_ref());
        let geometry = self.geometry(p, placed, textured);
        let geometry = geometry.map_err(|message| self.source.error(p.at(), message))?;
        self.done(p);
        let word = match &geometry {
            PendingGeometry::File(request) => {
                let file = request.path.file_name();
                file.map_or_else(String::new, |f| f.to_string_lossy().into_owned())
            }
            _ => p.name().to_owned(),
        };
        let shape = PendingShape {
            name: String::new(),
            at: p.at(),
            geometry,
            material,
            glow,
            flip_normals: self.graphics.reverse,
            group: self.group,
            boundary,
        };
        let Some(mut shape) = self.joined(shape) else {
            return Ok(());
        };
        shape.name = self.name_after(&word);
        self.shapes.push(shape);
        Ok(())
    }

    /// Whether a shape of this material and light is to have texture coordinates.
    pub fn reads_uvs(&self, material: MaterialId, glow: Option<&Glow>) -> bool {
        let mut reads = Reads::default();
        self.materials.add_reads(material, &mut reads);
        if let Some(glow) = glow {
            glow.radiance.add_reads(&mut reads);
        }
        reads.uvs
    }

    /// Curves that follow each other and are alike make one mesh: hair has a hundred thousand.
    fn joined(&mut self, mut shape: PendingShape<'s>) -> Option<PendingShape<'s>> {
        let Some(last) = self.shapes.last_mut() else {
            return Some(shape);
        };
        let alike = last.material == shape.material
            && last.group == shape.group
            && last.boundary == shape.boundary
            && last.glow.is_none()
            && shape.glow.is_none();
        if let (PendingGeometry::Inline(last), PendingGeometry::Inline(new), true) =
            (&mut last.geometry, &mut shape.geometry, alike)
        {
            let same_place = last.to_world == new.to_world && last.reverse == new.reverse;
            if let (InlineKind::Curves(list), InlineKind::Curves(new), true) =
                (&mut last.kind, &mut new.kind, same_place)
            {
                list.append(new);
                return None;
            }
        }
        Some(shape)
    }

    /// What the shape emits by the current `AreaLightSource`.
    fn shape_glow(&mut self, p: &Params<'_, 's>) -> Result<Option<Glow>, ImportError> {
        let Some(definition) = self.graphics.area_light.clone() else {
            return Ok(None);
        };
        if self.group.is_some() {
            self.warn_at(p.at(), "a shape in an object does not glow, as in pbrt");
            return Ok(None);
        }
        let light = Params::new(self.source, &definition);
        let glow = self.glow(&light);
        glow.map(Some)
            .map_err(|message| self.source.error(definition.at, message))
    }

    /// The media inside and outside of a shape; `None` if they are the same.
    fn boundary(&mut self, material: MaterialId, at: At) -> Option<Boundary> {
        let [inside, outside] = self.graphics.media;
        let mut boundary = Boundary {
            interior: self.medium_named(inside, at),
            exterior: self.medium_named(outside, at),
        };
        if let Some(&medium) = self.subsurface_of.get(&material) {
            boundary.interior = medium;
        }
        (boundary.interior != boundary.exterior).then_some(boundary)
    }

    /// The material with the shape's alpha around it.
    fn with_alpha(&mut self, p: &Params<'_, 's>, material: MaterialId) -> MaterialId {
        self.left_out(p, &["shadowalpha"], "shadows are those of \"alpha\"");
        let Some(alpha) = self.texture_given(p, "alpha", Role::Number) else {
            return material;
        };
        if alpha.constant().is_some_and(|a| luminance(a) >= 1.0) {
            return material;
        }
        if self.materials.is_null(material) {
            return material;
        }
        let key = (material, format!("{alpha:?}"));
        if let Some(&known) = self.masked.get(&key) {
            return known;
        }
        if self.graphics.area_light.is_some() && alpha.constant() == Some(Rgb::ZERO) {
            self.warn_at(
                p.place_of("alpha"),
                "a shape with an alpha of 0 does not shine here; in pbrt it shines and is not seen",
            );
        }
        let name = self.materials.name(material);
        let opacity = match alpha {
            Texture::Constant(c) => Texture::Constant(c.clamp(Rgb::ZERO, Rgb::ONE)),
            varying => varying,
        };
        let id = self.materials.push(Material::Mask {
            opacity,
            inner: material,
        });
        self.materials.set_name(id, name);
        self.masked.insert(key, id);
        id
    }

    fn geometry(
        &mut self,
        p: &Params<'_, 's>,
        to_world: DAffine3,
        textured: bool,
    ) -> Result<PendingGeometry<'s>, String> {
        let round = match p.name() {
            "plymesh" => return self.ply(p, to_world),
            "trianglemesh" => {
                let vertices = self.vertices(p, 3)?;
                // What is textured without coordinates has pbrt's own.
                match vertices.uvs.is_none() && textured {
                    true => InlineKind::Separate(vertices),
                    false => InlineKind::Triangles(vertices),
                }
            }
            "bilinearmesh" => InlineKind::Patches(self.vertices(p, 4)?),
            "loopsubdiv" => self.subdivision(p)?,
            "curve" => InlineKind::Curves(vec![self.curve(p)?]),
            "sphere" => return Ok(self.sphere(p, to_world)),
            "cylinder" => return Ok(self.cylinder(p, to_world)),
            "disk" => return Ok(self.disk(p, to_world, textured)),
            "cone" => self.round(
                p,
                RoundKind::Cone {
                    radius: p.positive("radius", 1.0),
                    height: p.positive("height", 1.0),
                },
            ),
            "paraboloid" => {
                let z = [p.float_in("zmin", 0.0, 0.0..=1e30), p.positive("zmax", 1.0)];
                let radius = p.positive("radius", 1.0);
                self.round(p, RoundKind::Paraboloid { radius, z })
            }
            other => {
                let help = named::did_you_mean(other, SHAPES.iter().copied());
                let help = help.map_or(String::new(), |h| format!("; {h}"));
                return Err(format!("shapes of the kind \"{other}\" are not read{help}"));
            }
        };
        Ok(self.inline(to_world, round))
    }

    pub fn inline(&self, to_world: DAffine3, kind: InlineKind<'s>) -> PendingGeometry<'s> {
        PendingGeometry::Inline(Inline {
            to_world,
            reverse: self.graphics.reverse,
            kind,
        })
    }

    fn ply(
        &mut self,
        p: &Params<'_, 's>,
        to_world: DAffine3,
    ) -> Result<PendingGeometry<'s>, String> {
        let path = self
            .file_given(p, "filename")
            .ok_or("a plymesh needs a \"filename\"")?;
        self.left_out(p, &["displacement"], "the mesh is as its file has it");
        p.ignore(&["edgelength"]);
        Ok(PendingGeometry::File(Request {
            path,
            options: MeshOptions {
                to_world,
                flat_without_normals: true,
                flip_normals: self.graphics.reverse,
                lenient: self.options.lenient,
                decode: self.options.decode,
                ..MeshOptions::default()
            },
        }))
    }

    /// Vertices and the corners of faces with so many corners.
    fn vertices(&mut self, p: &Params<'_, 's>, corners: usize) -> Result<Vertices<'s>, String> {
        p.ignore(&["faceIndices"]);
        self.left_out(
            p,
            &["emissionfilename"],
            "it says how pbrt draws places on a lamp, which is the renderer's business",
        );
        let positions = p.floats("P", &[Kind::Triple]);
        let positions = positions.ok_or("positions (\"point3 P\") are needed")?;
        let count = positions.len() / 3;
        if positions.len() % 3 != 0 {
            return Err(format!(
                "\"P\" has {} numbers, which are no triples",
                positions.len()
            ));
        }
        let single: &'static [i32] = if corners == 3 {
            &[0, 1, 2]
        } else {
            &[0, 1, 2, 3]
        };
        let indices = match p.integers("indices") {
            Some(indices) => indices,
            None if count == corners => single,
            None => return Err("\"integer indices\" are needed".into()),
        };
        if indices.len() % corners != 0 {
            let message = format!(
                "\"indices\" has {} numbers, which are no groups of {corners}",
                indices.len()
            );
            return Err(message);
        }
        if let Some(beyond) = indices
            .iter()
            .find(|i| usize::try_from(**i).map_or(true, |i| i >= count))
        {
            return Err(format!(
                "\"indices\" names vertex {beyond}, but there are {count}"
            ));
        }
        let mut beside = |name: &'static str, kinds: &[Kind], size: usize| {
            let list = p.floats(name, kinds)?;
            if list.len() == size * count {
                return Some(list);
            }
            let message = format!(
                "\"{name}\" is left out: it has {} numbers for {count} positions",
                list.len()
            );
            self.warn_at(p.place_of(name), &message);
            None
        };
        let uv = if p.has("st") { "st" } else { "uv" };
        Ok(Vertices {
            indices,
            positions,
            normals: beside("N", &[Kind::Triple], 3),
            tangents: beside("S", &[Kind::Triple], 3),
            uvs: beside(uv, &[Kind::Pair, Kind::Float], 2),
        })
    }

    fn subdivision(&mut self, p: &Params<'_, 's>) -> Result<InlineKind<'s>, String> {
        p.ignore(&["scheme"]);
        let name = if p.has("nlevels") {
            "nlevels"
        } else {
            "levels"
        };
        let levels = p.integer_given(name).unwrap_or(3).max(0).unsigned_abs();
        if levels > MOST_LEVELS {
            return Err(format!(
                "\"{name}\" is {levels}; {MOST_LEVELS} are the most"
            ));
        }
        Ok(InlineKind::Subdivision(self.vertices(p, 3)?, levels))
    }

    fn curve(&mut self, p: &Params<'_, 's>) -> Result<Curve<'s>, String> {
        // How finely pbrt cuts a curve before it traces it.
        p.ignore(&["splitdepth"]);
        let degree = match p.integer_given("degree").unwrap_or(3) {
            degree @ (2 | 3) => degree as usize,
            other => return Err(format!("\"degree\" is {other}; it can be 2 or 3")),
        };
        let bases = [("bezier", false), ("bspline", true)];
        let is_spline = p.choice("basis", &bases).unwrap_or(false);
        let points = p
            .floats("P", &[Kind::Triple])
            .ok_or("control points (\"point3 P\") are needed")?;
        let count = points.len() / 3;
        let fits = count > degree && (is_spline || (count - 1) % degree == 0);
        if points.len() % 3 != 0 || !fits {
            return Err(format!(
                "{count} control points make no curve of degree {degree}"
            ));
        }
        let segments = if is_spline {
            count - degree
        } else {
            (count - 1) / degree
        };
        let width = p.float("width", 1.0);
        let widths = [
            p.float("width0", width) as f32,
            p.float("width1", width) as f32,
        ];
        let kind = p.text("type").unwrap_or("flat");
        let normals = p.floats("N", &[Kind::Triple]);
        let normals = match kind {
            "ribbon" => match normals {
                Some(list) if list.len() == 3 * (segments + 1) => Some(list),
                _ => {
                    return Err(format!(
                        "a ribbon of {segments} segments needs {} normals",
                        segments + 1
                    ));
                }
            },
            "flat" | "cylinder" => None,
            other => {
                return Err(format!(
                    "\"type\" is \"{other}\"; it can be flat, ribbon or cylinder"
                ));
            }
        };
        if kind == "flat" {
            self.warn_once(
                p.at(),
                "flat curves, which face whoever looks at them, are rendered as round ones \
                of the same width",
            );
        }
        Ok(Curve {
            points,
            degree,
            is_spline,
            widths,
            normals,
        })
    }
}
