//! Agreement with Mitsuba 3.9.1: value, density and samples in a table that `tests/vectors/bsdf.py`
//! makes (`tests/vectors/bsdf.json`).

use super::models::{facets, gold};
use super::resolved;
use crate::bsdf::diffuse_only::Form;
use crate::bsdf::material::{Distribution, InvalidNormals};
use crate::bsdf::perturb::{Perturbation, bumped_normal};
use crate::bsdf::tree::Node;
use crate::bsdf::{Materials, Transport};
use crate::math::{Frame, Rgb, Vec2, Vec3};
use crate::texture::SurfacePoint;
use serde_json::Value;

fn table() -> Value {
    serde_json::from_str(include_str!("../../../tests/vectors/bsdf.json")).expect("the table")
}

fn number(v: &Value) -> f32 {
    v.as_f64().expect("a number") as f32
}

fn vector(v: &Value) -> Vec3 {
    Vec3::new(number(&v[0]), number(&v[1]), number(&v[2]))
}

fn rows(v: &Value) -> &Vec<Value> {
    v.as_array().expect("rows")
}

/// Relative difference, with a floor below which values are told apart absolutely.
fn difference(ours: Rgb, theirs: Rgb) -> f32 {
    let scale = theirs.abs().max_element().max(1e-4);
    (ours - theirs).abs().max_element() / scale
}

/// Largest relative difference of value and of density over rows of (wo, wi, value, pdf).
fn worst(list: &Value, ours: impl Fn(Vec3, Vec3) -> (Rgb, f32)) -> (f32, f32) {
    rows(list).iter().fold((0.0, 0.0), |(v, p), row| {
        let (value, pdf) = ours(vector(&row[0]), vector(&row[1]));
        let pdf_difference = difference(Rgb::splat(pdf), Rgb::splat(number(&row[3])));
        let value_difference = difference(value, vector(&row[2]));
        (f32::max(v, value_difference), f32::max(p, pdf_difference))
    })
}

#[test]
fn values_and_densities_agree() {
    for (name, list) in table()["evaluations"].as_object().expect("models") {
        let (value, pdf) = worst(list, |wo, wi| {
            resolved(name, wo).eval_pdf(wo, wi, Transport::Radiance)
        });
        // Blends are drawn from and weighted here as a whole mixture; so they are there.
        assert!(value < 1e-3 && pdf < 1e-3, "{name}: {value} {pdf}");
    }
}

#[test]
fn bump_maps_agree() {
    for bump in rows(&table()["bumps"]) {
        let gradient = Vec2::new(number(&bump["gradient"][0]), number(&bump["gradient"][1]));
        let frame = Frame {
            s: Vec3::X,
            t: Vec3::Y,
            n: Vec3::Z,
        };
        let n = bumped_normal(&frame, Vec3::Z, (Vec3::X, Vec3::Y), gradient);
        let (value, pdf) = worst(&bump["rows"], |wo, wi| {
            let mut materials = Materials::default();
            let inner = materials.push(gold(facets(Distribution::Ggx, 0.15, 0.5)));
            let point = SurfacePoint::at_uv(Vec2::ZERO);
            let Form::Tree(mut tree) = materials.resolve(inner, &point, wo).form else {
                panic!("a conductor is a tree");
            };
            let inner = tree.root();
            let root = tree.push(Node::Perturbed(
                Perturbation::new(n, wo, InvalidNormals::default()),
                inner,
            ));
            tree.eval_pdf(root, wo, wi, Transport::Radiance)
        });
        assert!(value < 1e-3 && pdf < 1e-3, "{gradient}: {value} {pdf}");
    }
}

#[test]
fn samples_of_mirrors_and_glass_agree() {
    for (name, list) in table()["samples"].as_object().expect("models") {
        for row in rows(list) {
            let wo = vector(&row[0]);
            let sample = resolved(name, wo)
                .sample(
                    wo,
                    number(&row[1]),
                    Vec2::new(0.3, 0.6),
                    Transport::Radiance,
                )
                .expect("Mitsuba has a sample here");
            let wi = vector(&row[2]);
            assert!((sample.wi - wi).length() < 1e-5, "{name} {wo} {wi}");
            let weight = difference(sample.weight, vector(&row[3]));
            assert!(weight < 1e-4, "{name} {wo}: {weight}");
            assert!((sample.pdf - number(&row[4])).abs() < 1e-4, "{name} {wo}");
            assert!((sample.eta - number(&row[5])).abs() < 1e-5, "{name} {wo}");
        }
    }
}
