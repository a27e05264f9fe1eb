//! Whether a scene fits into memory: asked before it is loaded and again before its trees are
//! built, so that the program says no with numbers instead of being ended by the system.
//!
//! The estimates are upper bounds of what was measured ([`manual::speed`](crate::manual::speed));
//! they err by tens of per cent, not by factors.

use super::ray_args::AccelBuild;
use super::{Failure, memory};
use crate::accel::Backend;
use crate::report::words;
use crate::scene::import::mesh::MeshKind;
use crate::scene::import::models::{ModelKind, ModelSource};
use std::collections::BTreeSet;

/// Bytes of an instance in the trees and in the scene.
const INSTANCE_BYTES: u64 = 1200;

/// What the trees are built of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Load {
    /// Triangles, instances counted once.
    pub triangles: u64,
    /// Instances.
    pub instances: u64,
}

/// Refuses models whose files alone say that they do not fit.
///
/// # Errors
/// With the bytes needed and available.
pub fn check_files(sources: &[ModelSource]) -> Result<(), Failure> {
    let Some(available) = memory::available_bytes() else {
        return Ok(());
    };
    let files: BTreeSet<_> = sources.iter().map(|s| &s.path).collect();
    let size = |path| std::fs::metadata(path).map_or(0, |m| m.len());
    let needed = files
        .into_iter()
        .map(|path| (size(path) as f64 * growth(path)) as u64)
        .fold(0u64, u64::saturating_add);
    if needed <= available {
        return Ok(());
    }
    Err(Failure::refused(
        format!(
            "reading the models takes about {} of memory, and {} are available",
            words::bytes(needed),
            words::bytes(available)
        ),
        "simplify the models, or take a machine with more memory",
    ))
}

/// Most memory that reading a file takes, in sizes of the file; the file itself, which is mapped,
/// does not count.
fn growth(path: &std::path::Path) -> f64 {
    match ModelKind::from_path(path) {
        Some(ModelKind::Mesh(MeshKind::Obj)) => 3.5,
        Some(ModelKind::Mesh(MeshKind::Ply)) => 2.0,
        Some(ModelKind::Mesh(MeshKind::Stl)) => 1.5,
        Some(ModelKind::Mesh(MeshKind::Serialized)) => 6.0,
        Some(ModelKind::Gltf) => 1.5,
        None => 0.0,
    }
}

/// The way of building that was asked for, or else the fastest that fits.
///
/// # Errors
/// When it does not fit, with the bytes needed and available.
pub fn choose(
    asked: Option<AccelBuild>,
    backend: Backend,
    load: Load,
    available: Option<u64>,
) -> Result<AccelBuild, Failure> {
    let Some(available) = available else {
        return Ok(asked.unwrap_or(AccelBuild::Balanced));
    };
    let ways = match asked {
        Some(way) => vec![way],
        None => vec![AccelBuild::Balanced, AccelBuild::Compact],
    };
    let fits = |way: &&AccelBuild| needed(**way, backend, load) <= available;
    if let Some(way) = ways.iter().find(fits) {
        return Ok(*way);
    }
    let least = ways.iter().map(|way| needed(*way, backend, load)).min();
    let help = match asked {
        Some(AccelBuild::Fast | AccelBuild::Balanced | AccelBuild::High) => {
            "--accel-build compact takes less"
        }
        _ => "simplify the models, or take a machine with more memory",
    };
    Err(Failure::refused(
        format!(
            "the ray tracer takes about {} of memory to build its trees over {} triangles and {} instances, and {} are available",
            words::bytes(least.unwrap_or(0)),
            words::count(load.triangles as f64),
            words::count(load.instances as f64),
            words::bytes(available)
        ),
        help,
    ))
}

/// Most bytes held while the trees are built, beside the meshes themselves.
fn needed(way: AccelBuild, backend: Backend, load: Load) -> u64 {
    let triangle = match (backend, way) {
        (Backend::Embree, AccelBuild::Compact) => 100,
        (Backend::Embree, AccelBuild::Fast | AccelBuild::Balanced) => 130,
        (Backend::Embree, AccelBuild::High) => 220,
        (Backend::Obvhs, _) => 360,
    };
    let triangles = load.triangles.saturating_mul(triangle);
    triangles.saturating_add(load.instances.saturating_mul(INSTANCE_BYTES))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn million(n: u64) -> Load {
        Load {
            triangles: n * 1_000_000,
            instances: 0,
        }
    }

    #[test]
    fn the_way_follows_from_memory() {
        let at = |asked, gigabytes: u64| {
            let available = Some(gigabytes * 1_000_000_000);
            choose(asked, Backend::Embree, million(50), available)
        };
        assert_eq!(at(None, 20), Ok(AccelBuild::Balanced));
        assert_eq!(at(None, 6), Ok(AccelBuild::Compact));
        assert_eq!(at(Some(AccelBuild::High), 20), Ok(AccelBuild::High));
        let refusal = at(None, 1).unwrap_err().text().unwrap();
        assert!(refusal.contains("50.0 M triangles"), "{refusal}");
        let refusal = at(Some(AccelBuild::Balanced), 6).unwrap_err();
        assert!(refusal.text().unwrap().contains("compact"));
        let unknown = choose(None, Backend::Embree, million(9999), None);
        assert_eq!(unknown, Ok(AccelBuild::Balanced));
    }

    #[test]
    fn instances_count_as_well() {
        let crowd = Load {
            triangles: 1000,
            instances: 10_000_000,
        };
        let available = Some(1_000_000_000);
        assert!(choose(None, Backend::Embree, crowd, available).is_err());
    }
}
