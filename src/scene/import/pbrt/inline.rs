//! Meshes that stand in the scene file, and shapes that become meshes.

use super::pending::{Inline, InlineKind, Round, RoundKind, Vertices};
use super::{curves, subdivision};
use crate::math::{DVec3, Vec2, Vec3, Vec4};
use crate::scene::import::mesh::{self, Buffers, Loaded, MeshOptions};
use crate::scene::import::{ImportError, ImportOptions};
use std::path::Path;

/// Cells along each side of a patch that is not flat.
const CELLS: usize = 16;
/// A patch whose fourth corner is this part of its size off the plane of the others is flat.
const FLAT: f32 = 1e-4;
/// Cells of a whole turn, and between the ends of a round shape.
const AROUND: usize = 128;
const ALONG: usize = 64;

/// Makes the mesh.
pub(super) fn make(inline: &Inline, options: &ImportOptions) -> Result<Loaded, ImportError> {
    let error = |message: String| ImportError {
        at: None,
        file: None,
        message,
        help: None,
    };
    let mut warnings = Vec::new();
    let buffers = match &inline.kind {
        InlineKind::Triangles(vertices) => triangles(vertices),
        InlineKind::Separate(vertices) => separate(triangles(vertices)),
        InlineKind::Patches(vertices) => patches(vertices, &mut warnings),
        InlineKind::Subdivision(vertices, levels) => {
            let mesh = subdivision::refine(vertices, *levels).map_err(error)?;
            Buffers {
                positions: mesh.positions,
                normals: Some(mesh.normals),
                triangles: mesh.triangles,
                ..Buffers::default()
            }
        }
        InlineKind::Curves(list) => curves::tessellate(list),
        InlineKind::Round(round) => turned(round),
    };
    let options = MeshOptions {
        to_world: inline.to_world,
        flat_without_normals: true,
        flip_normals: inline.reverse,
        lenient: options.lenient,
        decode: options.decode,
        ..MeshOptions::default()
    };
    let loaded = mesh::from_buffers(buffers, &options, Path::new(""));
    let mut loaded = loaded.map_err(|e| ImportError { file: None, ..e })?;
    warnings.append(&mut loaded.warnings);
    Ok(Loaded { warnings, ..loaded })
}

fn triples(list: &[f32]) -> Vec<Vec3> {
    list.chunks_exact(3).map(Vec3::from_slice).collect()
}

fn pairs(list: &[f32]) -> Vec<Vec2> {
    list.chunks_exact(2).map(Vec2::from_slice).collect()
}

fn corner(i: &i32) -> u32 {
    // Indices were checked.
    u32::try_from(*i).unwrap_or(0)
}

fn triangles(v: &Vertices) -> Buffers {
    let corners = v.indices.chunks_exact(3);
    Buffers {
        positions: triples(v.positions),
        normals: v.normals.map(triples),
        tangents: v.tangents.map(|list| {
            let tangents = list.chunks_exact(3);
            tangents.map(|t| Vec4::new(t[0], t[1], t[2], 1.0)).collect()
        }),
        uvs: v.uvs.map(pairs),
        triangles: corners
            .map(|c| [corner(&c[0]), corner(&c[1]), corner(&c[2])])
            .collect(),
        ..Buffers::default()
    }
}

/// Triangles that share no vertices, each laid on a half of the textures as pbrt does where a mesh
/// has no texture coordinates: its corners are at (0, 0), (1, 0) and (1, 1).
fn separate(mesh: Buffers) -> Buffers {
    fn each<T: Copy>(triangles: &[[u32; 3]], values: &[T]) -> Vec<T> {
        let corners = triangles.iter().flatten();
        corners.map(|&i| values[i as usize]).collect()
    }
    let faces = &mesh.triangles;
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE];
    Buffers {
        positions: each(faces, &mesh.positions),
        normals: mesh.normals.map(|list| each(faces, &list)),
        tangents: mesh.tangents.map(|list| each(faces, &list)),
        uvs: Some(corners.repeat(faces.len())),
        triangles: (0..faces.len() as u32)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect(),
        ..Buffers::default()
    }
}

/// Patches between four corners at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1): two triangles where
/// they are flat, a grid where they are not.
fn patches(v: &Vertices, warnings: &mut Vec<String>) -> Buffers {
    let positions = triples(v.positions);
    let (normals, uvs) = (v.normals.map(triples), v.uvs.map(pairs));
    let unit = [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE];
    let mut out = Buffers {
        normals: normals.as_ref().map(|_| Vec::new()),
        uvs: Some(Vec::new()),
        ..Buffers::default()
    };
    let mut curved = 0;
    for patch in v.indices.chunks_exact(4) {
        let corners = [0, 1, 2, 3].map(|k| corner(&patch[k]) as usize);
        let p = corners.map(|i| positions[i]);
        let n = normals.as_ref().map(|list| corners.map(|i| list[i]));
        let t = uvs.as_ref().map_or(unit, |list| corners.map(|i| list[i]));
        let flat = is_flat(&p);
        curved += usize::from(!flat);
        grid(&mut out, if flat { 1 } else { CELLS }, &p, n.as_ref(), &t);
    }
    if curved > 0 {
        warnings.push(format!(
            "{curved} bilinear patches are not flat: each is rendered as {CELLS} by {CELLS} cells"
        ));
    }
    out
}

fn is_flat(p: &[Vec3; 4]) -> bool {
    let [a, b, c] = [p[1] - p[0], p[2] - p[0], p[3] - p[0]];
    let volume = a.cross(b).dot(c).abs();
    let size = a.length().max(b.length()).max(c.length());
    volume <= FLAT * size * size * size
}

fn bilinear<T>(corners: &[T; 4], u: f32, v: f32) -> T
where
    T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    let low = corners[0] * (1.0 - u) + corners[1] * u;
    let high = corners[2] * (1.0 - u) + corners[3] * u;
    low * (1.0 - v) + high * v
}

fn grid(out: &mut Buffers, cells: usize, p: &[Vec3; 4], n: Option<&[Vec3; 4]>, t: &[Vec2; 4]) {
    let first = out.positions.len() as u32;
    let place = |i: usize| i as f32 / cells as f32;
    for (j, i) in (0..=cells).flat_map(|j| (0..=cells).map(move |i| (j, i))) {
        let (u, v) = (place(i), place(j));
        out.positions.push(bilinear(p, u, v));
        if let (Some(list), Some(n)) = (&mut out.normals, n) {
            list.push(bilinear(n, u, v));
        }
        if let Some(list) = &mut out.uvs {
            list.push(bilinear(t, u, v));
        }
    }
    cells_between(out, first, [cells, cells]);
}

/// Two triangles for each cell of a grid of vertices that begin at `first`.
fn cells_between(out: &mut Buffers, first: u32, [across, up]: [usize; 2]) {
    let row = across as u32 + 1;
    for (j, i) in (0..up as u32).flat_map(|j| (0..across as u32).map(move |i| (j, i))) {
        let a = first + j * row + i;
        out.triangles.push([a, a + 1, a + row + 1]);
        out.triangles.push([a, a + row + 1, a + row]);
    }
}

/// A part of a round shape: u around z, v as in pbrt.
fn turned(round: &Round) -> Buffers {
    let part = round.phi / (2.0 * std::f64::consts::PI);
    let around = ((AROUND as f64 * part).ceil() as usize).max(1);
    let along = match round.kind {
        RoundKind::Sphere { .. } | RoundKind::Paraboloid { .. } => ALONG,
        RoundKind::Cylinder { .. } | RoundKind::Disk { .. } | RoundKind::Cone { .. } => 1,
    };
    let mut out = Buffers {
        normals: Some(Vec::new()),
        uvs: Some(Vec::new()),
        ..Buffers::default()
    };
    for (j, i) in (0..=along).flat_map(|j| (0..=around).map(move |i| (j, i))) {
        let (u, v) = (i as f64 / around as f64, j as f64 / along as f64);
        let (sin, cos) = (u * round.phi).sin_cos();
        let ([r, z], [nr, nz]) = profile(&round.kind, v);
        out.positions
            .push(DVec3::new(r * cos, r * sin, z).as_vec3());
        let normal = DVec3::new(nr * cos, nr * sin, nz).as_vec3();
        out.normals.get_or_insert_default().push(normal);
        out.uvs
            .get_or_insert_default()
            .push(Vec2::new(u as f32, v as f32));
    }
    cells_between(&mut out, 0, [around, along]);
    // At a pole or a tip a cell has three corners.
    let at = &out.positions;
    out.triangles.retain(|t| {
        let [a, b, c] = t.map(|i| at[i as usize]);
        a != b && b != c && c != a
    });
    out
}

/// Radius and height at `v`, and those of the normal, outwards.
fn profile(kind: &RoundKind, v: f64) -> ([f64; 2], [f64; 2]) {
    let between = |[a, b]: [f64; 2]| a + (b - a) * v;
    match *kind {
        RoundKind::Sphere { radius, z } => {
            let theta = z.map(|z| (z / radius).clamp(-1.0, 1.0).acos());
            let (sin, cos) = between(theta).sin_cos();
            // Not what rounding leaves of pi.
            let sin = if sin.abs() < 1e-9 { 0.0 } else { sin };
            ([radius * sin, radius * cos], [sin, cos])
        }
        RoundKind::Cylinder { radius, z } => ([radius, between(z)], [1.0, 0.0]),
        RoundKind::Disk { height, radii } => {
            let [inner, outer] = radii;
            ([between([outer, inner]), height], [0.0, 1.0])
        }
        RoundKind::Cone { radius, height } => ([radius * (1.0 - v), height * v], [height, radius]),
        RoundKind::Paraboloid { radius, z } => {
            let height = between(z);
            let r = radius * (height / z[1]).max(0.0).sqrt();
            // z = zmax r^2 / radius^2 opens upwards: outwards is down.
            ([r, height], [2.0 * z[1] * r / (radius * radius), -1.0])
        }
    }
}
