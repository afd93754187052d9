//! Irradiance against sums over all texels, and what is interpolated against what is gathered at every pixel.

use glam::{DVec3, Vec3, dvec3, vec3};
use pass_test::{Harness, Outputs, RsmTexel, random, view::CAMERA};
use reflective_gather::PASS;
use scene::{Light, LightKind, Scene};
use std::f64::consts::PI;

pass_test::shaders_are_valid!(PASS);

const SPOT: LightKind = LightKind::Spot { inner: 0.1, outer: 0.3 };

/// Some scene under lights of these kinds, 2 m before the camera and looking away from it.
fn lit_by(lights: &[LightKind]) -> Scene {
    let mut scene = pass_test::scene("plane");
    let light = |kind: &LightKind| Light {
        kind: *kind,
        position: vec3(0.0, 0.0, -2.0),
        direction: Vec3::NEG_Z,
        ..scene.lights[0].clone()
    };
    scene.lights = lights.iter().map(light).collect();
    scene
}

fn number(i: u32, of: u32) -> f64 {
    random::unit_float(random::hash2(i, of))
}

/// Texels that lie behind the camera, with normals of all directions; every fifth saw nothing.
fn texels(count: u32) -> Vec<RsmTexel> {
    let texel = |i: u32| match i % 5 {
        0 => RsmTexel::default(),
        _ => RsmTexel {
            position: [2.0 * number(i, 0) - 1.0, 2.0 * number(i, 1) - 1.0, 0.3 + number(i, 2), 1.0]
                .map(|x| x as f32),
            normal: dvec3(number(i, 3) - 0.5, number(i, 4) - 0.5, -number(i, 5))
                .normalize()
                .as_vec3()
                .to_array(),
            flux: [number(i, 6).powi(2), 0.5, 0.0, 0.1].map(|x| x as f32),
        },
    };
    (0..count).map(texel).collect()
}

/// A picture of 9×7 pixels of depths from before the lights to behind them, and what each sees.
const SIZE: (u32, u32) = (9, 7);

fn depth(x: u32, y: u32) -> f32 {
    0.5 + 3.5 * number(x, y) as f32
}

fn seen_at(x: u32, y: u32) -> DVec3 {
    let half = (f64::from(CAMERA.vertical_fov) / 2.0).tan();
    let (width, height) = (f64::from(SIZE.0), f64::from(SIZE.1));
    let ndc = |i: u32, size: f64| (2.0 * f64::from(i) + 1.0) / size - 1.0;
    let depth = f64::from(depth(x, y));
    dvec3(ndc(x, width) * half * width / height, -ndc(y, height) * half, -1.0) * depth
}

/// Irradiance by all texels at a point that faces the camera, in red.
fn sum_over_all(texels: &[RsmTexel], at: DVec3) -> f64 {
    let of_texel = |texel: &RsmTexel| {
        let [x, y, z, _] = texel.position.map(f64::from);
        let offset = at - dvec3(x, y, z);
        let d2 = offset.length_squared();
        let leaving = Vec3::from(texel.normal).as_dvec3().dot(offset).max(0.0);
        f64::from(texel.flux[0]) * leaving * (-offset.z).max(0.0) / (PI * d2 * d2)
    };
    texels.iter().map(of_texel).sum()
}

fn irradiance(outputs: &Outputs) -> Vec<[f32; 4]> {
    outputs.read("irradiance")
}

/// How many pixels were gathered again.
fn gathered_again(outputs: &Outputs) -> u32 {
    let [pixels, interpolated, ..] = outputs.read::<u32>("interpolated")[..] else { panic!("two numbers") };
    pixels - interpolated
}

#[test]
fn samples_in_the_whole_map_expect_the_sum_over_all_texels() {
    let both = [SPOT, LightKind::Point];
    for (kinds, layers) in
        [(&[SPOT][..], 1), (&[LightKind::Directional], 1), (&[LightKind::Point], 6), (&both, 7)]
    {
        for size in [(8, 6), (1, 1)] {
            let texels = texels(1 + size.0 * size.1 * layers).split_off(1);
            let outputs = Harness::new(PASS)
                .with_scene(lit_by(kinds))
                .frame(SIZE.0, SIZE.1)
                .view(|x, y| (depth(x, y), [0.0, 0.0, 1.0]))
                .rsm(size, &texels)
                // Of all layers, more than one dispatch takes.
                .set("samples", 16384)
                .set("divisor", 1)
                .set("area_bound", 0.0)
                .run();
            let Some(outputs) = outputs else { return };
            let mut whole = (0.0, 0.0);
            for (i, found) in (0..).zip(irradiance(&outputs)) {
                let at = seen_at(i % SIZE.0, i / SIZE.0);
                let expected = sum_over_all(&texels, at);
                // Independent samples would deviate by 1 % where the projection is in the middle of the map, and by 3 % in a
                // corner, where three of four rays have no length.
                let error = (f64::from(found[0]) - expected).abs();
                assert!(
                    error <= 2e-2 * expected,
                    "{kinds:?}, {size:?}, at {at}: {} for {expected}",
                    found[0]
                );
                assert_eq!(found[3], 0.0, "nothing is removed");
                whole = (whole.0 + f64::from(found[0]), whole.1 + expected);
            }
            let (found, expected) = whole;
            assert!(
                (found - expected).abs() < 5e-3 * expected,
                "{kinds:?}, {size:?}: {found} for {expected}"
            );
        }
    }
}

/// Maps of one surface alone, which all samples see alike.
fn one_surface(count: u32) -> Vec<RsmTexel> {
    let texel =
        RsmTexel { position: [0.0, 0.0, 1.0, 1.0], normal: [0.0, 0.0, -1.0], flux: [1.0, 0.0, 0.0, 0.1] };
    vec![texel; count as usize]
}

/// The pixel in the middle projects to the middle of the map, whatever the axes of the light are.
#[test]
fn samples_reach_as_far_as_the_radius() {
    let sum = |radius: f32, weights: &str, texels: &[RsmTexel]| {
        let harness =
            Harness::new(PASS).with_scene(lit_by(&[SPOT])).frame(1, 1).view(|_, _| (3.0, [0.0, 0.0, 1.0]));
        let side = texels.len().isqrt() as u32;
        let harness = harness.rsm((side, side), texels).set("radius", radius).set("weights", weights);
        let outputs = harness.set("samples", 4096).set("area_bound", 0.0).run()?;
        Some(f64::from(irradiance(&outputs)[0][0]))
    };
    let all = one_surface(25);
    // Of 25 texels of 1 W at 4 m.
    let whole = 25.0 / (PI * 16.0);
    for weights in ["density", "squared"] {
        for radius in [0.0, 0.125, 0.5] {
            let Some(found) = sum(radius, weights, &all) else { return };
            // A disc of the map. The mean of the squares of stratified distances is 1/3 to 1e-3.
            let expected = PI * f64::from(radius).powi(2) * whole;
            assert!(
                (found - expected).abs() <= 2e-3 * expected,
                "{weights}, {radius}: {found} for {expected}"
            );
        }
        // The nearest point of a texel is this many texels from the middle, and a radius of 0.3 is 1.5 texels.
        for (texel, is_near) in [(12, true), (11, true), (6, true), (10, false), (14, false), (0, false)] {
            let mut one = vec![RsmTexel::default(); 25];
            one[texel] = all[texel];
            let Some(found) = sum(0.29, weights, &one) else { return };
            assert_eq!(found > 0.0, is_near, "{weights}: texel {texel} gives {found}");
        }
    }
    let Some(found) = sum(1.5, "density", &all) else { return };
    assert!((found - whole).abs() < 2e-3 * whole, "{found} for all of {whole}");
}

/// Squared distances, as the paper has it, make far texels count more than they are, and near ones less.
#[test]
fn squared_weights_prefer_far_texels() {
    let sum = |weights: &str, texel: usize| {
        let mut texels = vec![RsmTexel::default(); 25];
        texels[texel] = one_surface(1)[0];
        let harness =
            Harness::new(PASS).with_scene(lit_by(&[SPOT])).frame(1, 1).view(|_, _| (3.0, [0.0, 0.0, 1.0]));
        let harness =
            harness.rsm((5, 5), &texels).set("samples", 4096).set("weights", weights).set("radius", 0.5);
        Some(irradiance(&harness.run()?)[0][0])
    };
    for (texel, least, most) in [(12, 0.0, 0.5), (2, 1.2, 2.0)] {
        let (Some(squared), Some(density)) = (sum("squared", texel), sum("density", texel)) else { return };
        let ratio = squared / density;
        assert!((least..most).contains(&ratio), "texel {texel}: {ratio}");
    }
}

/// A picture of 70×37 pixels, of more than one block of a compaction, in which `see` says depths and normals.
fn picture(divisor: u32, see: impl Fn(u32, u32) -> (f32, [f32; 3])) -> Harness<'static> {
    let texel = |i: u32| RsmTexel {
        position: [(i % 32) as f32 / 16.0 - 1.0, (i / 32) as f32 / 16.0 - 1.0, 1.0, 1.0],
        ..one_surface(1)[0]
    };
    let texels: Vec<RsmTexel> = (0..32 * 32).map(texel).collect();
    Harness::new(PASS)
        .with_scene(lit_by(&[SPOT]))
        .frame(70, 37)
        .view(see)
        .rsm((32, 32), &texels)
        .set("samples", 64)
        .set("divisor", divisor)
}

fn facing(depth: f32) -> (f32, [f32; 3]) {
    (depth, [0.0, 0.0, 1.0])
}

#[test]
fn a_wall_is_interpolated_everywhere() {
    let wall = |_, _| facing(3.0);
    let Some(whole) = picture(1, wall).run() else { return };
    let whole_picture = irradiance(&whole);
    assert_eq!(gathered_again(&whole), 0);
    let mut errors = Vec::new();
    for divisor in [2, 4, 7, 64] {
        let Some(coarse) = picture(divisor, wall).run() else { return };
        assert_eq!(gathered_again(&coarse), 0, "every {divisor}th pixel");
        let of_pixel = |(found, exact): (&[f32; 4], &[f32; 4])| f64::from((found[0] - exact[0]).abs());
        let sum: f64 = irradiance(&coarse).iter().zip(&whole_picture).map(of_pixel).sum();
        errors.push(sum / whole_picture.iter().map(|texel| f64::from(texel[0])).sum::<f64>());
        for (i, (found, exact)) in (0..).zip(irradiance(&coarse).iter().zip(&whole_picture)) {
            let is_gathered = |at: u32, size: u32| at.is_multiple_of(divisor) || at == size - 1;
            if is_gathered(i % 70, 70) && is_gathered(i / 70, 37) {
                assert_eq!(found, exact, "pixel {i}");
            }
        }
    }
    assert!(errors.is_sorted() && errors[1] < 0.02 && errors[3] > 0.0, "{errors:?}");
}

#[test]
fn pixels_that_no_neighbours_resemble_are_gathered_again() {
    // Each pixel at a depth of its own, some of which see nothing: all but every fourth of every fourth row are unlike.
    let dust = |x: u32, y: u32| match random::hash2(x, y) % 7 {
        0 => facing(0.0),
        _ => facing(1.0 + 3.0 * number(x, y) as f32),
    };
    let (Some(whole), Some(coarse)) = (picture(1, dust).run(), picture(4, dust).run()) else { return };
    assert!(gathered_again(&coarse) > 1500, "{} pixels", gathered_again(&coarse));
    let mut alike = 0;
    for (i, (found, exact)) in (0..).zip(irradiance(&coarse).iter().zip(&irradiance(&whole))) {
        if dust(i % 70, i / 70).0 == 0.0 {
            assert_eq!(*found, [0.0; 4]);
        }
        alike += u32::from(found == exact);
    }
    // By chance, few lie in one plane with three of the four.
    assert!(alike > 70 * 37 * 9 / 10, "{alike} pixels");
    let outputs = picture(4, dust).set("neighbors", 4).set("plane", 0.0).run();
    let Some(outputs) = outputs else { return };
    assert_eq!(irradiance(&outputs), irradiance(&whole));
}

#[test]
fn steps_and_creases_are_gathered_again_along_their_edge_alone() {
    let step = |x: u32, _| facing(if x < 33 { 2.0 } else { 3.0 });
    // The plane from the edge on comes towards the camera.
    let ray = |x: u32| (f64::from(2 * x + 1) - 70.0) / 37.0 * (f64::from(CAMERA.vertical_fov) / 2.0).tan();
    let slanted = |x: u32| 2.5 * (0.6 + 0.8 * ray(33)) / (0.6 + 0.8 * ray(x));
    let crease = |x: u32, _| if x < 33 { facing(2.5) } else { (slanted(x) as f32, [-0.8, 0.0, 0.6]) };
    for (name, see) in [("step", &step as &dyn Fn(u32, u32) -> _), ("crease", &crease)] {
        let (Some(whole), Some(coarse)) = (picture(1, see).run(), picture(4, see).run()) else { return };
        // Between the columns 32 and 36, three pixels of each row; in its rows of `coarse` too.
        assert_eq!(gathered_again(&coarse), 37 * 3, "{name}");
        for (i, (found, exact)) in (0..).zip(irradiance(&coarse).iter().zip(&irradiance(&whole))) {
            if (33..36).contains(&(i % 70)) {
                assert_eq!(found, exact, "{name}, pixel {i}");
            }
        }
        // A plane that is far away, and a bent normal, are alike where the thresholds say so.
        let Some(loose) = picture(4, see).set("plane", 10.0).set("cosine", -1.0).run() else { return };
        assert_eq!(gathered_again(&loose), 0, "{name}");
    }
}

#[test]
fn light_behind_the_surface_and_lights_that_face_away_give_nothing() {
    let away = |_, _| (3.0, [0.0, 0.0, -1.0]);
    let Some(outputs) = picture(4, away).run() else { return };
    assert!(irradiance(&outputs).iter().all(|texel| *texel == [0.0; 4]));
    let mut texels = one_surface(1);
    texels[0].normal = [0.0, 0.0, 1.0];
    let harness = Harness::new(PASS).with_scene(lit_by(&[SPOT])).frame(3, 2).view(|_, _| facing(3.0));
    let Some(outputs) = harness.rsm((1, 1), &texels).run() else { return };
    assert!(irradiance(&outputs).iter().all(|texel| *texel == [0.0; 4]));
}

/// A receiver near a texel: what remains is bounded by the area for which a sample stands, but no farther off than a fifth of the extent
/// of the square, and alpha has the rest.
#[test]
fn what_the_bound_removes_is_in_alpha() {
    let light = |bound: f32, area: f32| {
        let texel =
            RsmTexel { position: [0.0, 0.0, -2.8, 1.0], flux: [1.0, 1.0, 1.0, area], ..one_surface(1)[0] };
        let harness = Harness::new(PASS).with_scene(lit_by(&[SPOT])).frame(1, 1).view(|_, _| facing(3.0));
        let harness = harness.rsm((1, 1), &[texel]).set("samples", 4096).set("area_bound", bound);
        Some(irradiance(&harness.run()?)[0])
    };
    // 1 / (π d²) with d = ⅕, and 1 / A: a sample stands for less than the texel.
    let whole = 25.0 / PI;
    for (area, least) in [(0.2, 0.2), (2.0, 0.32 * PI)] {
        let (Some(free), Some(bounded)) = (light(0.0, area), light(1.0, area)) else { return };
        for (found, expected) in
            [(free[0], whole), (bounded[0], 1.0 / least), (bounded[0] + bounded[3], whole)]
        {
            assert!((f64::from(found) - expected).abs() < 2e-3 * expected, "{found} for {expected}");
        }
        assert_eq!(free[3], 0.0);
    }
}

#[test]
fn extremes_give_finite_light() {
    let bright = |position| RsmTexel { position, flux: [1e30, 1e30, 1e30, 1e-30], ..one_surface(1)[0] };
    // At the receiver itself, a rounding before it, and at the light.
    let near = [[0.0, 0.0, -3.0, 1.0], [0.0, 0.0, -2.999_999_8, 1.0], [0.0, 0.0, -2.0, 1.0]].map(bright);
    for (width, height) in [(1, 9), (6, 1), (5, 4)] {
        for (scene, layers) in
            [(pass_test::scene("empty"), 1), (lit_by(&[SPOT]), 1), (lit_by(&[LightKind::Point]), 6)]
        {
            for texel in near.into_iter().chain([RsmTexel::default()]) {
                for (bound, radius) in [(0.0, 1.5), (100.0, 0.0)] {
                    let outputs = Harness::new(PASS)
                        .with_scene(scene.clone())
                        .frame(width, height)
                        // The light itself is seen, and what lies behind it.
                        .view(|x, y| facing([2.0, 3.0, 1.0, 0.0][((x + y) % 4) as usize]))
                        .rsm((1, 1), &vec![texel; layers])
                        .set("samples", 3)
                        .set("area_bound", bound)
                        .set("radius", radius)
                        .run();
                    let Some(outputs) = outputs else { return };
                    let found = irradiance(&outputs);
                    assert!(found.iter().flatten().all(|x| x.is_finite() && *x >= 0.0), "{found:?}");
                    let is_dark = texel == RsmTexel::default() || radius == 0.0;
                    assert!(!is_dark || found.iter().all(|texel| *texel == [0.0; 4]), "{found:?}");
                }
            }
        }
    }
}
