//! The example of the documentation, drawn.

use half::f16;
use pass::{Format, ResourceDesc};
use pass_test::Stand;

#[test]
fn the_vignette_darkens_the_corners() {
    const WIDTH: u32 = 20;
    const HEIGHT: u32 = 10;
    let white: Vec<u8> = 1f32.to_le_bytes().repeat((WIDTH * HEIGHT * 4) as usize);
    let picture = ResourceDesc::texture_2d(Format::Rgba32Float, (WIDTH, HEIGHT));
    let outputs = Stand::new(fullscreen::PASS)
        .shader("docs/examples/vignette.wgsl")
        .frame(7, 7)
        .set("strength", 0.8f32)
        .input("picture", "Radiance", &[], vec![("", picture, white)])
        .run();
    let Some(outputs) = outputs else { return };
    let shown: Vec<[f16; 4]> = outputs.read("result");
    assert_eq!(shown.len() as u32, WIDTH * HEIGHT, "as large as the picture, not as the frame");
    for (i, found) in shown.iter().enumerate() {
        let centre = |k: u32, side: u32| (k as f32 + 0.5) / side as f32 - 0.5;
        let (x, y) = (centre(i as u32 % WIDTH, WIDTH), centre(i as u32 / WIDTH, HEIGHT));
        let expected = 1.0 - 0.8 * 2.0 * (x * x + y * y);
        assert!((found[0].to_f32() - expected).abs() < 1e-3, "({x}, {y}): {} for {expected}", found[0]);
    }
}
