//! Tests of all lights together: densities against samples, and light against closed forms.

use super::*;
use crate::accel::{AnalyticKind, AnalyticShape, Bounds, Shape, TriangleMesh};
use crate::math::{Affine3A, Mat3, Pcg32};
use crate::texture::Texture;
use std::sync::Arc;

mod beside;
mod closed_form;
mod density;
mod emitting;
mod mitsuba;
mod scenes;
mod sky;
mod textured;
mod tree;
