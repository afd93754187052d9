//! A vaulted nave with aisles and an apse, modelled on the structure of Sibenik's cathedral: ribbed vaults on
//! compound piers, windows in the clerestory and the aisles. About 36 m × 17 m × 14 m, with x from west to
//! east.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::architecture::{Opening, Vault, Wall, column};
use super::builder::{Builder, MaterialId};
use crate::material::Material;
use crate::model::Model;

/// Length of a bay along x \[m\], and the number of bays.
const BAY: f32 = 5.0;
const BAYS: usize = 6;
/// Half the length of the nave; its piers are at z = ±`NAVE`, the walls of the aisles at z = ±`AISLE` \[m\].
const LENGTH: f32 = BAY * BAYS as f32 * 0.5;
const NAVE: f32 = 4.0;
const AISLE: f32 = 8.0;
const WALL: f32 = 0.6;
/// Heights \[m\]: springs of arcades and aisles, roof of the aisles, springs of the nave, its roof.
const ARCADE: f32 = 4.4;
const AISLE_ROOF: [f32; 2] = [7.0, 7.4];
const SPRING: f32 = 9.0;
const ROOF: [f32; 2] = [13.2, 13.6];

struct Materials {
    stone: MaterialId,
    vault: MaterialId,
    rib: MaterialId,
    floor: MaterialId,
    wood: MaterialId,
    carpet: MaterialId,
}

pub(super) fn nave() -> Model {
    let mut builder = Builder::default();
    let mut matte = |name, albedo| builder.material(Material::matte(name, albedo));
    let materials = Materials {
        stone: matte("stone", [0.62, 0.60, 0.55]),
        vault: matte("vault", [0.68, 0.62, 0.52]),
        rib: matte("rib", [0.50, 0.46, 0.40]),
        floor: matte("floor", [0.40, 0.34, 0.30]),
        wood: matte("wood", [0.24, 0.13, 0.07]),
        carpet: matte("carpet", [0.52, 0.05, 0.06]),
    };
    shell(&mut builder, &materials);
    for bay in 0..BAYS {
        let x = (bay as f32 + 0.5) * BAY - LENGTH;
        middle(&mut builder, &materials, x);
        for side in [-1.0, 1.0] {
            flank(&mut builder, &materials, x, side);
        }
    }
    for axis in 0..=BAYS {
        let x = axis as f32 * BAY - LENGTH;
        for side in [-1.0, 1.0] {
            pier(&mut builder, &materials, Vec3::new(x, 0.0, side * NAVE));
        }
        if axis > 0 && axis < BAYS {
            arches_across(&mut builder, &materials, x);
        }
    }
    apse(&mut builder, &materials);
    furniture(&mut builder, &materials);
    builder.finish("nave")
}

/// Adds floor, roofs, and the walls of both ends.
fn shell(builder: &mut Builder, materials: &Materials) {
    let (x, z) = (LENGTH + WALL, AISLE + WALL);
    let mut cuboid =
        |material, min: [f32; 3], max: [f32; 3]| builder.cuboid(material, min.into(), max.into());
    cuboid(materials.floor, [-x, -0.5, -z], [x + NAVE + WALL, 0.0, z]);
    cuboid(materials.stone, [-x, ROOF[0], -NAVE - 0.8], [x, ROOF[1], NAVE + 0.8]);
    for side in [-1.0f32, 1.0] {
        let between = |a: f32, b: f32| if side < 0.0 { [-b, -a] } else { [a, b] };
        let [near, far] = between(NAVE - 0.4, z);
        cuboid(materials.stone, [-x, AISLE_ROOF[0], near], [x, AISLE_ROOF[1], far]);
        let [near, far] = between(NAVE, z);
        cuboid(materials.stone, [-x, 0.0, near], [-LENGTH, AISLE_ROOF[0], far]);
        cuboid(materials.stone, [LENGTH, 0.0, near], [x, AISLE_ROOF[0], far]);
    }
    // The west wall has one large window; the arch to the apse has the same frame.
    let wall = |x: f32, along: Vec3| Wall {
        place: Vec3::new(x, 0.0, 0.0),
        along,
        width: 2.0 * NAVE + 1.6,
        bottom: 0.0,
        top: ROOF[0],
        thickness: WALL,
    };
    let window = Opening { half_width: 1.5, sill: 5.5, spring: 8.5, rise: 1.5 };
    let west = wall(-LENGTH - WALL * 0.5, Vec3::NEG_Z);
    west.with_opening(builder, materials.stone, window);
    west.ends(builder, materials.stone);
    let arch = Opening { half_width: 3.3, sill: 0.0, spring: SPRING, rise: 3.0 };
    let east = wall(LENGTH + WALL * 0.5, Vec3::Z);
    east.with_opening(builder, materials.stone, arch);
    east.ends(builder, materials.stone);
}

/// Adds the vault of a bay of the nave.
fn middle(builder: &mut Builder, materials: &Materials, x: f32) {
    let place = Vec3::new(x, 0.0, 0.0);
    let vault = Vault { place, half: [BAY * 0.5, NAVE], spring: SPRING, rise: 3.8, pointed: 0.4 };
    vault.build(builder, materials.vault, 24);
    vault.ribs(builder, materials.rib, 0.15, 24);
}

/// Adds one side of a bay: arcade, clerestory, aisle with its vault and window.
fn flank(builder: &mut Builder, materials: &Materials, x: f32, side: f32) {
    let along = Vec3::X * side;
    let mut wall = |z: f32, bottom: f32, top: f32, thickness: f32, opening: Opening| {
        let place = Vec3::new(x, 0.0, z * side);
        Wall { place, along, width: BAY, bottom, top, thickness }.with_opening(
            builder,
            materials.stone,
            opening,
        );
    };
    let arch = Opening { half_width: 1.8, sill: ARCADE, spring: ARCADE, rise: 2.0 };
    wall(NAVE, ARCADE, AISLE_ROOF[1], 0.8, arch);
    wall(NAVE, AISLE_ROOF[1], ROOF[0], 0.8, Opening { half_width: 1.2, sill: 8.2, spring: 10.8, rise: 1.2 });
    let window = Opening { half_width: 1.0, sill: 1.8, spring: 4.2, rise: 1.2 };
    wall(AISLE + WALL * 0.5, 0.0, AISLE_ROOF[0], WALL, window);
    let width = AISLE - NAVE;
    let place = Vec3::new(x, 0.0, side * (NAVE + width * 0.5));
    let vault = Vault { place, half: [BAY * 0.5, width * 0.5], spring: ARCADE, rise: 2.3, pointed: 0.3 };
    vault.build(builder, materials.vault, 16);
}

/// Adds a pier of five shafts; the one towards the nave reaches up to the vault.
fn pier(builder: &mut Builder, materials: &Materials, place: Vec3) {
    column(builder, materials.stone, place, 0.5, ARCADE, 32);
    for (along, across) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
        let inner = across * place.z < 0.0;
        let foot = place + Vec3::new(along, 0.0, across) * 0.56;
        column(builder, materials.rib, foot, 0.16, if inner { SPRING } else { ARCADE }, 16);
    }
}

/// Adds arches over nave and aisles between the bays.
fn arches_across(builder: &mut Builder, materials: &Materials, x: f32) {
    let mut wall = |z: f32, width: f32, bottom: f32, top: f32, rise: f32| {
        let wall = Wall { place: Vec3::new(x, 0.0, z), along: Vec3::Z, width, bottom, top, thickness: 0.45 };
        let opening = Opening { half_width: width * 0.5 - 0.35, sill: bottom, spring: bottom, rise };
        wall.with_opening(builder, materials.rib, opening);
    };
    wall(0.0, 2.0 * NAVE, SPRING, ROOF[0], 3.4);
    for side in [-1.0, 1.0] {
        wall(side * (NAVE + AISLE) * 0.5, AISLE - NAVE, ARCADE, AISLE_ROOF[0], 1.9);
    }
}

/// Adds half a cylinder with half a dome, as two shells one wall thickness apart.
fn apse(builder: &mut Builder, materials: &Materials) {
    let centre = Vec3::new(LENGTH + WALL, 0.0, 0.0);
    for (radius, rise, outside) in [(NAVE, 3.6, -1.0), (NAVE + WALL, 4.1, 1.0)] {
        let around = |u: f32| {
            let (sin, cos) = ((u - 0.5) * PI).sin_cos();
            Vec3::new(cos, 0.0, sin)
        };
        builder.surface(materials.stone, 32, 1, |u, v| {
            let out = around(u);
            (centre + out * radius + Vec3::Y * (v * SPRING), out * outside)
        });
        builder.surface(materials.vault, 32, 16, |u, v| {
            let (sin, cos) = (v * PI * 0.5).sin_cos();
            let cos = if v == 1.0 { 0.0 } else { cos };
            let out = around(u);
            let normal = out * (cos / radius) + Vec3::Y * (sin / rise);
            (centre + out * (radius * cos) + Vec3::Y * (SPRING + rise * sin), normal * outside)
        });
    }
}

/// Adds pews, a carpet between them, and an altar with a bowl.
fn furniture(builder: &mut Builder, materials: &Materials) {
    let mut cuboid =
        |material, min: [f32; 3], max: [f32; 3]| builder.cuboid(material, min.into(), max.into());
    for row in 0..12 {
        let x = row as f32 * 1.3 - 9.0;
        for side in [-1.0f32, 1.0] {
            let [near, far] = if side < 0.0 { [-2.9, -0.9] } else { [0.9, 2.9] };
            cuboid(materials.wood, [x, 0.4, near], [x + 0.45, 0.46, far]);
            cuboid(materials.wood, [x - 0.06, 0.0, near], [x, 0.95, far]);
            for z in [near, far - 0.06] {
                cuboid(materials.wood, [x, 0.0, z], [x + 0.45, 0.4, z + 0.06]);
            }
        }
    }
    cuboid(materials.carpet, [-LENGTH + 1.0, 0.0, -0.7], [LENGTH - 1.0, 0.02, 0.7]);
    cuboid(materials.stone, [LENGTH + 1.4, 0.0, -1.2], [LENGTH + 2.4, 1.0, 1.2]);
    let outline = [[0.15, 0.0], [0.06, 0.1], [0.06, 0.25], [0.3, 0.5], [0.27, 0.5], [0.05, 0.28]];
    builder.lathe(materials.wood, Vec3::new(LENGTH + 1.9, 1.0, 0.0), &outline, (TAU * 4.0) as usize);
}
