//! Grids of OpenVDB files: values, places, refusals. The files are made by `writer.cpp` beside this
//! file, which the first test compiles.

mod hostile;
mod renders;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use tempfile::TempDir;
use twintree::image::decoded::DecodeLimit;
use twintree::math::DVec3;
use twintree::medium::grids::Vdb;

/// Where the small grids begin, and how many voxels they have.
const LOW: [i32; 3] = [-3, 2, 5];
const SIZE: [u32; 3] = [7, 5, 9];

/// The program that writes files; compiled when its source is newer than what is there.
fn writer() -> &'static Path {
    static WRITER: OnceLock<PathBuf> = OnceLock::new();
    WRITER.get_or_init(|| {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vdb/writer.cpp");
        let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("vdb_writer");
        let modified = |path: &Path| path.metadata().and_then(|m| m.modified());
        let is_new = modified(&program).is_ok_and(|t| t > modified(&source).unwrap());
        if !is_new {
            let compiler = std::env::var("CXX").unwrap_or_else(|_| "c++".into());
            let made = program.with_extension("new");
            let done = Command::new(compiler)
                .args(["-std=c++17", "-Wall"])
                .arg(source)
                .arg("-o")
                .arg(&made)
                .args(["-lopenvdb", "-ltbb", "-lImath"])
                .output()
                .unwrap();
            assert!(
                done.status.success(),
                "{}",
                String::from_utf8_lossy(&done.stderr)
            );
            std::fs::rename(made, &program).unwrap();
        }
        program
    })
}

/// A folder with files that the writer makes.
struct Files(TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A file of that kind.
    fn write(&self, kind: &str) -> PathBuf {
        let path = self.0.path().join(format!("{kind}.vdb"));
        let done = Command::new(writer())
            .arg(kind)
            .arg(&path)
            .output()
            .unwrap();
        assert!(
            done.status.success(),
            "{}",
            String::from_utf8_lossy(&done.stderr)
        );
        path
    }

    fn read(&self, kind: &str, grid: Option<&str>) -> Result<Vdb, String> {
        read(&self.write(kind), grid)
    }
}

fn read(path: &Path, grid: Option<&str>) -> Result<Vdb, String> {
    Vdb::read(path, grid, DecodeLimit::default()).map_err(|e| e.to_string())
}

/// `value` of the writer.
fn value(x: i32, y: i32, z: i32) -> f32 {
    (((x + 3) * 37 + (y - 2) * 101 + (z - 5) * 53) % 499) as f32 / 16.0
}

/// All voxels of the small grids, in the order of their values.
fn voxels() -> impl Iterator<Item = [i32; 3]> {
    let [x, y, z] = [0, 1, 2].map(|axis| LOW[axis]..LOW[axis] + SIZE[axis] as i32);
    z.flat_map(move |z| {
        let x = x.clone();
        y.clone()
            .flat_map(move |y| x.clone().map(move |x| [x, y, z]))
    })
}

fn densities() -> Vec<f32> {
    voxels().map(|[x, y, z]| value(x, y, z)).collect()
}

#[test]
fn densities_are_those_that_were_written() {
    let files = Files::new();
    for kind in ["float", "half", "double"] {
        let vdb = files.read(kind, None).unwrap();
        assert_eq!((vdb.resolution, vdb.channels), (SIZE, 1), "{kind}");
        assert_eq!(vdb.values, densities(), "{kind}");
    }
}

#[test]
fn vectors_are_colours() {
    let files = Files::new();
    let colour = |[x, y, z]: [i32; 3]| {
        let v = value(x, y, z) / 32.0;
        [v, v / 2.0, 1.0 - v]
    };
    let colours: Vec<f32> = voxels().flat_map(colour).collect();
    for kind in ["vec3s", "vec3d"] {
        let vdb = files.read(kind, None).unwrap();
        assert_eq!((vdb.resolution, vdb.channels), (SIZE, 3), "{kind}");
        assert_eq!(vdb.values, colours, "{kind}");
    }
}

#[test]
fn the_box_is_that_of_the_active_voxels_and_the_others_in_it_have_their_values() {
    let vdb = Files::new().read("sparse", None).unwrap();
    assert_eq!(vdb.resolution, [21, 31, 4]);
    let mut expected = vec![0.25; 21 * 31 * 4];
    expected[0] = 1.0;
    expected[20] = 2.0;
    expected[(3 * 31 + 30) * 21 + 20] = 3.0;
    assert_eq!(vdb.values, expected);
}

#[test]
fn the_centre_of_each_voxel_lies_where_the_file_puts_its_coordinates() {
    let files = Files::new();
    for (kind, steps, origin) in [
        (
            "float",
            [DVec3::Y * 0.5, DVec3::X * -0.25, DVec3::Z * 2.0],
            DVec3::new(10.0, 20.0, 30.0),
        ),
        (
            "aligned",
            [DVec3::X * 0.5, DVec3::Y * 0.5, DVec3::Z * 0.5],
            DVec3::new(1.0, 2.0, 3.0),
        ),
        ("half", DVec3::AXES, DVec3::ZERO),
    ] {
        let vdb = files.read(kind, None).unwrap();
        for at in voxels() {
            let [x, y, z] = [0, 1, 2].map(|i| steps[i] * f64::from(at[i]));
            let share = |i| (f64::from(at[i] - LOW[i]) + 0.5) / f64::from(SIZE[i]);
            let inside = DVec3::new(share(0), share(1), share(2));
            let found = vdb.bbox_transform.transform_point3(inside);
            let error = (found - (origin + x + y + z)).length();
            assert!(error < 1e-12, "{kind} {at:?}: {found}");
        }
    }
}

#[test]
fn a_grid_is_named_or_called_density_or_alone() {
    let files = Files::new();
    assert_eq!(
        files.read("several", Some("second")).unwrap().values,
        densities()
    );
    assert_eq!(files.read("with-others", None).unwrap().values, densities());
    let colours = files.read("with-others", Some("color")).unwrap();
    assert_eq!(colours.channels, 3);
    for (kind, grid, words) in [
        (
            "several",
            None,
            "name one with \"grid\", of \"first\", \"second\"",
        ),
        (
            "several",
            Some("third"),
            "no grid \"third\", but \"first\", \"second\"",
        ),
        ("float", Some(""), "no grid \"\", but \"density\""),
        ("nothing", None, "has no grids"),
    ] {
        let error = files.read(kind, grid).unwrap_err();
        assert!(error.contains(words) && error.contains(kind), "{error}");
    }
}

#[test]
fn grids_that_share_voxels_and_grids_of_a_stream_are_read() {
    let files = Files::new();
    let shared = files.read("shared", None).unwrap();
    assert_eq!(shared, files.read("float", None).unwrap());
    assert_eq!(
        files.read("shared", Some("first")).unwrap().values,
        densities()
    );
    assert_eq!(
        files.read("stream", Some("second")).unwrap().values,
        densities()
    );
}

#[test]
fn what_is_no_density_is_refused_in_words() {
    let files = Files::new();
    for (kind, words) in [
        ("level-set", "is a level set"),
        ("staggered", "is staggered"),
        ("frustum", "only affine transforms"),
        (
            "bool",
            "of type Tree_bool_5_4_3: half, float, double and vec3 are read",
        ),
        ("empty", "no active voxels"),
        (
            "negative",
            "1 values are negative, the first is -1 in channel 0 of voxel (4, 1, 2)",
        ),
        ("infinite", "1 values are not finite"),
    ] {
        let error = files.read(kind, None).unwrap_err();
        let file = format!("{kind}.vdb: ");
        assert!(error.contains(words) && error.contains(&file), "{error}");
    }
}

#[test]
fn boxes_that_are_too_large_are_refused_before_memory_is_taken() {
    let files = Files::new();
    let endless = files.read("endless", None).unwrap_err();
    assert!(
        endless.contains("2147483649 x 1 x 1: each must be 1 to 65536"),
        "{endless}"
    );
    let path = files.write("huge");
    let huge = read(&path, None).unwrap_err();
    assert!(
        huge.contains("4096 x 4096 x 4096 voxels would take 256.0 GiB"),
        "{huge}"
    );
    assert!(huge.contains("--limit-decoded 262144M"), "{huge}");
    assert!(path.metadata().unwrap().len() < 1000);
}

#[test]
fn what_is_no_file_is_refused() {
    let text = |path: &Path| read(path, None).unwrap_err();
    assert!(text(Path::new("/dev/zero")).contains("a device, not a regular file"));
    assert!(text(Path::new("none.vdb")).starts_with("none.vdb: "));
    let folder = Files::new();
    let path = folder.0.path().join("text.vdb");
    std::fs::write(&path, "a text that is none of OpenVDB's files").unwrap();
    assert!(text(&path).contains("text.vdb: "), "{}", text(&path));
}
