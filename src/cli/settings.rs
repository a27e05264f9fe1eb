//! What the command line changes about a scene.

use super::guide_args::{Guide, GuideArgs, GuidedArgs, LearnArgs, Teachers, When};
use super::light_args::LightArgs;
use super::picture_args::{PictureArgs, SizeArgs};
use super::render_args::{RenderArgs, StopArgs};
use super::{Failure, aov, light_layers, memory};
use crate::film::{Extras, FilmDescription, Pixel};
use crate::integrate::progress::Limits;
use crate::integrate::training::LearnSettings;
use crate::integrate::{GuidedSettings, PathSettings};
use crate::photon::PhotonSettings;
use crate::photon::schedule::Budget;
use crate::scene::Description;
use crate::scene::description::{RenderDescription, SamplerKind};
use std::sync::Arc;

/// Applies the command line to the scene's film.
///
/// # Errors
/// When the crop does not fit, groups of lights are not the scene's, or the film does not fit into
/// memory.
pub fn apply_to_film(args: &RenderArgs, description: &mut Description) -> Result<(), Failure> {
    let mut extras = aov::extras(&args.files.aov, description);
    let hidden = args.light.hide_emitters || description.render.hide_emitters;
    extras.light = light_layers::parts(&args.layers, &args.files.aov, description)?;
    extras.alpha = args.picture.alpha || (description.render.alpha && hidden);
    let film = &mut description.film;
    resize(film, args.picture.size);
    crop(film, &args.picture)?;
    if let Some(filter) = args.picture.rfilter {
        film.filter = filter;
    }
    if let Some(exposure) = args.files.exposure {
        film.exposure = exposure;
    }
    film.extras = Arc::new(extras);
    check_memory(film.region(), &film.extras)
}

/// Sets the size; one side alone keeps the proportions. The scene's own crop grows with the film.
pub fn resize(film: &mut FilmDescription, size: SizeArgs) {
    let (old_width, old_height) = (film.width, film.height);
    let scaled = |side: u32, by: u32, of: u32| {
        let exact = f64::from(side) * f64::from(by) / f64::from(of);
        (exact.round() as u32).max(1)
    };
    (film.width, film.height) = match (size.width, size.height) {
        (None, None) => return,
        (Some(w), Some(h)) => (w, h),
        (Some(w), None) => (w, scaled(old_height, w, old_width)),
        (None, Some(h)) => (scaled(old_width, h, old_height), h),
    };
    film.crop = film.crop.map(|[x0, y0, x1, y1]| {
        let along = |at: u32, new: u32, old: u32| {
            (f64::from(at) * f64::from(new) / f64::from(old)).round() as u32
        };
        let (w, h) = (film.width, film.height);
        let (x0, y0) = (
            along(x0, w, old_width).min(w - 1),
            along(y0, h, old_height).min(h - 1),
        );
        let (x1, y1) = (along(x1, w, old_width), along(y1, h, old_height));
        [x0, y0, x1.clamp(x0 + 1, w), y1.clamp(y0 + 1, h)]
    });
}

fn crop(film: &mut FilmDescription, args: &PictureArgs) -> Result<(), Failure> {
    let Some(crop) = args.crop else { return Ok(()) };
    let [_, _, x1, y1] = crop.0;
    if x1 > film.width || y1 > film.height {
        let [x0, y0, ..] = crop.0;
        return Err(Failure::wrong(
            format!(
                "--crop {x0},{y0},{x1},{y1} reaches beyond the film of {} x {} pixels",
                film.width, film.height
            ),
            format!(
                "x1 may be up to {} and y1 up to {}",
                film.width, film.height
            ),
        ));
    }
    film.crop = Some(crop.0);
    Ok(())
}

/// A film that does not fit would not fail when it is made: the system would end the program later,
/// without a word.
///
/// # Errors
/// When the film of the region x0, y0, x1, y1 does not fit into the memory that is free.
pub fn check_memory([x0, y0, x1, y1]: [u32; 4], extras: &Extras) -> Result<(), Failure> {
    let pixels = u64::from(x1 - x0) * u64::from(y1 - y0);
    let needed = pixels * (size_of::<Pixel>() + extras.bytes_of_pixel()) as u64;
    match memory::available_bytes() {
        Some(available) if needed > available => Err(Failure::refused(
            format!(
                "a film of {} x {} pixels needs {} MiB, and {} MiB are free",
                x1 - x0,
                y1 - y0,
                needed >> 20,
                available >> 20
            ),
            "ask for a smaller one with --width, or for a part of it with --crop",
        )),
        _ => Ok(()),
    }
}

/// How the paths of a render are traced.
pub fn of_render(args: &RenderArgs, scene: &RenderDescription) -> PathSettings {
    let guided = guided_settings(&args.guide.guided);
    PathSettings {
        hide_environment: args.picture.alpha,
        ..path_settings(&args.light, scene, guided)
    }
}

/// How paths are traced: the scene's words, then the command line's.
///
/// Sobol points drive the samples unless the command line says otherwise, with and without a field,
/// whatever the scene names, for a scene mostly asks for independent numbers because that is what
/// its format has by default. (Relative variance of 64 guided samples without the worst 0.1 % of
/// the pixels, with independent numbers and with Sobol points: a kitchen 0.057, 0.052; a torus in
/// glass 0.0101, 0.0078; veach-ajar 0.0305, 0.0284; lux-pool 0.093, 0.090; `scenes/pool` 0.0236,
/// 0.0190; in 1.0 to 1.07 times the time.)
pub fn path_settings(
    args: &LightArgs,
    scene: &RenderDescription,
    guided: GuidedSettings,
) -> PathSettings {
    let max_depth = args.max_depth.map_or(scene.max_depth, |depth| depth.0);
    PathSettings {
        max_depth: max_depth.unwrap_or(u32::MAX),
        rr_depth: args.rr_depth.unwrap_or(scene.rr_depth),
        guided,
        hide_emitters: args.hide_emitters || scene.hide_emitters,
        hide_environment: false,
        strict_normals: args.strict_normals || scene.strict_normals,
        sampler: args.sampler.unwrap_or(SamplerKind::Sobol),
        seed: args.seed,
    }
}

/// How paths of a render are traced where a field guides them.
pub fn guided_settings(args: &GuidedArgs) -> GuidedSettings {
    GuidedSettings {
        roulette: args.roulette,
        reuse: args.reuse,
        manifold: args.manifold == When::Auto,
        adaptive: args.adaptive == When::Auto,
    }
}

/// Most scatterings of a photon where paths are unlimited: roulette has ended nearly all by then.
/// (In a room of white walls, where none ends, 1000 of them made learning take 6 s of a render of
/// 2 s.)
const UNLIMITED_BOUNCES: u32 = 256;

/// Photons that a field is learned from where no image says how many it is worth.
pub const PHOTONS: u64 = 500_000;
/// Samples a pixel that a render without a limit in samples is taken to have.
const ENDLESS_SPP: u64 = 256;

/// Photons for a render: as many as are given, or as it is worth. An SD-tree takes none, but what
/// it costs is weighed by what the image is worth.
pub fn photons_for(args: &GuideArgs, film: &FilmDescription, limits: &Limits) -> Budget {
    match args.learn.photons {
        Some(photons) if args.way() != Guide::Ppg => exactly(photons, args.learn.batches),
        _ => photons_as_needed(film, limits),
    }
}

/// As many photons as an image is worth.
pub fn photons_as_needed(film: &FilmDescription, limits: &Limits) -> Budget {
    let spp = match limits.spp {
        u64::MAX if limits.time.is_none() => ENDLESS_SPP,
        spp => spp,
    };
    Budget::AsNeeded {
        samples: film.pixels().saturating_mul(spp),
        time: limits.time,
    }
}

/// Photons for a field without an image.
pub fn photons_alone(args: &LearnArgs) -> Budget {
    exactly(args.photons.unwrap_or(PHOTONS), args.batches)
}

fn exactly(photons: u64, batches: u32) -> Budget {
    Budget::Exactly { photons, batches }
}

/// How photons are traced: they scatter as often as camera paths can.
pub fn photon_settings(path: &PathSettings) -> PhotonSettings {
    PhotonSettings {
        max_bounces: path.max_depth.saturating_sub(2).min(UNLIMITED_BOUNCES),
        roulette_after: path.rr_depth.saturating_sub(2),
        seed: path.seed,
    }
}

/// How to learn a field.
///
/// # Errors
/// When nothing is left to learn from.
pub fn learn_settings(
    args: &LearnArgs,
    path: &PathSettings,
    photons: Budget,
) -> Result<LearnSettings, Failure> {
    let (photons, paths) = match args.train {
        Teachers::Photons => (photons, 0),
        Teachers::Paths => (exactly(0, args.batches), args.paths),
        Teachers::Both => (photons, args.paths),
    };
    if photons.is_none() && paths == 0 {
        let help = "give --photons or --paths a number above 0, or leave them away";
        return Err(Failure::wrong("there is nothing to learn from", help));
    }
    Ok(LearnSettings {
        photons,
        paths,
        batches: args.batches,
        memory: args.guide_memory as u64,
        photon: photon_settings(path),
        model: args.guide_model,
        mixture: None,
        trial: false,
    })
}

/// When to stop. The scene's number of samples counts only where the command line names no limit.
pub fn limits(args: &StopArgs, scene: &RenderDescription) -> Limits {
    let endless = args.time.is_some() || args.noise.is_some();
    let default = if endless {
        u64::MAX
    } else {
        u64::from(scene.spp.max(1))
    };
    Limits {
        spp: args.spp.unwrap_or(default),
        time: args.time,
        noise: args.noise,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmKind;
    use crate::film::filter::Filter;

    fn film(width: u32, height: u32, crop: Option<[u32; 4]>) -> FilmDescription {
        FilmDescription {
            width,
            height,
            crop,
            filter: Filter::Box { radius: 0.5 },
            kind: FilmKind::Hdr,
            exposure: 0.0,
            extras: Default::default(),
        }
    }

    #[test]
    fn one_side_keeps_the_proportions() {
        for (width, height, expected) in [
            (Some(320), None, (320, 180)),
            (None, Some(90), (160, 90)),
            (Some(10), Some(10), (10, 10)),
            (None, None, (640, 360)),
            (Some(1), None, (1, 1)),
        ] {
            let mut film = film(640, 360, None);
            resize(&mut film, SizeArgs { width, height });
            assert_eq!((film.width, film.height), expected);
        }
    }

    #[test]
    fn the_crop_of_the_scene_grows_with_the_film_and_keeps_a_pixel() {
        let width = |side| SizeArgs {
            width: Some(side),
            height: None,
        };
        let mut large = film(100, 100, Some([10, 20, 30, 40]));
        resize(&mut large, width(200));
        assert_eq!(large.crop, Some([20, 40, 60, 80]));
        let mut small = film(100, 100, Some([98, 99, 99, 100]));
        resize(&mut small, width(10));
        assert_eq!(small.crop, Some([9, 9, 10, 10]));
    }

    #[test]
    fn a_limit_of_the_command_line_replaces_that_of_the_scene() {
        let scene = RenderDescription::default();
        let mut stop = StopArgs {
            quality: None,
            spp: None,
            time: None,
            noise: None,
        };
        assert_eq!(limits(&stop, &scene).spp, 64);
        stop.noise = Some(0.1);
        assert_eq!(limits(&stop, &scene).spp, u64::MAX);
        stop.spp = Some(5);
        assert_eq!(limits(&stop, &scene).spp, 5);
    }

    #[test]
    fn an_sd_tree_is_worth_what_the_image_is_whatever_is_said_of_photons() {
        use super::super::args::{Cli, Command};
        use clap::Parser;
        let limits = Limits {
            spp: 8,
            time: None,
            noise: None,
        };
        let photons = |line: &str| {
            let Command::Render(args) = Cli::parse_from(line.split(' ')).command else {
                panic!("another command");
            };
            photons_for(&args.guide, &film(10, 10, None), &limits)
        };
        let as_needed = Budget::AsNeeded {
            samples: 800,
            time: None,
        };
        let line = "twintree render a.xml --guide";
        assert_eq!(photons(&format!("{line} ppg --photons 9")), as_needed);
        assert_eq!(photons(&format!("{line} double")), as_needed);
        assert_eq!(
            photons(&format!("{line} double --photons 9 --batches 3")),
            exactly(9, 3)
        );
    }
}
