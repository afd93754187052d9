//! The filter of the documentation, docs/examples/a-trous.wgsl, against the same in plain f64.

use glam::{DVec3, Vec3, dvec3};
use half::f16;
use pass::{Format, ResourceDesc};
use pass_test::{Harness, random};

const WIDTH: u32 = 45;
const HEIGHT: u32 = 31;
const FOV: f64 = 0.8;

/// The surface that a pixel sees, in the precision of the textures.
#[derive(Clone, Copy)]
struct Pixel {
    depth: f32,
    normal: [f16; 4],
    irradiance: [f32; 4],
}

/// Two walls that meet in a corner, one step, noise of light, and a hole that sees nothing.
fn pixels(level: u32) -> Vec<Pixel> {
    let pixel = |i: u32| {
        let (x, y) = (i % WIDTH, i / WIDTH);
        let noise = |k: u32| random::unit_float(random::hash2(i * 4 + k, level)) as f32;
        let side = if x < 20 { [0.0, 0.0, 1.0] } else { [-0.6, 0.0, 0.8] };
        let depth = match (x, y) {
            (30..34, 10..16) => 0.0,
            (_, 22..) => 2.0,
            (20.., _) => 3.0 - 0.03 * (x - 20) as f32,
            _ => 3.0,
        };
        // A shadow: its light is another, not noise.
        let light = if x + y < 18 { 0.05 } else { 1.0 };
        let rgb = [0, 1, 2].map(|k| light * (0.5 + noise(k)));
        Pixel {
            depth,
            normal: [side[0], side[1], side[2], 0.0].map(f16::from_f32),
            irradiance: [rgb[0], rgb[1], rgb[2], noise(3)],
        }
    };
    (0..WIDTH * HEIGHT).map(pixel).collect()
}

/// World position of what a pixel sees, for a camera at the origin that looks along -z.
fn position(x: i32, y: i32, depth: f32) -> DVec3 {
    let (half_height, depth) = ((FOV / 2.0).tan(), f64::from(depth));
    let half_width = half_height * f64::from(WIDTH) / f64::from(HEIGHT);
    let ndc = |at: i32, side: u32| 2.0 * (f64::from(at) + 0.5) / f64::from(side) - 1.0;
    dvec3(ndc(x, WIDTH) * half_width, -ndc(y, HEIGHT) * half_height, -1.0) * depth
}

fn edge_weight(difference: f64, sigma: f64) -> f64 {
    (-(difference / sigma).powi(2)).exp()
}

/// One iteration. [Dammertz et al. 2010]
fn smooth_once(pixels: &[Pixel], level: u32, light_too: bool) -> Vec<[f64; 4]> {
    let at = |x: i32, y: i32| {
        let inside = (0..WIDTH as i32).contains(&x) && (0..HEIGHT as i32).contains(&y);
        inside.then(|| pixels[(y as u32 * WIDTH + x as u32) as usize])
    };
    let normal = |pixel: &Pixel| DVec3::from([0, 1, 2].map(|k| pixel.normal[k].to_f64()));
    let luminance = |pixel: &Pixel| {
        let [r, g, b, _] = pixel.irradiance.map(f64::from);
        dvec3(r, g, b).dot(dvec3(0.2126, 0.7152, 0.0722))
    };
    let step = 1 << level;
    let smooth = |(i, pixel): (usize, &Pixel)| {
        let (x, y) = (i as i32 % WIDTH as i32, i as i32 / WIDTH as i32);
        if pixel.depth <= 0.0 {
            return [0.0; 4];
        }
        let (mut sum, mut weights) = ([0.0; 4], 0.0);
        for (dy, dx) in (-2i32..=2).flat_map(|dy| (-2i32..=2).map(move |dx| (dy, dx))) {
            let (tap_x, tap_y) = (x + step * dx, y + step * dy);
            let Some(tap) = at(tap_x, tap_y).filter(|tap| tap.depth > 0.0) else { continue };
            let kernel = [3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];
            let offset = position(tap_x, tap_y, tap.depth) - position(x, y, pixel.depth);
            let mut weight = kernel[dx.unsigned_abs() as usize]
                * kernel[dy.unsigned_abs() as usize]
                * edge_weight(normal(&tap).distance(normal(pixel)), 0.35)
                * edge_weight(normal(pixel).dot(offset) / f64::from(pixel.depth), 0.02);
            if light_too {
                let (light, tap_light) = (luminance(pixel), luminance(&tap));
                weight *= edge_weight((tap_light - light) / (tap_light + light), 0.5 / f64::from(step));
            }
            (0..4).for_each(|k| sum[k] += weight * f64::from(tap.irradiance[k]));
            weights += weight;
        }
        sum.map(|sum| sum / weights)
    };
    pixels.iter().enumerate().map(smooth).collect()
}

/// Runs the shader on it.
fn run(pixels: &[Pixel], level: u32, edges: &str) -> Option<Vec<[f32; 4]>> {
    let texture = |format| ResourceDesc::texture_2d(format, (WIDTH, HEIGHT));
    let bytes = |of: &dyn Fn(&Pixel) -> Vec<u8>| pixels.iter().flat_map(of).collect::<Vec<u8>>();
    let camera = scene::Camera {
        position: Vec3::ZERO,
        target: Vec3::NEG_Z,
        up: Vec3::Y,
        vertical_fov: FOV as f32,
        near: 0.01,
    };
    let view = vec![
        ("depth", texture(Format::R32Float), bytes(&|pixel| pixel.depth.to_le_bytes().to_vec())),
        (
            "normal",
            texture(Format::Rgba16Float),
            bytes(&|pixel| pixel.normal.iter().flat_map(|n| n.to_le_bytes()).collect()),
        ),
    ];
    let irradiance = bytes(&|pixel| pixel.irradiance.iter().flat_map(|n| n.to_le_bytes()).collect());
    let outputs = Harness::new(compute::PASS)
        .shader("docs/examples/a-trous.wgsl")
        .frame(WIDTH, HEIGHT)
        .camera(camera)
        .set("level", level)
        .set("edges", edges)
        .input("view", "GBuffer", &[], view)
        .input("irradiance", "Irradiance", &[], vec![("", texture(Format::Rgba32Float), irradiance)])
        .run()?;
    Some(outputs.read("smoothed"))
}

#[test]
fn each_iteration_is_the_references() {
    for (level, edges) in [(0, "all"), (1, "all"), (3, "all"), (4, "all"), (2, "geometry")] {
        let pixels = pixels(level);
        let Some(got) = run(&pixels, level, edges) else { return };
        let expected = smooth_once(&pixels, level, edges == "all");
        for (i, (got, expected)) in got.iter().zip(&expected).enumerate() {
            for (got, expected) in got.iter().zip(expected) {
                // Exponents reach some 100 where weights still count; f32 has 24 bits of them, and positions 24 of metres.
                let error = (f64::from(*got) - expected).abs();
                assert!(
                    error <= 1e-3 * expected.abs(),
                    "level {level}, {edges}, pixel {i}: {got} for {expected}"
                );
            }
        }
    }
}

#[test]
fn five_iterations_remove_noise_and_keep_edges() {
    let mut pixels = pixels(7);
    let before = pixels.clone();
    for level in 0..5 {
        let smoothed = smooth_once(&pixels, level, true);
        for (pixel, smoothed) in pixels.iter_mut().zip(smoothed) {
            pixel.irradiance = smoothed.map(|value| value as f32);
        }
    }
    let spread = |pixels: &[Pixel], lit: bool| {
        let green: Vec<f64> = (0..)
            .zip(pixels)
            .filter(|(i, _)| i % WIDTH < 20 && i / WIDTH < 22 && (i % WIDTH + i / WIDTH >= 18) == lit)
            .map(|(_, pixel)| f64::from(pixel.irradiance[1]))
            .collect();
        let mean = green.iter().sum::<f64>() / green.len() as f64;
        let variance = green.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / green.len() as f64;
        (mean, variance.sqrt() / mean)
    };
    for (lit, light) in [(true, 1.0), (false, 0.05)] {
        let (mean, noise) = spread(&pixels, lit);
        let (_, noise_before) = spread(&before, lit);
        assert!(noise < 0.4 * noise_before, "lit {lit}: {noise} of {noise_before}");
        // Noise is uniform in 0.5..1.5 times the light: the edge of the shadow stays where its mean does.
        assert!((mean / light - 1.0).abs() < 0.25, "lit {lit}: {mean} for {light}");
    }
}
