//! A cloth that hangs from a rod and waves: a test of methods that follow deforming geometry.
//!
//! It hangs in the plane z = 0 from y = 0 down, and a wave runs down it: at time t each point is displaced by
//!
//! z(x, y, t) = a (y/h)² sin(φ − ωt), with φ = kₓ x − k_y y
//!
//! which is cos ωt · [a (y/h)² sin φ] + sin ωt · [−a (y/h)² cos φ]: exactly two morph targets. The normal,
//! (−∂z/∂x, −∂z/∂y, 1) before normalisation, is linear in z, and so is exact too.

use std::f32::consts::TAU;

use glam::Vec3;

use super::builder::Builder;
use crate::animation::{Between, Outside, Track};
use crate::material::Material;
use crate::model::{Model, Morph, MorphTarget};

const BLUE: [f32; 3] = [0.10, 0.22, 0.60];
const WIDTH: f32 = 1.0;
/// h \[m\].
const HEIGHT: f32 = 1.5;
/// a \[m\]: how far the free edge swings to either side.
const AMPLITUDE: f32 = 0.25;
/// kₓ and k_y \[rad/m\]: half a wave across, one and a quarter down.
const WAVE: [f32; 2] = [0.5 * TAU / WIDTH, 1.25 * TAU / HEIGHT];
/// 2π/ω \[s\].
const PERIOD: f32 = 2.0;
/// Keys per period, with cubic interpolation: its error for sine and cosine is below 4·10⁻⁶.
const KEYS: usize = 32;

/// Returns a cloth of 1 m × 1.5 m, 3072 triangles, that hangs from y = 0 at z = 0 and waves with a period of
/// two seconds.
pub(super) fn cloth() -> Model {
    let mut builder = Builder::default();
    let blue = builder.material(Material::matte("cloth", BLUE));
    builder.surface(blue, 32, 48, |u, v| (Vec3::new((u - 0.5) * WIDTH, -v * HEIGHT, 0.0), Vec3::Z));
    let mut model = builder.finish("cloth");
    let primitive = &mut model.meshes[0].primitives[0];
    primitive.targets = vec![
        target(&primitive.positions, f32::sin_cos),
        target(&primitive.positions, |phase| {
            let (sin, cos) = phase.sin_cos();
            (-cos, sin)
        }),
    ];
    let cos = weight(|phase| (phase.cos(), -phase.sin()));
    let sin = weight(|phase| (phase.sin(), phase.cos()));
    model.nodes[0].morph = Morph { rest: vec![cos.at(0.0), sin.at(0.0)], tracks: vec![cos, sin] };
    model
}

/// Returns the displacement along z by a (y/h)² f(φ); `wave` returns f and its derivative.
fn target(positions: &[Vec3], wave: impl Fn(f32) -> (f32, f32)) -> MorphTarget {
    let displaced = positions.iter().map(|p| {
        let (value, slope) = wave(WAVE[0] * p.x - WAVE[1] * p.y);
        let swing = AMPLITUDE * (p.y / HEIGHT).powi(2);
        let dx = swing * slope * WAVE[0];
        let dy = 2.0 * AMPLITUDE * p.y / (HEIGHT * HEIGHT) * value - swing * slope * WAVE[1];
        (Vec3::new(0.0, 0.0, swing * value), Vec3::new(-dx, -dy, 0.0))
    });
    let (positions, normals) = displaced.unzip();
    MorphTarget { positions, normals }
}

/// Returns a track of one period; `wave` returns the value at a phase and its derivative.
fn weight(wave: impl Fn(f32) -> (f32, f32)) -> Track<f32> {
    let phases = (0..=KEYS).map(|i| i as f32 / KEYS as f32);
    let (keys, slopes): (Vec<_>, Vec<_>) = phases
        .map(|phase| {
            let (value, slope) = wave(phase * TAU);
            ((phase * PERIOD, value), [slope * TAU / PERIOD; 2])
        })
        .unzip();
    Track::new(keys, Between::Cubic(slopes), Outside::Repeat(PERIOD)).expect("keys at rising times")
}
