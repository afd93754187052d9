//! Frames that go on, values that are kept, and causes that reset history buffers.

use crate::{PIPELINE, counted, gpu, renderer, step, tree, without_pipeline};
use frame_graph::Overrides;
use renderer::{Assets, Catalog, Reload, RenderError, Renderer};
use std::collections::BTreeSet;
use std::sync::Arc;

#[test]
fn a_frame_without_a_pipeline_is_an_error() {
    let Some(gpu) = gpu() else { return };
    let folder = tree();
    let mut renderer = without_pipeline(gpu, folder.path(), "plane");
    assert!(matches!(renderer.frame(), Err(RenderError::NoPipeline)));
    assert!(matches!(renderer.output("count"), Err(RenderError::NoPipeline)));
    assert!(renderer.progress().unwrap().is_none());
}

#[test]
fn what_is_refused_replaces_nothing() {
    let Some((mut renderer, folder)) = renderer() else { return };
    assert_eq!(counted(&mut renderer), [1.0, 0.0]);
    assert!(renderer.set_pipeline("owm", &Overrides::default()).is_err(), "there is no such file");
    assert!(renderer.set_pipeline("own", &step(10.0)).is_err(), "the value is out of range");
    std::fs::write(folder.path().join("pipelines/broken.ron"), PIPELINE.replace("gbuffer", "gbufer"))
        .unwrap();
    assert!(renderer.set_pipeline("broken", &Overrides::default()).is_err(), "there is no such kind");
    assert_eq!(renderer.pipeline_name(), "own");
    assert_eq!(counted(&mut renderer), [2.0, 1.0], "the past goes on");
}

#[test]
fn a_size_is_taken_and_ends_the_past() {
    let Some((mut renderer, _folder)) = renderer() else { return };
    counted(&mut renderer);
    renderer.set_size((8, 6)).unwrap();
    assert_eq!(counted(&mut renderer), [2.0, 1.0], "it is the size before");
    renderer.set_size((5, 0)).unwrap();
    assert_eq!(counted(&mut renderer), [1.0, 0.0]);
    let depth = renderer.output("depth").unwrap();
    assert_eq!((depth.width(), depth.height()), (5, 1), "a frame has at least one pixel");
}

#[test]
fn a_cut_ends_the_past_and_a_camera_that_moves_does_not() {
    let Some((mut renderer, _folder)) = renderer() else { return };
    counted(&mut renderer);
    let camera = renderer.scene().camera;
    let far = scene::Camera { position: camera.position * 2.0, ..camera };
    renderer.set_camera(Some(far), false);
    assert_eq!(counted(&mut renderer), [2.0, 1.0]);
    renderer.set_camera(None, true);
    assert_eq!(counted(&mut renderer), [1.0, 0.0]);
    assert_eq!(counted(&mut renderer), [2.0, 1.0], "the event has passed");
}

#[test]
fn another_scene_is_seen_and_ends_the_past() {
    let Some((mut renderer, folder)) = renderer() else { return };
    counted(&mut renderer);
    let plane = renderer.output("depth").unwrap();
    assert!(plane.pixels().iter().any(|pixel| pixel[0] > 0.0), "the plane is seen");
    let empty = without_pipeline(renderer.gpu().clone(), folder.path(), "empty").scene().clone();
    renderer.set_scene(empty).unwrap();
    assert_eq!(counted(&mut renderer), [1.0, 0.0]);
    assert!(renderer.output("depth").unwrap().pixels().iter().all(|pixel| pixel[0] == 0.0));
}

#[test]
fn files_are_read_again_and_broken_ones_replace_nothing() {
    let Some((mut renderer, folder)) = renderer() else { return };
    counted(&mut renderer);
    let shader = folder.path().join("shaders/count.wgsl");
    let changed = BTreeSet::from([shader.clone()]);
    let good = std::fs::read_to_string(&shader).unwrap();
    assert!(matches!(
        renderer.reload(&BTreeSet::from([folder.path().join("shaders/no.wgsl")])),
        Reload::Nothing
    ));
    std::fs::write(&shader, good.replace("settings.step", "settings.stop")).unwrap();
    assert!(matches!(renderer.reload(&changed), Reload::Failed(_)));
    assert_eq!(counted(&mut renderer), [2.0, 1.0]);
    std::fs::write(&shader, good.replace("settings.step;", "settings.step * 2.0;")).unwrap();
    let Reload::Done(report) = renderer.reload(&changed) else { panic!("the shader is whole") };
    assert_eq!(report.changed.len(), 1, "one pass uses it");
    assert_eq!(counted(&mut renderer)[0], 4.0);
}

/// Two renderers of one device do not meet.
#[test]
fn two_renderers_share_a_device() {
    let (Some((mut first, _one)), Some((mut second, _two))) = (renderer(), renderer()) else { return };
    second.set_pipeline("own", &step(3.0)).unwrap();
    assert_eq!(counted(&mut first), [1.0, 0.0]);
    assert_eq!(counted(&mut second), [3.0, 0.0]);
    assert_eq!(counted(&mut first), [2.0, 1.0]);
    assert_eq!(counted(&mut second), [6.0, 1.0]);
}

/// Two renderers of one catalog both see a shader that was saved: the first to reload takes nothing from the second.
#[test]
fn two_renderers_of_one_catalog_reload_the_same_shader() {
    let (Some(gpu), folder) = (gpu(), tree()) else { return };
    let catalog = Arc::new(Catalog::new(Assets::new(Some(folder.path().to_owned()))));
    let mut renderers = [(); 2].map(|()| {
        let scene = renderer::load_scene(&catalog, "plane").unwrap();
        let mut renderer = Renderer::new(gpu.clone(), Arc::clone(&catalog), scene, (8, 6)).unwrap();
        renderer.set_pipeline("own", &Overrides::default()).unwrap();
        renderer
    });
    let shader = folder.path().join("shaders/count.wgsl");
    let text = std::fs::read_to_string(&shader).unwrap();
    std::fs::write(&shader, text.replace("settings.step;", "settings.step * 2.0;")).unwrap();
    for renderer in &mut renderers {
        assert!(matches!(renderer.reload(&BTreeSet::from([shader.clone()])), Reload::Done(_)));
        assert_eq!(counted(renderer)[0], 2.0);
    }
}
