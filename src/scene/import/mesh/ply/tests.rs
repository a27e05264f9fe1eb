//! The manual's table of properties against what is read of them.

use super::LIST_NAMES;
use super::columns::UV_NAMES;
use crate::scene::Mesh;
use crate::scene::import::mesh::{MeshKind, MeshOptions, read};
use std::path::Path;

/// The names of each row of the table, in groups, and what it says becomes of them.
fn rows() -> Vec<(Vec<Vec<&'static str>>, &'static str)> {
    let page = include_str!("../../../../manual/models.md");
    let table = page.split("## PLY").nth(1).expect("a section");
    let table = table.split("## STL").next().expect("its end");
    let rows = table.lines().filter(|line| line.starts_with("| `"));
    rows.map(|row| {
        let columns: Vec<&str> = row.split('|').map(str::trim).collect();
        let names = |group: &'static str| group.split('`').skip(1).step_by(2).collect();
        (columns[1].split(';').map(names).collect(), columns[2])
    })
    .collect()
}

/// A triangle with these numbers for each vertex besides its place, its corners in `list`.
fn triangle(numbers: &[&str], list: &str) -> Mesh {
    let properties: String = numbers
        .iter()
        .map(|n| format!("property float {n}\n"))
        .collect();
    let values = " .25".repeat(numbers.len());
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
         property float z\n{properties}element face 1\nproperty list uchar int {list}\nend_header\n\
         0 0 0{values}\n1 0 0{values}\n0 1 0{values}\n3 0 1 2\n"
    );
    let options = MeshOptions::default();
    let read = read(text.as_bytes(), MeshKind::Ply, &options, Path::new("m.ply"));
    read.expect("a mesh").mesh
}

#[test]
fn every_property_of_the_manuals_table_is_read_and_no_other_is_known() {
    let rows = rows();
    assert!(rows.len() >= 8, "{rows:?}");
    let groups: Vec<&Vec<&str>> = rows.iter().flat_map(|(groups, _)| groups).collect();
    for uv in UV_NAMES {
        assert!(
            groups.iter().any(|g| ***g == uv),
            "{uv:?} is not in the manual"
        );
    }
    for list in LIST_NAMES {
        assert!(
            groups.iter().any(|g| g.contains(&list)),
            "{list} is not in the manual"
        );
    }
    let plain = triangle(&[], LIST_NAMES[0]);
    for (groups, becomes) in &rows {
        for group in groups {
            match group.as_slice() {
                ["x", "y", "z"] => assert_eq!(plain.triangles.positions().len(), 3),
                numbers @ [_, _] if numbers.iter().all(|n| !LIST_NAMES.contains(n)) => {
                    assert!(
                        triangle(numbers, LIST_NAMES[0]).uvs.is_some(),
                        "{numbers:?}"
                    );
                }
                ["nx", "ny", "nz"] => {
                    let normals = triangle(group, LIST_NAMES[0]).normals.expect("normals");
                    assert!((normals[0].z - 1.0 / 3f32.sqrt()).abs() < 1e-6);
                }
                colors @ [_, _, _] => {
                    let attributes = triangle(colors, LIST_NAMES[0]).attributes.list;
                    assert_eq!(attributes.len(), 1, "{colors:?}");
                }
                lists if lists.iter().any(|n| LIST_NAMES.contains(n)) => {
                    for list in lists.iter().filter(|n| **n != "tristrips") {
                        assert_eq!(triangle(&[], list).triangles.triangles().len(), 1);
                    }
                }
                ["texcoord" | "comment TextureFile"] => assert_eq!(*becomes, "read"),
                ["texnumber"] => assert_eq!(*becomes, "left out"),
                other => panic!("the manual names {other:?}, which nothing here checks"),
            }
        }
    }
}
