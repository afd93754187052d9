//! The pass on a GPU, against the CPU reference.

use crate::cpu_reference::{Rgb, composite, displayed};
use pass::{Format, ResourceDesc};
use pass_test::{Harness, Member, Outputs, halves, member};

const WIDTH: u32 = 12;
const HEIGHT: u32 = 8;
const PIXELS: usize = (WIDTH * HEIGHT) as usize;

/// Light over many magnitudes, the same in every run; the last pixels are the extremes.
fn light(seed: u32) -> Vec<Rgb> {
    let number = |i: u32| f64::from((seed + i).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24);
    let mut all: Vec<Rgb> =
        (0..PIXELS as u32).map(|i| [0, 1, 2].map(|k| 10f64.powf(6.0 * number(3 * i + k) - 4.0))).collect();
    all[PIXELS - 4] = [0.0; 3];
    all[PIXELS - 3] = [1e30; 3];
    all[PIXELS - 2] = [1e-30; 3];
    all
}

fn floats(texels: &[Rgb], alpha: f32) -> Vec<[f32; 4]> {
    texels.iter().map(|[r, g, b]| [*r as f32, *g as f32, *b as f32, alpha]).collect()
}

fn texture(format: Format) -> ResourceDesc {
    ResourceDesc::texture_2d(format, (WIDTH, HEIGHT))
}

/// A G-buffer of depth 1, but for the first pixel, which sees nothing.
fn view(albedo: &[Rgb], emission: &[Rgb]) -> Vec<Member<'static>> {
    let depth: Vec<f32> = (0..PIXELS).map(|i| f32::from(i != 0)).collect();
    let albedo: Vec<[u16; 4]> = albedo.iter().map(|[r, g, b]| halves([*r, *g, *b, 1.0])).collect();
    vec![
        member("depth", texture(Format::R32Float), &depth),
        ("normal", texture(Format::Rgba16Float), Vec::new()),
        member("albedo", texture(Format::Rgba16Float), &albedo),
        member("emission", texture(Format::Rgba32Float), &floats(emission, 0.0)),
    ]
}

fn radiance(texels: &[Rgb]) -> Vec<Member<'static>> {
    vec![member("", texture(Format::Rgba32Float), &floats(texels, 1.0))]
}

/// The pictures of all light, for a frame whose pixels have `side`² samples.
fn composed(
    side: u32,
    view: Vec<Member<'static>>,
    [direct, irradiance, glossy]: [&[Rgb]; 3],
) -> Option<Outputs> {
    Harness::new(composite::PASS)
        .frame(WIDTH / side, HEIGHT / side)
        .input("view", "GBuffer", &[], view)
        .input("direct", "Radiance", &[], radiance(direct))
        .input("indirect", "Irradiance", &[], radiance(irradiance))
        .input("glossy", "Radiance", &[], radiance(glossy))
        .run()
}

#[test]
fn light_is_added_as_the_cpu_reference_adds_it() {
    let (direct, irradiance, glossy, emission) = (light(1), light(2), light(3), light(4));
    let albedo = vec![[0.25, 0.5, 0.75]; PIXELS];
    let seen = view(&albedo, &emission);
    let Some(outputs) = composed(1, seen, [&direct, &irradiance, &glossy]) else { return };
    let (image, indirect): (Vec<[f32; 4]>, Vec<[f32; 4]>) =
        (outputs.read("image"), outputs.read("indirect_radiance"));
    for i in 0..PIXELS {
        let all = composite(direct[i], albedo[i], irradiance[i], glossy[i], emission[i]);
        let reflected = composite([0.0; 3], albedo[i], irradiance[i], glossy[i], [0.0; 3]);
        for k in 0..3 {
            assert!((f64::from(image[i][k]) / all[k] - 1.0).abs() < 1e-5 || all[k] == 0.0, "{i} {image:?}");
            let found = f64::from(indirect[i][k]);
            assert!((found / reflected[k] - 1.0).abs() < 1e-5 || reflected[k] == 0.0, "{i}: {found}");
        }
        assert_eq!((image[i][3], indirect[i][3]), if i == 0 { (0.0, 0.0) } else { (1.0, 1.0) });
    }
}

#[test]
fn a_pixel_is_the_mean_of_its_samples() {
    let (direct, irradiance, glossy, emission) = (light(1), light(2), light(3), light(4));
    let albedo = vec![[0.25, 0.5, 0.75]; PIXELS];
    for side in [2, 4] {
        let seen = view(&albedo, &emission);
        let Some(outputs) = composed(side, seen, [&direct, &irradiance, &glossy]) else { return };
        let black = [0.0; 3];
        let found =
            ["image", "direct_radiance", "indirect_radiance"].map(|name| outputs.read::<[f32; 4]>(name));
        for pixel in 0..PIXELS / (side * side) as usize {
            let (x, y) = (pixel as u32 % (WIDTH / side), pixel as u32 / (WIDTH / side));
            let samples = (0..side * side).map(|s| (y * side + s / side) * WIDTH + x * side + s % side);
            let mean = |sample: &dyn Fn(usize) -> Rgb| {
                samples.clone().fold(black, |sum, s| {
                    let of_sample = sample(s as usize);
                    std::array::from_fn(|k| sum[k] + of_sample[k] / f64::from(side * side))
                })
            };
            let expected = [
                mean(&|i| composite(direct[i], albedo[i], irradiance[i], glossy[i], emission[i])),
                mean(&|i| direct[i]),
                mean(&|i| composite(black, albedo[i], irradiance[i], glossy[i], black)),
            ];
            for (found, expected) in found.iter().zip(expected) {
                for (found, expected) in found[pixel].iter().zip(expected) {
                    let near = (f64::from(*found) - expected).abs() <= 1e-5 * expected;
                    assert!(near, "{side}² samples at {pixel}: {found} for {expected}");
                }
            }
            // The first sample sees nothing.
            let share = if pixel == 0 { 1.0 - 1.0 / (side * side) as f32 } else { 1.0 };
            assert!(found.iter().all(|found| (found[pixel][3] - share).abs() < 1e-6));
        }
        assert_eq!(outputs.read::<[u8; 4]>("display").len(), PIXELS / (side * side) as usize);
    }
}

#[test]
fn every_curve_shows_what_the_cpu_reference_shows() {
    let mut direct = light(5);
    direct[PIXELS - 1] = [0.0, f64::NAN, 0.0];
    for tonemap in ["reinhard", "reinhard-simple", "aces", "filmic", "none"] {
        let black = vec![[0.0; 3]; PIXELS];
        let outputs = Harness::new(composite::PASS)
            .frame(WIDTH, HEIGHT)
            .set("tonemap", tonemap)
            .set("exposure", 1.5f32)
            .set("white", 6.0f32)
            .input("view", "GBuffer", &[], view(&black, &black))
            .input("direct", "Radiance", &[], radiance(&direct))
            .run();
        let Some(outputs) = outputs else { return };
        let display: Vec<[u8; 4]> = outputs.read("display");
        for (i, found) in display.iter().enumerate() {
            assert_eq!(found[3], 255, "a display hides nothing");
            let expected = displayed(tonemap, direct[i], 1.5, 6.0);
            for k in 0..3 {
                // Half a step for rounding, and a little for the GPU's pow.
                let error = (f64::from(found[k]) - expected[k] * 255.0).abs();
                assert!(error < 0.6, "{tonemap} of {:?}: {found:?} for {expected:?}", direct[i]);
            }
        }
    }
}

#[test]
fn an_input_of_another_size_is_refused() {
    let harness = Harness::new(composite::PASS).frame(WIDTH, HEIGHT);
    let small = vec![("", ResourceDesc::texture_2d(Format::Rgba32Float, (4, 4)), Vec::new())];
    let black = vec![[0.0; 3]; PIXELS];
    let harness =
        harness.input("view", "GBuffer", &[], view(&black, &black)).input("direct", "Radiance", &[], small);
    let Some(refusal) = harness.refusal() else { return };
    assert!(refusal.contains("`direct` is 4×4, but `view` is 12×8"), "{refusal}");
    // Who gave no size, as in `check`, is told which one these follow from.
    assert!(refusal.contains("of a frame of 12×8 px"), "{refusal}");
}
