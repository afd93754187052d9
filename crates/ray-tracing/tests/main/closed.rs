//! Rays from inside a closed surface meet it, also where triangles meet.

use crate::shared::{Mesh, Random};
use glam::Vec3;

fn assert_closed(
    mesh: &Mesh,
    origins: &[Vec3],
    targets: impl Fn([Vec3; 3], &mut Random) -> Vec3,
    what: &str,
) {
    let bvh = mesh.bvh();
    let mut random = Random(5);
    for origin in origins {
        for index in 0..mesh.triangles() {
            let target = targets(mesh.triangle(index), &mut random);
            let direction = target - *origin;
            let hit = bvh.intersect(*origin, direction, 0.0, f32::MAX);
            assert!(hit.is_some(), "{what}: from {origin} through {target}, of triangle {index}");
            assert!(bvh.occluded(*origin, direction, 0.0, f32::MAX), "{what}: any hit");
        }
    }
}

/// Places of no simple coordinates inside a unit sphere.
fn origins(center: Vec3, scale: f32) -> Vec<Vec3> {
    let mut random = Random(6);
    let within = (0..12).map(|_| (center + random.in_cube() * 0.5) * scale);
    std::iter::once(center * scale).chain(within).collect()
}

#[test]
fn no_ray_leaves_between_triangles() {
    for (center, scale) in
        [(Vec3::ZERO, 1.0), (Vec3::new(3.1, -0.7, 9.3), 1e-3), (Vec3::new(0.2, 5.0, 0.1), 1e6)]
    {
        let mesh = Mesh::sphere(24, center).map(|p| p * scale);
        let origins = origins(center, scale);
        let what = format!("scale {scale}");
        assert_closed(&mesh, &origins, |[a, ..], _| a, &format!("{what}, vertices"));
        assert_closed(&mesh, &origins, |[a, b, _], _| (a + b) * 0.5, &format!("{what}, middles of edges"));
        let along = |[a, _, c]: [Vec3; 3], random: &mut Random| a + (c - a) * random.next();
        assert_closed(&mesh, &origins, along, &format!("{what}, edges"));
    }
}

#[test]
fn no_axis_parallel_ray_passes_between_flat_boxes() {
    // A wall of squares in the plane x = 0: boxes without thickness, rays along an axis through every corner.
    let mut mesh = Mesh::default();
    for y in 0..=16u8 {
        for z in 0..=16u8 {
            mesh.positions.push([0.0, f32::from(y), f32::from(z)]);
        }
    }
    for y in 0..16 {
        for z in 0..16 {
            let at = |dy: u32, dz: u32| (y + dy) * 17 + z + dz;
            mesh.indices.extend([at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)]);
        }
    }
    let bvh = mesh.bvh();
    for y in 0..=32u8 {
        for z in 0..=32u8 {
            let origin = Vec3::new(1.0, f32::from(y) * 0.5, f32::from(z) * 0.5);
            let hit = bvh.intersect(origin, Vec3::NEG_X, 0.0, 2.0);
            assert_eq!(hit.map(|hit| hit.distance), Some(1.0), "from {origin}");
        }
    }
}
