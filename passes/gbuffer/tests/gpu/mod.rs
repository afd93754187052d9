//! The pass on a GPU, against rays through the same pixels.

use crate::cpu_reference::Camera;
use glam::{DMat3, DVec3, UVec2, dvec2, dvec3, uvec2};
use half::f16;
use pass_test::Harness;
use pass_test::random::hash;
use scene::Scene;

const WIDTH: u32 = 45;
const HEIGHT: u32 = 30;

fn camera(scene: &Scene) -> Camera {
    let tangent = f64::from(scene.camera.vertical_fov * 0.5).tan();
    Camera {
        axes: DMat3::from_mat4(scene.camera.view().inverse().as_dmat4()),
        position: scene.camera.position.as_dvec3(),
        half_extent: dvec2(tangent * f64::from(WIDTH) / f64::from(HEIGHT), tangent),
        size: uvec2(WIDTH, HEIGHT).as_dvec2(),
    }
}

/// What a ray meets.
struct Hit {
    /// Distance along the camera's axis \[m\].
    depth: f64,
    /// Geometric, on the camera's side.
    normal: DVec3,
    /// The vertices of the triangle.
    corners: [usize; 3],
    /// The weights of the second and third.
    weights: [f64; 2],
}

/// The surface that a ray through a pixel's centre meets first: distance along the axis, geometric normal on the camera's side,
/// and material.
fn trace(scene: &Scene, camera: &Camera, pixel: UVec2) -> Option<(f64, DVec3, usize)> {
    let hit = hit(scene, camera, pixel)?;
    Some((hit.depth, hit.normal, scene.vertices[hit.corners[0]].material as usize))
}

fn hit(scene: &Scene, camera: &Camera, pixel: UVec2) -> Option<Hit> {
    let ray = camera.view_ray(pixel.as_dvec2() + 0.5);
    let triangles = scene.indices.chunks_exact(3);
    let hits = triangles.filter_map(|corners| {
        let corners = [0, 1, 2].map(|i| corners[i] as usize);
        let [a, b, c] = corners.map(|i| DVec3::from(scene.vertices[i].position.map(f64::from)));
        let (u, v, from) = (b - a, c - a, camera.position - a);
        let (p, q) = (ray.cross(v), from.cross(u));
        let det = u.dot(p);
        let (x, y, t) = (from.dot(p) / det, ray.dot(q) / det, v.dot(q) / det);
        let normal = u.cross(v).normalize_or_zero();
        let towards = if normal.dot(ray) < 0.0 { normal } else { -normal };
        (det != 0.0 && x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t > f64::from(scene.camera.near))
            .then_some(Hit { depth: t, normal: towards, corners, weights: [x, y] })
    });
    hits.min_by(|a, b| a.depth.total_cmp(&b.depth))
}

struct Seen {
    depth: Vec<f32>,
    normal: Vec<[f16; 4]>,
    albedo: Vec<[f16; 4]>,
}

fn run(scene: &Scene) -> Option<Seen> {
    let outputs = Harness::new(gbuffer::PASS).with_scene(scene.clone()).frame(WIDTH, HEIGHT).run()?;
    let depth = outputs.read("view.depth");
    Some(Seen { depth, normal: outputs.read("view.normal"), albedo: outputs.read("view.albedo") })
}

#[test]
fn a_normal_map_bends_the_normal_for_shading_alone() {
    for angle in [30.0, 75.0] {
        let (mut scene, bent) = pass_test::rooms::bent_plane(angle);
        // From the side away from which the normal is bent: by 75° it turns away from the camera.
        scene.camera = pass_test::rooms::camera_at([-0.5, 0.4, 0.0], [0.0; 3], 0.02);
        let harness = Harness::new(gbuffer::PASS).with_scene(scene).frame(WIDTH, HEIGHT);
        let Some(outputs) = harness.run() else { return };
        let halves = |name: &str| outputs.read::<f16>(name).into_iter().map(f64::from).collect::<Vec<_>>();
        let (normal, albedo) = (halves("view.normal"), halves("view.albedo"));
        for (normal, albedo) in normal.chunks_exact(4).zip(albedo.chunks_exact(4)) {
            assert!(DVec3::from_slice(normal).abs_diff_eq(bent, 2e-3), "{normal:?} for {bent}");
            let seen = if angle < 60.0 { 0.5 } else { 0.0 };
            assert!((albedo[0] - seen).abs() < 1e-3, "{angle}°: {albedo:?}");
        }
        // An octahedron's image of y.
        for at in halves("view.geometric").chunks_exact(2) {
            assert!(at[0].abs() < 1e-3 && (at[1] - 1.0).abs() < 1e-3, "{at:?}");
        }
    }
}

/// Flat-shaded, so that the shading normal is the geometric one.
#[test]
fn it_sees_what_rays_see() {
    for name in ["cornell-box", "plane"] {
        let scene = pass_test::scene(name);
        let Some(seen) = run(&scene) else { return };
        let camera = camera(&scene);
        let mut wrong = 0;
        for i in 0..WIDTH * HEIGHT {
            let found = trace(&scene, &camera, uvec2(i % WIDTH, i / WIDTH));
            let i = i as usize;
            let Some((depth, normal, material)) = found else {
                wrong += u32::from(seen.depth[i] != 0.0);
                continue;
            };
            // Points are to lie on the surface, where rays begin: interpolated depths are off by 10⁻⁴ on some adapters.
            let near = (f64::from(seen.depth[i]) / depth - 1.0).abs() < 3e-6;
            let [x, y, z, _] = seen.normal[i].map(f64::from);
            let facing = dvec3(x, y, z).dot(normal) > 0.999;
            let base = scene.materials[material].base_color.to_array();
            let colored = (0..3).all(|k| (seen.albedo[i][k].to_f32() - base[k]).abs() < 1e-3);
            wrong += u32::from(!(near && facing && colored));
        }
        // An edge may fall to the other side of a pixel's centre.
        assert!(wrong <= WIDTH * HEIGHT / 200, "{name}: {wrong} pixels differ");
    }
}

#[test]
fn winding_changes_nothing() {
    let scene = pass_test::scene("cornell-box");
    let mut turned = scene.clone();
    turned.indices.chunks_exact_mut(3).step_by(2).for_each(|corners| corners.swap(1, 2));
    let mut mirrored = scene.clone();
    mirrored.vertices.iter_mut().for_each(|vertex| vertex.normal = vertex.normal.map(|n| -n));
    let Some(seen) = run(&scene) else { return };
    for other in [turned, mirrored] {
        let Some(again) = run(&other) else { return };
        let differs = |i: &usize| {
            (0..3).any(|k| (seen.normal[*i][k].to_f32() - again.normal[*i][k].to_f32()).abs() > 1e-3)
        };
        let wrong = (0..seen.normal.len()).filter(differs).count();
        assert!(wrong <= seen.normal.len() / 200, "{wrong} normals differ");
    }
}

#[test]
fn members_are_those_of_the_scene() {
    let mut scene = pass_test::scene("cornell-box-lamp");
    // Up at the lamp, which from its own place the camera sees nearly on edge.
    scene.camera.position = glam::vec3(0.278, 0.25, 0.1);
    scene.camera.target = glam::vec3(0.278, 0.548, 0.28);
    // The white walls become half a metal, the green one lacquer; the rest stays dull.
    scene.materials[0].metallic = 0.5;
    scene.materials[2].roughness = 0.25;
    let harness = Harness::new(gbuffer::PASS).with_scene(scene.clone()).frame(WIDTH, HEIGHT);
    let Some(outputs) = harness.set("motion", true).run() else { return };
    let emission: Vec<[f32; 4]> = outputs.read("view.emission");
    let specular: Vec<[f16; 4]> = outputs.read("view.specular");
    let albedo: Vec<[f16; 4]> = outputs.read("view.albedo");
    let motion: Vec<[f32; 2]> = outputs.read("view.motion");
    let camera = camera(&scene);
    let (mut wrong, mut lamp) = (0, 0);
    for i in 0..WIDTH * HEIGHT {
        let found = trace(&scene, &camera, uvec2(i % WIDTH, i / WIDTH));
        let material = found.map(|(_, _, material)| &scene.materials[material]);
        let expected = material.map_or([0.0; 3], |m| m.emission.to_array());
        lamp += u32::from(expected[0] > 0.0);
        let i = i as usize;
        let same = (0..3).all(|k| (emission[i][k] - expected[k]).abs() <= 1e-5 * expected[k].abs());
        let rough = material.is_none_or(|m| {
            let dielectric = if m.roughness < 1.0 { m.specular.x } else { 0.0 };
            let specular_x = dielectric + (m.base_color.x - dielectric) * m.metallic;
            (specular[i][0].to_f32() - specular_x).abs() < 1e-3 && specular[i][3].to_f32() == m.roughness
        });
        // What a metal reflects, it does not scatter.
        let matte = material
            .is_none_or(|m| (albedo[i][0].to_f32() - m.base_color.x * (1.0 - m.metallic)).abs() < 1e-3);
        wrong += u32::from(!same || !rough || !matte);
        // The camera was where it is.
        assert!(motion[i].iter().all(|m| m.abs() < 1e-2), "pixel {i} moved by {:?}", motion[i]);
    }
    assert!(lamp > 5, "the lamp is in the picture");
    assert!(wrong <= WIDTH * HEIGHT / 200, "{wrong} pixels differ");
}

/// The scene with its geometry and its camera of a time \[s\].
fn at(scene: &Scene, time: f32) -> Scene {
    let (mut posed, pose) = (scene.clone(), scene.at(time));
    for moved in &pose.moved {
        let first = moved.first_vertex as usize;
        posed.vertices[first..first + moved.vertices.len()].copy_from_slice(&moved.vertices);
    }
    posed.camera = pose.camera;
    posed
}

/// Against the places of the very points of the triangles in both frames.
#[test]
fn motion_is_that_of_the_surface_and_of_the_camera() {
    for name in ["cornell-box-cloth", "cornell-box-moving"] {
        let scene = pass_test::scene(name);
        let (first, step) = (1.0, 0.125);
        let harness = Harness::new(gbuffer::PASS).with_scene(scene.clone()).frame(WIDTH, HEIGHT);
        let Some(outputs) = harness.set("motion", true).time(first).time_step(step).frames(2).run() else {
            return;
        };
        let motion: Vec<[f32; 2]> = outputs.read("view.motion");
        let (before, now) = (at(&scene, first), at(&scene, first + step));
        let (camera_before, camera_now) = (camera(&before), camera(&now));
        let (mut wrong, mut moves) = (0, 0);
        for i in 0..WIDTH * HEIGHT {
            let pixel = uvec2(i % WIDTH, i / WIDTH);
            let expected = hit(&now, &camera_now, pixel).map_or(glam::DVec2::ZERO, |hit| {
                let [a, b, c] = hit.corners.map(|i| DVec3::from(before.vertices[i].position.map(f64::from)));
                let place = a + (b - a) * hit.weights[0] + (c - a) * hit.weights[1];
                camera_before.project(place).0 - (pixel.as_dvec2() + 0.5)
            });
            let found = dvec2(motion[i as usize][0].into(), motion[i as usize][1].into());
            moves += u32::from(expected.length() > 0.1);
            wrong += u32::from(found.distance(expected) > 0.02 + 0.01 * expected.length());
        }
        assert!(moves > 10, "{name}: {moves} pixels move");
        // An edge may fall to the other side of a pixel's centre.
        assert!(wrong <= WIDTH * HEIGHT / 100, "{name}: {wrong} pixels differ, {moves} move");
    }
}

/// The samples of a frame are the pixels of a larger one: in motion, and with a sky.
#[test]
fn samples_are_the_pixels_of_a_larger_frame() {
    for (name, members) in [
        ("cornell-box-moving", &["depth", "normal", "albedo", "motion"][..]),
        ("atrium-sky", &["depth", "normal", "albedo", "emission"]),
    ] {
        let seen = |samples: u32| {
            let harness = Harness::new(gbuffer::PASS).with_scene(pass_test::scene(name));
            let harness = harness.frame(2 * WIDTH / samples, 2 * HEIGHT / samples);
            let harness = harness.set("supersampling", samples).set("motion", members.contains(&"motion"));
            harness.time(1.0).time_step(0.125).frames(2).run()
        };
        let (Some(large), Some(sampled)) = (seen(1), seen(2)) else { return };
        for member in members {
            let output = format!("view.{member}");
            let (large, sampled): (Vec<u8>, Vec<u8>) = (large.read(&output), sampled.read(&output));
            assert!(large.iter().any(|byte| *byte != 0), "{name}: no {member}");
            assert!(large == sampled, "{name}: {member} differs");
        }
    }
}

#[test]
fn an_empty_scene_is_seen_nowhere() {
    let Some(seen) = run(&pass_test::scene("empty")) else { return };
    assert!(seen.depth.iter().all(|depth| *depth == 0.0));
}

/// Full normals are exact where half ones are not, and all else is the same; in a glossy scene too, which takes another draw.
#[test]
fn full_normals_are_exact() {
    let mut scene = pass_test::scene("cornell-box");
    for (metallic, roughness) in [(0.0, 1.0), (0.5, 0.25)] {
        for material in &mut scene.materials {
            (material.metallic, material.roughness) = (metallic, roughness);
        }
        let run = |normals: &str| {
            let harness = Harness::new(gbuffer::PASS).with_scene(scene.clone()).frame(WIDTH, HEIGHT);
            harness.set("normals", normals).run()
        };
        let Some((half, full)) = run("half").zip(run("full")) else { return };
        for member in ["view.depth", "view.albedo"] {
            assert_eq!(half.read::<u8>(member), full.read::<u8>(member), "{member}");
        }
        if metallic > 0.0 {
            assert_eq!(half.read::<u8>("view.specular"), full.read::<u8>("view.specular"));
        }
        let camera = camera(&scene);
        let normals: Vec<[f32; 4]> = full.read("view.normal");
        let halves: Vec<[f16; 4]> = half.read("view.normal");
        let (mut off, mut half_off) = (0, 0);
        for i in 0..WIDTH * HEIGHT {
            let Some((_, normal, _)) = trace(&scene, &camera, uvec2(i % WIDTH, i / WIDTH)) else { continue };
            let distance = |at: [f64; 4]| dvec3(at[0], at[1], at[2]).distance(normal);
            let i = i as usize;
            let (full, half) = (distance(normals[i].map(f64::from)), distance(halves[i].map(f64::from)));
            // One wall's corners are not in a plane, and their normals no triangle's.
            if half < 2e-3 {
                off += u32::from(full > 1e-5);
                half_off += u32::from(half > 1e-5);
            }
        }
        assert!(off <= WIDTH * HEIGHT / 200, "{off} full normals are off");
        assert!(half_off > WIDTH * HEIGHT / 20, "{half_off} half normals are off: nothing is measured");
    }
}

/// In a frame of one pixel the next pixel lies beyond the horizon of a wall that is seen along.
#[test]
fn normals_face_the_camera_in_frames_of_few_pixels() {
    let mut scene = pass_test::scene("cornell-box");
    scene.camera.vertical_fov = 80f32.to_radians();
    scene.camera.position = glam::vec3(0.3, 0.273, -0.2);
    let mut seen = 0;
    for (x, y) in [(0.02, 0.273), (0.53, 0.273), (0.278, 0.02), (0.278, 0.53)] {
        scene.camera.target = glam::vec3(x, y, 0.3);
        let harness = Harness::new(gbuffer::PASS).with_scene(scene.clone());
        let Some(outputs) = harness.frame(1, 1).set("normals", "full").run() else { return };
        let normal: Vec<[f32; 4]> = outputs.read("view.normal");
        let camera = Camera { size: uvec2(1, 1).as_dvec2(), ..camera(&scene) };
        let half_extent = dvec2(camera.half_extent.y, camera.half_extent.y);
        let camera = Camera { half_extent, ..camera };
        let Some((_, expected, _)) = trace(&scene, &camera, uvec2(0, 0)) else { continue };
        let [x, y, z, _] = normal[0].map(f64::from);
        assert!(dvec3(x, y, z).dot(expected) > 0.99, "{x} {y} {z} in place of {expected}");
        seen += 1;
    }
    assert_eq!(seen, 4);
}

/// A texture scales how metallic and how rough a surface is: green is roughness, and blue metal.
#[test]
fn a_texture_of_metal_scales_the_material() {
    let (mut scene, _) = pass_test::rooms::bent_plane(0.0);
    scene.textures[0].pixels = vec![0, 204, 51, 255];
    let material = &mut scene.materials[0];
    (material.normal_texture, material.metallic_roughness_texture) = (None, Some(0));
    (material.metallic, material.roughness) = (0.5, 0.75);
    let base = material.base_color.x;
    scene.camera = pass_test::rooms::camera_at([0.0, 0.5, 0.0], [0.0; 3], 0.5);
    let harness = Harness::new(gbuffer::PASS).with_scene(scene).frame(8, 8);
    let Some(outputs) = harness.run() else { return };
    let metal = 0.5 * 51.0 / 255.0;
    for albedo in outputs.read::<[f16; 4]>("view.albedo") {
        assert!((albedo[0].to_f32() - base * (1.0 - metal)).abs() < 1e-3, "{albedo:?}");
    }
    for specular in outputs.read::<[f16; 4]>("view.specular") {
        assert!((specular[3].to_f32() - 0.75 * 204.0 / 255.0).abs() < 1e-3, "{specular:?}");
    }
}

/// Stripes that are finer than pixels have their mean in every pixel, also where the footprint is narrow across them.
#[test]
fn fine_stripes_are_filtered_along_either_axis() {
    for across in [false, true] {
        let (mut scene, _) = pass_test::rooms::bent_plane(0.0);
        let along = |i: u32| if across { i % 256 } else { i / 256 };
        // The middles of pixels lie in the middles of black stripes.
        let stripe = |i| if (along(i) + 2) % 8 < 4 { [255; 4] } else { [0, 0, 0, 255] };
        let texture = &mut scene.textures[0];
        (texture.width, texture.height) = (256, 256);
        (texture.pixels, texture.encoding) =
            ((0..256 * 256).flat_map(stripe).collect(), scene::Encoding::Srgb);
        for vertex in &mut scene.vertices {
            vertex.uv[usize::from(across)] = 0.5;
        }
        let material = &mut scene.materials[0];
        (material.normal_texture, material.base_color_texture) = (None, Some(0));
        let mean = 0.5 * material.base_color.x;
        // A pixel sees eight rows of the 256 on 2 m.
        scene.camera = pass_test::rooms::camera_at([0.0, 2.0, 0.0], [0.0; 3], 2.0 * 0.25f32.atan());
        let Some(outputs) = Harness::new(gbuffer::PASS).with_scene(scene).frame(16, 16).run() else { return };
        for (i, albedo) in outputs.read::<[f16; 4]>("view.albedo").into_iter().enumerate() {
            let found = albedo[0].to_f32();
            assert!((found - mean).abs() < 0.1 * mean, "pixel {i}, across {across}: {found} for {mean}");
        }
    }
}

/// Of strips of which three in ten are there, at random and finer than pixels, three in ten pixels see one, with its whole color: their
/// mean is below the cutoff.
#[test]
fn fine_masks_leave_what_is_there() {
    let (mut scene, _) = pass_test::rooms::bent_plane(0.0);
    let strip = |i: u32| if hash(i / 4096 * 512 + i % 512) % 10 < 3 { [255; 4] } else { [0; 4] };
    let texture = &mut scene.textures[0];
    (texture.width, texture.height, texture.encoding) = (512, 512, scene::Encoding::Srgb);
    texture.pixels = (0..512 * 512).flat_map(strip).collect();
    let there = (0..512 * 512).filter(|i| strip(*i)[3] > 0).count() as f64 / f64::from(512 * 512);
    let material = &mut scene.materials[0];
    (material.normal_texture, material.base_color_texture) = (None, Some(0));
    material.alpha_cutoff = Some(0.5);
    let whole = material.base_color.x;
    // Some five of the 512 texels on 2 m are in a pixel, at another place in each.
    scene.camera = pass_test::rooms::camera_at([0.0, 2.0, 0.0], [0.3, 0.0, 0.1], 2.0 * 0.3f32.atan());
    let Some(outputs) = Harness::new(gbuffer::PASS).with_scene(scene).frame(64, 64).run() else { return };
    let depths: Vec<f32> = outputs.read("view.depth");
    let seen = depths.iter().filter(|depth| **depth > 0.0).count() as f64 / depths.len() as f64;
    assert!((seen / there - 1.0).abs() < 0.1, "{seen} for {there}");
    for (albedo, depth) in outputs.read::<[f16; 4]>("view.albedo").into_iter().zip(depths) {
        let expected = if depth > 0.0 { whole } else { 0.0 };
        assert!((albedo[0].to_f32() - expected).abs() < 0.03 * whole, "{albedo:?} for {expected}");
    }
}
