//! Paths against closed forms, and against quadrature where there is none.

mod emitters;
mod glossy;

use pass_test::rooms::{self, floor_and_wall, furnace};
use pass_test::statistics::spread;
use pass_test::{Harness, Outputs, scene};
use std::f64::consts::PI;

#[test]
fn every_variant_is_valid() {
    pass_test::assert_shaders_are_valid(path_tracer::PASS);
}

fn pixels(outputs: &Outputs, name: &str) -> Vec<[f32; 4]> {
    outputs.read(name)
}

/// In a closed room of uniform surfaces that emit E and reflect ρ, every direction brings E · Σ ρᵏ: samples are exact.
#[test]
fn a_furnace_is_even() {
    let (emitted, albedo) = ([0.5, 0.25, 1.0], [0.2, 0.5, 0.8]);
    let bounces = 6;
    let harness = Harness::new(path_tracer::PASS).with_scene(furnace(emitted, albedo)).frame(24, 16);
    let Some(outputs) = harness.set("bounces", bounces).set("samples_per_frame", 6u32).run() else { return };
    let series = |c: usize, terms: std::ops::RangeInclusive<u32>| -> f64 {
        terms.map(|k| emitted[c] * albedo[c].powi(k as i32)).sum()
    };
    let expected = |name: &str, c: usize| match name {
        "image" => series(c, 0..=bounces + 1),
        "direct" => series(c, 1..=1),
        "indirect" => series(c, 2..=bounces + 1),
        _ => PI * series(c, 1..=bounces),
    };
    for name in ["image", "direct", "indirect", "irradiance"] {
        for pixel in pixels(&outputs, name) {
            for (c, found) in pixel[..3].iter().enumerate() {
                let (found, expected) = (f64::from(*found), expected(name, c));
                assert!((found / expected - 1.0).abs() < 2e-5, "{name}: {found}, expected {expected}");
            }
        }
    }
    let progress: Vec<u32> = outputs.read("samples.progress");
    assert_eq!((progress[0], progress[1], progress[3]), (6, 1024, 0));
    // Every sample is the same, so there is no spread but that of rounding: of the mean of squares, less the mean squared.
    assert!(f32::from_bits(progress[2]) < f32::EPSILON, "{}", f32::from_bits(progress[2]));
}

/// Under the spot the irradiance is 1 W/m², and the albedo is ½ (scenes/plane.ron).
#[test]
fn a_patch_under_a_spot() {
    let camera = rooms::camera_at([0.0, 0.5, 0.0], [0.0; 3], 1e-3);
    let harness = Harness::new(path_tracer::PASS).with_scene(scene("plane")).camera(camera).frame(4, 4);
    let Some(outputs) = harness.set("samples_per_frame", 1u32).run() else { return };
    for pixel in pixels(&outputs, "direct") {
        assert!((f64::from(pixel[0]) * PI / 0.5 - 1.0).abs() < 1e-4, "{pixel:?}");
        assert_eq!(pixel[3], 1.0);
    }
    // A plane alone sees nothing of itself.
    assert!(pixels(&outputs, "indirect").iter().all(|pixel| pixel[..3] == [0.0; 3]));
}

/// A normal map lights by the cosine of the bent normal; no light arrives from behind the surface, whatever the normal, and none
/// is reflected to where the bent normal turns away (as Mitsuba's `normalmap` has it).
#[test]
fn a_normal_map_lights_and_hides() {
    for angle in [0.0, 30.0, 75.0] {
        let (mut scene, bent) = rooms::bent_plane(angle);
        for (travels, eye) in [
            ([0.0, -1.0, 0.0], [0.0, 0.5, 0.0]),
            ([0.0, -1.0, 0.0], [-0.5, 0.2, 0.0]),
            ([0.0, -1.0, 0.0], [0.5, 0.2, 0.0]),
            ([-0.6, -0.8, 0.0], [0.0, 0.5, 0.1]),
            ([0.6, -0.8, 0.0], [0.0, 0.5, 0.1]),
            // From below, where a normal that is bent by 75° still faces it.
            ([-0.8, 0.6, 0.0], [0.0, 0.5, 0.1]),
        ] {
            let direction = glam::Vec3::from(travels);
            let kind = scene::LightKind::Directional;
            scene.lights[0] =
                scene::Light { kind, direction, intensity: glam::Vec3::ONE, ..scene.lights[0].clone() };
            let camera = rooms::camera_at(eye, [0.0; 3], 1e-3);
            let harness =
                Harness::new(path_tracer::PASS).with_scene(scene.clone()).camera(camera).frame(4, 4);
            let Some(outputs) = harness.set("samples_per_frame", 1u32).run() else { return };
            let sees = bent.dot(glam::Vec3::from(eye).as_dvec3()) > 0.0 && direction.y < 0.0;
            let lit = if sees { bent.dot(-direction.as_dvec3()).max(0.0) } else { 0.0 };
            for pixel in pixels(&outputs, "direct") {
                let radiance = f64::from(pixel[0]) * PI / 0.5;
                assert!((radiance - lit).abs() < 1e-4, "{angle}° {travels:?} {eye:?}: {radiance} for {lit}");
            }
        }
    }
}

#[test]
fn a_screen_shades() {
    let run = |height: f32| {
        let floor = rooms::quad([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0);
        let screen = rooms::quad([-0.5, height, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0);
        let mut scene = rooms::room(&[floor, screen], vec![rooms::matte([0.5; 3], [0.0; 3])]);
        scene.lights[0].intensity = glam::Vec3::ONE;
        // Below the screen in either case.
        let camera = rooms::camera_at([0.3, 0.2, 0.0], [0.0; 3], 1e-3);
        let harness = Harness::new(path_tracer::PASS).with_scene(scene).camera(camera).frame(4, 4);
        let outputs = harness.set("samples_per_frame", 1u32).run()?;
        Some(spread(pixels(&outputs, "direct").iter().map(|pixel| pixel[0])).0)
    };
    // The spot hangs 1 m above the floor: below a screen at 2 m, and above one at half a metre.
    let (Some(lit), Some(shaded)) = (run(2.0), run(0.5)) else { return };
    assert!(lit > 0.1, "{lit}");
    assert_eq!(shaded, 0.0);
}

/// Form factor from a point of the floor to the wall that stands `away` from it, `height` high and `width` wide, with
/// the point before its middle (element to rectangle at right angles: Howell's catalogue, B-4, twice half the width).
fn form_factor(away: f64, height: f64, width: f64) -> f64 {
    let (x, y) = (height / (width / 2.0), away / (width / 2.0));
    let far = (x * x + y * y).sqrt();
    2.0 / (2.0 * PI) * ((1.0 / y).atan() - y / far * (1.0 / far).atan())
}

/// The same by quadrature, with the geometry term bounded at `closest`.
fn clamped_form_factor(away: f64, height: f64, width: f64, closest: f64) -> f64 {
    let steps = 400;
    let (dy, dz) = (height / f64::from(steps), width / f64::from(steps));
    let mut sum = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            let (y, z) = ((f64::from(i) + 0.5) * dy, (f64::from(j) + 0.5) * dz - width / 2.0);
            let distance2 = away * away + y * y + z * z;
            sum += y * away / distance2 / (PI * distance2.max(closest * closest)) * dy * dz;
        }
    }
    sum
}

/// A wall under a sun that grazes the floor, which sees the wall alone.
fn irradiance_of_floor(away: f32, clamp: f32) -> Option<[(f64, f64); 2]> {
    let camera = rooms::camera_at([away, 0.5, 0.0], [away, 0.0, 0.0], 1e-3);
    let harness = Harness::new(path_tracer::PASS).with_scene(floor_and_wall()).camera(camera).frame(64, 64);
    let outputs = harness
        .set("bounces", 1u32)
        .set("samples_per_frame", 32u32)
        .set("clamp", clamp)
        .set("filter", "centre")
        .run()?;
    let irradiance = pixels(&outputs, "irradiance");
    assert!(pixels(&outputs, "direct").iter().all(|pixel| pixel[0] == 0.0), "the sun grazes the floor");
    Some([spread(irradiance.iter().map(|p| p[0])), spread(irradiance.iter().map(|p| p[3]))])
}

/// The centre of a pixel, or a grid of points in it, as the pixels of larger frames.
#[test]
fn the_points_of_a_pixel_are_the_centres_of_a_larger_frame() {
    let direct = |side: u32, supersampling: u32| {
        let harness = Harness::new(path_tracer::PASS).scene("cornell-box").frame(side, side);
        let harness = harness.set("filter", "centre").set("supersampling", supersampling);
        let outputs = harness.set("bounces", 0u32).set("samples_per_frame", 64u32).run()?;
        Some(pixels(&outputs, "direct"))
    };
    for side in [1, 2, 4] {
        let (Some(found), Some(large)) = (direct(12, side), direct(12 * side, 1)) else { return };
        for (i, pixel) in found.iter().enumerate() {
            let (x, y) = (i as u32 % 12 * side, i as u32 / 12 * side);
            let points =
                (0..side * side).map(|p| large[((y + p / side) * 12 * side + x + p % side) as usize][0]);
            let expected = points.sum::<f32>() / (side * side) as f32;
            assert!((pixel[0] - expected).abs() <= 1e-4 * expected, "{side}² points at {i}: {pixel:?}");
        }
    }
}

#[test]
fn a_floor_sees_a_wall_by_its_form_factor() {
    // Radiosity of the wall: 2 W/m² · 0.6.
    let radiosity = 1.2;
    assert!((form_factor(0.4, 1.0, 1.0) / clamped_form_factor(0.4, 1.0, 1.0, 0.0) - 1.0).abs() < 1e-4);
    for away in [0.1_f32, 0.4, 0.9] {
        let Some([(mean, deviation), _]) = irradiance_of_floor(away, 0.0) else { return };
        let expected = radiosity * form_factor(f64::from(away), 1.0, 1.0);
        assert!(
            (mean - expected).abs() < 4.0 * deviation,
            "{away}: {mean} ± {deviation}, expected {expected}"
        );
        assert!(deviation < 0.005 * expected, "{away}: ± {deviation} of {expected}");
    }
}

#[test]
fn the_clamp_bounds_the_first_segment() {
    // The extent of the scene that the room is built on is that of `plane`.
    let extent = 8f64.sqrt();
    let (away, clamp) = (0.1, 0.1);
    let Some([(mean, deviation), (removed, of_removed)]) = irradiance_of_floor(away as f32, clamp as f32)
    else {
        return;
    };
    let whole = 1.2 * form_factor(away, 1.0, 1.0);
    let expected = 1.2 * clamped_form_factor(away, 1.0, 1.0, clamp * extent);
    assert!(expected < 0.8 * whole, "the clamp does something here: {expected} of {whole}");
    assert!((mean - expected).abs() < 4.0 * deviation, "{mean} ± {deviation}, expected {expected}");
    assert!((removed - (whole - expected)).abs() < 4.0 * of_removed, "{removed} of {whole} − {expected}");
}

#[test]
fn a_seed_is_a_picture() {
    let run = |seed: u32| {
        let harness = Harness::new(path_tracer::PASS).scene("cornell-box").frame(16, 16);
        let outputs = harness.seed(seed).set("samples_per_frame", 2u32).run()?;
        Some(pixels(&outputs, "image"))
    };
    let (Some(one), Some(again), Some(other)) = (run(1), run(1), run(2)) else { return };
    assert_eq!(one, again);
    assert_ne!(one, other);
}

/// The adapter's ray queries find the same hits, up to their rounding.
#[test]
fn queries_give_the_same_picture() {
    if !pass_test::gpu().is_some_and(|gpu| gpu.has_ray_queries()) {
        eprintln!("skipped: the adapter has no ray queries");
        return;
    }
    let run = |rays: &str| {
        let harness = Harness::new(path_tracer::PASS).scene("cornell-box").frame(16, 16);
        let outputs = harness.set("rays", rays).set("samples_per_frame", 16u32).run()?;
        Some(pixels(&outputs, "image"))
    };
    let (Some(bvh), Some(query)) = (run("bvh"), run("query")) else { return };
    let apart = |(a, b): (&[f32; 4], &[f32; 4])| (a[0] - b[0]).abs() > 1e-3 * (a[0] + b[0]);
    // Where an edge is hit or missed by a rounding, a path goes another way.
    let different = bvh.iter().zip(&query).filter(|pair| apart(*pair)).count();
    assert!(different <= 4, "{different} of 256 pixels differ");
}

/// Light passes where a mask cuts a hole in a quad: half of the wall's texture is transparent.
#[test]
fn masked_surfaces_let_light_through() {
    let run = |masked: bool| {
        let mut scene = floor_and_wall();
        if masked {
            scene.materials[1].alpha_cutoff = Some(0.5);
            scene.materials[1].base_color.w = 0.25;
        }
        let camera = rooms::camera_at([0.4, 0.5, 0.0], [0.4, 0.0, 0.0], 1e-3);
        let harness = Harness::new(path_tracer::PASS).with_scene(scene).camera(camera).frame(4, 4);
        let outputs = harness.set("samples_per_frame", 8u32).run()?;
        Some(spread(pixels(&outputs, "indirect").iter().map(|p| p[0])).0)
    };
    let (Some(whole), Some(cut)) = (run(false), run(true)) else { return };
    assert!(whole > 0.0);
    assert_eq!(cut, 0.0, "a wall of too little alpha is not there");
}

/// Runs frames of so many samples of the Cornell box.
fn frames_of(size: (u32, u32), frames: u32, samples: u32) -> Option<Outputs> {
    let harness = Harness::new(path_tracer::PASS).scene("cornell-box").frame(size.0, size.1);
    let harness = harness.set("samples", 1u32 << 16).set("samples_per_frame", samples);
    harness.feedback("past", "samples").frames(frames).run()
}

fn luminances(outputs: &Outputs) -> Vec<f64> {
    let luminance = |pixel: &[f32; 4]| {
        let [r, g, b] = [pixel[0], pixel[1], pixel[2]].map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    pixels(outputs, "samples.image").iter().map(luminance).collect()
}

/// What the pass says of its error.
fn estimate(outputs: &Outputs) -> f64 {
    let progress: Vec<u32> = outputs.read("samples.progress");
    f64::from(f32::from_bits(progress[2]))
}

/// The estimate of the error follows from the means: the square of what they have moved by since samples were half as many, over the
/// squared median of both halves and of the pixels around. It falls as samples grow until they have doubled again.
#[test]
fn the_error_is_that_of_the_halves() {
    let size = (24, 18);
    let place = |i: usize| ((i as u32 % size.0) as i32, (i as u32 / size.0) as i32);
    let Some(half) = frames_of(size, 8, 4) else { return };
    assert!(estimate(&half) < 0.0, "32 samples are too few");
    let half = luminances(&half);
    let mut known = 0;
    for (frames, samples) in [(8, 8), (16, 4), (24, 4)] {
        let outputs = frames_of(size, frames, samples).expect("the adapter is still there");
        let whole = luminances(&frames_of(size, 64 / samples, samples).expect("the adapter is still there"));
        let mean = whole.iter().sum::<f64>() / whole.len() as f64;
        let around = |i: usize| {
            let near = |j: &usize| {
                let ((x, y), (u, v)) = (place(i), place(*j));
                *j != i && (x - u).abs() <= 1 && (y - v).abs() <= 1
            };
            let near: Vec<f64> = (0..whole.len()).filter(near).map(|j| whole[j]).collect();
            near.iter().sum::<f64>() / near.len() as f64
        };
        let of_pixel = |i: usize| {
            let mut means = [half[i], 2.0 * whole[i] - half[i], around(i)].map(|of| of / mean);
            means.sort_by(f64::total_cmp);
            ((whole[i] - half[i]) / mean).powi(2) / (means[1].powi(2) + 0.01)
        };
        let errors: Vec<f64> = (0..whole.len()).map(of_pixel).collect();
        let sum = errors.iter().sum::<f64>();
        let scatter = errors.iter().map(|error| error * error).sum::<f64>().sqrt() / sum;
        let of_64 = if scatter <= 0.25 { sum / errors.len() as f64 } else { -1.0 };
        let wanted = of_64 * 64.0 / f64::from(frames * samples);
        let found = estimate(&outputs);
        assert!((found / wanted - 1.0).abs() < 1e-2, "{frames} × {samples}: {found} for {wanted}, {scatter}");
        known += u32::from(wanted > 0.0);
    }
    assert!(known > 0, "some of it is known");
    // Of two pixels one has most of it.
    let few = frames_of((2, 1), 16, 4).expect("the adapter is still there");
    assert!(estimate(&few) < 0.0, "{}", estimate(&few));
    assert_eq!(
        estimate(&frames_of(size, 1, 4).expect("the adapter is still there")),
        0.0,
        "there is no half yet"
    );
}

/// Each quarter of a plane has the color of its quarter of the texture: u grows along x, and v against z.
#[test]
fn textures_lie_where_they_should() {
    let (mut scene, _) = rooms::bent_plane(0.0);
    let texture = &mut scene.textures[0];
    (texture.width, texture.height) = (2, 2);
    // At 0.6 m from the middle a tenth of the neighbour is mixed in.
    let quarters = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 0, 255]];
    texture.pixels = quarters.concat();
    let material = &mut scene.materials[0];
    (material.normal_texture, material.base_color_texture) = (None, Some(0));
    material.base_color = glam::Vec4::ONE;
    let direction = glam::Vec3::NEG_Y;
    let kind = scene::LightKind::Directional;
    scene.lights[0] = scene::Light { kind, direction, intensity: glam::Vec3::ONE, ..scene.lights[0].clone() };
    let places = [([-0.6, -0.5], 2), ([0.6, -0.5], 3), ([-0.6, 0.5], 0), ([0.6, 0.5], 1)];
    for (place, quarter, is_turned) in
        places.into_iter().flat_map(|(at, q)| [(at, q, false), (at, 3 - q, true)])
    {
        let [x, z] = place;
        let mut scene = scene.clone();
        if is_turned {
            for vertex in &mut scene.vertices {
                vertex.uv = vertex.uv.map(|x| 1.0 - x);
            }
        }
        let camera = rooms::camera_at([x, 0.2, z], [x, 0.0, z], 1e-3);
        let harness = Harness::new(path_tracer::PASS).with_scene(scene).camera(camera).frame(2, 2);
        let Some(outputs) = harness.set("samples_per_frame", 1u32).run() else { return };
        for pixel in pixels(&outputs, "direct") {
            for channel in 0..3 {
                let albedo = f64::from(pixel[channel]) * PI;
                let wanted = f64::from(quarters[quarter][channel]) / 255.0;
                assert!((albedo - wanted).abs() < 0.15, "{place:?}: {pixel:?} for {:?}", quarters[quarter]);
            }
        }
    }
}

/// In a scene where something else is glossy a matte surface stays Lambertian, also where it is seen and lit on edge.
#[test]
fn a_matte_surface_is_lambertian_among_glossy_ones() {
    let mut scene = scene("plane");
    let direction = glam::Vec3::new(0.98, -0.2, 0.0).normalize();
    let kind = scene::LightKind::Directional;
    scene.lights[0] = scene::Light { kind, direction, intensity: glam::Vec3::ONE, ..scene.lights[0].clone() };
    let camera = rooms::camera_at([0.98, 0.2, 0.0], [0.0; 3], 1e-3);
    let harness = Harness::new(path_tracer::PASS).with_scene(scene).camera(camera).frame(2, 2);
    let harness = harness.scene_trait("glossy", true).set("samples_per_frame", 1u32);
    let Some(outputs) = harness.run() else { return };
    let lit = f64::from(-direction.y);
    for pixel in pixels(&outputs, "direct") {
        let irradiance = f64::from(pixel[0]) * PI / 0.5;
        assert!((irradiance / lit - 1.0).abs() < 1e-4, "{irradiance} for {lit}");
    }
}
