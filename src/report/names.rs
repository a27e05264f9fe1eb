//! The names by which scene files call things.

use crate::accel::AnalyticKind;
use crate::camera::Projection;
use crate::film::filter::Filter;
use crate::light::Emitter;

/// The plugin name of an emitter.
pub fn emitter(emitter: &Emitter) -> &'static str {
    match emitter {
        Emitter::Area { .. } => "area",
        Emitter::Point { .. } => "point",
        Emitter::Spot { .. } => "spot",
        Emitter::Directional { .. } => "directional",
        Emitter::Constant { .. } => "constant",
        Emitter::EnvironmentMap { .. } => "envmap",
        Emitter::SunSky { settings, .. } => match (settings.sun, settings.sky) {
            (true, false) => "sun",
            (false, true) => "sky",
            _ => "sunsky",
        },
        Emitter::Projector { .. } => "projector",
        Emitter::Goniometric { .. } => "goniometric",
    }
}

/// The plugin name of an exact shape.
pub fn shape(kind: AnalyticKind) -> &'static str {
    match kind {
        AnalyticKind::Sphere => "sphere",
        AnalyticKind::Disk => "disk",
        AnalyticKind::Cylinder => "cylinder",
        AnalyticKind::Rectangle => "rectangle",
    }
}

/// The plugin name of a camera.
pub fn camera(projection: &Projection) -> &'static str {
    match projection {
        Projection::Perspective { .. } => "perspective",
        Projection::ThinLens { .. } => "thinlens",
        Projection::Orthographic => "orthographic",
        Projection::Spherical => "spherical",
        Projection::Fisheye { .. } => "fisheye",
    }
}

/// The plugin name of a reconstruction filter.
pub fn filter(filter: &Filter) -> &'static str {
    match filter {
        Filter::Box { .. } => "box",
        Filter::Tent { .. } => "tent",
        Filter::Gaussian { .. } => "gaussian",
        Filter::Mitchell { .. } => "mitchell",
        Filter::CatmullRom => "catmullrom",
        Filter::Lanczos { .. } => "lanczos",
    }
}
