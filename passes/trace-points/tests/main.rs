//! Where rays end, and how their directions are distributed.

use glam::{DVec3, Vec3};
use interfaces::surface_points::{SurfacePoint, SurfacePointsHeader};
use pass_test::random::{hash2, unit_float};
use pass_test::statistics::assert_follows;
use pass_test::{Harness, scene, soup};
use ray_tracing::Bvh;
use scene::Scene;
use std::collections::HashSet;
use std::f64::consts::TAU;
use trace_points::PASS;

type Points = (SurfacePointsHeader, Vec<SurfacePoint>);

fn run(harness: Harness<'_>) -> Option<Points> {
    Some(harness.run()?.surface_points("traced"))
}

fn position(scene: &Scene, triangle: u32, [u, v]: [f32; 2]) -> Vec3 {
    let corner = |k| Vec3::from(scene.vertices[scene.indices[3 * triangle as usize + k] as usize].position);
    corner(0) + (corner(1) - corner(0)) * u + (corner(2) - corner(0)) * v
}

/// Points all over the surfaces of a scene, on either side.
fn all_over(scene: &Scene, count: u32) -> Vec<SurfacePoint> {
    let random = |i: u32, dimension: u32| unit_float(hash2(i, dimension)) as f32;
    let point = |i: u32| {
        let triangle = i % scene.triangles() as u32;
        let (a, b) = (random(i, 0), random(i, 1));
        let at = if a + b > 1.0 { [1.0 - a, 1.0 - b] } else { [a, b] };
        let corner = |u, v| position(scene, triangle, [u, v]);
        let origin = corner(0.0, 0.0);
        let normal = (corner(1.0, 0.0) - origin).cross(corner(0.0, 1.0) - origin).normalize();
        let side = if hash2(i, 2).is_multiple_of(2) { normal } else { -normal };
        SurfacePoint {
            position: corner(at[0], at[1]).to_array(),
            triangle,
            normal: side.to_array(),
            seed: i,
            barycentrics: at,
            ..SurfacePoint::default()
        }
    };
    (0..count).map(point).collect()
}

pass_test::shaders_are_valid!(PASS);

#[test]
fn rays_end_at_the_first_surface() {
    let scene = scene("cornell-box");
    let positions: Vec<[f32; 3]> = scene.vertices.iter().map(|vertex| vertex.position).collect();
    let bvh = Bvh::build(&positions, &scene.indices);
    let origins = all_over(&scene, 1500);
    for directions in ["cosine", "uniform"] {
        let harness = Harness::new(PASS).scene("cornell-box").set("directions", directions);
        let Some((header, traced)) = run(harness.surface_points("points", 4, &origins)) else { return };
        assert_eq!((header.count, header.iteration), (1500, 4), "{directions}");
        let mut hits = 0;
        for (from, to) in std::iter::zip(&origins, &traced).filter(|(_, to)| !to.is_none()) {
            hits += 1;
            let (at, normal) = (Vec3::from(to.position), Vec3::from(to.normal));
            assert!(at.distance(position(&scene, to.triangle, to.barycentrics)) < 1e-6, "{to:?}");
            let way = at - Vec3::from(from.position);
            assert!(
                way.dot(Vec3::from(from.normal)) > -1e-4 * way.length(),
                "below the surface: {from:?} {to:?}"
            );
            assert!(way.dot(normal) < 1e-4 * way.length(), "from the other side: {from:?} {to:?}");
            let origin = Vec3::from(from.position) + Vec3::from(from.normal) * 1e-5;
            // In a corner the way is no longer than rays are moved off their surface.
            let is_between = way.length() > 1e-4 && bvh.occluded(origin, at - origin, 1e-4, 0.999);
            assert!(!is_between, "something is between {from:?} {to:?}");
        }
        assert!(hits > 800, "{hits} of 1500");
        let seeds: HashSet<u32> = traced.iter().filter(|to| !to.is_none()).map(|to| to.seed).collect();
        assert_eq!(seeds.len(), hits, "points share seeds");
        assert!(seeds.iter().all(|seed| *seed >= 1500), "a point has the seed of an origin");
    }
}

/// A closed cube of 2 m about the origin.
fn cube() -> Scene {
    let mut corners = Vec::new();
    for axis in 0..3 {
        for side in [-1.0f32, 1.0] {
            let corner = |u: f32, v: f32| {
                let mut at = [side; 3];
                (at[(axis + 1) % 3], at[(axis + 2) % 3]) = (u, v);
                at
            };
            corners.extend([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)]);
            corners.extend([corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
        }
    }
    soup(&corners)
}

/// In a cube about the origin, the place where a ray ends is its direction.
#[test]
fn directions_follow_their_distribution() {
    let count = 8192;
    for (n, normal) in
        [[0.0f32, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.48, -0.6, 0.64]].into_iter().enumerate()
    {
        for (directions, mean) in [("cosine", 2.0 / 3.0), ("uniform", 0.5)] {
            let centre = SurfacePoint { normal, ..SurfacePoint::default() };
            let harness = Harness::new(PASS).with_scene(cube()).set("directions", directions);
            let harness = harness.surface_points("points", n as u32, &vec![centre; count as usize]);
            let Some((_, traced)) = run(harness) else { return };
            let z = DVec3::from(normal.map(f64::from));
            let x = z.any_orthonormal_vector();
            let (mut cosines, mut rings, mut sectors) = (0.0, [0; 32], [0; 32]);
            for point in &traced {
                assert!(!point.is_none(), "the cube is closed");
                let direction = DVec3::from(point.position.map(f64::from)).normalize();
                let cosine = direction.dot(z).clamp(0.0, 1.0);
                let angle = direction.dot(z.cross(x)).atan2(direction.dot(x)).rem_euclid(TAU) / TAU;
                // Each ring has the same share.
                let share = if directions == "cosine" { cosine * cosine } else { cosine };
                cosines += cosine;
                rings[((share * 32.0) as usize).min(31)] += 1;
                sectors[((angle * 32.0) as usize).min(31)] += 1;
            }
            let found = cosines / f64::from(count);
            // Far below the spread of independent directions, which is 0.003: they are stratified.
            assert!((found - mean).abs() < 1e-3, "{directions} about {normal:?}: mean cosine {found}");
            let expected = [f64::from(count) / 32.0; 32];
            assert_follows(&rings, &expected);
            assert_follows(&sectors, &expected);
        }
    }
}

#[test]
fn rays_that_meet_nothing_give_no_point() {
    let floor = soup(&[[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 0.0, 2.0]]);
    let up = SurfacePoint { normal: [0.0, 1.0, 0.0], seed: 7, ..SurfacePoint::default() };
    let below = SurfacePoint { position: [0.0, -0.1, 0.0], ..up };
    let points = [up, SurfacePoint::NONE, below, SurfacePoint { triangle: u32::MAX, ..below }];
    let Some((header, traced)) =
        run(Harness::new(PASS).with_scene(floor).surface_points("points", 0, &points))
    else {
        return;
    };
    assert_eq!(header.count, 4);
    for (i, point) in traced.iter().enumerate() {
        assert_eq!(point.is_none(), i != 2, "{i}: {point:?}");
        assert!(i == 2 || *point == SurfacePoint::NONE, "{i}: {point:?}");
    }
    assert_eq!(traced[2].normal.map(f32::abs), [0.0, 1.0, 0.0]);
    assert!(traced[2].normal[1] < 0.0, "it is reached from below");
}

#[test]
fn every_iteration_has_other_rays() {
    let origins = vec![SurfacePoint { normal: [0.0, 1.0, 0.0], ..SurfacePoint::default() }; 300];
    let at = |iteration: u32, seed: u32| {
        let harness = Harness::new(PASS).with_scene(cube()).seed(seed);
        run(harness.surface_points("points", iteration, &origins))
    };
    let Some(first) = at(0, 0) else { return };
    for other in [at(1, 0).unwrap(), at(0, 1).unwrap()] {
        let same =
            std::iter::zip(&first.1, &other.1).filter(|(a, b)| a.position == b.position || a.seed == b.seed);
        assert_eq!(same.count(), 0);
    }
    assert_eq!(at(0, 0).unwrap(), first);
}
