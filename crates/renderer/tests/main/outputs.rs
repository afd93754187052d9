//! Outputs, what is kept beside them, progress, and provenance.

use crate::{counted, gpu, renderer, step, without_pipeline};
use frame_graph::{Overrides, Value};
use renderer::{Provenance, RenderError};
use std::ops::ControlFlow;

#[test]
fn an_output_that_is_not_there_is_told_with_the_nearest_or_all() {
    let Some((mut renderer, _folder)) = renderer() else { return };
    counted(&mut renderer);
    let error = renderer.output("dept").unwrap_err().to_string();
    assert!(error.contains("`dept`") && error.contains("did you mean `depth`"), "{error}");
    let error = renderer.output("irradiance").unwrap_err().to_string();
    assert!(error.contains("`depth`") && error.contains("`count`"), "no name is near: {error}");
    assert!(matches!(renderer.output_texture("dept"), Err(RenderError::NoOutput { .. })));
    assert_eq!(renderer.output_texture("depth").unwrap().texture().size().width, 8);
}

#[test]
fn a_resource_is_kept_for_reading_back() {
    let Some((mut renderer, _folder)) = renderer() else { return };
    assert!(renderer.keep("view.norml").is_err());
    renderer.keep("view.normal").unwrap();
    renderer.frame().unwrap();
    let normal = renderer.picture("view.normal", 0).unwrap();
    let length = |pixel: &[f32; 4]| pixel[..3].iter().map(|x| x * x).sum::<f32>().sqrt();
    assert!(normal.pixels().iter().any(|pixel| (length(pixel) - 1.0).abs() < 1e-2), "a floor has normals");
}

#[test]
fn frames_run_until_the_pipeline_says_that_it_is_done() {
    let Some((mut plain, folder)) = renderer() else { return };
    let mut reported = Vec::new();
    let mut note = |progress: Option<renderer::Progress>| reported.push(progress.is_some());
    plain
        .frame_until_done(|_, progress| {
            note(progress);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(reported, [false], "a pipeline that says nothing is done with every frame");

    let Some(gpu) = gpu() else { return };
    let mut progressive = without_pipeline(gpu, folder.path(), "plane");
    let set = |name: &str, value| (name.to_owned(), Value::U32(value));
    let values = Overrides(vec![set("samples", 3), set("samples_per_frame", 1)]);
    progressive.set_pipeline("reference", &values).unwrap();
    let mut frames = 0;
    progressive
        .frame_until_done(|_, _| {
            frames += 1;
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(frames, 3);
    progressive.set_seed(1);
    progressive.run_everything();
    frames = 0;
    progressive
        .frame_until_done(|_, _| {
            frames += 1;
            ControlFlow::Break(())
        })
        .unwrap();
    assert_eq!(frames, 1, "the application broke off");
    let values = Overrides(vec![set("samples", 9), set("samples_per_frame", 1)]);
    progressive.set_pipeline("reference", &values).unwrap();
    let mut partial = Vec::new();
    progressive
        .frames_until_done(3, |report, _| {
            partial.push(report.partial);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(partial, [false, true, false], "the last of so many frames is whole");
}

#[test]
fn provenance_makes_the_same_renderer_again() {
    let Some((mut renderer, folder)) = renderer() else { return };
    renderer.set_pipeline("own", &step(2.5)).unwrap();
    renderer.set_seed(7);
    counted(&mut renderer);
    let written = Provenance::new(&renderer, "plane", ("count", 0), 0);
    let read = Provenance::from_json(&written.to_json()).unwrap();
    for size in [(0, 6), (8, 16_385)] {
        let refused = Provenance::from_json(&Provenance { size, ..read.clone() }.to_json());
        let refused = refused.err().map(|error| error.to_string()).unwrap_or_default();
        assert!(refused.contains("a side is from 1 to 16384 px"), "{refused}");
    }
    assert_eq!(read.overrides(), step(2.5));
    assert_eq!((read.size, read.frame, read.seed), ((8, 6), 0, 7));

    let mut again = without_pipeline(renderer.gpu().clone(), folder.path(), &read.scene);
    again.set_pipeline(&read.pipeline, &read.overrides()).unwrap();
    again.set_seed(read.seed);
    assert_eq!(counted(&mut again), [2.5, 0.0]);
    let same = Provenance::new(&again, &read.scene, ("count", 0), read.first_frame);
    assert_eq!(read.differences(&same), Vec::<String>::new());

    // What an application replaced of the scene is in the record too.
    let camera = scene::Camera { position: glam::Vec3::new(0.1, 2.0, 3.3), ..again.scene().camera };
    let mut lights = again.scene().lights.clone();
    lights.iter_mut().for_each(|light| light.intensity *= 0.3);
    again.set_camera(Some(camera), true);
    again.set_lights(Some(lights.clone())).unwrap();
    again.set_time(Some(0.7));
    counted(&mut again);
    let moved = Provenance::new(&again, "plane", ("count", 0), 0);
    let moved = Provenance::from_json(&moved.to_json()).unwrap();
    moved.apply_view(&mut renderer).unwrap();
    counted(&mut renderer);
    assert_eq!((renderer.pose().camera, renderer.pose().time), (camera, 0.7));
    assert_eq!(renderer.pose().lights, lights);

    again.set_pipeline("own", &step(1.0)).unwrap();
    counted(&mut again);
    let other = Provenance::new(&again, "plane", ("count", 0), 0);
    assert!(read.differences(&other).iter().any(|line| line.starts_with("plan: ")), "the setting differs");
}
