//! The scenes made by code.

use data_file::Files;
use glam::Vec3;
use scene::{Scene, about, built_in_names};

use crate::common::{Shipped, assert_trait, built_in, shipped};

#[test]
fn every_shipped_scene_loads_and_says_what_it_is() {
    let list = Shipped.list();
    assert!(list.len() >= 9, "{list:?}");
    for file in list {
        let name = file.trim_end_matches(".ron");
        let scene = shipped(name);
        assert!(!about(name, &Shipped).expect("a good file").is_empty(), "{name} says what it shows");
        assert!(!scene.repairs.iter().any(|r| r.contains("camera")), "{name} has a camera");
        for vertex in &scene.vertices {
            let normal = Vec3::from(vertex.normal);
            assert!((normal.length() - 1.0).abs() < 1e-4, "{name}: a normal of length 1, found {normal}");
            assert!(Vec3::from(vertex.position).is_finite(), "{name}: finite");
        }
        assert_eq!(scene.hash, shipped(name).hash, "{name} is the same each time");
    }
}

/// Every triangle winds as its normals say.
fn assert_windings(scene: &Scene) {
    for (number, triangle) in scene.indices.chunks_exact(3).enumerate() {
        let corners = [0, 1, 2].map(|i| scene.vertices[triangle[i] as usize]);
        let [a, b, c] = corners.map(|v| Vec3::from(v.position));
        let normal = corners.iter().map(|v| Vec3::from(v.normal)).sum::<Vec3>();
        let facing = (b - a).cross(c - a).dot(normal);
        assert!(facing > 0.0, "{}: triangle {number} at {a} winds against its normals", scene.name);
    }
}

#[test]
fn triangles_wind_as_their_normals_say() {
    for name in built_in_names() {
        assert_windings(&built_in(name));
    }
}

#[test]
fn every_material_of_a_built_in_geometry_is_seen() {
    for name in built_in_names() {
        let scene = built_in(name);
        for (i, material) in (0..).zip(&scene.materials) {
            let is_seen = scene.vertices.is_empty() || scene.vertices.iter().any(|v| v.material == i);
            assert!(is_seen, "{name}: nothing has the material {}", material.name);
        }
    }
}

#[test]
fn the_cornell_box_has_the_measured_area() {
    // By hand from the measured corners, in m²: trapezia of floor, back and right and left wall, the ceiling,
    // and for each block its roof and the perimeter of its foot times its height.
    let (h, d) = (0.5488, 0.5592);
    let floor = d * (0.5528 + 0.5496) / 2.0;
    let back = h * (0.5496 + 0.5560) / 2.0;
    let (ceiling, right) = (0.5560 * d, d * h);
    // The left wall's corners (552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0) are not in
    // one plane: two triangles, as the quad is split.
    let triangle = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        let [a, b, c] = [a, b, c].map(glam::DVec3::from);
        0.5e-6 * (b - a).cross(c - a).length()
    };
    let left = triangle([552.8, 0.0, 0.0], [549.6, 0.0, 559.2], [556.0, 548.8, 559.2])
        + triangle([552.8, 0.0, 0.0], [556.0, 548.8, 559.2], [556.0, 548.8, 0.0]);
    let block = |feet: [[f64; 2]; 4], height: f64| {
        let edge = |i: usize| {
            let ([ax, az], [bx, bz]) = (feet[i], feet[(i + 1) % 4]);
            ((ax - bx).hypot(az - bz), ax * bz - bx * az)
        };
        let perimeter: f64 = (0..4).map(|i| edge(i).0).sum();
        let shoelace: f64 = (0..4).map(|i| edge(i).1).sum::<f64>().abs() / 2.0;
        (perimeter * height + shoelace) * 1e-6
    };
    let short = block([[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]], 165.0);
    let tall = block([[423.0, 247.0], [265.0, 296.0], [314.0, 456.0], [472.0, 406.0]], 330.0);
    let expected = floor + back + ceiling + right + left + short + tall;
    let area = shipped("cornell-box").area();
    assert!((area / expected - 1.0).abs() < 1e-5, "{area} m², expected {expected} m²");

    let (min, max) = shipped("cornell-box").bounds();
    assert!(min.abs_diff_eq(Vec3::ZERO, 1e-6) && max.abs_diff_eq(Vec3::new(0.556, 0.5488, 0.5592), 1e-6));
    assert_eq!(shipped("cornell-box").triangles(), 30, "five walls and ten faces of blocks");
}

#[test]
fn the_cornell_boxs_walls_face_inwards_and_its_blocks_outwards() {
    let scene = shipped("cornell-box");
    let box_centre = Vec3::new(0.278, 0.2744, 0.2796);
    let (short, tall) = (Vec3::new(0.1855, 0.08, 0.169), Vec3::new(0.3685, 0.16, 0.351));
    // Four vertices a quad: floor, ceiling and back wall, five quads each of the blocks, the two side walls.
    for (number, vertex) in scene.vertices.iter().enumerate() {
        let (position, normal) = (Vec3::from(vertex.position), Vec3::from(vertex.normal));
        let outwards = match number / 4 {
            3..8 => position - short,
            8..13 => position - tall,
            _ => box_centre - position,
        };
        assert!(outwards.dot(normal) > 0.0, "at {position} with normal {normal}");
    }
}

/// The hall is the same surface in any number of triangles.
#[test]
fn halls_differ_in_triangles_alone() {
    let pillar = 4.0 * 0.5 * 4.0;
    let expected = 2.0 * (12.0 * 8.0 + 12.0 * 4.0 + 8.0 * 4.0) + 10.0 * pillar;
    for (name, triangles) in [("hall-1k", 1 << 10), ("hall-4k", 1 << 12), ("hall-64k", 1 << 16)] {
        let hall = shipped(name);
        assert_eq!(hall.triangles(), triangles, "{name}");
        assert!((hall.area() / expected - 1.0).abs() < 1e-5, "{name}: {} m²", hall.area());
        assert_eq!(hall.bounds(), shipped("hall-1k").bounds());
        let centre = Vec3::new(0.0, 2.0, 0.0);
        // Walls face inwards, and are all that lies on the bounds.
        let (min, max) = hall.bounds();
        let on_bounds = |at: Vec3| at.x == min.x || at.x == max.x || at.z == min.z || at.z == max.z;
        for vertex in hall.vertices.iter().filter(|vertex| on_bounds(Vec3::from(vertex.position))) {
            let inwards = centre - Vec3::from(vertex.position);
            assert!(inwards.dot(vertex.normal.into()) > 0.0, "{name}: {vertex:?}");
        }
    }
    assert_eq!(shipped("hall-1m").triangles(), 1 << 20);
}

/// Returns the volume that a scene encloses with faces turned inwards, from the divergence theorem, seen from `origin`:
/// the same from everywhere if nothing is open.
fn enclosed(scene: &Scene, origin: Vec3) -> f64 {
    let sixfold = scene.indices.chunks_exact(3).map(|triangle| {
        let [a, b, c] = [0, 1, 2].map(|i| Vec3::from(scene.vertices[triangle[i] as usize].position) - origin);
        f64::from(-a.dot(b.cross(c)))
    });
    sixfold.sum::<f64>() / 6.0
}

#[test]
fn plans_are_closed_and_of_the_drawn_size() {
    // By hand from the plans, in cells of 0.16 m²: rooms and corridors 2.6 m high, doorways 2.1 m.
    let volume = |rooms: f64, doorways: f64| 0.16 * (rooms * 2.6 + doorways * 2.1);
    let maze = 3.0 * 6.0 * (7.0 + 6.0 + 5.0) + 2.0 * 28.0 * 3.0 + 6.0 * 7.0 * 3.0;
    let corridor = 5.0 * 42.0 + 39.0 * 4.0;
    for (name, expected, count) in
        [("maze", volume(maze, 10.0 * 3.0), 13), ("corridor", volume(corridor, 5.0 * 3.0), 5)]
    {
        let scene = shipped(name);
        for origin in [Vec3::ZERO, Vec3::new(7.0, -3.0, 5.0)] {
            let found = enclosed(&scene, origin);
            assert!((found / expected - 1.0).abs() < 1e-4, "{name}: {found} m³, expected {expected} m³");
        }
        assert_eq!(scene.lights.len(), count, "{name}");
    }
    let (min, max) = shipped("maze").bounds();
    assert!(
        min.abs_diff_eq(Vec3::new(-5.6, 0.0, -5.6), 1e-5) && max.abs_diff_eq(Vec3::new(5.6, 2.6, 5.6), 1e-5)
    );
    // Floor and ceiling; the walls of rooms, the corridor and the doorways, less the doors.
    let door = 1.2 * 2.1;
    let walls = 5.0 * (10.4 * 2.6 - door) + (34.4 * 2.6 - 5.0 * door) + 5.0 * (0.8 * 2.1);
    let expected = 2.0 * 0.16 * (corridor + 15.0) + walls;
    let area = shipped("corridor").area();
    assert!((area / expected - 1.0).abs() < 1e-5, "{area} m², expected {expected} m²");
}

#[test]
fn simple_bodies_have_their_closed_forms() {
    let area = |name: &str| built_in(name).area();
    assert!((area("plane") - 4.0).abs() < 1e-6, "2 m × 2 m");
    assert!((area("cube") - 6.0).abs() < 1e-6, "six faces");
    let sphere = area("sphere");
    let expected = 4.0 * std::f64::consts::PI;
    assert!(sphere < expected && sphere > 0.99 * expected, "inscribed: {sphere} of {expected}");
}

#[test]
fn traits_state_what_is_there() {
    let expect = |name: &str, expected: &[(&str, u32)]| {
        let scene = shipped(name);
        for (key, value) in expected {
            assert_eq!(scene.traits().values[*key].as_u32(), Some(*value), "{name}: {key}");
        }
        scene
    };
    let counts = [
        ("lights", 3),
        ("spot_lights", 1),
        ("point_lights", 1),
        ("directional_lights", 1),
        ("light_layers", 8),
        ("triangles", 30),
    ];
    let lights = expect("cornell-box-lights", &counts);
    for name in ["textured", "glossy", "emissive", "masked", "environment", "moving_camera", "moving_lights"]
    {
        assert_trait(&lights, name, false);
    }
    let lamp = expect("cornell-box-lamp", &[("lights", 0), ("light_layers", 0), ("triangles", 32)]);
    assert_trait(&lamp, "emissive", true);
    expect("empty", &[("triangles", 0)]);
}
