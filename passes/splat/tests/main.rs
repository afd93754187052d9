//! Splats against closed forms.

mod cpu_reference;
mod filling;
mod traced;

use cpu_reference::{Shape, map, splat};
use glam::{DVec3, dvec3, uvec2};
use gpu_algorithms::reference::paraboloid::{
    direction_from_paraboloid, frame_from_normal, paraboloid_density, paraboloid_from_direction, texel_area,
    texel_centre, texel_in_hemisphere,
};
use interfaces::virtual_lights::VirtualLight;
use pass::LARGEST_WINDOW;
use pass_test::{Harness, elements, light_at};
use splat::points_of_map;
use std::f64::consts::PI;

/// Points spread uniformly over the unit sphere, by the golden angle.
fn sphere(count: usize) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |i| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let (sin, cos) = (i as f64 * PI * (3.0 - 5f64.sqrt())).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        dvec3(radius * cos, radius * sin, z)
    })
}

const AXES: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

#[test]
fn frames_are_orthonormal_and_right_handed() {
    for normal in sphere(5_000).chain(AXES) {
        let frame = frame_from_normal(normal);
        let (x, y, z) = (frame.x_axis, frame.y_axis, frame.z_axis);
        assert_eq!(z, normal, "z is the normal");
        for (a, b, wanted) in [(x, x, 1.0), (y, y, 1.0), (x, y, 0.0), (x, z, 0.0), (y, z, 0.0)] {
            assert!((a.dot(b) - wanted).abs() < 1e-12, "frame of {normal:?}");
        }
        assert!(x.cross(y).dot(z) > 0.999, "frame of {normal:?} is right-handed");
    }
}

#[test]
fn the_map_and_its_inverse_cancel() {
    for direction in sphere(5_000).filter(|direction| direction.z >= 0.0) {
        let at = paraboloid_from_direction(direction);
        assert!(at.length_squared() <= 1.0 + 1e-12, "the hemisphere is the disc");
        let back = direction_from_paraboloid(at);
        assert!(back.abs_diff_eq(direction, 1e-12), "{direction:?}");
    }
}

#[test]
fn solid_angles_of_the_texels_sum_to_the_hemisphere() {
    // The error is that of covering a disc with squares: it falls faster than the side of a texel.
    for (tile, error) in [(64, 0.02), (512, 0.001)] {
        let centres = (0..tile * tile).map(|i| texel_centre(uvec2(i % tile, i / tile), tile));
        let sum: f64 = centres
            .filter(|at| at.length_squared() < 1.0)
            .map(|at| paraboloid_density(at) * texel_area(tile))
            .sum();
        assert!((sum - 2.0 * PI).abs() < error, "{sum} for tiles of {tile}");
    }
}

#[test]
fn a_map_of_one_texel_looks_along_the_normal() {
    assert_eq!(direction_from_paraboloid(texel_centre(uvec2(0, 0), 1)), UP);
    assert!(texel_in_hemisphere(uvec2(0, 0), 1), "and is looked up");
}

#[test]
fn points_a_map_follow_the_papers_guideline() {
    // ISM §5.2: P ≈ ¼ N_res N_vpl for all maps, with N_res the texels of the hemisphere, which are counted here.
    for tile in [64, 128, 256] {
        let centres = (0..tile * tile).map(|i| texel_centre(uvec2(i % tile, i / tile), tile));
        let texels = centres.filter(|at| at.length_squared() < 1.0).count() as f64;
        let points = f64::from(points_of_map(tile, 0.25));
        // The counted disc is one of whole texels: by Gauss's circle problem it is off by a fraction of its edge.
        assert!((points - 0.25 * texels).abs() < 0.01 * points, "{points} for {texels} texels");
    }
    assert_eq!((points_of_map(64, 0.25), points_of_map(64, 1.0)), (804, 3217));
    assert_eq!((points_of_map(1, 0.25), points_of_map(64, 0.0)), (1, 1), "a map has a point");
}

fn shape(tile: u32, area: f64) -> Shape {
    Shape { tile, area, extent: 10.0, splat_scale: 1.0, max_splat: 1e9 }
}

/// The module of points that lie in a buffer.
const STORED: &str = "shaders/points-stored.wgsl";

const UP: DVec3 = DVec3::Z;

#[test]
fn a_splat_has_the_solid_angle_of_its_patch() {
    let shape = shape(256, 0.5);
    for direction in sphere(2_000).filter(|direction| direction.z > 0.05) {
        // A patch that faces the light at 3 m, and one tilted by 60°.
        let tilted = 0.5 * direction + 0.75f64.sqrt() * frame_from_normal(direction).x_axis;
        for (normal, facing) in [(direction, 1.0), (tilted, 0.5)] {
            let splat = splat(direction * 3.0, normal, DVec3::ZERO, UP, &shape).expect("it is in front");
            let texel = paraboloid_density(paraboloid_from_direction(direction)) * texel_area(256);
            let wanted = 0.5 * facing / 9.0;
            assert!((splat.side.powi(2) * texel - wanted).abs() < 1e-9 * wanted, "{direction:?}");
            assert!((splat.distance - 3.0).abs() < 1e-12, "{direction:?}");
        }
    }
}

#[test]
fn what_lies_in_the_plane_of_the_light_or_behind_it_is_left_out() {
    let at = |z: f64| splat(dvec3(1.0, 2.0, z), UP, DVec3::ZERO, UP, &shape(64, 0.1));
    assert!(at(0.0).is_none() && at(-1.0).is_none() && at(1e-3).is_none(), "the light's own surface");
    assert!(at(0.1).is_some(), "an occluder");
    assert!(
        splat(DVec3::ZERO, UP, DVec3::ZERO, UP, &shape(64, 0.1)).is_none(),
        "a point on the light itself"
    );
}

#[test]
fn every_splat_covers_a_texel_of_its_own_map() {
    for tile in [1, 2, 3, 64] {
        for direction in sphere(3_000).filter(|direction| direction.z > 0.01) {
            let splat =
                splat(direction, direction, DVec3::ZERO, UP, &shape(tile, 1e-9)).expect("it is in front");
            let (low, high) = splat.texels(tile);
            let covers = low.cmplt(high).all() && high.max_element() <= tile;
            assert!(covers, "{direction:?} in a map of {tile}");
        }
    }
}

#[test]
fn a_sphere_around_the_light_is_at_its_radius_everywhere() {
    let points: Vec<(DVec3, DVec3)> = sphere(6_000).map(|normal| (normal * 2.5, normal)).collect();
    let shape = shape(32, 4.0 * PI * 2.5f64.powi(2) / 6_000.0);
    let depth = map(&points, DVec3::ZERO, dvec3(0.6, 0.0, -0.8), &shape);
    let seen: Vec<f64> = (0..32 * 32)
        .filter(|i| texel_in_hemisphere(uvec2(i % 32, i / 32), 32))
        .map(|i| depth[i as usize])
        .filter(|depth| depth.is_finite())
        .collect();
    assert!(seen.len() as f64 > 0.9 * PI / 4.0 * 1024.0, "{} texels are covered", seen.len());
    assert!(seen.iter().all(|depth| (depth - 2.5).abs() < 1e-9), "a distance is wrong");
}

#[test]
fn the_nearest_of_two_points_is_kept() {
    let points = [4.0, 1.5, 3.0].map(|z| (z * UP, UP));
    let depth = map(&points, DVec3::ZERO, UP, &shape(8, 1e-6));
    assert_eq!(depth.iter().copied().fold(f64::INFINITY, f64::min), 1.5);
}

#[test]
fn the_gpu_agrees_with_the_cpu_reference() {
    // The scene `plane`: 4 m², and a diagonal of √8 m. Two maps of different points, and a third without a light.
    let cloud: Vec<(DVec3, DVec3)> = sphere(900)
        .enumerate()
        .map(|(i, normal)| {
            (normal * (0.3 + 1.7 * (i as f64 * 0.618).fract()), frame_from_normal(normal).col(i % 3))
        })
        .collect();
    let lights: [(DVec3, DVec3); 2] =
        [(dvec3(0.1, -0.2, 0.05), dvec3(0.48, 0.6, 0.64)), (DVec3::ZERO, DVec3::NEG_Z)];
    for (tile, per_map, max_splat) in [(1, 400, 8.0), (3, 400, 2.0), (64, 700, 8.0), (33, 900, 64.0)] {
        let points: Vec<[f32; 8]> =
            cloud.iter().map(|(p, n)| [p.x, p.y, p.z, 0.0, n.x, n.y, n.z, 0.0].map(|x| x as f32)).collect();
        let given = lights.map(|(position, normal)| light_at(position, normal));
        let outputs = Harness::new(splat::PASS)
            .scene("plane")
            .set("kernel", "box")
            .set("candidates", 1)
            .set("map", tile)
            .set("points_per_map", per_map)
            .set("max_splat", max_splat as f32)
            .input("points", "Points", &[("count", 900)], elements(&points))
            .module(STORED)
            .lights(&given)
            .fact("count", 3_u32)
            .run();
        let Some(outputs) = outputs else { return };
        assert_eq!(outputs.read::<u32>("counters")[..2], [3 * per_map, 3 * per_map], "requested and made");
        let depth: Vec<f32> = outputs.read::<u32>("depth").into_iter().map(f32::from_bits).collect();
        let texels = (tile * tile) as usize;
        assert!(
            depth[2 * texels..3 * texels].iter().all(|depth| *depth == f32::INFINITY),
            "no light, no splat"
        );

        let shape =
            Shape { tile, area: 4.0 / f64::from(per_map), extent: 8f64.sqrt(), splat_scale: 1.0, max_splat };
        for (m, (position, normal)) in lights.iter().enumerate() {
            let subset: Vec<(DVec3, DVec3)> =
                (0..per_map as usize).map(|i| cloud[(m * per_map as usize + i) % 900]).collect();
            let wanted = map(&subset, *position, *normal, &shape);
            let differ = (0..texels).filter(|i| {
                let (got, wanted) = (f64::from(depth[m * texels + i]), wanted[*i]);
                got != wanted && (got - wanted).abs() > 1e-5 * wanted
            });
            // The edge of a splat may fall on either side of a texel's centre in single precision.
            assert!(differ.count() * 500 <= texels, "map {m} of {tile}²");
        }
    }
}

#[test]
fn maps_that_are_bound_in_parts_are_splatted_as_in_one() {
    // 130 maps in parts of 64, each with a light of its own.
    let points: Vec<[f32; 8]> = sphere(900)
        .enumerate()
        .map(|(i, n)| (n * (0.3 + 1.7 * (i as f64 * 0.618).fract()), frame_from_normal(n).col(i % 3)))
        .map(|(p, n)| [p.x, p.y, p.z, 0.0, n.x, n.y, n.z, 0.0].map(|x| x as f32))
        .collect();
    let normals: Vec<DVec3> = sphere(130).collect();
    let lights: Vec<VirtualLight> =
        (0..130).map(|i| normals[i * 37 % 130]).map(|normal| light_at(0.1 * normal, normal)).collect();
    let splatted = |window| {
        let outputs = Harness::new(&splat::Splat { window })
            .scene("plane")
            .set("kernel", "box")
            .set("map", 16)
            .set("points_per_map", 50)
            .set("traced", true)
            .input("points", "Points", &[("count", 900)], elements(&points))
            .module(STORED)
            .lights(&lights)
            .run()?;
        Some((outputs.read::<u32>("depth"), outputs.read::<u32>("counters")))
    };
    let Some(whole) = splatted(LARGEST_WINDOW) else { return };
    let last = &whole.0[129 * 256..];
    assert!(last.iter().any(|bits| *bits != f32::INFINITY.to_bits()), "the last map has points");
    assert!(whole == splatted(1).expect("the adapter is still there"), "texels or counters differ");
}

/// Returns where the ray of a texel of a map of 32² meets the plane y = 0, for a light 1 m above it that looks down.
fn on_the_floor(texel: usize) -> DVec3 {
    let (x, y) = (texel as u32 % 32, texel as u32 / 32);
    let direction = direction_from_paraboloid(texel_centre(uvec2(x, y), 32));
    DVec3::Y + frame_from_normal(DVec3::NEG_Y) * direction / direction.z
}

/// Splats points of the scene `plane`, (x, z) and the triangle that each says, into a map of 32² of a light above it; the distances.
fn surfels(scene: scene::Scene, points: &[([f32; 2], u32)]) -> Option<Vec<f64>> {
    surfels_of(&light_at(DVec3::Y, DVec3::NEG_Y), scene, points)
}

/// Points of the scene `plane` as they are stored, (x, z) and the triangle of each.
fn stored(points: &[([f32; 2], u32)]) -> Vec<[u32; 8]> {
    let one = |([x, z], triangle): &([f32; 2], u32)| {
        [x.to_bits(), 0, z.to_bits(), *triangle, 0, 1f32.to_bits(), 0, 0]
    };
    points.iter().map(one).collect()
}

fn surfels_of(light: &VirtualLight, scene: scene::Scene, points: &[([f32; 2], u32)]) -> Option<Vec<f64>> {
    let stored = stored(points);
    let outputs = Harness::new(splat::PASS)
        .with_scene(scene)
        .set("map", 32)
        .set("candidates", 1)
        .set("points_per_map", points.len() as u32)
        .input("points", "Points", &[("count", points.len() as u32)], elements(&stored))
        .module(STORED)
        .lights(&[*light])
        .run()?;
    Some(outputs.read::<u32>("depth").into_iter().map(|bits| f64::from(f32::from_bits(bits))).collect())
}

/// The same disc in the map of a light infinitely far, whose rays are parallel.
#[test]
fn surfels_of_parallel_rays_are_whole() {
    let scene = pass_test::scene("plane");
    // The map is as wide as the sphere around the scene, and it lies beside that sphere.
    let reach = 0.505 * f64::from(scene.extent());
    let sun = VirtualLight { kind: 1, ..light_at(reach * DVec3::Y, DVec3::NEG_Y) };
    let Some(depth) = surfels_of(&sun, scene, &[([0.3, 0.1], 0)]) else { return };
    let mut met = 0;
    for (i, depth) in (0..).zip(depth) {
        let at = reach * texel_centre(uvec2(i % 32, i / 32), 32);
        let off = (frame_from_normal(DVec3::NEG_Y) * at.extend(0.0)).distance(dvec3(0.3, 0.0, 0.1));
        if off < 0.99 {
            assert!((depth - reach).abs() < 1e-5, "texel {i}, {off} m off: {depth} for {reach}");
            met += 1;
        } else if off > 1.01 {
            assert!(depth.is_infinite(), "texel {i}, {off} m off, has {depth}");
        }
    }
    assert!(met > 300, "{met} texels see the disc");
}

#[test]
fn surfels_store_the_distance_of_their_plane() {
    // One point for 4 m²: a disc of radius 1 m, as its triangle has only 2 m².
    let Some(depth) = surfels(pass_test::scene("plane"), &[([0.3, 0.1], 0)]) else { return };
    for (i, depth) in depth.into_iter().enumerate() {
        let at = on_the_floor(i);
        let off = at.distance(dvec3(0.3, 0.0, 0.1));
        let is_front = at.y.abs() < 1e-9 && at.is_finite();
        if is_front && off < 0.99 {
            let wanted = at.distance(DVec3::Y);
            assert!((depth - wanted).abs() < 1e-5 * wanted, "texel {i}: {depth} for {wanted}");
        } else if off > 1.01 {
            assert!(depth.is_infinite(), "texel {i}, {off} m off, has {depth}");
        }
    }
}

/// Returns 64 points in the middles of the cells of a grid over the scene `plane`, with their triangles.
fn grid() -> Vec<([f32; 2], u32)> {
    let scene = pass_test::scene("plane");
    let corner = |i: usize| glam::Vec3::from(scene.vertices[scene.indices[i] as usize].position);
    let inside = |at: glam::Vec3, triangle: usize| {
        let sides = [0, 1, 2].map(|i| {
            let (a, b) = (corner(3 * triangle + i), corner(3 * triangle + (i + 1) % 3));
            (b - a).cross(at - a).y
        });
        sides.iter().all(|side| *side >= 0.0)
    };
    let middle = |i: usize| (i as f32 + 0.5) / 4.0 - 1.0;
    let places = (0..64).map(|i| [middle(i % 8), middle(i / 8)]);
    places.map(|[x, z]| ([x, z], u32::from(!inside(glam::vec3(x, 0.0, z), 0)))).collect()
}

/// A surfel overlaps its neighbours, so none of the surface is lost; but none reaches beyond its triangle.
#[test]
fn surfels_end_with_their_triangles() {
    let Some(depth) = surfels(pass_test::scene("plane"), &grid()) else { return };
    let mut covered = 0;
    for (i, depth) in depth.into_iter().enumerate() {
        let at = on_the_floor(i);
        let (side, wanted) = (at.x.abs().max(at.z.abs()), at.distance(DVec3::Y));
        if side < 0.999
            && direction_from_paraboloid(texel_centre(uvec2(i as u32 % 32, i as u32 / 32), 32)).z > 0.0
        {
            assert!((depth - wanted).abs() < 1e-5 * wanted, "texel {i} at {at}: {depth} for {wanted}");
            covered += 1;
        } else {
            assert!(depth.is_infinite() || side < 1.001, "texel {i} at {at} has {depth}");
        }
    }
    assert!(covered > 150, "{covered} texels see the square");
}

#[test]
fn surfels_are_cut_out_as_their_triangles_are() {
    let Some(depth) = surfels(pass_test::rooms::half_plane(), &grid()) else { return };
    for (i, depth) in depth.into_iter().enumerate() {
        let at = on_the_floor(i);
        if at.x < -0.1 {
            assert!(depth.is_infinite(), "texel {i} at {at} has {depth}");
        } else if at.x > 0.1 && at.x.max(at.z.abs()) < 0.99 && at.y.abs() < 1e-9 {
            assert!(depth.is_finite(), "texel {i} at {at} is empty");
        }
    }
}

/// Half of the points are behind the light: of two candidates, a splat takes the one before it.
#[test]
fn candidates_are_taken_by_the_solid_angle_they_cover() {
    let cloud: Vec<[f32; 8]> = sphere(800)
        .enumerate()
        .map(|(i, n)| (n * (0.5 + 1.5 * (i as f64 * 0.618).fract()), n))
        .map(|(p, n)| [p.x, p.y, p.z, 0.0, n.x, n.y, n.z, 0.0].map(|x| x as f32))
        .collect();
    let covered = |candidates: u32| {
        let outputs = Harness::new(splat::PASS)
            .scene("plane")
            .set("kernel", "box")
            .set("map", 64)
            .set("max_splat", 1.0)
            .set("candidates", candidates)
            .set("points_per_map", 200)
            .input("points", "Points", &[("count", 800)], elements(&cloud))
            .module(STORED)
            .lights(&[light_at(DVec3::ZERO, DVec3::X)])
            .run()?;
        let points = outputs.read::<u32>("counters")[1];
        assert_eq!(points, 200 * candidates);
        let depth: Vec<f64> =
            outputs.read::<u32>("depth").into_iter().map(|bits| f64::from(f32::from_bits(bits))).collect();
        let depth: Vec<f64> = depth.into_iter().filter(|depth| depth.is_finite()).collect();
        Some((depth.len(), depth.iter().sum::<f64>() / depth.len() as f64))
    };
    let (Some(one), Some(four)) = (covered(1), covered(4)) else { return };
    // Of 200 points 100 are before the light; of 200 splats of four candidates, but for 1 in 16.
    assert!((85..=115).contains(&one.0) && (165..=200).contains(&four.0), "{one:?} {four:?}");
    assert!(four.1 < 0.8 * one.1, "splats are nearer: {one:?} {four:?}");
}

/// Points that triangles ask for: 10 over the scene `plane`, whose second triangle has three quarters of them.
fn ten_points() -> [u32; 9] {
    let (requested, step) = (10_u32, (1_u64 << 63) / 10);
    // No guide: the only entry is the first triangle, and the last is the second.
    [requested, 0, (step >> 32) as u32, step as u32, 0, 1 << 29, 1 << 31, 0, 1]
}

#[test]
fn what_is_made_of_what_is_asked_for_is_told() {
    let light = light_at(DVec3::Z, DVec3::NEG_Z);
    // Of 700 a map, a budget of 7 leaves 3.
    for (per_map, budget, made) in [(3, 100, 6), (5, 100, 10), (700, 10_000, 10), (700, 7, 6)] {
        let outputs = Harness::new(splat::PASS)
            .scene("plane")
            .set("map", 8)
            .set("candidates", 1)
            .set("points_per_map", per_map)
            .set("budget", budget)
            .input("points", "Points", &[("count", u32::MAX)], elements(&ten_points()))
            .module("shaders/points-on-the-fly.wgsl")
            .lights(&[light; 2])
            .run();
        let Some(outputs) = outputs else { return };
        assert_eq!(outputs.read::<u32>("counters")[..2], [10, made], "requested and made of {per_map} a map");
    }
}

#[test]
fn without_triangles_the_maps_are_empty() {
    let light = light_at(DVec3::ZERO, DVec3::Z);
    let outputs = Harness::new(splat::PASS)
        .set("map", 8)
        .input("points", "Points", &[("count", 0)], elements(&[0_u32; 8]))
        .module("shaders/points-on-the-fly.wgsl")
        .lights(&[light])
        .run();
    let Some(outputs) = outputs else { return };
    assert!(outputs.read::<u32>("depth").iter().all(|bits| *bits == f32::INFINITY.to_bits()));
}

/// What lookups compare with: a surfel stores what the centre of a texel sees, a box the middle of a splat that is wider than one.
#[test]
fn the_bias_of_lookups_is_that_of_the_kernel() {
    use pass::Value;
    let input = |name: &str, interface: &str, facts: &[(&'static str, Value)], module: Option<&str>| {
        let mut given =
            pass_test::maps(&[""], &pass_test::buffer(1 << 20), facts, module.map(pass::Module::new));
        (given.name, given.interface) = (name.into(), interface.into());
        given
    };
    let facts = |kernel: &str| {
        let settings = [
            ("kernel", kernel.into()),
            ("map", 64_u32.into()),
            ("depth_bias", Value::F32(0.5)),
            ("keep", false.into()),
        ];
        let inputs = [
            input("points", "Points", &[("count", 9_u32.into())], Some(STORED)),
            input("lights", "VirtualLights", &[("count", 4_u32.into())], None),
        ];
        let made =
            pass_test::outputs_of(splat::PASS, &settings, &inputs, &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let depth = made.into_iter().find(|made| made.facts.get("depth_bias").is_some()).expect("maps");
        ["depth_bias", "slope_bias"].map(|name| match depth.facts.get(name) {
            Some(Value::F32(value)) => *value,
            other => panic!("{name}: {other:?}"),
        })
    };
    let near = |found: [f32; 2], wanted: [f32; 2]| {
        assert!(found.into_iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} for {wanted:?}");
    };
    near(facts("surfel"), [0.15, 0.0]);
    near(facts("box"), [0.1, 1.0]);
}

/// Maps take turns in blocks, and a splat chooses among points of its own map: in every map there are as many.
#[test]
fn each_map_of_a_block_chooses_among_its_own_points() {
    let mut points = ten_points();
    points[0] = u32::MAX;
    let maps = 40;
    let outputs = Harness::new(splat::PASS)
        .scene("plane")
        .set("map", 16)
        .set("kernel", "box")
        .set("max_splat", 1.0)
        .set("candidates", 4)
        .set("points_per_map", 60)
        .input("points", "Points", &[("count", u32::MAX), ("block", 32)], elements(&points))
        .module("shaders/points-on-the-fly.wgsl")
        .lights(&vec![light_at(DVec3::Y, DVec3::NEG_Y); maps])
        .run();
    let Some(outputs) = outputs else { return };
    let depth = outputs.read::<u32>("depth");
    let covered = |map: &[u32]| map.iter().filter(|bits| **bits != f32::INFINITY.to_bits()).count();
    let covered: Vec<usize> = depth.chunks(16 * 16).map(covered).collect();
    let (least, most) = (covered.iter().min(), covered.iter().max());
    assert_eq!(covered.len(), maps);
    assert!(least > Some(&25) && most <= Some(&60), "texels covered in each map: {covered:?}");
}
