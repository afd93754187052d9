//! The shader against its CPU reference.

use crate::shared::{Mesh, Random, Ray};
use frame_graph::port::OutputOverride;
use glam::{Vec2, Vec3};
use pass_test::Harness;
use scene::{Encoding, Scene, Texture, Vertex, Wrap};

wgsl_structs::wgsl! {
    "tests/rays.wgsl" {
        struct GivenRay;
        struct FoundHit;
    }
}

/// The ways in which the shader traces rays: by the hierarchy, and by ray queries where the adapter has them.
fn ways() -> Vec<&'static str> {
    let queries = pass_test::gpu().is_some_and(|gpu| gpu.has_ray_queries());
    if !queries {
        eprintln!("skipped: ray queries, which the adapter does not have");
    }
    if queries { vec!["bvh", "query"] } else { vec!["bvh"] }
}

fn follow(scene: &Scene, time: f32, way: &str, rays: &[Ray]) -> Option<Vec<FoundHit>> {
    let given: Vec<GivenRay> = rays
        .iter()
        .map(|ray| GivenRay {
            origin: ray.origin.to_array(),
            nearest: ray.nearest,
            direction: ray.direction.to_array(),
            farthest: ray.farthest,
        })
        .collect();
    let bytes: Vec<u8> = bytemuck::cast_slice(&given).to_vec();
    let out = OutputOverride { count: Some(rays.len() as u32), ..OutputOverride::default() };
    let outputs = Harness::new(compute::PASS)
        .shader("crates/ray-tracing/tests/rays.wgsl")
        .set("rays", way)
        .out("hits", out)
        .input("rays", "Buffer", &[], vec![("", pass_test::buffer(bytes.len() as u64), bytes)])
        .with_scene(scene.clone())
        .time(time)
        .run()?;
    Some(outputs.read("hits"))
}

/// The shader has the hits that the CPU reference has of the mesh, by either way of tracing.
fn assert_agrees(scene: &Scene, time: f32, mesh: &Mesh, rays: &[Ray]) {
    let bvh = mesh.bvh();
    for way in ways() {
        let what = format!("{}, {way}", scene.name);
        let Some(found) = follow(scene, time, way, rays) else { return };
        for (ray, found) in rays.iter().zip(found) {
            let expected = bvh.intersect(ray.origin, ray.direction, ray.nearest, ray.farthest);
            assert_eq!(found.occluded == 1, expected.is_some(), "{what}: any hit of {ray:?}");
            let Some(hit) = expected else {
                assert_eq!(found.triangle, u32::MAX, "{what}: {found:?} of {ray:?}");
                continue;
            };
            // How an adapter rounds places is its own: by some spacings of floats in the scene, a millionth of it. Where a ray
            // grazes a triangle, it meets it so much the farther.
            let [a, b, c] = mesh.triangle(hit.triangle);
            let normal = (b - a).cross(c - a).normalize();
            let spacing = 1e-6 * scene.extent() / ray.direction.dot(normal).abs();
            let error = (found.distance - hit.distance).abs();
            assert!(error < 1e-5 * hit.distance + spacing, "{what}: {found:?} is not {hit:?} of {ray:?}");
            let other = found.triangle != hit.triangle;
            let close = Vec2::from(found.barycentrics).abs_diff_eq(hit.barycentrics, 1e-3);
            assert!(other || close, "{what}: {found:?} is not {hit:?} of {ray:?}");
        }
    }
}

#[test]
fn the_shader_has_the_hits_of_its_cpu_reference() {
    for name in ["cornell-box", "atrium", "nave"] {
        let scene = pass_test::scene(name);
        let rays = Random(8).rays(scene.bounds(), 20_000);
        assert_agrees(&scene, 0.0, &Mesh::of(&scene), &rays);
    }
}

#[test]
fn a_scene_of_none_or_few_triangles_can_be_traced() {
    for name in ["empty", "plane"] {
        let scene = pass_test::scene(name);
        let rays = Random(9).rays((Vec3::NEG_ONE, Vec3::ONE), 500);
        assert_agrees(&scene, 0.0, &Mesh::of(&scene), &rays);
    }
}

#[test]
fn masked_triangles_do_not_count() {
    let mut scene = pass_test::scene("cornell-box");
    // The back wall and its like let everything pass; the right wall nothing.
    let (gone, kept) = (0, scene.materials.len() - 1);
    for (material, alpha) in [(gone, 0.25), (kept, 0.75)] {
        scene.materials[material].alpha_cutoff = Some(0.5);
        scene.materials[material].base_color.w = alpha;
    }
    let mut mesh = Mesh::of(&scene);
    for triangle in mesh.indices.chunks_exact_mut(3) {
        if scene.vertices[triangle[0] as usize].material == gone as u32 {
            triangle.fill(0);
        }
    }
    assert_ne!(mesh.indices, scene.indices);
    let rays = Random(11).rays(scene.bounds(), 20_000);
    assert_agrees(&scene, 0.0, &mesh, &rays);
}

#[test]
fn holes_of_a_texture_do_not_count() {
    // The plane, 2 m wide, with a texture along x: left of the middle nothing, right of it all.
    let mut scene = pass_test::scene("plane");
    let pixels = (0..64 * 64).flat_map(|i| [255, 255, 255, if i % 64 < 32 { 0 } else { 255 }]).collect();
    scene.textures = vec![Texture {
        name: "half".into(),
        width: 64,
        height: 64,
        pixels,
        encoding: Encoding::Srgb,
        wrap: [Wrap::Clamp; 2],
    }];
    scene.materials[0].base_color_texture = Some(0);
    scene.materials[0].alpha_cutoff = Some(0.5);
    scene.vertices.iter_mut().for_each(|v| v.uv = [v.position[0] * 0.5 + 0.5, v.position[2] * 0.5 + 0.5]);
    let mut random = Random(12);
    let places: Vec<Vec3> = (0..4000).map(|_| random.in_cube() * Vec3::new(0.99, 0.0, 0.99)).collect();
    let rays: Vec<Ray> = places
        .iter()
        .map(|place| {
            let origin = *place + Vec3::new(0.3, 1.0, -0.2);
            Ray::new(origin, *place - origin)
        })
        .collect();
    for way in ways() {
        let Some(found) = follow(&scene, 0.0, way, &rays) else { return };
        // Texels are half a texel wide of the edge.
        for (place, found) in places.iter().zip(found).filter(|(place, _)| place.x.abs() > 1.0 / 32.0) {
            assert_eq!(found.triangle != u32::MAX, place.x > 0.0, "{way}: at {place}");
            assert_eq!(found.occluded == 1, place.x > 0.0, "{way}: any hit at {place}");
        }
    }
}

#[test]
fn what_moves_is_hit_where_it_is() {
    let scene = pass_test::scene("cornell-box-moving");
    let time = scene.duration * 0.4;
    let (rest, mut mesh) = (Mesh::of(&scene), Mesh::of(&scene));
    for moved in scene.at(time).moved {
        let places = &mut mesh.positions[moved.first_vertex as usize..];
        places.iter_mut().zip(&moved.vertices).for_each(|(place, vertex)| *place = vertex.position);
    }
    assert_ne!(mesh.positions, rest.positions);
    let rays = Random(13).rays(scene.bounds(), 5000);
    assert_agrees(&scene, time, &mesh, &rays);
}

#[test]
fn ray_queries_are_refused_where_there_are_none() {
    if pass_test::gpu().is_none_or(|gpu| gpu.has_ray_queries()) {
        return eprintln!("skipped: the adapter has ray queries");
    }
    let scene = pass_test::scene("plane");
    let rays = Random(1).rays(scene.bounds(), 1);
    let refused = std::panic::catch_unwind(|| follow(&scene, 0.0, "query", &rays)).err();
    let words = refused.and_then(|words| words.downcast::<String>().ok()).unwrap();
    assert!(words.starts_with("pass compute uses ray queries, which "), "{words}");
}

/// The atrium, larger by a factor.
fn scaled(factor: f32) -> Scene {
    pass_test::scene_from(&format!(
        "Scene(
            about: \"\",
            geometry: Objects([Object(
                name: \"atrium\", geometry: BuiltIn(\"atrium\"),
                transform: Transform(scale: ({factor:?}, {factor:?}, {factor:?})),
            )]),
        )"
    ))
}

#[test]
fn rays_leave_the_surfaces_that_they_start_from() {
    let named = ["nave", "cornell-box"].map(pass_test::scene);
    for scene in named.into_iter().chain([1e-3, 1.0, 1e5].map(scaled)) {
        let rays = Random(10).rays(scene.bounds(), 20_000);
        for way in ways() {
            let Some(found) = follow(&scene, 0.0, way, &rays) else { return };
            for (ray, found) in rays.iter().zip(found) {
                let (name, extent) = (&scene.name, scene.extent());
                assert_eq!(found.leaves, 1, "{name} of {extent} m, {way}: {found:?} of {ray:?}");
            }
        }
    }
}

/// A scene of a mesh.
fn scene_of(mesh: &Mesh) -> Scene {
    let mut scene = pass_test::scene("plane");
    let vertex = |position: &[f32; 3]| Vertex { position: *position, ..scene.vertices[0] };
    scene.vertices = mesh.positions.iter().map(vertex).collect();
    scene.indices.clone_from(&mesh.indices);
    scene.instances[0].vertex_count = scene.vertices.len() as u32;
    scene.instances[0].index_count = scene.indices.len() as u32;
    scene
}

/// The boxes of a flat wall are flat and meet at edges, where the distances at which a ray from far enters one and leaves it
/// differ by rounding alone.
#[test]
fn no_ray_from_far_passes_a_wall_between_its_boxes() {
    const SIDE: u32 = 32;
    let mut wall = Mesh::default();
    for i in 0..(SIDE + 1) * (SIDE + 1) {
        wall.positions.push([(i % (SIDE + 1)) as f32, (i / (SIDE + 1)) as f32, 0.0]);
    }
    for i in 0..SIDE * SIDE {
        let at = |x: u32, y: u32| (i / SIDE + y) * (SIDE + 1) + i % SIDE + x;
        wall.indices.extend([at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)]);
    }
    let mut random = Random(12);
    let side = SIDE as f32;
    let mut ray = |i: u32| {
        let edge = (random.next() * (side - 2.0)).round() + 1.0;
        let along = 0.5 + random.next() * (side - 1.0);
        let target =
            if i.is_multiple_of(2) { Vec3::new(edge, along, 0.0) } else { Vec3::new(along, edge, 0.0) };
        let direction = random.direction();
        let origin = target + direction * Vec3::new(1.0, 1.0, direction.z.signum()) * 1e4;
        Ray::new(origin, target - origin)
    };
    let rays: Vec<Ray> = (0..50_000).map(&mut ray).filter(|ray| ray.direction.z < -1e3).collect();
    for way in ways() {
        let Some(found) = follow(&scene_of(&wall), 0.0, way, &rays) else { return };
        let passed =
            found[..rays.len()].iter().filter(|hit| hit.occluded == 0 || hit.triangle == u32::MAX).count();
        assert_eq!(passed, 0, "{way}: of {} rays", rays.len());
    }
}

#[test]
fn rays_leave_surfaces_far_from_the_origin() {
    for name in ["nave", "cornell-box"] {
        let mut scene = pass_test::scene(name);
        let far = Vec3::new(1e3, -1e3, 1e3) * scene.extent();
        let (low, high) = scene.bounds();
        let mesh = Mesh::of(&scene).map(|position| position + far);
        for (vertex, position) in scene.vertices.iter_mut().zip(&mesh.positions) {
            vertex.position = *position;
        }
        let rays = Random(13).rays((low + far, high + far), 20_000);
        for way in ways() {
            let Some(found) = follow(&scene, 0.0, way, &rays) else { return };
            let (mut hits, mut stay) = (0, 0);
            for hit in found.iter().filter(|hit| hit.triangle != u32::MAX) {
                (hits, stay) = (hits + 1, stay + u32::from(hit.leaves == 0));
            }
            assert!(hits > 5000 && stay == 0, "{name}, {way}: {stay} of {hits} do not leave");
        }
    }
}
