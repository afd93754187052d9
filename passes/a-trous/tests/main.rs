//! The filter removes the pattern of interleaving, and keeps edges.

use glam::Vec3;
use half::f16;
use pass::{Format, ResourceDesc};
use pass_test::Harness;

const SIDE: u32 = 48;

/// What the filter makes of an interleaved picture of 4×4 sub-images, in which a function gives each pixel its depth \[m\]
/// and normal, and another its irradiance. The camera looks along -z.
fn filtered(
    see: impl Fn(u32, u32) -> (f32, [f32; 3]),
    irradiance: impl Fn(u32, u32) -> f32,
    iterations: u32,
) -> Option<Vec<f32>> {
    let pixels = || (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE));
    let depth: Vec<f32> = pixels().map(|(x, y)| see(x, y).0).collect();
    let normal: Vec<[u16; 4]> = pixels()
        .map(|(x, y)| {
            let [x, y, z] = see(x, y).1;
            [x, y, z, 0.0].map(|v| f16::from_f32(v).to_bits())
        })
        .collect();
    let value: Vec<[f32; 4]> = pixels().map(|(x, y)| [irradiance(x, y); 4]).collect();
    let texture = |format| ResourceDesc::texture_2d(format, (SIDE, SIDE));
    let camera = scene::Camera {
        position: Vec3::ZERO,
        target: Vec3::NEG_Z,
        up: Vec3::Y,
        vertical_fov: 0.8,
        near: 0.01,
    };
    let outputs = Harness::new(a_trous::PASS)
        .frame(SIDE, SIDE)
        .camera(camera)
        .set("iterations", iterations)
        .input(
            "view",
            "GBuffer",
            &[],
            vec![
                ("depth", texture(Format::R32Float), bytemuck::cast_slice(&depth).to_vec()),
                ("normal", texture(Format::Rgba16Float), bytemuck::cast_slice(&normal).to_vec()),
            ],
        )
        .input(
            "irradiance",
            "Irradiance",
            &[("interleave_x", 4), ("interleave_y", 4)],
            vec![("", texture(Format::Rgba32Float), bytemuck::cast_slice(&value).to_vec())],
        )
        .run()?;
    let pixels: Vec<[f32; 4]> = outputs.read("filtered");
    Some(pixels.into_iter().map(|pixel| pixel[0]).collect())
}

const TOWARDS: [f32; 3] = [0.0, 0.0, 1.0];

/// A wall across the axis.
fn wall(_: u32, _: u32) -> (f32, [f32; 3]) {
    (3.0, TOWARDS)
}

fn subset(x: u32, y: u32) -> f32 {
    (y % 4 * 4 + x % 4) as f32
}

/// Pixels so far from the edges of the picture that windows end within it.
fn inner(pixels: &[f32]) -> impl Iterator<Item = f32> + '_ {
    let inside = |i: usize| (16..32).contains(&(i as u32 % SIDE)) && (16..32).contains(&(i as u32 / SIDE));
    pixels.iter().enumerate().filter(move |(i, _)| inside(*i)).map(|(_, value)| *value)
}

/// Each subset has the same weight after two iterations, and not after one.
#[test]
fn the_pattern_of_the_interleaving_goes() {
    let (Some(two), Some(one)) = (filtered(wall, subset, 0), filtered(wall, subset, 1)) else { return };
    for value in inner(&two) {
        assert!((value - 7.5).abs() < 1e-4, "{value} for the mean of all subsets");
    }
    assert!(
        inner(&one).any(|value| (value - 7.5).abs() > 0.1),
        "one iteration is too few for four sub-images"
    );
}

/// Half of the picture sees something nearer, or something that faces another way: neither takes of the other.
#[test]
fn edges_stay() {
    let step = |x: u32, _: u32| (if x < SIDE / 2 { 3.0 } else { 5.0 }, TOWARDS);
    let crease = |x: u32, _: u32| (3.0, if x < SIDE / 2 { TOWARDS } else { [1.0, 0.0, 0.0] });
    let light = |x: u32, _: u32| if x < SIDE / 2 { 1.0 } else { 9.0 };
    for pixels in [filtered(step, light, 0), filtered(crease, light, 0)] {
        let Some(pixels) = pixels else { return };
        for (i, value) in (0..).zip(pixels) {
            let wanted = light(i % SIDE, 0);
            assert!((value - wanted).abs() < 1e-3, "{value} for {wanted} at {}, {}", i % SIDE, i / SIDE);
        }
    }
}

#[test]
fn what_sees_nothing_is_black_and_gives_nothing() {
    let hole = |x: u32, y: u32| if (x, y) == (20, 20) { (0.0, [0.0; 3]) } else { wall(x, y) };
    let light = |x: u32, y: u32| if (x, y) == (20, 20) { 1e6 } else { 2.0 };
    let Some(pixels) = filtered(hole, light, 0) else { return };
    for (i, value) in (0..).zip(pixels) {
        let wanted = if i == 20 * SIDE + 20 { 0.0 } else { 2.0 };
        assert!((value - wanted).abs() < 1e-4, "{value} for {wanted}");
    }
}

/// A floor seen at a grazing angle is one surface, though depths of neighbours differ by far more than `plane`.
#[test]
fn a_slanted_floor_is_one_surface() {
    let floor = |_: u32, y: u32| {
        // 1 m below the camera.
        let down = ((f64::from(y) + 0.5) / f64::from(SIDE) * 2.0 - 1.0) * f64::from(0.4f32).tan();
        if down > 0.02 { ((1.0 / down) as f32, [0.0, 1.0, 0.0]) } else { (0.0, [0.0; 3]) }
    };
    let stripes = |_: u32, y: u32| (y % 2) as f32;
    let Some(pixels) = filtered(floor, stripes, 0) else { return };
    for x in 16..32 {
        let value = pixels[(36 * SIDE + x) as usize];
        assert!((value - 0.5).abs() < 0.05, "stripes remain: {value}");
    }
}
