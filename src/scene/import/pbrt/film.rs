//! Film, filter, sampler, integrator, and the exposure of the sensor.

use super::importer::Importer;
use super::parameter::Kind;
use super::params::Params;
use crate::film::filter::Filter;
use crate::film::{FilmDescription, FilmKind};
use crate::scene::description::SamplerKind;
use crate::scene::import::named;

/// Largest picture: OpenEXR and common sense end there.
const MAX_SIZE: u32 = 1 << 20;

/// The kinds of films, filters, samplers and integrators that have a meaning here.
pub(super) const FILMS: &[&str] = &["rgb", "gbuffer", "spectral", "image"];
pub(super) const FILTERS: &[&str] = &["box", "triangle", "gaussian", "mitchell", "sinc"];
pub(super) const SAMPLERS: &[&str] = &[
    "independent",
    "random",
    "stratified",
    "halton",
    "paddedsobol",
    "sobol",
    "zsobol",
    "pmj02bn",
    "02sequence",
    "lowdiscrepancy",
    "maxmindist",
];
/// Integrators whose paths are those of this program.
pub(super) const INTEGRATORS: &[&str] =
    &["path", "volpath", "simplevolpath", "bdpt", "mlt", "sppm"];

impl<'s> Importer<'s> {
    /// The film, with its filter.
    pub fn film(
        &mut self,
        p: Option<&Params<'_, 's>>,
        filter: Filter,
    ) -> Result<FilmDescription, String> {
        let mut film = FilmDescription {
            width: 1280,
            height: 720,
            crop: None,
            filter,
            kind: FilmKind::Hdr,
            exposure: 0.0,
            extras: Default::default(),
        };
        let Some(p) = p else {
            return Ok(film);
        };
        if !FILMS.contains(&p.name()) {
            let help = named::did_you_mean(p.name(), FILMS.iter().copied());
            let help = help.map_or(String::new(), |h| format!("; {h}"));
            return Err(format!("there is no film \"{}\"{help}", p.name()));
        }
        // What files hold and how they are named is asked for on the command line; how large the
        // film is in millimetres matters to lens systems alone.
        p.ignore(&["filename", "savefp16", "diagonal", "coordinatesystem"]);
        if p.name() == "spectral" {
            p.ignore(&["nbuckets", "lambdamin", "lambdamax"]);
            self.warn_at(
                p.at(),
                "a spectral film is rendered as one of red, green and blue",
            );
        }
        self.left_out(
            p,
            &["maxcomponentvalue"],
            "no sample is cut; v4's default would cut nothing either",
        );
        let v3 = p.name() == "image";
        film.width = p.count("xresolution", if v3 { 640 } else { 1280 });
        film.height = p.count("yresolution", if v3 { 480 } else { 720 });
        if film.width > MAX_SIZE || film.height > MAX_SIZE {
            return Err(format!(
                "a picture of {} x {} pixels is too large",
                film.width, film.height
            ));
        }
        film.crop = self.crop(p, [film.width, film.height]);
        if p.float_given("scale").is_some_and(|scale| scale != 1.0) {
            self.left_out(p, &["scale"], "--exposure brightens a picture");
        }
        self.sensor(p);
        self.done(p);
        Ok(film)
    }

    /// The part of the picture that is rendered: x0, y0, x1, y1 in pixels.
    fn crop(&mut self, p: &Params<'_, 's>, [width, height]: [u32; 2]) -> Option<[u32; 4]> {
        let pixels = match (
            p.floats("cropwindow", &[Kind::Float]),
            p.integers("pixelbounds"),
        ) {
            (Some(&[x0, x1, y0, y1]), _) => {
                let at = |x: f32, n: u32| (x.clamp(0.0, 1.0) * n as f32).ceil() as u32;
                [
                    at(x0.min(x1), width),
                    at(y0.min(y1), height),
                    at(x0.max(x1), width),
                    at(y0.max(y1), height),
                ]
            }
            (None, Some(&[x0, x1, y0, y1])) => {
                let at = |x: i32, n: u32| u32::try_from(x.max(0)).unwrap_or(0).min(n);
                [at(x0, width), at(y0, height), at(x1, width), at(y1, height)]
            }
            (None, None) => return None,
            (Some(_), _) => {
                p.wrong(
                    "cropwindow",
                    "\"cropwindow\" is four numbers: x from, x to, y from, y to",
                );
                return None;
            }
            (None, Some(_)) => {
                p.wrong(
                    "pixelbounds",
                    "\"pixelbounds\" is four numbers: x from, x to, y from, y to",
                );
                return None;
            }
        };
        let [x0, y0, x1, y1] = pixels;
        if x0 >= x1 || y0 >= y1 {
            let name = if p.has("cropwindow") {
                "cropwindow"
            } else {
                "pixelbounds"
            };
            p.wrong(
                name,
                format!("\"{name}\" leaves no pixel of {width} x {height}"),
            );
            return None;
        }
        (pixels != [0, 0, width, height]).then_some(pixels)
    }

    /// What is told of a sensor: its exposure is in [`Importer::exposure`].
    fn sensor(&mut self, p: &Params<'_, 's>) {
        p.ignore(&["iso"]);
        let sensor = p.text("sensor").unwrap_or("cie1931");
        if sensor != "cie1931" {
            self.warn_at(p.place_of("sensor"), &format!(
                "the sensor \"{sensor}\" is rendered as \"cie1931\": as bright, in slightly other \
                 colours"
            ));
            p.ignore(&["whitebalance"]);
        } else if p.float("whitebalance", 0.0) != 0.0 {
            self.left_out(p, &["whitebalance"], "white is that of sRGB");
        }
    }

    /// pbrt's imaging ratio: seconds of exposure times ISO over 100. It multiplies every picture,
    /// and therefore every light here.
    pub fn exposure(&mut self) -> f32 {
        let shutter = self.setup.camera.clone().map_or(1.0, |(camera, _)| {
            let p = Params::new(self.source, &camera);
            let open = p.float("shutteropen", 0.0);
            let seconds = p.float("shutterclose", 1.0) - open;
            if seconds <= 0.0 {
                p.wrong("shutterclose", "the shutter closes before it opens");
                return 1.0;
            }
            seconds
        });
        let iso = self.setup.film.clone().map_or(100.0, |film| {
            let p = Params::new(self.source, &film);
            // v3's film has no sensor, and its shutter no exposure.
            if p.name() == "image" {
                100.0 / shutter
            } else {
                p.positive("iso", 100.0)
            }
        });
        (shutter * iso / 100.0) as f32
    }

    /// The reconstruction filter.
    pub fn filter(&mut self, p: Option<&Params<'_, 's>>) -> Result<Filter, String> {
        let Some(p) = p else {
            return Ok(Filter::Gaussian { stddev: 0.5 });
        };
        let radius = |importer: &mut Self, default: f64| {
            let radii = ["xradius", "yradius", "xwidth", "ywidth"].map(|name| p.float_given(name));
            let [x, y, old_x, old_y] = radii;
            let x = x.or(old_x).unwrap_or(default);
            if (y.or(old_y).unwrap_or(default) - x).abs() > 1e-6 {
                importer.warn_at(p.at(), "the filter is as wide along y as along x");
            }
            if x > 0.0 { x } else { default }
        };
        let filter = match p.name() {
            "box" => Filter::Box {
                radius: radius(self, 0.5) as f32,
            },
            "triangle" => Filter::Tent {
                radius: radius(self, 2.0) as f32,
            },
            "gaussian" => {
                // v3's alpha is 1 / (2 sigma^2).
                let alpha = p.float_given("alpha").filter(|alpha| *alpha > 0.0);
                let sigma = alpha.map(|alpha| (0.5 / alpha).sqrt());
                let stddev = sigma.unwrap_or_else(|| p.positive("sigma", 0.5));
                let given = radius(self, 1.5);
                self.nearly(p, given, 3.0 * stddev, "cut at four of its sigmas");
                Filter::Gaussian {
                    stddev: stddev as f32,
                }
            }
            "mitchell" => {
                let given = radius(self, 2.0);
                self.nearly(p, given, 2.0, "two pixels wide to each side");
                Filter::Mitchell {
                    b: p.float("B", 1.0 / 3.0) as f32,
                    c: p.float("C", 1.0 / 3.0) as f32,
                }
            }
            "sinc" => {
                let tau = p.positive("tau", 3.0);
                let given = radius(self, 4.0);
                self.nearly(p, given, tau, "as wide as its window");
                Filter::Lanczos {
                    lobes: tau.min(64.0) as f32,
                }
            }
            other => {
                let help = named::did_you_mean(other, FILTERS.iter().copied());
                let help = help.map_or(String::new(), |h| format!("; {h}"));
                return Err(format!("there is no filter \"{other}\"{help}"));
            }
        };
        self.done(p);
        Ok(filter)
    }

    /// Says that a filter of another radius has the one that belongs to it.
    fn nearly(&mut self, p: &Params, given: f64, own: f64, what: &str) {
        if (given - own).abs() > 1e-3 * own {
            self.warn_at(
                p.at(),
                &format!("the {} filter is {what}, not {given}", p.name()),
            );
        }
    }

    /// The sampler, and samples a pixel.
    pub fn sampler(&mut self, p: Option<&Params<'_, 's>>) -> Result<(SamplerKind, u32), String> {
        let Some(p) = p else {
            return Ok((SamplerKind::Sobol, 16));
        };
        // How points are scrambled is the renderer's business; seeds come from the command line.
        p.ignore(&[
            "seed",
            "randomization",
            "jitter",
            "dimensions",
            "samplepixelcenter",
        ]);
        let kind = match p.name() {
            "independent" | "random" => SamplerKind::Independent,
            name if SAMPLERS.contains(&name) => SamplerKind::Sobol,
            other => {
                let help = named::did_you_mean(other, SAMPLERS.iter().copied());
                let help = help.map_or(String::new(), |h| format!("; {h}"));
                return Err(format!("there is no sampler \"{other}\"{help}"));
            }
        };
        let spp = match p.name() {
            "stratified" => p
                .count("xsamples", 4)
                .saturating_mul(p.count("ysamples", 4)),
            _ => p.count("pixelsamples", 16),
        };
        self.done(p);
        Ok((kind, spp))
    }

    /// What the integrator says of paths.
    pub fn integrator(&mut self, p: Option<&Params<'_, 's>>) {
        // pbrt counts bounces, the path tracer here edges: emission alone is 0 there and 1 here.
        self.render.max_depth = Some(6);
        let Some(p) = p else {
            return;
        };
        if let Some(depth) = p.integer_given("maxdepth") {
            let bounces = u32::try_from(depth).unwrap_or(0);
            self.render.max_depth = Some(bounces.saturating_add(1));
        } else if p.name() == "simplepath" || p.name() == "simplevolpath" {
            self.render.max_depth = Some(6);
        }
        // How lights are chosen and paths ended is the renderer's business.
        p.ignore(&[
            "lightsampler",
            "lightsamplestrategy",
            "rrthreshold",
            "samplelights",
            "samplebsdf",
        ]);
        if p.boolean("regularize", false) {
            self.left_out(p, &["regularize"], "glossy paths are rendered as they are");
        }
        if p.name() == "directlighting" {
            self.render.max_depth = Some(2);
        } else if !matches!(
            p.name(),
            "path" | "volpath" | "simplepath" | "simplevolpath"
        ) {
            let known = INTEGRATORS.contains(&p.name());
            let what = if known {
                "is rendered by"
            } else {
                "is not known here;"
            };
            let at = p.at();
            let name = p.name();
            self.warn_at(
                at,
                &format!("integrator \"{name}\" {what} this program's own path tracer"),
            );
        }
        self.done(p);
    }
}
