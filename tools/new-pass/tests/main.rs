//! Tests of the pass.

use new_pass::PASS;
use pass::{Format, ResourceDesc};
use pass_test::Harness;

#[test]
fn every_variant_of_the_shaders_is_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}

#[test]
fn the_gpu_agrees_with_the_cpu_reference() {
    // No multiple of a workgroup in either direction.
    let (width, height) = (19u8, 13u8);
    let radiance: Vec<[f32; 4]> =
        (0..width * height).map(f32::from).map(|i| [i, 1e30 * i, -1e-30 * i, i % 2.0]).collect();
    let bytes = radiance.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let texture = ResourceDesc::texture_2d(Format::Rgba32Float, (width.into(), height.into()));
    let harness = Harness::new(PASS).set("gain", 2.5f32).frame(width.into(), height.into()).input(
        "radiance",
        "Radiance",
        &[],
        vec![("", texture, bytes)],
    );
    let Some(outputs) = harness.run() else { return };

    let image: Vec<[f32; 4]> = outputs.read("image");
    assert_eq!(image.len(), radiance.len());
    for (texel, &[r, g, b, seen]) in image.iter().zip(&radiance) {
        let expected = [r, g, b].map(|x| f64::from(x) * 2.5);
        for (&on_gpu, exact) in texel.iter().zip(expected) {
            // One product, rounded once.
            assert!(
                (f64::from(on_gpu) - exact).abs() <= f64::from(f32::EPSILON) * exact.abs(),
                "{on_gpu} {exact}"
            );
        }
        assert_eq!(texel[3], seen);
    }
}
