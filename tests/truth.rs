//! The reference pipeline: it accumulates, stops, begins again where something moves, and agrees with virtual lights
//! that have nothing wrong with them but their number.

use crate::adapter::{bits, done, mean, references, renderer, shown};
use crate::program::Folder;
use frame_graph::Value;
use glam::Vec3;
use metrics::statistics::Summary;
use metrics::{Epsilon, Image, Pair};
use renderer::Renderer;

fn samples(renderer: &Renderer) -> u32 {
    renderer.progress().unwrap().expect("the reference reports its progress").step
}

#[test]
fn frames_add_up_to_the_same_picture() {
    let picture = |per_frame: &str| {
        let values = ["samples=8", per_frame];
        let mut renderer = renderer("reference", "cornell-box", (24, 24), &values)?;
        let frames = done(&mut renderer);
        Some((frames, renderer.output("image").unwrap()))
    };
    let Some((one, whole)) = picture("samples_per_frame=8") else { return };
    let Some((many, parts)) = picture("samples_per_frame=3") else { return };
    assert_eq!((one, many), (1, 3));
    // A frame's samples are summed before they are added to those before: other frames round otherwise, and no more.
    for (a, b) in whole.pixels().iter().flatten().zip(parts.pixels().iter().flatten()) {
        assert!((a - b).abs() <= 1e-6 * a.abs(), "samples are the same ones: {a} in one frame, {b} in three");
    }
    assert!(whole.pixels().iter().any(|pixel| pixel[0] > 0.0));
}

#[test]
fn it_stops_at_the_count_and_stays() {
    let Some(mut renderer) = renderer("reference", "cornell-box", (16, 16), &["samples=10"]) else { return };
    assert_eq!(done(&mut renderer), 3, "4 + 4 + 2 samples");
    assert_eq!(samples(&renderer), 10);
    let finished = bits(&renderer.output("indirect").unwrap());
    for _ in 0..3 {
        renderer.frame().unwrap();
    }
    assert_eq!(samples(&renderer), 10);
    assert!(finished == bits(&renderer.output("indirect").unwrap()), "no sample comes after the last");
}

#[test]
fn it_stops_at_the_error_it_estimates() {
    let values = ["samples=4096", "samples_per_frame=16", "error=0.1"];
    let Some(mut renderer) = renderer("reference", "cornell-box", (16, 16), &values) else { return };
    done(&mut renderer);
    let progress = renderer.progress().unwrap().unwrap();
    assert!(progress.is_done() && progress.error <= 0.1 && progress.step < 4096, "{progress:?}");
    assert!(progress.error > 0.01, "one frame fewer would not have done: {progress:?}");
}

/// The estimate of the error is near the measured one, also at few samples, where a rare bright path stands out of dark pixels.
/// Scrambled sequences err less than independent samples would, the more the more samples there are.
#[test]
fn the_estimate_is_of_the_size_of_the_error() {
    let picture = |samples: u32, seed: u32| {
        let values = [&format!("samples={samples}") as &str, "samples_per_frame=16"];
        let mut renderer = renderer("reference", "cornell-box", (32, 32), &values)?;
        renderer.set_seed(seed);
        done(&mut renderer);
        Some((renderer.output("image").unwrap(), renderer.progress().unwrap().unwrap().error))
    };
    let Some((fine, _)) = picture(2048, 99) else { return };
    for (samples, seeds) in [(64, 8), (256, 4)] {
        let ratios: Vec<f64> = (1..=seeds)
            .map(|seed| {
                let (rough, estimate) = picture(samples, seed).unwrap();
                let measured = Pair::new(&rough, &fine).unwrap().rel_mse(Epsilon::default()).unwrap();
                // The fine picture errs as well.
                f64::from(estimate) / measured * (1.0 + f64::from(samples) / 2048.0)
            })
            .collect();
        let Summary { mean, half_width_95, .. } = Summary::of(&ratios).unwrap();
        let interval = (mean - half_width_95, mean + half_width_95);
        assert!(interval.0 > 0.7 && interval.1 < 1.4, "{samples} samples: estimate / measured {interval:?}");
    }
}

/// A value that the samples do not follow from, another output and another pass do not end them; one that they follow
/// from does.
#[test]
fn what_does_not_concern_the_samples_does_not_end_them() {
    let Some(mut renderer) = renderer("reference", "cornell-box", (16, 16), &["samples=64"]) else { return };
    renderer.frame().unwrap();
    renderer.set_value("image.exposure", Value::F32(1.5)).unwrap();
    renderer.frame().unwrap();
    assert_eq!(samples(&renderer), 8, "the exposure is of the picture, not of the samples");
    renderer.keep("view.normal").unwrap();
    renderer.frame().unwrap();
    assert_eq!(samples(&renderer), 12, "another output");
    renderer.set_value("bounces", Value::U32(2)).unwrap();
    renderer.frame().unwrap();
    assert_eq!(samples(&renderer), 4, "paths are of other lengths");
}

#[test]
fn what_moves_begins_again() {
    let Some(mut renderer) = renderer("reference", "cornell-box-moving", (16, 16), &["samples=12"]) else {
        return;
    };
    done(&mut renderer);
    assert_eq!(samples(&renderer), 12);
    // The same time again changes nothing; another one does, and so does the camera.
    renderer.set_frame_index(0);
    renderer.frame().unwrap();
    assert_eq!(samples(&renderer), 12);
    renderer.set_frame_index(7);
    renderer.frame().unwrap();
    assert_eq!(samples(&renderer), 4, "something moved");
    let camera = renderer.scene().camera;
    renderer.set_camera(Some(scene::Camera { position: camera.position + Vec3::X * 0.1, ..camera }), false);
    renderer.set_frame_index(7);
    renderer.frame().unwrap();
    assert_eq!(samples(&renderer), 4, "the camera moved");
}

/// Virtual lights without fault: every one from every pixel by rays, clamped as the paths are. SMC-IR §5.4.
#[test]
fn virtual_lights_converge_to_clamped_paths() {
    let size = (32, 32);
    let lights = ["lights=4096", "rsm.size=256", "gather.clamp=0.2", "gather.area_bound=0.0"];
    let Some(mut exhaustive) = renderer("exhaustive", "cornell-box", size, &lights) else { return };
    let found = shown(&mut exhaustive, "indirect");
    let reference = |clamp: &str| {
        let values = ["samples=512", "samples_per_frame=64", "filter=centre", clamp];
        let mut renderer = renderer("reference", "cornell-box", size, &values)?;
        done(&mut renderer);
        Some((renderer.output("indirect").unwrap(), renderer.output("irradiance").unwrap()))
    };
    let Some((clamped, irradiance)) = reference("clamp=0.2") else { return };
    let Some((whole, _)) = reference("clamp=0") else { return };
    let energy = Pair::new(&found, &clamped).unwrap().energy_ratio().unwrap();
    let of_whole = Pair::new(&found, &whole).unwrap().energy_ratio().unwrap();
    assert!((energy - 1.0).abs() < 0.01, "energy {energy} of the clamped paths'");
    assert!(of_whole < 0.98, "energy {of_whole} of the whole: the clamp takes some away");
    // Both say how much.
    let removed = |image: &Image| metrics::virtual_lights::clamped_share(image).unwrap();
    let [paths, virtual_lights] = [removed(&irradiance), removed(&exhaustive.output("irradiance").unwrap())];
    assert!((paths / virtual_lights - 1.0).abs() < 0.1, "paths {paths}, virtual lights {virtual_lights}");
    // Short rays return it, where there is more of it than errors of the lights.
    let rays = [&lights[..], &["near-field.rays_per_pixel=64"]].concat();
    let Some(mut compensated) = renderer("bias-compensated", "cornell-box", size, &rays) else { return };
    let found = shown(&mut compensated, "indirect");
    let energy = Pair::new(&found, &whole).unwrap().energy_ratio().unwrap();
    assert!((energy - 1.0).abs() < 0.01, "energy {energy} of the whole");
}

/// The mean over squares of pixels, as a smaller picture has it.
pub(crate) fn shrunk(image: &Image, by: usize) -> Image {
    let area = (by * by) as f32;
    Image::from_fn(image.width() / by, image.height() / by, |x, y| {
        let mut sum = [0.0; 4];
        for i in 0..by * by {
            let pixel = image.pixels()[(y * by + i / by) * image.width() + x * by + i % by];
            (0..4).for_each(|c| sum[c] += pixel[c] / area);
        }
        sum
    })
    .unwrap()
}

/// The same quantity by another program: Mitsuba's, whose pictures have squares of 4×4 pixels for each of these.
#[test]
fn another_path_tracer_agrees() {
    let Some(folder) = references() else { return };
    let cases = [
        ("cornell_spot", (64, 64), "direct", 0, 64, 0.02),
        ("cornell_spot", (64, 64), "indirect", 1, 512, 0.02),
        ("cornell_spot", (64, 64), "indirect", 3, 512, 0.02),
        ("sponza_spot", (80, 60), "indirect", 1, 512, 0.06),
        ("sponza_sun", (80, 60), "indirect", 3, 512, 0.06),
    ];
    for (name, size, output, bounces, count, most) in cases {
        let scene = folder.join(format!("{name}.glb"));
        let values =
            [format!("bounces={bounces}"), format!("samples={count}"), "samples_per_frame=32".to_owned()];
        let values: Vec<&str> = values.iter().map(String::as_str).collect();
        let Some(mut renderer) = renderer("reference", &scene.to_string_lossy(), size, &values) else {
            return;
        };
        done(&mut renderer);
        let found = renderer.output(output).unwrap();
        let file = if output == "direct" { output.to_owned() } else { format!("{output}{bounces}") };
        let reference = shrunk(&Image::read(folder.join(format!("{name}_{file}.exr"))).unwrap(), 4);
        let pair = Pair::new(&found, &reference).unwrap();
        let (energy, error) = (pair.energy_ratio().unwrap(), pair.rel_mse(Epsilon::default()).unwrap());
        eprintln!("{name}, {file}: energy {energy:.4}, relMSE {error:.2e}");
        assert!((energy - 1.0).abs() < 0.005, "{name}, {file}: energy {energy}");
        assert!(error < most, "{name}, {file}: relMSE {error}");
    }
}

/// A path tracer takes the place of every maker of irradiance.
#[test]
fn paths_make_irradiance_too() {
    let folder = Folder::new(&[]);
    let text = r#"Pipeline(
        extends: "reference.ron",
        passes: { "lit": Pass(kind: "composite", in: { "view": "view", "indirect": "path.irradiance" }) },
        outputs: { "indirect": "lit.indirect_radiance", "radiance": "path.indirect" },
    )"#;
    folder.write("pipelines/mixed.ron", text);
    let values = ["samples=32", "samples_per_frame=32", "filter=centre"];
    let Some(mut mixed) = crate::adapter::renderer_in(&folder, "mixed", "cornell-box", (24, 24), &values)
    else {
        return;
    };
    mixed.frame().unwrap();
    let [lit, paths] = ["indirect", "radiance"].map(|name| mean(&mixed.output(name).unwrap())[0]);
    // Albedos are stored in half precision.
    assert!(paths > 0.0 && (lit / paths - 1.0).abs() < 1e-3, "{lit} and {paths}");
}
