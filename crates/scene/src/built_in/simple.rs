//! Simple shapes: for tests against closed forms, and as objects of other scenes.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::builder::Builder;
use crate::material::Material;
use crate::model::Model;

/// Albedo ½.
const GREY: [f32; 3] = [0.5, 0.5, 0.5];

/// Returns a square of 2 m × 2 m at y = 0, facing up, of albedo ½.
pub(super) fn plane() -> Model {
    let mut builder = Builder::default();
    let grey = builder.material(Material::matte("grey", GREY));
    let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    builder.quad(grey, [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)]);
    builder.finish("plane")
}

/// Returns a cube of edge 1 m around the origin, of albedo ½.
pub(super) fn cube() -> Model {
    let mut builder = Builder::default();
    let grey = builder.material(Material::matte("grey", GREY));
    builder.cuboid(grey, Vec3::splat(-0.5), Vec3::splat(0.5));
    builder.finish("cube")
}

/// Returns a sphere of radius 1 m around the origin, 48 × 24 quads, of albedo ½.
pub(super) fn sphere() -> Model {
    let mut builder = Builder::default();
    let grey = builder.material(Material::matte("grey", GREY));
    builder.surface(grey, 48, 24, |u, v| {
        let (sin_phi, cos_phi) = if u == 1.0 { (0.0, 1.0) } else { (u * TAU).sin_cos() };
        let (sin_theta, cos_theta) = if v == 1.0 { (0.0, -1.0) } else { (v * PI).sin_cos() };
        let point = Vec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi);
        (point, point)
    });
    builder.finish("sphere")
}

/// Returns a model without geometry.
pub(super) fn empty() -> Model {
    Model { may_be_empty: true, ..Model::default() }
}
