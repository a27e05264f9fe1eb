//! Scenes made in code, and how to render them, for the tests beside this folder.

#![allow(dead_code, missing_docs)]

use std::sync::Arc;
use twintree::accel::{AnalyticKind, AnalyticShape, Backend, BuildSettings, TriangleMesh};
use twintree::bsdf::material::Diffuse;
use twintree::bsdf::{Material, MaterialId, Materials};
use twintree::camera::{Camera, CameraDescription, FovAxis, Projection};
use twintree::film::{Film, FilmDescription, FilmKind, filter::Filter};
use twintree::guide::ModelKind;
use twintree::integrate::View;
use twintree::integrate::debug::probe::LatLong;
use twintree::integrate::guiding::{Guidance, Guide};
use twintree::integrate::progress::{Limits, Observer, Progress, Summary};
use twintree::integrate::render::render;
use twintree::integrate::training::LearnSettings;
use twintree::integrate::{GuidedSettings, PathSettings};
use twintree::light::Emitter;
use twintree::math::{Affine3A, DAffine3, DVec3, Rgb, Vec3};
use twintree::medium::Media;
use twintree::photon::PhotonSettings;
use twintree::photon::schedule::Budget;
use twintree::scene::description::{RenderDescription, SamplerKind};
use twintree::scene::{Description, Geometry, Mesh, Scene, Shape};
use twintree::texture::Texture;

/// A scene under construction.
pub struct SceneMaker {
    pub description: Description,
}

/// A constant grey.
pub fn grey(value: f32) -> Texture {
    Texture::Constant(Rgb::splat(value))
}

impl SceneMaker {
    /// An empty scene seen from `eye` towards `target`, `size` pixels square.
    pub fn new(eye: Vec3, target: Vec3, fov_degrees: f64, size: u32) -> Self {
        let forward = (target - eye).as_dvec3().normalize();
        let up = if forward.y.abs() > 0.99 {
            DVec3::X
        } else {
            DVec3::Y
        };
        let left = up.cross(forward).normalize();
        let to_world = DAffine3::from_cols(left, forward.cross(left), forward, eye.as_dvec3());
        let projection = Projection::Perspective {
            fov_degrees,
            fov_axis: FovAxis::X,
            principal_point: [0.0, 0.0],
        };
        Self {
            description: Description {
                media: Media::default(),
                camera_medium: None,
                shapes: Vec::new(),
                groups: 0,
                instances: Vec::new(),
                materials: Materials::default(),
                emitters: Vec::new(),
                emitter_names: Default::default(),
                camera: CameraDescription {
                    to_world,
                    projection,
                    near_clip: 1e-4,
                    far_clip: 1e9,
                },
                film: FilmDescription {
                    width: size,
                    height: size,
                    crop: None,
                    filter: Filter::Box { radius: 0.5 },
                    kind: FilmKind::Hdr,
                    exposure: 0.0,
                    extras: Default::default(),
                },
                render: RenderDescription::default(),
                origin: DVec3::ZERO,
                warnings: Vec::new(),
            },
        }
    }

    pub fn material(&mut self, material: impl Into<Material>) -> MaterialId {
        self.description.materials.push(material)
    }

    pub fn diffuse(&mut self, reflectance: f32) -> MaterialId {
        self.material(Diffuse {
            reflectance: grey(reflectance),
        })
    }

    /// Adds a shape; with `glow`, an emitter of that radiance.
    pub fn shape(
        &mut self,
        geometry: Geometry,
        material: MaterialId,
        glow: Option<f32>,
        flip: bool,
    ) {
        let shape = self.description.shapes.len() as u32;
        let emitter = glow.map(|radiance| {
            self.description.emitters.push(Emitter::Area {
                shape,
                radiance: grey(radiance),
                both_sides: false,
            });
            (self.description.emitters.len() - 1) as u32
        });
        self.description.shapes.push(Shape {
            boundary: None,
            name: format!("shape {shape}"),
            geometry,
            material,
            emitter,
            flip_normals: flip,
            group: None,
        });
    }

    pub fn emitter(&mut self, emitter: Emitter) {
        self.description.emitters.push(emitter);
    }

    pub fn exact(&mut self, kind: AnalyticKind, to_world: Affine3A) -> Geometry {
        Geometry::Analytic(AnalyticShape::new(kind, to_world))
    }

    pub fn sphere(
        &mut self,
        center: Vec3,
        radius: f32,
        material: MaterialId,
        glow: Option<f32>,
        flip: bool,
    ) {
        let place = Affine3A::from_translation(center) * Affine3A::from_scale(Vec3::splat(radius));
        let geometry = self.exact(AnalyticKind::Sphere, place);
        self.shape(geometry, material, glow, flip);
    }

    /// Builds the scene with a backend.
    pub fn build(mut self, backend: Backend) -> Built {
        let camera = Camera::new(
            &self.description.camera,
            self.description.film.width,
            self.description.film.height,
        );
        let settings = BuildSettings {
            robust: true,
            ..BuildSettings::default()
        };
        let scene =
            Scene::build(&mut self.description, settings, backend).expect("the scene builds");
        Built {
            scene,
            camera,
            film: self.description.film,
        }
    }
}

/// A mesh from corners, flat shaded.
pub fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Geometry {
    let triangles = Arc::new(TriangleMesh::new(positions, triangles).expect("indices in range"));
    Geometry::Mesh(Arc::new(Mesh {
        triangles,
        ..Mesh::default()
    }))
}

/// The inside of the cube `[-h, h]^3`: normals point inwards.
pub fn inside_of_cube(h: f32) -> Geometry {
    let corner = |i: u32| {
        let side = |bit: u32| if i & bit == 0 { -h } else { h };
        Vec3::new(side(1), side(2), side(4))
    };
    let faces = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let triangles = faces
        .iter()
        .flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]])
        .collect();
    mesh((0..8).map(corner).collect(), triangles)
}

/// The cube `[-h, h]^3`: normals point outwards.
pub fn cube(h: f32) -> Geometry {
    let Geometry::Mesh(inside) = inside_of_cube(h) else {
        unreachable!("it is a mesh")
    };
    let turned = inside
        .triangles
        .triangles()
        .iter()
        .map(|&[a, b, c]| [a, c, b]);
    mesh(inside.triangles.positions().to_vec(), turned.collect())
}

/// A scene ready to render.
pub struct Built {
    pub scene: Scene,
    pub camera: Camera,
    pub film: FilmDescription,
}

/// Nobody looks on.
pub struct Silent;

impl Observer for Silent {
    fn pass_done(&self, _: &Progress, _: &Film) {}
    fn should_stop(&self) -> bool {
        false
    }
}

/// Path settings of the tests: unlimited depth unless changed.
pub fn settings() -> PathSettings {
    PathSettings {
        max_depth: u32::MAX,
        rr_depth: 5,
        guided: GuidedSettings::PLAIN,
        hide_emitters: false,
        hide_environment: false,
        strict_normals: false,
        sampler: SamplerKind::Independent,
        seed: 1,
    }
}

impl Built {
    /// Renders `spp` samples a pixel, unguided.
    pub fn render(&self, settings: &PathSettings, spp: u64) -> (Film, Summary) {
        self.render_guided(settings, spp, None)
    }

    /// Renders `spp` samples a pixel.
    pub fn render_guided(
        &self,
        settings: &PathSettings,
        spp: u64,
        guide: Option<&Guide>,
    ) -> (Film, Summary) {
        self.render_by(settings, spp, guide.map(Into::into))
    }

    /// The same, guided by any field.
    pub fn render_by(
        &self,
        settings: &PathSettings,
        spp: u64,
        guide: Option<Guidance>,
    ) -> (Film, Summary) {
        let mut film = Film::new(&self.film);
        let limits = Limits {
            spp,
            time: None,
            noise: None,
        };
        let view = View {
            guide,
            ..self.view(settings, None)
        };
        let summary = render(&view, &mut film, &limits, &Silent);
        (film, summary)
    }

    /// The scene as its camera sees it.
    pub fn view<'a>(&'a self, settings: &'a PathSettings, guide: Option<&'a Guide>) -> View<'a> {
        View {
            scene: &self.scene,
            camera: &self.camera,
            film: &self.film,
            settings,
            guide: guide.map(Into::into),
        }
    }

    /// Mean of the image over all pixels and channels, with its standard error from the pixels' own
    /// variances.
    pub fn mean(&self, settings: &PathSettings, spp: u64) -> (f64, f64) {
        film_mean(&self.render(settings, spp).0)
    }
}

/// Mean of a grey film over all pixels and channels, with its standard error from the pixels' own
/// variances.
pub fn film_mean(film: &Film) -> (f64, f64) {
    let mut sum = 0.0;
    let mut variance = 0.0;
    let mut count = 0.0;
    for y in 0..film.height() {
        for x in 0..film.width() {
            let (mean, var) = (film.pixel(x, y).mean(), film.pixel(x, y).variance_of_mean());
            for c in 0..3 {
                sum += mean[c];
                variance += var[c];
                count += 1.0;
            }
        }
    }
    // The three channels of a grey scene are the same number: their errors add up linearly.
    (sum / count, (3.0 * variance).sqrt() / count)
}

/// What a pixel is over many renders, in green.
pub struct Spread {
    /// Mean of its values.
    pub mean: f64,
    /// Variance of its values.
    pub actual: f64,
    /// What it tells of that itself, on average.
    pub told: f64,
}

/// The spread of all pixels over renders with different seeds.
pub fn spreads(films: &[Film]) -> Vec<Spread> {
    let n = films.len() as f64;
    let of = |(x, y): (u32, u32)| {
        let pixels: Vec<_> = films.iter().map(|f| f.pixel(x, y)).collect();
        let mean = pixels.iter().map(|p| p.mean()[1]).sum::<f64>() / n;
        let squares: f64 = pixels.iter().map(|p| (p.mean()[1] - mean).powi(2)).sum();
        Spread {
            mean,
            actual: squares / (n - 1.0),
            told: pixels.iter().map(|p| p.variance_of_mean()[1]).sum::<f64>() / n,
        }
    };
    let (width, height) = (films[0].width(), films[0].height());
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    places.map(of).collect()
}

/// How the tests learn a field.
pub fn how(photons: u64, paths: u64) -> LearnSettings {
    let photon = PhotonSettings {
        max_bounces: 11,
        roulette_after: 3,
        seed: 5,
    };
    LearnSettings {
        photons: Budget::Exactly {
            photons,
            batches: 6,
        },
        paths,
        batches: 6,
        memory: 32 << 20,
        mixture: None,
        trial: true,
        photon,
        // What the program takes unless it is told otherwise.
        model: ModelKind::Gauss,
    }
}

/// Block means of two renders agree: 4 x 4 pixels, 64 blocks; the largest of 64 normal deviates
/// exceeds 4.2 once in a thousand tests.
pub fn agree(what: &str, a: &Film, b: &Film) {
    let mut worst: f64 = 0.0;
    for by in 0..a.height() / 4 {
        for bx in 0..a.width() / 4 {
            let sum = |film: &Film| {
                let mut sum = (0.0, 0.0);
                for i in 0..16 {
                    let pixel = film.pixel(bx * 4 + i % 4, by * 4 + i / 4);
                    sum.0 += pixel.mean()[1];
                    sum.1 += pixel.variance_of_mean()[1];
                }
                sum
            };
            let (sa, sb) = (sum(a), sum(b));
            worst = worst.max((sa.0 - sb.0).abs() / (sa.1 + sb.1).sqrt());
        }
    }
    let (ma, mb) = (film_mean(a), film_mean(b));
    let z = (ma.0 - mb.0) / ma.1.hypot(mb.1);
    println!(
        "{what}: {:.5} +- {:.5} and {:.5} +- {:.5}, worst block {worst:.2}",
        ma.0, ma.1, mb.0, mb.1
    );
    assert!(z.abs() < 3.3, "{what}: means differ by {z} standard errors");
    assert!(
        worst < 4.2,
        "{what}: a block differs by {worst} standard errors"
    );
}

/// The part of two densities over the sphere that is common: 1 if they are the same, 0 if disjoint.
pub fn overlap(a: &LatLong, b: &LatLong) -> f32 {
    let (sum_a, sum_b) = (a.integral().x, b.integral().x);
    let pixels = a.pixels.iter().zip(&b.pixels);
    let common = LatLong {
        pixels: pixels.map(|(a, b)| (*a / sum_a).min(*b / sum_b)).collect(),
        ..a.clone()
    };
    common.integral().x
}
