//! The example of the documentation and the shadow term, drawn.

use frame_graph::port::OutputOverride;
use half::f16;
use pass::{Format, ResourceDesc};
use pass_test::{Harness, member};

#[test]
fn the_vignette_darkens_the_corners() {
    const WIDTH: u32 = 20;
    const HEIGHT: u32 = 10;
    let white: Vec<u8> = 1f32.to_le_bytes().repeat((WIDTH * HEIGHT * 4) as usize);
    let picture = ResourceDesc::texture_2d(Format::Rgba32Float, (WIDTH, HEIGHT));
    let display = OutputOverride { interface: Some("Display".into()), ..OutputOverride::default() };
    let harness = || {
        Harness::new(fullscreen::PASS)
            .shader("docs/examples/vignette.wgsl")
            .frame(7, 7)
            .set("strength", 0.8f32)
            .input("picture", "Radiance", &[], vec![("", picture.clone(), white.clone())])
    };
    let (Some(shown), Some(displayed)) = (harness().run(), harness().out("result", display).run()) else {
        return;
    };
    let shown: Vec<[f16; 4]> = shown.read("result");
    assert_eq!(shown.len() as u32, WIDTH * HEIGHT, "as large as the picture, not as the frame");
    let displayed: Vec<[u8; 4]> = displayed.read("result");
    for (i, found) in shown.iter().enumerate() {
        let centre = |k: u32, side: u32| (k as f32 + 0.5) / side as f32 - 0.5;
        let (x, y) = (centre(i as u32 % WIDTH, WIDTH), centre(i as u32 / WIDTH, HEIGHT));
        let expected = 1.0 - 0.8 * 2.0 * (x * x + y * y);
        assert!((found[0].to_f32() - expected).abs() < 1e-3, "({x}, {y}): {} for {expected}", found[0]);
        let byte = f32::from(displayed[i][0]);
        // What Vulkan allows for rounding to bytes: 0.6 of a step, where 0.5 would be exact.
        assert!((byte - expected * 255.0).abs() < 0.61, "({x}, {y}): {byte} for {expected}");
    }
}

/// The part of the light that shadows take away, by luminance: none where more arrives than there is, or where there is no light.
#[test]
fn the_shadow_term_is_what_shadows_take_away() {
    // What arrives with shadows and without, and the term.
    let cases: [([f32; 3], [f32; 3], f32); 5] = [
        ([2.0; 3], [8.0; 3], 0.75),
        ([0.0; 3], [0.5; 3], 1.0),
        ([0.0, 1.0, 0.0], [1.0; 3], 1.0 - 0.7152),
        ([3.0; 3], [2.0; 3], 0.0),
        ([0.0; 3], [0.0; 3], 0.0),
    ];
    let picture = ResourceDesc::texture_2d(Format::Rgba32Float, (cases.len() as u32, 1));
    let light = |colors: Vec<[f32; 3]>| {
        let texels: Vec<[f32; 4]> = colors.iter().map(|[r, g, b]| [*r, *g, *b, 1.0]).collect();
        vec![member("", picture.clone(), &texels)]
    };
    let harness = Harness::new(fullscreen::PASS)
        .shader("shaders/shadow-term.wgsl")
        .input("shadowed", "Radiance", &[], light(cases.map(|case| case.0).to_vec()))
        .input("unshadowed", "Radiance", &[], light(cases.map(|case| case.1).to_vec()));
    let Some(outputs) = harness.run() else { return };
    let found: Vec<[f16; 4]> = outputs.read("result");
    for (found, (shadowed, unshadowed, expected)) in found.iter().zip(cases) {
        let wrong = (found[0].to_f32() - expected).abs() > 1e-3;
        assert!(!wrong, "{shadowed:?} of {unshadowed:?}: {} for {expected}", found[0]);
    }
}
