//! Irradiance against closed forms, and the way lights are shared out among sub-images.

mod cpu_reference;

use cpu_reference::{Bound, VirtualLight, geometry, subset};
use glam::{DVec3, Vec3, dvec3};
use pass_test::{Harness, Outputs};
use std::f64::consts::PI;

const EXTENT: f64 = 2.828_427_124_746_19; // of the scene `plane`, a square of 2 m

/// A view of the plane y = 0 from 2 m above it.
struct View {
    width: u32,
    height: u32,
    fov: f32,
}

impl View {
    fn harness(&self, lights: &[VirtualLight]) -> Harness<'static> {
        self.at_depth(lights, 2.0)
    }

    fn at_depth(&self, lights: &[VirtualLight], depth: f32) -> Harness<'static> {
        self.over(lights, move |_, _| depth)
    }

    /// Over surfaces at the depth of each pixel \[m\].
    fn over(&self, lights: &[VirtualLight], depth: impl Fn(u32, u32) -> f32) -> Harness<'static> {
        let camera = scene::Camera {
            position: Vec3::new(0.0, 2.0, 0.0),
            target: Vec3::ZERO,
            up: Vec3::NEG_Z,
            vertical_fov: self.fov,
            near: 0.01,
        };
        let given = |light: &VirtualLight| interfaces::virtual_lights::VirtualLight {
            position: light.position.as_vec3().to_array(),
            area: light.area as f32,
            normal: light.normal.as_vec3().to_array(),
            flux: [light.flux, 2.0 * light.flux, 0.0].map(|x| x as f32),
            ..Default::default()
        };
        let lights: Vec<_> = lights.iter().map(given).collect();
        Harness::new(gather::PASS)
            .frame(self.width, self.height)
            .scene("plane")
            .view(|x, y| (depth(x, y), [0.0, 1.0, 0.0]))
            .camera(camera)
            .lights(&lights)
    }

    /// Where a pixel looks.
    fn position(&self, x: u32, y: u32) -> DVec3 {
        let tan = (f64::from(self.fov) / 2.0).tan() * 2.0;
        let (w, h) = (f64::from(self.width), f64::from(self.height));
        dvec3(
            ((2.0 * f64::from(x) + 1.0) / w - 1.0) * tan * w / h,
            0.0,
            ((2.0 * f64::from(y) + 1.0) / h - 1.0) * tan,
        )
    }

    fn pixels(&self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.width * self.height).map(|i| (i % self.width, i / self.width))
    }
}

const DOWN: DVec3 = DVec3::NEG_Y;
const UP: DVec3 = DVec3::Y;

fn read(outputs: &Outputs) -> Vec<[f32; 4]> {
    outputs.read("irradiance")
}

/// Lights above the plane, looking down at an angle.
fn lights(count: usize) -> Vec<VirtualLight> {
    (0..count)
        .map(|i| {
            let [u, v, w] = [0.754_877, 0.569_840, 0.411_403].map(|step| (i as f64 * step).fract());
            let (sin, cos) = (2.0 * PI * v).sin_cos();
            VirtualLight {
                position: dvec3(u - 0.5, 0.3 + v, w - 0.5),
                normal: dvec3(0.6 * sin, -0.8, 0.6 * cos),
                flux: 0.5 + w,
                area: if i % 3 == 0 { 0.1 * u } else { 0.0 },
            }
        })
        .collect()
}

#[test]
fn one_light_over_a_plane_gives_the_closed_form() {
    let view = View { width: 21, height: 13, fov: 1.0 };
    let light = VirtualLight { position: dvec3(0.3, 0.7, -0.2), normal: DOWN, flux: 5.0, area: 0.0 };
    for area in [0.0, 0.04] {
        let light = VirtualLight { area, ..light };
        let outputs = view
            .harness(&[light])
            .set("interleave_x", 1)
            .set("interleave_y", 1)
            .set("geometry", "point-to-disc")
            .run();
        let Some(outputs) = outputs else { return };
        for ((x, y), got) in view.pixels().zip(read(&outputs)) {
            let d2 = view.position(x, y).distance_squared(light.position);
            // Both cosines are height over distance.
            let wanted = 5.0 * 0.49 / d2 / (PI * d2 + area);
            for (channel, factor) in [(0, 1.0), (1, 2.0), (2, 0.0)] {
                let got = f64::from(got[channel]);
                assert!(
                    (got - factor * wanted).abs() <= 1e-4 * wanted,
                    "({x}, {y}): {got} for {}",
                    factor * wanted
                );
            }
            assert_eq!(got[3], 0.0, "nothing is removed");
        }
    }
}

#[test]
fn a_disc_of_lights_gives_the_form_factor_of_a_disc() {
    // A Lambertian disc of radius a at height h gives its middle M a² / (a² + h²), M = Φ / area.
    let (a, h) = (0.5, 0.8);
    let disc: Vec<VirtualLight> = (0..4096)
        .map(|i| {
            let radius = a * ((f64::from(i) + 0.5) / 4096.0).sqrt();
            let (sin, cos) = (f64::from(i) * PI * (3.0 - 5f64.sqrt())).sin_cos();
            let position = dvec3(radius * cos, h, radius * sin);
            VirtualLight { position, normal: DOWN, flux: 1.0 / 4096.0, area: 0.0 }
        })
        .collect();
    let view = View { width: 1, height: 1, fov: 0.5 };
    let outputs = view.harness(&disc).set("interleave_x", 1).set("interleave_y", 1).set("clamp", 0.0).run();
    let Some(outputs) = outputs else { return };
    let wanted = 1.0 / (PI * a * a) * a * a / (a * a + h * h);
    let got = f64::from(read(&outputs)[0][0]);
    // Spiral points integrate over the disc to 1/N.
    assert!((got - wanted).abs() < 1e-3 * wanted, "{got} for {wanted}");
}

/// Irradiance of a disc of flux 1 at a receiver, by its definition, the mean over the disc of cosθ cosθ' / (π d²); and the most
/// that a receiver of any normal gets that has the whole disc before it.
fn disc_by_quadrature(light: &VirtualLight, at: DVec3, normal: DVec3) -> (f64, f64) {
    let radius = (light.area / PI).sqrt();
    let (u, v) = light.normal.any_orthonormal_pair();
    let sides = 600;
    let (mut sum, mut vector) = (0.0, DVec3::ZERO);
    for ring in 0..sides {
        let r = radius * ((f64::from(ring) + 0.5) / f64::from(sides)).sqrt();
        for step in 0..sides {
            let (sin, cos) = (2.0 * PI * (f64::from(step) + 0.5) / f64::from(sides)).sin_cos();
            let to_receiver = at - (light.position + r * (cos * u + sin * v));
            let d2 = to_receiver.length_squared();
            let arriving = to_receiver * light.normal.dot(to_receiver).max(0.0) / (PI * d2 * d2);
            sum += (-normal.dot(arriving)).max(0.0);
            vector += arriving;
        }
    }
    let samples = f64::from(sides * sides);
    (sum / samples, vector.length() / samples)
}

#[test]
fn a_disc_gives_the_integral_over_it() {
    let view = View { width: 9, height: 7, fov: 1.4 };
    // The last but one reaches below the plane, and so does the last by more than half its radius.
    for (height, tilt, area) in
        [(0.7, 0.0, 2.0), (0.05, 0.0, 0.5), (0.6, 0.6, 1.0), (0.4, 1.4, 1.0), (0.0, 1.57, 0.3)]
    {
        let (sin, cos) = f64::sin_cos(tilt);
        let normal = dvec3(sin, -cos, 0.0);
        let light = VirtualLight { position: dvec3(0.1, height, -0.05), normal, flux: 1.0, area };
        let harness = view.harness(&[light]).set("interleave_x", 1).set("interleave_y", 1);
        let Some(outputs) = harness.set("geometry", "disc").run() else { return };
        let mut errors = Vec::new();
        for ((x, y), got) in view.pixels().zip(read(&outputs)) {
            let (integral, whole) = disc_by_quadrature(&light, view.position(x, y), UP);
            // A disc whose middle is not above the plane gives nothing.
            let wanted = if height > 0.0 { integral } else { 0.0 };
            if whole > 0.0 {
                errors.push((f64::from(got[0]) - wanted).abs() / whole);
            }
        }
        // Of what a receiver gets that has the whole disc before it.
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        let greatest = errors.into_iter().fold(0.0, f64::max);
        assert!(
            greatest < 0.09 && mean < 0.014,
            "a disc of {area} m² at {height} m, tilted by {tilt}: errors of {greatest}, on average {mean}"
        );
    }
}

#[test]
fn a_disc_loses_no_flux_to_a_plane_that_touches_it() {
    // All that a disc emits arrives on a plane beside it, wherever it lies.
    let view = View { width: 400, height: 400, fov: 3.0 };
    for area in [0.0, 0.5, 4.0] {
        let light = VirtualLight { position: dvec3(0.0, 0.3, 0.0), normal: DOWN, flux: 1.0, area };
        let harness = view.harness(&[light]).set("interleave_x", 1).set("interleave_y", 1);
        let Some(outputs) = harness.set("geometry", "disc").run() else { return };
        let side = view.position(1, 0).distance(view.position(0, 0));
        let arrives: f64 = read(&outputs).iter().map(|e| f64::from(e[0])).sum::<f64>() * side * side;
        // What arrives beyond the view is that of a point from there, or less.
        assert!((0.99..1.002).contains(&arrives), "{arrives} of the flux of a disc of {area} m²");
    }
}

#[test]
fn every_light_is_in_exactly_one_subset() {
    for runs in [false, true] {
        for (subsets, count) in [(1, 7), (16, 64), (16, 61), (16, 5), (256, 1000), (9, 0)] {
            let mut all: Vec<u32> = (0..subsets).flat_map(|s| subset(s, subsets, count, runs)).collect();
            all.sort_unstable();
            assert_eq!(all, (0..count).collect::<Vec<u32>>(), "{count} lights in {subsets} subsets");
        }
    }
}

#[test]
fn each_sub_image_sums_its_subset() {
    // Odd frames, one smaller than the interleaving, more lights a subset than are staged at once, and fewer
    // lights than subsets.
    for (width, height, n, m, count) in
        [(21, 13, 4, 4, 61), (37, 19, 1, 2, 300), (1, 1, 16, 16, 3), (5, 3, 3, 5, 7)]
    {
        // A bound in radii of a disc of each light's area, or a disc itself; and a share of what is near.
        for (subsets, geometry_of, radii, bound) in [
            ("runs", "bounded", 0.0, Bound::Radii(0.0)),
            ("runs", "bounded", 3.0, Bound::Radii(3.0)),
            ("strides", "point-to-disc", 3.0, Bound::PointToDisc),
        ] {
            let view = View { width, height, fov: 0.8 };
            let lights = lights(count);
            let outputs = view
                .harness(&lights)
                .set("interleave_x", n)
                .set("interleave_y", m)
                .set("subsets", subsets)
                .set("geometry", geometry_of)
                .set("clamp", 0.2)
                .set("area_bound", radii)
                .set("complete_below", 0)
                .run();
            let Some(outputs) = outputs else { return };
            // A block is no larger than the frame.
            let (n, m) = (n.min(width), m.min(height));
            for ((x, y), got) in view.pixels().zip(read(&outputs)) {
                let own = subset(y % m * n + x % n, n * m, count as u32, subsets == "runs");
                let terms = own.iter().map(|i| {
                    let light = &lights[*i as usize];
                    let (kept, removed) =
                        geometry(light, view.position(x, y), UP, (bound, 0.2 * EXTENT), EXTENT);
                    (light.flux * kept, light.flux * removed)
                });
                let (kept, removed) = terms.fold((0.0, 0.0), |sum, term| (sum.0 + term.0, sum.1 + term.1));
                let scale = f64::from(n * m);
                // The luminance of (1, 2, 0).
                let removed = removed * (0.2126 + 2.0 * 0.7152);
                for (got, wanted) in [(got[0], kept), (got[1], 2.0 * kept), (got[3], removed)] {
                    let (got, wanted) = (f64::from(got), scale * wanted);
                    let tolerance = 1e-4 * wanted.max(scale * kept);
                    assert!(
                        (got - wanted).abs() <= tolerance,
                        "({x}, {y}) of {width}×{height}: {got} for {wanted}"
                    );
                }
            }
        }
    }
}

/// Short rays return what is missing of a near light whatever its geometry, so each has to leave the same.
#[test]
fn of_a_disc_nearer_than_the_clamp_its_share_remains() {
    let view = View { width: 16, height: 12, fov: 0.8 };
    let light = VirtualLight { position: dvec3(0.3, 0.7, -0.2), normal: DOWN, flux: 5.0, area: 0.04 };
    let gathered = |clamp: f64| {
        let harness = view.harness(&[light]).set("interleave_x", 1).set("interleave_y", 1);
        harness.set("geometry", "disc").set("clamp", clamp as f32).run()
    };
    let (Some(whole), Some(part)) = (gathered(0.0), gathered(0.4)) else { return };
    let mut near = 0;
    for (((x, y), whole), part) in view.pixels().zip(read(&whole)).zip(read(&part)) {
        let distance2 = view.position(x, y).distance_squared(light.position);
        let share = (distance2 / (0.4 * EXTENT).powi(2)).min(1.0);
        near += usize::from(share < 1.0);
        let [whole, kept, removed] = [whole[0], part[0], part[3]].map(f64::from);
        // The luminance of (1, 2, 0).
        let lost = (1.0 - share) * whole * (0.2126 + 2.0 * 0.7152);
        assert!((kept - share * whole).abs() < 1e-4 * whole, "({x}, {y}): {kept} of {whole}, not {share}");
        assert!((removed - lost).abs() < 1e-4 * whole, "({x}, {y}): {removed} are removed, not {lost}");
    }
    assert!((10..180).contains(&near), "{near} pixels are near");
}

#[test]
fn the_mean_over_the_sub_images_is_the_sum_over_all_lights() {
    // A view so narrow that all pixels see one place.
    let lights = lights(100);
    // The last two frames are smaller than a block.
    for (width, height) in [(12, 12), (2, 3), (1, 1)] {
        let view = View { width, height, fov: 1e-5 };
        let all = view.harness(&lights).set("interleave_x", 1).set("interleave_y", 1).run();
        let interleaved = view.harness(&lights).set("interleave_x", 4).set("interleave_y", 3).run();
        let (Some(all), Some(interleaved)) = (all, interleaved) else { return };
        let sum = |outputs: &Outputs| read(outputs).iter().map(|e| f64::from(e[0])).sum::<f64>();
        let mean = |outputs: &Outputs| sum(outputs) / f64::from(width * height);
        let (all, interleaved) = (mean(&all), mean(&interleaved));
        assert!((all - interleaved).abs() < 1e-4 * all, "{width}×{height}: {interleaved} for {all}");
    }
}

/// The depths of surfaces one beside the other \[m\]: broad ones, a column of one pixel, two pixels, and one pixel of nothing.
fn depth_of_steps(x: u32, y: u32) -> f32 {
    match (x, y) {
        (9, _) => 1.0,
        (5..=6, 6) => 1.5,
        (0..=3, _) => 3.0,
        (19, 3) => 0.0,
        _ => 2.0,
    }
}

#[test]
fn pixels_without_enough_of_their_surface_around_them_take_all_lights() {
    let view = View { width: 21, height: 13, fov: 0.8 };
    for (n, m, count) in [(4, 2, 61), (8, 8, 130), (3, 5, 7), (1, 16, 40)] {
        let lights = lights(count);
        let run = |n: u32, m: u32, below: u32| {
            let harness = view.over(&lights, depth_of_steps).set("interleave_x", n).set("interleave_y", m);
            Some(read(&harness.set("complete_below", below).run()?))
        };
        let (Some(all), Some(own)) = (run(1, 1, 0), run(n, m, 0)) else { return };
        for below in [1, 2, 3, 4, 6, 40, 256] {
            let got = run(n, m, below).unwrap();
            let (reach_x, reach_y) = (n.min(21) / 2, m.min(13) / 2);
            for ((x, y), got) in view.pixels().zip(got) {
                let depth = depth_of_steps(x, y);
                let around = view.pixels().filter(|&(u, v)| {
                    u.abs_diff(x) <= reach_x && v.abs_diff(y) <= reach_y && depth_of_steps(u, v) == depth
                });
                let is_alone = depth > 0.0 && around.count() < below as usize;
                let wanted = if is_alone { &all } else { &own }[(y * view.width + x) as usize];
                for (got, wanted) in got.into_iter().zip(wanted) {
                    assert!(
                        (got - wanted).abs() <= 1e-5 * wanted,
                        "({x}, {y}) of {n}×{m} below {below}: {got} for {wanted}"
                    );
                }
            }
        }
    }
}

/// As many lights as one of one sample: each of its samples takes a part of them.
#[test]
fn a_pixel_of_several_samples_takes_as_many_lights() {
    let view = View { width: 24, height: 12, fov: 0.8 };
    let lights = lights(130);
    for side in [2, 3] {
        let run = |(n, m): (u32, u32), below: u32, frame: u32| {
            let harness = view.over(&lights, depth_of_steps).frame(view.width / frame, view.height / frame);
            let harness = harness.set("interleave_x", n).set("interleave_y", m).set("complete_below", below);
            Some(read(&harness.run()?))
        };
        // Below the third part of a sample none is alone; below three of a pixel's samples, those are without two others.
        for (below, of_samples) in [(3, 0), (3 * side * side, 3)] {
            let (Some(samples), Some(pixels)) =
                (run((2, 1), below, side), run((2 * side, side), of_samples, 1))
            else {
                return;
            };
            assert!(samples == pixels, "{side}² samples, below {below}");
        }
    }
}

/// More lights than one dispatch may take: drivers end loops that go on for too long.
#[test]
fn many_lights_take_several_dispatches() {
    let view = View { width: 9, height: 5, fov: 0.8 };
    let light = lights(1)[0];
    let run = |count: usize, interleave: u32| {
        let harness = view.harness(&vec![light; count]).set("interleave_x", interleave);
        // With sub-images, all pixels take all lights.
        let harness = harness.set("interleave_y", interleave).set("complete_below", 256);
        Some(read(&harness.run()?))
    };
    for interleave in [1, 3] {
        let (Some(one), Some(many)) = (run(1, 1), run(70_000, interleave)) else { return };
        for (one, many) in one.iter().zip(&many) {
            // So many roundings of a growing sum add up to a thousandth.
            assert!((many[0] / one[0] / 70_000.0 - 1.0).abs() < 2e-3, "{many:?} for 70,000 times {one:?}");
        }
    }
}

#[test]
fn extremes_stay_finite() {
    let view = View { width: 3, height: 3, fov: 1.0 };
    let on_the_receiver = VirtualLight { position: view.position(1, 1), normal: UP, flux: 1e9, area: 0.0 };
    let facing = VirtualLight { position: dvec3(0.0, 1e-12, 0.0), normal: DOWN, ..on_the_receiver };
    let behind = VirtualLight { position: DVec3::NEG_Y, normal: UP, ..on_the_receiver };
    for lights in [vec![on_the_receiver], vec![facing], vec![behind], Vec::new()] {
        let outputs =
            view.harness(&lights).set("interleave_x", 1).set("interleave_y", 1).set("clamp", 0.0).run();
        let Some(outputs) = outputs else { return };
        for value in read(&outputs).into_iter().flatten() {
            assert!(value.is_finite() && value >= 0.0, "{value} of {lights:?}");
        }
    }
}

#[test]
fn pixels_that_see_nothing_are_black() {
    let view = View { width: 4, height: 4, fov: 1.0 };
    let light = VirtualLight { position: DVec3::Y, normal: DOWN, flux: 1.0, area: 0.0 };
    let Some(outputs) = view.at_depth(&[light], 0.0).run() else { return };
    assert!(read(&outputs).iter().all(|e| *e == [0.0; 4]), "nothing is lit");
}

/// Runs one light over the plane with an atlas of one map of 8², filled with one distance.
fn with_map(stored: f32) -> Option<Vec<[f32; 4]>> {
    let view = View { width: 9, height: 9, fov: 0.6 };
    let light = VirtualLight { position: dvec3(0.1, 1.0, 0.0), normal: DOWN, flux: 1.0, area: 0.0 };
    let atlas = pass::ResourceDesc::texture_2d_array(pass::Format::R32Float, (8, 8), 1);
    let outputs = view
        .harness(&[light])
        .set("interleave_x", 1)
        .set("interleave_y", 1)
        .input(
            "visibility",
            "Visibility",
            &[("tile", 8), ("columns", 1), ("rows", 1)],
            vec![("atlas", atlas, bytemuck::cast_slice(&[stored; 64]).to_vec())],
        )
        .fact("depth_bias", 0.1)
        .fact("slope_bias", 0.0)
        .module("shaders/visibility-atlas.wgsl")
        .run();
    outputs.map(|outputs| read(&outputs))
}

#[test]
fn a_map_shadows_what_is_behind_its_distance() {
    let (Some(open), Some(closed)) = (with_map(3.0e38), with_map(0.5)) else { return };
    assert!(open.iter().all(|e| e[0] > 0.0), "nothing is in the way");
    assert!(closed.iter().all(|e| e[0] == 0.0), "something is half way to the plane");
    // At 1.02 m the map lets the places near the foot of the light through, whose distance is 1 m and a little.
    let Some(edge) = with_map(1.02) else { return };
    let lit = edge.iter().filter(|e| e[0] > 0.0).count();
    assert!(lit > 0 && lit < edge.len(), "{lit} pixels are lit");
    for (edge, open) in edge.iter().zip(&open) {
        assert!(edge[0] == 0.0 || edge[0] == open[0], "one distance everywhere makes no penumbra");
    }
}

#[test]
fn the_module_of_no_visibility_is_the_same_as_none() {
    let view = View { width: 5, height: 5, fov: 0.6 };
    let lights = lights(20);
    let none = view.harness(&lights).run();
    let module = view
        .harness(&lights)
        .input("visibility", "Visibility", &[], Vec::new())
        .module("shaders/visibility-none.wgsl")
        .run();
    let (Some(none), Some(module)) = (none, module) else { return };
    assert_eq!(read(&none), read(&module));
}
