//! Simple shapes: for tests against closed forms, and as objects of other scenes.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::builder::Builder;
use crate::material::Material;
use crate::model::Model;

/// Albedo ½.
const GREY: [f32; 3] = [0.5, 0.5, 0.5];

/// Reflectance of gold at normal incidence, linear Rec. 709.
const GOLD: Vec3 = Vec3::new(1.0, 0.766, 0.336);

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

/// Returns a band of gold around the axis y, of radius 1 m from y = 0 to 0.4 m, 128 × 2 quads: seen from within, it throws the
/// caustic of a ring.
pub(super) fn ring() -> Model {
    let mut builder = Builder::default();
    let gold = builder.material(Material {
        name: "gold".into(),
        base_color: GOLD.extend(1.0),
        metallic: 1.0,
        roughness: 0.4,
        ..Material::default()
    });
    builder.surface(gold, 128, 2, |u, v| {
        let (sin, cos) = if u == 1.0 { (0.0, 1.0) } else { (u * TAU).sin_cos() };
        (Vec3::new(cos, 0.4 * v, sin), Vec3::new(cos, 0.0, sin))
    });
    builder.finish("ring")
}

/// Returns a model without geometry.
pub(super) fn empty() -> Model {
    Model { may_be_empty: true, ..Model::default() }
}
