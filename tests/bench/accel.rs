//! Rays a second, and how thin the layer over Embree is.
//!
//! ```text
//! cargo bench --bench accel            # divan: each backend, single rays and batches
//! cargo bench --bench accel -- thin    # the same rays through the trait and through C
//! ```
//!
//! The second compiles `embree_direct.c` with `cc` (Debian: `apt install gcc libembree-dev`) and
//! runs both sides in turn, pass by pass: the ratio holds on a busy machine, the rates do not.

use divan::{Bencher, black_box, counter::ItemsCount};
use std::f32::consts::{PI, TAU};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::{Arc, OnceLock};
use std::time::Instant;
use twintree::accel::{
    Backend, BuildSettings, Geometry, Hit, Ray, RayQuery, Shape, TriangleMesh, World, build,
    prepare_thread,
};
use twintree::math::{Frame, Pcg32, Vec2, Vec3, warp};

/// Rays of one pass: 1 MiB of them and 768 KiB of hits, as a wavefront has.
const RAYS: usize = 1 << 15;

fn main() {
    prepare_thread();
    if std::env::args().any(|a| a == "thin") {
        thinness();
    } else {
        divan::main();
    }
}

/// A bumpy sphere of a million triangles, seen from inside.
fn mesh() -> Arc<TriangleMesh> {
    const N: u32 = 724;
    let mut positions = Vec::new();
    for i in 0..=N {
        for j in 0..N {
            let (theta, phi) = (PI * i as f32 / N as f32, TAU * j as f32 / N as f32);
            let bump = (40.0 * phi).sin() * (31.0 * theta).sin() + (7.0 * phi + 5.0 * theta).sin();
            let (sin, cos) = theta.sin_cos();
            let p = Vec3::new(sin * phi.cos(), sin * phi.sin(), cos);
            positions.push(p * (1.0 + 0.08 * bump));
        }
    }
    let mut triangles = Vec::new();
    for i in 0..N {
        for j in 0..N {
            let (a, b) = (i * N + j, i * N + (j + 1) % N);
            triangles.extend([[a, b, b + N], [a, b + N, a + N]]);
        }
    }
    Arc::new(TriangleMesh::new(positions, triangles).unwrap())
}

fn world(mesh: &Arc<TriangleMesh>) -> World {
    World {
        geometries: vec![Geometry {
            id: 0,
            shape: Shape::Triangles(Arc::clone(mesh)),
            masked: false,
        }],
        ..Default::default()
    }
}

fn trace(backend: Backend) -> Box<dyn RayQuery> {
    let settings = BuildSettings {
        robust: true,
        threads: 1,
        ..Default::default()
    };
    build(world(scene()), settings, None, backend).unwrap()
}

fn scene() -> &'static Arc<TriangleMesh> {
    static SCENE: OnceLock<Arc<TriangleMesh>> = OnceLock::new();
    SCENE.get_or_init(mesh)
}

/// The second bounce of a path tracer on white walls: scattered origins, cosine-distributed
/// directions.
fn bounces(tracer: &dyn RayQuery) -> Vec<Ray> {
    let mut rng = Pcg32::new(1, 1);
    let mut rays = Vec::with_capacity(RAYS);
    while rays.len() < RAYS {
        let mut uniform = || Vec2::new(rng.next_f32(), rng.next_f32());
        let first = Ray::new(Vec3::ZERO, warp::uniform_sphere(uniform()));
        let hit = tracer.intersect(&first);
        if !hit.is_some() {
            continue;
        }
        let [a, b, c] = scene().corners(hit.prim);
        let normal = (b - a).cross(c - a).normalize();
        let inward = if normal.dot(first.dir) > 0.0 {
            -normal
        } else {
            normal
        };
        let dir = Frame::new(inward).to_world(warp::cosine_hemisphere(uniform()));
        rays.push(Ray::new(first.at(hit.t) + inward * 1e-4, dir));
    }
    rays
}

/// The ray tracers of this build, by name.
fn backends() -> &'static [&'static str] {
    if cfg!(feature = "embree") {
        &["Embree", "obvhs"]
    } else {
        &["obvhs"]
    }
}

macro_rules! benchmark {
    ($name:ident, $out:expr, $call:expr) => {
        #[divan::bench(args = backends())]
        fn $name(bencher: Bencher, backend: &str) {
            let backend = if backend == "Embree" {
                Backend::Embree
            } else {
                Backend::Obvhs
            };
            let tracer = trace(backend);
            let rays = bounces(&*tracer);
            let mut out = vec![$out; RAYS];
            bencher
                .counter(ItemsCount::new(RAYS))
                .bench_local(|| $call(&*tracer, black_box(&rays), &mut out));
        }
    };
}

benchmark!(
    closest_batch,
    Hit::NONE,
    |t: &dyn RayQuery, r: &[Ray], o: &mut [Hit]| t.intersect_batch(r, o)
);
benchmark!(
    shadow_batch,
    false,
    |t: &dyn RayQuery, r: &[Ray], o: &mut [bool]| t.occluded_batch(r, o)
);
benchmark!(
    closest_single,
    Hit::NONE,
    |t: &dyn RayQuery, r: &[Ray], o: &mut [Hit]| {
        for (ray, hit) in r.iter().zip(o) {
            *hit = t.intersect(ray);
        }
    }
);
benchmark!(
    shadow_single,
    false,
    |t: &dyn RayQuery, r: &[Ray], o: &mut [bool]| {
        for (ray, blocked) in r.iter().zip(o) {
            *blocked = t.occluded(ray);
        }
    }
);

/// Seconds of one pass over all rays.
#[derive(Clone, Copy)]
struct Pass {
    closest: f64,
    shadow: f64,
}

/// Passes of each kind. The median of so many paired ratios is good to about half a per cent.
const PASSES: usize = 41;

fn thinness() {
    let tracer = trace(Backend::Embree);
    let rays = bounces(&*tracer);
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("scene");
    write_scene(&data, &rays).unwrap();
    let mut direct = Direct::start(&compile(folder.path(), &tracer.name()), &data);
    println!(
        "{}, one thread, median in millions of rays a second",
        tracer.name()
    );
    println!("{:<22} {:>8} {:>8}", "", "closest", "shadow");
    for coherent in [false, true] {
        for width in [1, 4, 8, 16] {
            let passes: Vec<_> = (0..9).map(|_| direct.pass(width, coherent)).collect();
            let flag = if coherent { ", coherent" } else { "" };
            row(&format!("C, by {width}{flag}"), &passes);
        }
    }
    for (batch, width) in [(true, 16), (false, 1)] {
        let pair = |_| (direct.pass(width, false), run_trait(&*tracer, &rays, batch));
        let pairs: Vec<_> = (0..PASSES).map(pair).collect();
        let name = if batch {
            "trait, batch"
        } else {
            "trait, single"
        };
        row(name, &pairs.iter().map(|p| p.1).collect::<Vec<_>>());
        let cost = |of: fn(&Pass) -> f64| {
            100.0 * (median(pairs.iter().map(|(c, rust)| of(rust) / of(c))) - 1.0)
        };
        println!(
            "{:<22} {:>+7.1}% {:>+7.1}%",
            "  more than C",
            cost(|p| p.closest),
            cost(|p| p.shadow)
        );
    }
}

fn row(name: &str, passes: &[Pass]) {
    let rate = |of: fn(&Pass) -> f64| 1e-6 * RAYS as f64 / median(passes.iter().map(of));
    println!(
        "{name:<22} {:>8.2} {:>8.2}",
        rate(|p| p.closest),
        rate(|p| p.shadow)
    );
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The program in C, which traces a pass for every line it is sent.
struct Direct {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Direct {
    fn start(program: &Path, data: &Path) -> Self {
        let mut child = Command::new(program)
            .arg(data)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("embree_direct starts");
        Self {
            input: child.stdin.take().unwrap(),
            output: BufReader::new(child.stdout.take().unwrap()),
            child,
        }
    }

    fn pass(&mut self, width: u32, coherent: bool) -> Pass {
        writeln!(self.input, "{width} {}", u8::from(coherent)).unwrap();
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap();
        let seconds: Vec<f64> = line.split_whitespace().flat_map(str::parse).collect();
        Pass {
            closest: seconds[0],
            shadow: seconds[1],
        }
    }
}

impl Drop for Direct {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn write_scene(path: &Path, rays: &[Ray]) -> std::io::Result<()> {
    let mut out = std::io::BufWriter::new(std::fs::File::create(path)?);
    let mesh = scene();
    for count in [mesh.positions().len(), mesh.triangles().len(), rays.len()] {
        out.write_all(&(count as u32).to_le_bytes())?;
    }
    for p in mesh.positions() {
        for c in p.to_array() {
            out.write_all(&c.to_le_bytes())?;
        }
    }
    for index in mesh.triangles().iter().flatten() {
        out.write_all(&index.to_le_bytes())?;
    }
    for ray in rays {
        let words = [ray.org.to_array(), ray.dir.to_array()];
        for (v, bound) in words.iter().zip([ray.tmin, ray.tmax]) {
            for c in v.iter().chain([&bound]) {
                out.write_all(&c.to_le_bytes())?;
            }
        }
    }
    out.flush()
}

fn compile(folder: &Path, embree: &str) -> PathBuf {
    let program = folder.join("embree_direct");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bench/embree_direct.c");
    let major = if embree.starts_with("Embree 4") { 4 } else { 3 };
    let status = Command::new("cc")
        .args(["-O3", "-march=native", "-o"])
        .arg(&program)
        .arg(source)
        .args([format!("-DEMBREE{major}"), format!("-lembree{major}")])
        .status()
        .expect("cc runs (Debian: apt install gcc)");
    assert!(status.success(), "embree_direct.c did not compile");
    program
}

fn run_trait(tracer: &dyn RayQuery, rays: &[Ray], batch: bool) -> Pass {
    let mut hits = vec![Hit::NONE; rays.len()];
    let mut blocked = vec![false; rays.len()];
    let start = Instant::now();
    if batch {
        tracer.intersect_batch(black_box(rays), &mut hits);
    } else {
        for (ray, hit) in rays.iter().zip(&mut hits) {
            *hit = tracer.intersect(ray);
        }
    }
    let middle = Instant::now();
    if batch {
        tracer.occluded_batch(black_box(rays), &mut blocked);
    } else {
        for (ray, blocked) in rays.iter().zip(&mut blocked) {
            *blocked = tracer.occluded(ray);
        }
    }
    let shadow = middle.elapsed().as_secs_f64();
    black_box((hits, blocked));
    Pass {
        closest: (middle - start).as_secs_f64(),
        shadow,
    }
}
