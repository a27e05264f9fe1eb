//! The manual: what the program does, page by page. There is only documentation here.
//!
//! | page | what is in it |
//! |---|---|
//! | [`start`] | installing, five minutes with the program, all commands |
//! | [`render`] | options of `render`, outputs, noise, `--quality`, exit codes |
//! | [`media`] | fog, tinted water, cloudy glass |
//! | [`layers`] | layers of an EXR beside the picture |
//! | [`denoise`] | `--denoise` and `twintree denoise`, where the denoiser comes from, what it gains |
//! | [`guiding`] | options of guiding, field files, what guiding gains |
//! | [`parts`] | checkpoints, parts of an image on many machines, job files |
//! | [`pbrt`] | what of pbrt's scene files is read, and how near it comes |
//! | [`scenes`] | what of Mitsuba's scene files is read; models without a scene |
//! | [`models`] | what of glTF, MTL, PLY, STL and USD is read, approximated, left out |
//! | [`python`] | the package for Python: renders, fields and comparisons as arrays |
//! | [`compare`] | how far images are from a reference; `sweep`: which settings suit a scene |
//! | [`table1`] | the table of the method's paper |
//! | [`stats`] | the keys of the `--stats` file |
//! | [`speed`] | Mitsuba 3 beside, large models, `bench accel` and `bench scale` |
//!
//! `twintree COMMAND --help` and the man pages (`twintree generate man DIR`) list every option.

pub mod compare {
    #![doc = include_str!("compare.md")]
}

pub mod denoise {
    #![doc = include_str!("denoise.md")]
}

pub mod guiding {
    #![doc = include_str!("guiding.md")]
}

pub mod media {
    #![doc = include_str!("media.md")]
}
pub mod layers {
    #![doc = include_str!("layers.md")]
}

pub mod models {
    #![doc = include_str!("models.md")]
}

pub mod parts {
    #![doc = include_str!("parts.md")]
}

pub mod pbrt {
    #![doc = include_str!("pbrt.md")]
}

pub mod python {
    #![doc = include_str!("python.md")]
}

pub mod render {
    #![doc = include_str!("render.md")]
}

pub mod scenes {
    #![doc = include_str!("scenes.md")]
}

pub mod speed {
    #![doc = include_str!("speed.md")]
    #![doc = "\n<div style=\"overflow-x: auto\">"]
    #![doc = include_str!("../../scenes/pictures/growth.svg")]
    #![doc = "</div>"]
}

pub mod start {
    #![doc = include_str!("start.md")]
}

pub mod stats {
    #![doc = include_str!("stats.md")]
}

pub mod table1 {
    #![doc = include_str!("table1.md")]
}
