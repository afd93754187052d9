//! Rooms that light enters through screens: a lattice that is cut out of its texture between walls with a normal map, and blinds
//! of thin slats.

use glam::{Quat, Vec2, Vec3};

use super::builder::{Builder, MaterialId};
use crate::material::{Encoding, Material, Texture, Wrap};
use crate::model::Model;

/// Pixels along each side of a texture.
const SIDE: u32 = 64;
/// Greatest slope of the stones' relief.
const SLOPE: f32 = 0.5;

/// Returns a hall of 8 m × 4 m × 5 m, divided lengthwise by columns with lattices between them.
pub(super) fn arcade() -> Model {
    let mut builder = Builder::default();
    let stone = |name: &str, albedo| Material { normal_texture: Some(0), ..Material::matte(name, albedo) };
    let wall = builder.material(stone("wall", [0.66, 0.60, 0.50]));
    let floor = builder.material(stone("floor", [0.45, 0.40, 0.36]));
    let plain = builder.material(Material::matte("plain", [0.70, 0.68, 0.64]));
    let end = builder.material(stone("end", [0.68, 0.28, 0.22]));
    let lattice = builder.material(Material {
        base_color_texture: Some(1),
        alpha_cutoff: Some(0.5),
        ..Material::matte("lattice", [0.35, 0.50, 0.30])
    });
    let (low, high) = (Vec3::new(-4.0, 0.0, -2.5), Vec3::new(4.0, 4.0, 2.5));
    inside(&mut builder, [floor, plain, wall, end], low, high);
    for column in 0..4 {
        let x = -3.0 + 2.0 * column as f32;
        let outline = [[0.24, 0.0], [0.24, 0.2], [0.18, 0.3], [0.16, 3.5], [0.26, 3.7], [0.26, 4.0]];
        builder.lathe(plain, Vec3::new(x, 0.0, 0.5), &outline, 24);
    }
    for screen in 0..5 {
        let [left, right] = [-5.0, -3.0].map(|x: f32| (x + 2.0 * screen as f32).clamp(low.x, high.x));
        let corners = [[left, 0.0], [right, 0.0], [right, 3.0], [left, 3.0]];
        let repeats = Vec2::new(right - left, 3.0);
        builder.tiled_quad(lattice, corners.map(|[x, y]| Vec3::new(x, y, 0.5)), repeats);
    }
    let mut model = builder.finish("arcade");
    model.textures = vec![relief(), holes()];
    model
}

/// Returns a room of 4 m × 2.6 m × 5 m, divided by a wall with a window, which slats of 8 cm by 6 mm fill.
pub(super) fn blinds() -> Model {
    let mut builder = Builder::default();
    let white = builder.material(Material::matte("white", [0.75, 0.74, 0.72]));
    let floor = builder.material(Material::matte("floor", [0.50, 0.38, 0.28]));
    let blue = builder.material(Material::matte("blue", [0.30, 0.40, 0.65]));
    let slat = builder.material(Material::matte("slat", [0.80, 0.78, 0.74]));
    let (low, high) = (Vec3::new(-2.0, 0.0, -2.5), Vec3::new(2.0, 2.6, 2.5));
    inside(&mut builder, [floor, white, white, blue], low, high);
    let (sill, lintel, jamb) = (0.6, 2.2, 1.4);
    let mut piece = |min: [f32; 2], max: [f32; 2]| {
        builder.cuboid(white, Vec3::new(min[0], min[1], 0.4), Vec3::new(max[0], max[1], 0.5));
    };
    piece([low.x, low.y], [high.x, sill]);
    piece([low.x, lintel], [high.x, high.y]);
    piece([low.x, sill], [-jamb, lintel]);
    piece([jamb, sill], [high.x, lintel]);
    let tilt = Quat::from_rotation_x(0.6);
    for row in 0..16 {
        let middle = Vec3::new(0.0, sill + 0.05 + 0.1 * row as f32, 0.45);
        builder.turned_cuboid(slat, middle, Vec3::new(jamb, 0.003, 0.04), tilt);
    }
    builder.finish("blinds")
}

/// Adds the six faces of a room, seen from within: floor, ceiling, long walls and ends. Textures repeat each metre.
fn inside(builder: &mut Builder, [floor, ceiling, wall, end]: [MaterialId; 4], low: Vec3, high: Vec3) {
    let c =
        |x: usize, y: usize, z: usize| Vec3::new([low.x, high.x][x], [low.y, high.y][y], [low.z, high.z][z]);
    let faces = [
        (floor, [c(0, 0, 1), c(1, 0, 1), c(1, 0, 0), c(0, 0, 0)]),
        (ceiling, [c(0, 1, 0), c(1, 1, 0), c(1, 1, 1), c(0, 1, 1)]),
        (wall, [c(0, 0, 0), c(1, 0, 0), c(1, 1, 0), c(0, 1, 0)]),
        (wall, [c(1, 0, 1), c(0, 0, 1), c(0, 1, 1), c(1, 1, 1)]),
        (end, [c(0, 0, 1), c(0, 0, 0), c(0, 1, 0), c(0, 1, 1)]),
        (end, [c(1, 0, 0), c(1, 0, 1), c(1, 1, 1), c(1, 1, 0)]),
    ];
    for (material, corners) in faces {
        let repeats = Vec2::new(corners[0].distance(corners[1]), corners[1].distance(corners[2]));
        builder.tiled_quad(material, corners, repeats);
    }
}

/// Returns a texture whose pixel at (u, v) has these values in 0..=1.
fn texture(name: &str, encoding: Encoding, pixel: impl Fn(f32, f32) -> [f32; 4]) -> Texture {
    let at = |i: u32| (i as f32 + 0.5) / SIDE as f32;
    let places = (0..SIDE * SIDE).map(|i| (at(i % SIDE), at(i / SIDE)));
    let byte = |value: f32| (value * 255.0).round() as u8;
    let pixels = places.flat_map(|(u, v)| pixel(u, v).map(byte)).collect();
    Texture { name: name.into(), width: SIDE, height: SIDE, pixels, encoding, wrap: [Wrap::Repeat; 2] }
}

/// Returns the normals of stones, four in each metre, whose faces rise and fall as a cosine.
fn relief() -> Texture {
    texture("relief", Encoding::Linear, |u, v| {
        let slope = |x: f32| SLOPE * (std::f32::consts::TAU * 2.0 * x).sin();
        // v goes down, y of the tangent space goes up.
        let normal = Vec3::new(slope(u), -slope(v), 1.0).normalize();
        (0.5 * normal + 0.5).extend(1.0).into()
    })
}

/// Returns a lattice with round holes, which take a half of it.
fn holes() -> Texture {
    texture("holes", Encoding::Srgb, |u, v| {
        let from_middle = Vec2::new((4.0 * u).fract(), (4.0 * v).fract()) - 0.5;
        let is_hole = from_middle.length_squared() < 0.5 / std::f32::consts::PI;
        [1.0, 1.0, 1.0, if is_hole { 0.0 } else { 1.0 }]
    })
}
