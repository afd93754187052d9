//! Pictures whose frames are samples of them: what differs between frames, what they converge to, and when they begin again.

use crate::adapter::{bits, done, rel_mse, renderer, root, set};
use frame_graph::Value;
use glam::Vec3;
use metrics::Pair;
use renderer::Renderer;

const SIZE: (u32, u32) = (48, 48);

const FEW: &[&str] = &["lights=64", "map=16", "rsm.size=64"];

fn accumulated(frames: &str) -> Option<Renderer> {
    renderer("ism-invtm-accumulated", "cornell-box", SIZE, &[FEW, &[frames]].concat())
}

/// The same with maps of the scene's lights that are fine enough for the edges of their shadows.
fn with_fine_edges(frames: &str) -> Option<Renderer> {
    renderer("ism-invtm-accumulated", "cornell-box", SIZE, &["lights=64", "map=16", "rsm.size=1024", frames])
}

fn step(renderer: &Renderer) -> u32 {
    renderer.progress().unwrap().expect("the pipeline reports its progress").step
}

#[test]
fn the_first_sample_is_the_picture_without_accumulation() {
    let Some(mut mean) = accumulated("frames=4") else { return };
    let Some(mut single) = renderer("ism-invtm", "cornell-box", SIZE, &[FEW, &["supersampling=1"]].concat())
    else {
        return;
    };
    mean.frame().unwrap();
    single.frame().unwrap();
    for output in ["direct", "indirect", "image"] {
        let [mean, single] = [&mean, &single].map(|renderer| bits(&renderer.output(output).unwrap()));
        assert!(mean == single, "{output} differs");
    }
}

/// Edges of objects and shadows are as smooth as a path tracer has them, whose pixels are means over squares; and the noise
/// of few lights goes.
#[test]
#[ignore = "slow"]
fn the_mean_over_frames_converges() {
    let Some(mut paths) =
        renderer("reference", "cornell-box", SIZE, &["samples=256", "samples_per_frame=64"])
    else {
        return;
    };
    done(&mut paths);
    let errors = |frames: &str| {
        let mut renderer = with_fine_edges(frames)?;
        let ran = done(&mut renderer);
        let error = |output| rel_mse(&renderer.output(output).unwrap(), &paths.output(output).unwrap());
        Some((ran, error("direct"), error("indirect")))
    };
    let (Some(one), Some(many)) = (errors("frames=1"), errors("frames=24")) else { return };
    assert_eq!((one.0, many.0), (1, 24));
    assert!(many.1 < 0.25 * one.1, "direct light: {} after one frame, {} after 24", one.1, many.1);
    assert!(many.2 < 0.7 * one.2, "indirect light: {} after one frame, {} after 24", one.2, many.2);
}

#[test]
fn another_sample_is_no_movement_and_movement_begins_again() {
    let Some(mut renderer) = accumulated("frames=100") else { return };
    for frame in 1..=3 {
        renderer.frame().unwrap();
        assert_eq!(step(&renderer), frame);
    }
    let camera = renderer.scene().camera;
    let moved = scene::Camera { position: camera.position + Vec3::X * 0.1, ..camera };
    renderer.set_camera(Some(moved), false);
    renderer.frame().unwrap();
    assert_eq!(step(&renderer), 1, "the camera moved");
    // The frame after still differs in where the camera was before it.
    renderer.frame().unwrap();
    renderer.frame().unwrap();
    renderer.frame().unwrap();
    assert!(step(&renderer) >= 2, "it stands still");
}

/// A value that the sum does not follow from neither ends it nor begins the samples again.
#[test]
fn a_change_of_exposure_keeps_the_samples() {
    let picture = |changes: bool| {
        let mut renderer = accumulated("frames=100")?;
        for _ in 0..4 {
            renderer.frame().unwrap();
            if changes {
                renderer.set_value("image/screen.exposure", Value::F32(2.0)).unwrap();
            }
        }
        assert_eq!(step(&renderer), 4);
        Some(bits(&renderer.output("indirect").unwrap()))
    };
    let (Some(whole), Some(changed)) = (picture(false), picture(true)) else { return };
    assert!(whole == changed, "the same four samples");
}

/// A pass that reads no random numbers and no camera does not run again, and what it has made is kept: the maps of the scene's own
/// lights, and sums over them where they do not follow from the view.
#[test]
fn a_sample_runs_what_differs_between_samples_alone() {
    let all = ["view", "lights", "gather", "direct", "image/image", "image/screen"];
    let of_maps = ["importance", "sums", "shadows/splat", "filter"];
    for (pipeline, same, other) in [
        ("ism-invtm-accumulated", &["rsm"][..], &of_maps[..]),
        ("restir-vpl-accumulated", &["rsm", "flux", "sums"], &["propose", "near"]),
    ] {
        let Some(mut renderer) = crate::adapter::renderer(pipeline, "cornell-box-lights", SIZE, FEW) else {
            return;
        };
        renderer.frame().unwrap();
        renderer.frame().unwrap();
        let ran = renderer.frame().unwrap().ran.clone();
        let plan = renderer.plan().unwrap();
        let ran = |name: &str| {
            let at = plan.passes.iter().position(|pass| &*pass.name == name).expect("the plan has it");
            ran[at]
        };
        for name in same {
            assert!(!ran(name), "{pipeline}: the lights of the scene stand still, and {name} ran");
        }
        for name in all.iter().chain(other) {
            assert!(ran(name), "{pipeline}: {name} has another sample");
        }
    }
}

/// A pipeline without accumulation has the same picture in every frame, also after one that accumulates.
#[test]
fn other_pipelines_have_the_runs_own_sample() {
    let Some(mut renderer) = accumulated("frames=100") else { return };
    renderer.frame().unwrap();
    renderer.frame().unwrap();
    let Some(mut fresh) = crate::adapter::renderer("ism-invtm", "cornell-box", SIZE, FEW) else { return };
    renderer.set_pipeline("ism-invtm", &set(FEW)).unwrap();
    renderer.frame().unwrap();
    fresh.frame().unwrap();
    let [after, fresh] = [&renderer, &fresh].map(|renderer| bits(&renderer.output("image").unwrap()));
    assert!(after == fresh, "seed and place are the run's own again");
}

/// The tutorial's pass, in WGSL and RON alone: frames of a still picture are samples, and their mean converges.
#[test]
fn the_guides_average_converges() {
    let page = std::fs::read_to_string(root().join("docs/first-pipeline.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for name in ["average.ron", "average.wgsl"] {
        let from = page.find(&format!("// {name}")).unwrap_or_else(|| panic!("the guide has no {name}"));
        let text = page[from..].split("```").next().unwrap();
        let text = text.replace("\"average.wgsl\"", &format!("{:?}", folder.path().join("average.wgsl")));
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let pipeline = folder.path().join("average.ron").display().to_string();
    let Some(mut renderer) = renderer(&pipeline, "cornell-box", SIZE, FEW) else { return };
    let mut after = Vec::new();
    for frame in 1..=192 {
        renderer.frame().unwrap();
        if [1, 2, 24, 192].contains(&frame) {
            after.push(renderer.output("indirect").unwrap());
        }
    }
    // Not relative to each pixel: those at the edge of the box are dark in the frames that do not see it.
    let error = |i: usize| Pair::new(&after[i], &after[3]).unwrap().rmse();
    assert!(bits(&after[0]) != bits(&after[1]), "frames differ");
    assert!(error(2) < 0.4 * error(0), "{} after one frame, {} after 24", error(0), error(2));
}
