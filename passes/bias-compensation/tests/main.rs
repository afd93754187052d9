//! The results of short rays, against closed forms over a lit plane.

use glam::{DVec3, Vec3, vec3};
use interfaces::virtual_lights::VirtualLight;
use pass_test::{Harness, INFINITELY_FAR};
use scene::{Camera, Light, LightKind};
use std::f64::consts::PI;

/// Pixels along a side of the view.
const SIDE: u32 = 64;

/// Light that falls straight on the plane [W/m²].
const SUN: f32 = 3.0;

/// Diagonal of the plane, a square of 2 m, which is the extent of the scene \[m\].
const EXTENT: f32 = 2.0 * std::f32::consts::SQRT_2;

/// The pass for receivers that face the middle of a sunlit plane of albedo ½ from the height `height` \[m\]; each had the
/// irradiance `before`.
fn over_plane(height: f32, before: [f32; 4]) -> Harness<'static> {
    over_plane_by(|_| height, before)
}

/// The same with a height for each column of pixels.
fn over_plane_by(height: impl Fn(u32) -> f32, before: [f32; 4]) -> Harness<'static> {
    receivers(height).irradiance((4, 2), |_, _| before)
}

/// The same without the irradiance.
fn receivers(height: impl Fn(u32) -> f32) -> Harness<'static> {
    let mut scene = pass_test::scene("plane");
    let sun = LightKind::Directional;
    let light = scene.lights[0].clone();
    scene.lights = vec![Light { kind: sun, direction: Vec3::NEG_Y, intensity: Vec3::splat(SUN), ..light }];
    Harness::new(bias_compensation::PASS)
        .with_scene(scene)
        // Far above and narrow: all receivers are within 1 mm of the middle.
        .camera(Camera {
            position: vec3(0.0, 1.0, 0.0),
            target: Vec3::ZERO,
            up: Vec3::NEG_Z,
            vertical_fov: 0.001,
            near: 0.01,
        })
        .frame(SIDE, SIDE)
        .seen(|x, _| (1.0 - height(x), [0.0, -1.0, 0.0]))
}

/// The compensated irradiance of these receivers, where lights have the one bound `bound` \[m\].
fn compensated(height: f32, bound: f32, rays: u32, before: [f32; 4]) -> Option<Vec<[f32; 4]>> {
    compensated_by(height, bound, [rays, rays], 0.0, before)
}

/// The same with that many rays at the least and at the most, and noise that is left.
fn compensated_by(
    height: f32,
    bound: f32,
    [least, most]: [u32; 2],
    noise: f32,
    before: [f32; 4],
) -> Option<Vec<[f32; 4]>> {
    let harness = over_plane(height, before).fact("clamp", bound / EXTENT);
    Some(
        harness
            .set("rays_per_pixel", least)
            .set("most_rays", most)
            .set("noise", noise)
            .run()?
            .read("compensated"),
    )
}

/// The compensated irradiance where each of these lights is bounded at `radii` radii of its area.
fn compensated_by_area(height: f32, radii: f32, lights: &[VirtualLight]) -> Option<Vec<[f32; 4]>> {
    let harness = over_plane(height, [0.0; 4]).fact("clamp", 0.0f32).fact("area_bound", radii).lights(lights);
    Some(harness.set("rays_per_pixel", 4u32).run()?.read("compensated"))
}

/// A light on the plane that stands for a disc of this radius, both in metres.
fn light(x: f64, radius: f32, normal: DVec3) -> VirtualLight {
    let light = pass_test::light_at(DVec3::new(x, 0.0, 0.0), normal);
    VirtualLight { area: std::f32::consts::PI * radius * radius, ..light }
}

/// The irradiance that a plane of radiance L lacks at the height h below the bound b: with a = h / b, the integral of
/// L cosθ (1 - a² / cos²θ) over the directions of cosθ > a, 2π L ((1 - a²) / 2 + a² ln a).
fn missing(height: f64, bound: f64) -> f64 {
    let radiance = 0.5 / PI * f64::from(SUN);
    let a = height / bound;
    if a >= 1.0 { 0.0 } else { 2.0 * PI * radiance * ((1.0 - a * a) / 2.0 + a * a * a.ln()) }
}

fn mean(pixels: &[[f32; 4]]) -> f64 {
    pixels.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / pixels.len() as f64
}

#[test]
fn a_plane_returns_its_near_field() {
    for (height, bound) in [(0.001, 0.4), (0.05, 0.4), (0.2, 0.4), (0.39, 0.4)] {
        let Some(pixels) = compensated(height, bound, 4, [0.0; 4]) else { return };
        let (found, wanted) = (mean(&pixels), missing(f64::from(height), f64::from(bound)));
        // 16,384 stratified rays.
        assert!(
            (found - wanted).abs() < 4e-3 * wanted + 1e-5,
            "at {height} of {bound}: {found} for {wanted}"
        );
    }
}

/// How far the rays of lights that are bounded by their areas go \[m\].
const MOST_BOUND: f32 = 0.2 * EXTENT;

/// A light that is bounded at r radii of a disc of the radius a lacks what one bound at r a takes, and no more than rays reach.
#[test]
fn a_plane_returns_what_bounds_by_area_take() {
    for (height, radii, radius) in
        [(0.05, 1.0, 0.2), (0.05, 2.0, 0.1), (0.2, 4.0, 0.06), (0.001, 2.0, 0.1), (0.05, 2.0, 0.3)]
    {
        let Some(pixels) = compensated_by_area(height, radii, &[light(0.0, radius, DVec3::Y)]) else {
            return;
        };
        let (found, wanted) =
            (mean(&pixels), missing(f64::from(height), f64::from((radii * radius).min(MOST_BOUND))));
        assert!((found - wanted).abs() < 4e-3 * wanted + 1e-5, "at {height}: {found} for {wanted}");
    }
}

/// The nearest light of a surface says what lights there stand for: neither one farther off, nor one on the back of the surface, nor one
/// infinitely far.
#[test]
fn the_nearest_light_of_the_side_decides() {
    let decides = light(0.05, 0.15, DVec3::Y);
    let infinitely_far = VirtualLight { kind: INFINITELY_FAR, ..light(0.0, 0.7, DVec3::Y) };
    let lights = [light(0.9, 0.1, DVec3::Y), light(0.0, 0.5, DVec3::NEG_Y), infinitely_far, decides];
    let Some(pixels) = compensated_by_area(0.01, 1.0, &lights) else { return };
    let (found, wanted) = (mean(&pixels), missing(0.01, 0.15));
    assert!((found - wanted).abs() < 4e-3 * wanted, "{found} for {wanted}");
}

/// Without lights, without any on this side, without area and without a bound nothing is missing.
#[test]
fn what_no_light_lacks_is_not_returned() {
    let away = light(0.0, 0.3, DVec3::NEG_Y);
    for (radii, lights) in [
        (1.0, vec![]),
        (1.0, vec![away]),
        (1.0, vec![light(0.0, 0.0, DVec3::Y)]),
        (0.0, vec![light(0.0, 0.3, DVec3::Y)]),
    ] {
        let Some(pixels) = compensated_by_area(0.01, radii, &lights) else { return };
        assert!(pixels.iter().all(|pixel| *pixel == [0.0; 4]), "{radii} radii, {lights:?}: {:?}", pixels[0]);
    }
}

/// 65,536 lights and all rays of a pixel are within what a driver loops over, also where its samples see several surfaces: the areas of
/// a run of lights are enough.
#[test]
fn many_lights_are_sampled_by_a_run() {
    let lights: Vec<_> = (0..65_536).map(|i| light(f64::from(i % 64) / 64.0 - 0.5, 0.2, DVec3::Y)).collect();
    for supersampling in [1, 4] {
        let height = |x| 0.05 * (1.0 + (x % supersampling) as f32);
        let harness = over_plane_by(height, [0.0; 4]).fact("clamp", 0.0f32).fact("area_bound", 1.0f32);
        let harness = harness.lights(&lights).frame(SIDE / supersampling, SIDE / supersampling);
        let harness = harness.set("rays_per_pixel", 64u32).set("most_rays", 64u32);
        let Some(outputs) = harness.run() else { return };
        let found = mean(&outputs.read("compensated"));
        let wanted = (0..supersampling).map(|x| missing(height(x).into(), 0.2)).sum::<f64>();
        let wanted = wanted / f64::from(supersampling);
        assert!((found - wanted).abs() < 3e-3 * wanted, "{supersampling}: {found} for {wanted}");
    }
}

#[test]
fn what_was_there_is_kept() {
    for (bound, rays) in [(0.0, 1), (0.1, 1), (0.4, 0)] {
        // The plane is farther than the bound, or no ray is traced.
        let Some(pixels) = compensated(0.2, bound, rays, [1.0, 2.0, 3.0, 4.0]) else { return };
        assert!(pixels.iter().all(|pixel| *pixel == [1.0, 2.0, 3.0, 4.0]), "{:?}", pixels[0]);
    }
}

#[test]
fn what_rays_return_is_not_missing_any_more() {
    let Some(pixels) = compensated(0.05, 0.4, 1, [0.0, 0.0, 0.0, 7.0]) else { return };
    for [r, g, b, missing] in &pixels {
        let returned = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        assert!((missing + returned - 7.0).abs() < 1e-4, "{missing} are missing, and {returned} came back");
    }
    assert!(mean(&pixels) > 0.0);
}

fn variance(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64
}

fn singles(pixels: &[[f32; 4]]) -> Vec<f64> {
    pixels.iter().map(|pixel| f64::from(pixel[0])).collect()
}

/// Where rays differ, pixels trace more of them, which leaves less noise and the same mean, also where few rays return anything.
#[test]
fn pixels_trace_more_rays_where_they_differ() {
    for height in [0.05, 0.2, 0.37] {
        let wanted = missing(f64::from(height), 0.4);
        let of = |most, before| compensated_by(height, 0.4, [1, most], 0.01, [before, before, before, 0.0]);
        let Some(few) = of(1, 0.0) else { return };
        let many = of(16, 0.0).expect("the adapter is still there");
        let ratio = variance(&singles(&many)) / variance(&singles(&few));
        assert!(ratio < 0.1, "at {height}: {ratio} of the variance");
        let off = mean(&many) - wanted;
        let error = (variance(&singles(&many)) / many.len() as f64).sqrt();
        assert!(off.abs() < 3.0 * error + 2e-3 * wanted, "at {height}: off by {off}, {error} by noise");
        // Beside much light the same noise is little.
        let bright = of(16, 1e3 * wanted as f32).expect("the adapter is still there");
        let dark = of(1, 1e3 * wanted as f32).expect("the adapter is still there");
        let whole_windows = |pixels: &[[f32; 4]]| {
            let inside = 2..SIDE as usize - 2;
            inside
                .clone()
                .flat_map(|y| pixels[y * SIDE as usize..][inside.clone()].to_vec())
                .collect::<Vec<_>>()
        };
        assert!(whole_windows(&bright) == whole_windows(&dark), "at {height}");
    }
}

/// A pixel whose window sees other surfaces traces the rays of the pixels that do, since a filter finds none of them.
#[test]
fn pixels_alone_on_a_surface_trace_the_rays_of_their_window() {
    let of = |most: u32, stripes: bool| {
        let height = |x| if stripes && x % 4 != 1 { 0.1 } else { 0.05 };
        let harness = over_plane_by(height, [1e3, 1e3, 1e3, 0.0]);
        let harness = harness.set("rays_per_pixel", 1u32).set("most_rays", most).set("noise", 1.0f32);
        let pixels: Vec<[f32; 4]> = harness.fact("clamp", 0.4 / EXTENT).run()?.read("compensated");
        // A column of every fourth.
        let column =
            |i: u32| f64::from(pixels[((2 + i / 14) * SIDE + 4 * (1 + i % 14) + 1) as usize][0]) - 1e3;
        Some((0..14 * 60).map(column).collect::<Vec<f64>>())
    };
    let Some(alone) = of(8, true) else { return };
    let [few, among] = [(1, true), (8, false)].map(|(most, stripes)| of(most, stripes).expect("an adapter"));
    // Of the 15 pixels of a window three see the column's surface: three rays each are eight together, or one more.
    let ratio = variance(&alone) / variance(&few);
    assert!((0.15..0.5).contains(&ratio), "three rays have {ratio} of the variance of one");
    let same = of(1, false).expect("an adapter");
    assert!(among == same, "no more rays where all pixels see one surface");
}

/// The eight pixels of a window of the interleaving share one set of stratified rays, so that their mean, which a filter
/// takes, varies less than that of eight rays of their own.
#[test]
fn a_window_shares_its_rays() {
    let Some(pixels) = compensated(0.05, 0.4, 1, [0.0; 4]) else { return };
    let single = singles(&pixels);
    let window = |x: u32, y: u32| {
        let pixel = |i: u32| single[((2 * y + i / 4) * SIDE + 4 * x + i % 4) as usize];
        (0..8).map(pixel).sum::<f64>() / 8.0
    };
    let windows: Vec<f64> =
        (0..SIDE / 4 * (SIDE / 2)).map(|i| window(i % (SIDE / 4), i / (SIDE / 4))).collect();
    let (of_windows, independent) = (variance(&windows), variance(&single) / 8.0);
    assert!(of_windows < 0.5 * independent, "{of_windows} against {independent}");
}

/// The samples of a pixel that see one surface share the rays of one of them, and those that see another trace their own: each surface
/// gets what it lacks.
/// The rays of a pixel that has a set of its own are stratified over the samples of a picture: their mean errs less than that of as many seeds.
#[test]
fn samples_of_a_picture_are_one_set() {
    const COUNT: u32 = 32;
    let mean_of = |places: &dyn Fn(Harness<'static>, u32) -> Harness<'static>| -> Option<f64> {
        let mut sums = vec![0.0; (SIDE * SIDE) as usize];
        for i in 0..COUNT {
            let harness = receivers(|_| 0.05).irradiance((1, 1), |_, _| [0.0; 4]);
            let harness = harness.fact("clamp", 0.4 / EXTENT).set("most_rays", 1u32);
            let pixels: Vec<[f32; 4]> = places(harness, i).run()?.read("compensated");
            sums.iter_mut().zip(&pixels).for_each(|(sum, pixel)| *sum += f64::from(pixel[0]));
        }
        sums.iter_mut().for_each(|sum| *sum /= f64::from(COUNT));
        Some(variance(&sums))
    };
    let Some(of_seeds) = mean_of(&|harness, i| harness.seed(i + 1)) else { return };
    let of_samples = mean_of(&|harness, i| harness.seed(1).sample(i)).unwrap();
    assert!(of_samples < 0.25 * of_seeds, "{of_samples} for {of_seeds}");
}

#[test]
fn samples_of_a_pixel_share_rays() {
    let of = |low: f32| {
        let height = |x: u32| if x.is_multiple_of(2) { 0.05 } else { low };
        let harness = over_plane_by(height, [0.0; 4]).fact("clamp", 0.4 / EXTENT);
        // The view has two samples along each side of a pixel.
        let harness = harness.frame(SIDE / 2, SIDE / 2).set("rays_per_pixel", 1u32).set("most_rays", 1u32);
        Some(singles(&harness.run()?.read("compensated")))
    };
    let sample = |x: u32, y: u32| (y * SIDE + x) as usize;
    for (low, shared) in [(0.05, true), (0.1, false)] {
        let Some(samples) = of(low) else { return };
        let mut differ = 0;
        for (x, y) in (0..SIDE / 2).flat_map(|x| (0..SIDE / 2).map(move |y| (2 * x, 2 * y))) {
            let [upper, lower] = [y, y + 1].map(|y| [x, x + 1].map(|x| samples[sample(x, y)]));
            assert_eq!(upper, lower, "at {x}, {y}: samples of one surface");
            differ += u32::from(upper[0] != upper[1]);
        }
        assert!(if shared { differ == 0 } else { differ > 900 }, "{differ} of 1,024 differ");
        for (column, height) in [(0, 0.05), (1, low)] {
            let of_column = (0..SIDE * SIDE).filter(|i| i % 2 == column).map(|i| samples[i as usize]);
            let of_column: Vec<f64> = of_column.collect();
            let off = of_column.iter().sum::<f64>() / of_column.len() as f64 - missing(height.into(), 0.4);
            // Of two samples that are equal.
            let error = (variance(&of_column) / (of_column.len() / 2) as f64).sqrt();
            assert!(off.abs() < 3.0 * error, "{low}, column {column}: off by {off}, {error} by noise");
        }
    }
}
