//! Random rays, broken triangles, trees of unusual shape.

use crate::shared::{Mesh, Random, Ray};
use glam::Vec3;
use ray_tracing::{Bvh, STACK};

/// Every hit is that of brute force, up to what rounding at an edge decides.
fn assert_hits(mesh: &Mesh, bvh: &Bvh, rays: &[Ray], what: &str) {
    let mut hits = 0;
    for ray in rays {
        let found = bvh.intersect(ray.origin, ray.direction, ray.nearest, ray.farthest);
        assert_eq!(
            bvh.occluded(ray.origin, ray.direction, ray.nearest, ray.farthest),
            found.is_some(),
            "{what}: any hit of {ray:?}"
        );
        let distance = found.map(|hit| f64::from(hit.distance));
        // Places are rounded to the spacing of floats there, which counts the more the flatter the ray.
        let spacing = f64::from(ray.origin.abs().max_element() / ray.direction.length() * f32::EPSILON * 8.0);
        let near = |other: Option<f64>| match (distance, other) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-5 * b + spacing,
            (a, b) => a.is_none() && b.is_none(),
        };
        let (inner, outer) = (mesh.brute_force(ray, -1e-5), mesh.brute_force(ray, 1e-5));
        assert!(near(inner) || near(outer), "{what}: {distance:?}, not {inner:?} or {outer:?}: {ray:?}");
        if let Some(hit) = found {
            hits += 1;
            let [a, b, c] = mesh.triangle(hit.triangle);
            let place = a + (b - a) * hit.barycentrics.x + (c - a) * hit.barycentrics.y;
            let along = ray.origin + ray.direction * hit.distance;
            let size = ray.origin.abs().max(along.abs()).max(place.abs()).max_element();
            assert!(place.abs_diff_eq(along, 1e-5 * size), "{what}: {place} is not {along}: {ray:?}");
        }
    }
    assert!(hits * 10 > rays.len(), "{what}: only {hits} hits of {}", rays.len());
}

#[test]
fn random_rays_hit_what_brute_force_hits() {
    for (name, count) in [("cornell-box", 4000), ("atrium", 150), ("nave", 150)] {
        let scene = pass_test::scene(name);
        let mesh = Mesh::of(&scene);
        let bvh = mesh.bvh();
        let rays = Random(1).rays(scene.bounds(), count);
        assert_hits(&mesh, &bvh, &rays, &format!("{name}, {} triangles", mesh.triangles()));
    }
}

#[test]
fn hits_do_not_depend_on_the_scale() {
    let (center, count) = (Vec3::new(0.3, -0.2, 0.7), 500);
    for scale in [1e-3, 1.0, 1e6] {
        let mesh = Mesh::sphere(12, center).map(|p| p * scale);
        let rays = Random(2).rays(((center - 1.0) * scale, (center + 1.0) * scale), count);
        assert_hits(&mesh, &mesh.bvh(), &rays, &format!("scale {scale}"));
    }
}

#[test]
fn hits_lie_between_nearest_and_farthest() {
    let bvh = Mesh::sphere(16, Vec3::ZERO).bvh();
    let (origin, direction) = (Vec3::new(0.01, 0.02, 4.0), Vec3::NEG_Z * 0.5);
    let first = bvh.intersect(origin, direction, 0.0, f32::MAX).unwrap().distance;
    assert!((first - 6.0).abs() < 0.02, "{first} lengths of ½");
    let second = bvh.intersect(origin, direction, first, f32::MAX).unwrap().distance;
    assert!((second - 10.0).abs() < 0.02, "the far side at {second}");
    assert_eq!(bvh.intersect(origin, direction, first, second), None, "neither end counts");
    assert!(!bvh.occluded(origin, direction, 0.0, first), "the far end does not count");
    assert!(bvh.occluded(origin, direction, 0.0, first * 1.001));
    assert_eq!(bvh.intersect(origin, direction, second, f32::MAX), None, "nothing behind");
}

#[test]
fn triangles_without_area_are_never_hit() {
    let mut mesh = Mesh::sphere(8, Vec3::ZERO);
    let sound = mesh.bvh();
    let first = mesh.positions.len() as u32;
    // One place thrice, two places, three on a line, none at all; an index without a vertex.
    let broken =
        [Vec3::splat(0.9), Vec3::splat(-0.9), Vec3::ZERO, Vec3::NAN, Vec3::new(f32::INFINITY, 0.0, 0.0)];
    mesh.positions.extend(broken.map(<[f32; 3]>::from));
    for [a, b, c] in [[0, 0, 0], [0, 1, 1], [0, 1, 2], [0, 1, 3], [4, 0, 2], [0, 1, 1000]] {
        mesh.indices.extend([first + a, first + b, first + c]);
    }
    let bvh = mesh.bvh();
    for ray in Random(3).rays((Vec3::NEG_ONE, Vec3::ONE), 2000) {
        let hit = bvh.intersect(ray.origin, ray.direction, 0.0, f32::MAX);
        let without = sound.intersect(ray.origin, ray.direction, 0.0, f32::MAX);
        assert_eq!(hit.map(|hit| hit.distance), without.map(|hit| hit.distance), "{ray:?}");
    }
    for target in [0.9, 0.5, -0.3].map(Vec3::splat) {
        let hit = bvh.intersect(Vec3::new(0.1, 0.2, -0.1), target - Vec3::new(0.1, 0.2, -0.1), 0.0, 1.01);
        assert_eq!(hit.map(|hit| hit.triangle).filter(|index| *index >= mesh.triangles() - 6), None);
    }
}

#[test]
fn none_one_and_equal_triangles_make_trees() {
    let one = Mesh { positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], indices: vec![0, 1, 2] };
    let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
    let hit = |mesh: &Mesh| mesh.bvh().intersect(ray.origin, ray.direction, 0.0, f32::MAX);
    assert_eq!(hit(&Mesh::default()), None);
    assert_eq!(
        Mesh::default().bvh().bytes().len(),
        96,
        "a root and a triangle that cannot be hit: bindings are never empty"
    );
    assert_eq!(hit(&one).map(|hit| hit.distance), Some(1.0));
    let same = Mesh { indices: [0, 1, 2].repeat(5000), ..one };
    assert_eq!(hit(&same).map(|hit| hit.distance), Some(1.0));
    assert!(same.bvh().stack() <= STACK, "{}", same.bvh().stack());
}

#[test]
fn a_tree_too_deep_is_built_by_halves() {
    // Each triangle is larger than all before it together: the surface area heuristic peels them off one by one.
    let mut mesh = Mesh::default();
    for i in 0..100 {
        let (x, size) = (1.5_f32.powi(i), 1.5_f32.powi(i) * 0.4);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([[x, -size, -size], [x, size, -size], [x, 0.0, size]]);
        mesh.indices.extend([first, first + 1, first + 2]);
    }
    let bvh = mesh.bvh();
    // Halves and halves of halves of 25 to 50 leaves make three levels of four.
    assert!(bvh.stack() <= 9, "{}", bvh.stack());
    let mut from = 0.0;
    for i in 0..100 {
        let hit = bvh.intersect(Vec3::ZERO, Vec3::X, from, f32::MAX).unwrap();
        assert_eq!(hit.triangle, i);
        from = hit.distance;
    }
}

/// A ray visits a few more nodes of flat walls with each division of their triangles, not twice the number.
#[test]
fn flat_walls_cost_the_logarithm_of_their_triangles() {
    let [few, more] = ["hall-1k", "hall-64k"].map(|name| Mesh::of(&pass_test::scene(name)).bvh().cost());
    // 64 times as many are three levels of four children.
    assert!(few < 16.0 && more < few + 8.0, "{few} {more}");
}

#[test]
fn a_million_triangles() {
    let started = std::time::Instant::now();
    let mesh = Mesh::sphere(500, Vec3::new(2.0, -1.0, 3.0));
    assert_eq!(mesh.triangles(), 1_000_000);
    let bvh = mesh.bvh();
    let took = started.elapsed().as_secs_f32();
    // If the time grew with the square of the triangles, no machine could do it.
    assert!(took < 600.0, "{took} s");
    assert!(bvh.bytes().len() < 128 << 20, "{} bytes are more than adapters bind", bvh.bytes().len());
    assert!(bvh.stack() <= STACK);
    let mut random = Random(4);
    for _ in 0..20_000 {
        let direction = random.direction();
        let hit = bvh.intersect(Vec3::new(2.0, -1.0, 3.0), direction, 0.0, f32::MAX).unwrap();
        assert!((hit.distance - 1.0).abs() < 2e-5, "{} along {direction}", hit.distance);
    }
    let (mb, depth, cost) = (bvh.bytes().len() >> 20, bvh.stack(), bvh.cost());
    println!("built in {took:.2} s: {mb} MiB, a stack of {depth}, cost {cost:.1}");
}
