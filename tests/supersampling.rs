//! Several samples of each pixel, among which the lights of a pixel are interleaved.

use crate::adapter::{done, energy, rel_mse, renderer, shown};
use metrics::Image;
use renderer::Renderer;

/// The mean of a pixel is nearer to that of path tracing, and no light is lost: direct light where shadows and slats are fine, and
/// indirect light where edges are many.
#[test]
fn edges_are_those_of_the_mean_over_pixels() {
    for (scene, output, most) in
        [("blinds", "direct", 0.5), ("arcade", "direct", 0.5), ("arcade", "indirect", 0.8)]
    {
        let values = ["samples=256", "samples_per_frame=64"];
        let Some(mut truth) = renderer("reference", scene, (48, 36), &values) else { return };
        done(&mut truth);
        let truth = truth.output(output).unwrap();
        let found = |samples: &str| {
            let values = ["lights=512", "map=32", samples];
            let mut renderer = renderer("ism-invtm", scene, (48, 36), &values).expect("an adapter");
            shown(&mut renderer, output)
        };
        let [one, four] = ["supersampling=1", "supersampling=2"].map(found);
        let ratio = rel_mse(&four, &truth) / rel_mse(&one, &truth);
        let energy = energy(&four) / energy(&truth);
        eprintln!("RATIO {scene}, {output}: error {ratio:.3}, energy {energy:.3}");
        assert!(ratio < most, "{scene}, {output}: {ratio} of the error of one sample");
        assert!((energy - 1.0).abs() < 0.06, "{scene}, {output}: {energy} of the energy");
    }
}

/// All outputs have a texel for each pixel.
#[test]
fn outputs_have_the_size_of_the_frame() {
    let sizes = |renderer: &Renderer| {
        let outputs = &renderer.plan().expect("a plan").outputs;
        let image = |name: &str| renderer.output(name).map(|image: Image| (image.width(), image.height()));
        let of_light = |interface: &str| matches!(interface, "Radiance" | "Irradiance" | "Display");
        let light = outputs.iter().filter(|output| of_light(output.interface.as_str()));
        light
            .map(|output| (output.name.to_string(), image(output.name.as_str()).unwrap()))
            .collect::<Vec<_>>()
    };
    for pipeline in [
        "ism",
        "ism-area-light",
        "ism-environment",
        "ism-glossy",
        "ism-multibounce",
        "ism-invtm",
        "ism-invtm-a-trous",
        "ism-invtm-accumulated",
        "ism-mixed-maps",
        "tcas",
        "acrsm",
        "instant-radiosity",
        "exhaustive",
        "stochastic-lightcuts",
    ] {
        let values = ["lights=64", "supersampling=2"];
        let Some(mut renderer) = renderer(pipeline, "cornell-box", (12, 9), &values) else { return };
        renderer.frame().unwrap();
        let sizes = sizes(&renderer);
        assert!(!sizes.is_empty() && sizes.iter().all(|(_, size)| *size == (12, 9)), "{pipeline}: {sizes:?}");
    }
}
