//! A colonnaded atrium, modelled on the structure of Sponza: a court open to the sky, surrounded by two
//! storeys of arcades, the lower with groin vaults; drapes of strong colors in the arches. About 31 m × 16 m
//! × 9 m.

use std::f32::consts::TAU;

use glam::Vec3;

use super::architecture::{Opening, Vault, Wall, column};
use super::builder::{Builder, MaterialId};
use crate::material::Material;
use crate::model::Model;

/// All bays are squares of this side \[m\].
const BAY: f32 = 3.0;
/// Bays of the court, along x and z.
const BAYS: [usize; 2] = [8, 3];
/// Half the size of the court, between the axes of its columns, along x and z \[m\].
const COURT: [f32; 2] = [12.0, 4.5];
/// Half the size of the building, inside its walls, along x and z \[m\].
const INSIDE: [f32; 2] = [COURT[0] + BAY, COURT[1] + BAY];
const WALL: f32 = 0.5;
/// Heights of the springs of the lower arches, the slab between the storeys, the springs of the upper arches,
/// and the roof.
const SPRING: [f32; 2] = [2.6, 6.7];
const SLAB: [f32; 2] = [4.2, 4.6];
const ROOF: [f32; 2] = [8.5, 8.8];

struct Materials {
    stone: MaterialId,
    plaster: MaterialId,
    floor: MaterialId,
    paving: MaterialId,
    roof: MaterialId,
    drapes: [MaterialId; 3],
}

pub(super) fn atrium() -> Model {
    let mut builder = Builder::default();
    let mut matte = |name, albedo| builder.material(Material::matte(name, albedo));
    let materials = Materials {
        stone: matte("stone", [0.60, 0.54, 0.46]),
        plaster: matte("plaster", [0.72, 0.66, 0.56]),
        floor: matte("floor", [0.42, 0.38, 0.34]),
        paving: matte("paving", [0.52, 0.48, 0.42]),
        roof: matte("roof", [0.45, 0.25, 0.17]),
        drapes: [
            matte("red drape", [0.62, 0.06, 0.05]),
            matte("green drape", [0.10, 0.42, 0.12]),
            matte("blue drape", [0.07, 0.15, 0.50]),
        ],
    };
    shell(&mut builder, &materials);
    for (place, along, number) in arcade_bays() {
        arcade(&mut builder, &materials, place, along);
        if number % 2 == 1 {
            drape(&mut builder, materials.drapes[number / 2 % 3], place, along);
        }
    }
    for (place, corner) in supports() {
        support(&mut builder, &materials, place, corner);
    }
    aisles(&mut builder, &materials);
    builder.finish("atrium")
}

/// Returns the bays of the arcade around the court: the centre of each on the columns' axis, its direction
/// (with the court in front), its number.
fn arcade_bays() -> Vec<(Vec3, Vec3, usize)> {
    let mut bays = Vec::new();
    for (axis, along, across) in [(0, Vec3::X, Vec3::Z), (1, Vec3::NEG_Z, Vec3::X)] {
        for side in [-1.0, 1.0] {
            for i in 0..BAYS[axis] {
                let s = (i as f32 + 0.5) * BAY - COURT[axis];
                // Turned so that its front, along × up, faces the court.
                bays.push((along * s + across * (side * COURT[1 - axis]), along * -side, bays.len()));
            }
        }
    }
    bays
}

/// Returns the feet of all columns, and whether they stand at a corner.
fn supports() -> Vec<(Vec3, bool)> {
    let [nx, nz] = BAYS;
    let grid = (0..=nx).flat_map(|i| (0..=nz).map(move |k| (i, k)));
    grid.filter(|(i, k)| *i == 0 || *i == nx || *k == 0 || *k == nz)
        .map(|(i, k)| {
            let corner = (i == 0 || i == nx) && (k == 0 || k == nz);
            (Vec3::new(i as f32 * BAY - COURT[0], 0.0, k as f32 * BAY - COURT[1]), corner)
        })
        .collect()
}

/// Adds floor, outer walls, slab and roof.
fn shell(builder: &mut Builder, materials: &Materials) {
    let [x, z] = [INSIDE[0] + WALL, INSIDE[1] + WALL];
    builder.cuboid(materials.stone, Vec3::new(-x, -0.5, -z), Vec3::new(x, -0.1, z));
    ring(builder, materials.floor, COURT, INSIDE, [-0.1, 0.0]);
    builder.cuboid(
        materials.paving,
        Vec3::new(-COURT[0], -0.1, -COURT[1]),
        Vec3::new(COURT[0], 0.0, COURT[1]),
    );
    ring(builder, materials.plaster, INSIDE, [x, z], [-0.1, ROOF[0]]);
    let edge = COURT.map(|c| c - 0.3);
    ring(builder, materials.stone, edge, INSIDE, SLAB);
    ring(builder, materials.stone, edge.map(|c| c - 0.15), [x, z], [ROOF[0], ROOF[0] + 0.15]);
    ring(builder, materials.roof, edge, [x, z], [ROOF[0] + 0.15, ROOF[1]]);
}

/// Adds four boxes between two rectangles around the origin.
fn ring(builder: &mut Builder, material: MaterialId, inner: [f32; 2], outer: [f32; 2], y: [f32; 2]) {
    let mut cuboid = |x: [f32; 2], z: [f32; 2]| {
        builder.cuboid(material, Vec3::new(x[0], y[0], z[0]), Vec3::new(x[1], y[1], z[1]));
    };
    cuboid([-outer[0], outer[0]], [inner[1], outer[1]]);
    cuboid([-outer[0], outer[0]], [-outer[1], -inner[1]]);
    cuboid([inner[0], outer[0]], [-inner[1], inner[1]]);
    cuboid([-outer[0], -inner[0]], [-inner[1], inner[1]]);
}

/// Adds one bay of the arches of both storeys, with the balustrade of the upper one.
fn arcade(builder: &mut Builder, materials: &Materials, place: Vec3, along: Vec3) {
    for (spring, top) in [(SPRING[0], SLAB[0]), (SPRING[1], ROOF[0])] {
        let wall = Wall { place, along, width: BAY, bottom: spring, top, thickness: 0.5 };
        let opening = Opening { half_width: 1.2, sill: spring, spring, rise: 1.2 };
        wall.with_opening(builder, materials.stone, opening);
    }
    let across = along.cross(Vec3::Y).abs();
    let bar = |builder: &mut Builder, y: f32, height: f32, half: f32| {
        let size = along.abs() * (BAY * 0.5) + across * half;
        builder.cuboid(materials.stone, place - size + Vec3::Y * y, place + size + Vec3::Y * (y + height));
    };
    bar(builder, SLAB[1], 0.1, 0.12);
    bar(builder, SLAB[1] + 0.85, 0.12, 0.14);
    for i in 0..7 {
        let foot = place + along * ((i as f32 + 0.5) / 7.0 - 0.5) * (BAY - 0.5) + Vec3::Y * (SLAB[1] + 0.1);
        let outline = [[0.05, 0.0], [0.09, 0.2], [0.045, 0.5], [0.04, 0.65], [0.06, 0.75]];
        builder.lathe(materials.plaster, foot, &outline, 10);
    }
}

/// Adds a column in each storey, or a pier at the corners.
fn support(builder: &mut Builder, materials: &Materials, place: Vec3, corner: bool) {
    for (foot, top) in [(0.0, SPRING[0]), (SLAB[1], SPRING[1])] {
        let foot = place + Vec3::Y * foot;
        let height = place.y + top - foot.y;
        if corner {
            let half = Vec3::new(0.32, 0.0, 0.32);
            builder.cuboid(materials.stone, foot - half, foot + half + Vec3::Y * height);
        } else {
            column(builder, materials.stone, foot, 0.2, height, 28);
        }
    }
    if corner {
        // The arcades of two sides meet above the pier: it continues between their ends, up to slab and roof.
        let half = Vec3::new(0.32, 0.0, 0.32);
        for (bottom, top) in [(SPRING[0], SLAB[0]), (SPRING[1], ROOF[0])] {
            builder.cuboid(materials.stone, place - half + Vec3::Y * bottom, place + half + Vec3::Y * top);
        }
    }
}

/// Adds the vaults around the court, with arches from each column to the wall.
fn aisles(builder: &mut Builder, materials: &Materials) {
    let [nx, nz] = [BAYS[0] + 2, BAYS[1] + 2];
    let middle = |i: usize, axis: usize| (i as f32 + 0.5) * BAY - INSIDE[axis];
    for i in 0..nx {
        for k in 0..nz {
            if i > 0 && i + 1 < nx && k > 0 && k + 1 < nz {
                continue;
            }
            let place = Vec3::new(middle(i, 0), 0.0, middle(k, 1));
            let half = [BAY * 0.5; 2];
            let vault = Vault { place, half, spring: SPRING[0], rise: 1.4, pointed: 0.0 };
            vault.build(builder, materials.plaster, 16);
        }
    }
    let opening = Opening { half_width: 1.2, sill: SPRING[0], spring: SPRING[0], rise: 1.1 };
    let wall =
        |place, along| Wall { place, along, width: BAY, bottom: SPRING[0], top: SLAB[0], thickness: 0.35 };
    for side in [-1.0, 1.0] {
        for i in 0..=BAYS[0] {
            let place = Vec3::new(i as f32 * BAY - COURT[0], 0.0, side * (COURT[1] + BAY * 0.5));
            wall(place, Vec3::Z).with_opening(builder, materials.stone, opening);
        }
        for k in 0..=BAYS[1] {
            let place = Vec3::new(side * (COURT[0] + BAY * 0.5), 0.0, k as f32 * BAY - COURT[1]);
            wall(place, Vec3::X).with_opening(builder, materials.stone, opening);
        }
    }
}

/// Adds a pleated cloth that hangs from a rod in a lower arch.
fn drape(builder: &mut Builder, material: MaterialId, place: Vec3, along: Vec3) {
    let (width, top, length, pleats, depth) = (2.1, 3.25, 2.2, 7.0, 0.07);
    let front = along.cross(Vec3::Y);
    builder.surface(material, 56, 8, |u, v| {
        // Gathered at the rod, loose below.
        let (sin, cos) = (u * pleats * TAU).sin_cos();
        let open = depth * (0.5 + 0.5 * v);
        let point = along * ((u - 0.5) * width) + Vec3::Y * (top - length * v) + front * (open * sin);
        let slope = open * pleats * TAU * cos / width;
        (place + point, front - along * slope + Vec3::Y * (depth * 0.5 * sin / length))
    });
}
