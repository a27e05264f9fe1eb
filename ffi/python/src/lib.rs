//! twintree for Python: renders, learned fields and comparisons as arrays.
//!
//! | file | idea |
//! |---|---|
//! | `words.rs` | keyword arguments are the command line's options, read by its own parser |
//! | `failure.rs` | what goes wrong, as Python's exceptions |
//! | `arrays.rs` | arrays in and out: shapes, types, numbers that are not finite |
//! | `work.rs` | work without Python's lock: threads, Ctrl-C, progress, messages, forks |
//! | `messages.rs` | the program's messages, for Python's `logging` |
//! | `scene.rs`, `additions.rs` | scenes from files and arrays |
//! | `state.rs` | what a scene keeps from one render to the next |
//! | `render.rs`, `picture.rs` | rendering, and what came of it |
//! | `field.rs`, `trainer.rs` | learned fields, and fields of one's own records |
//! | `incident.rs` | the light at a place, by brute force |
//! | `compare.rs` | how far an image is from a reference |
//! | `program.rs` | the command line itself: `python -m twintree` |
//!
//! The package around it is in `python/twintree`; its types are in `_native.pyi`.

mod additions;
mod arrays;
mod compare;
mod failure;
mod field;
mod incident;
mod messages;
mod picture;
mod program;
mod progress;
mod render;
mod scene;
mod state;
mod trainer;
mod words;
mod work;

use pyo3::prelude::*;

/// The compiled part of the package `twintree`.
#[pymodule]
mod _native {
    use super::*;

    #[pymodule_export]
    use super::{
        compare::compare, field::Field, picture::Render, program::main, scene::Scene, scene::load,
        trainer::Trainer, words::options,
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
