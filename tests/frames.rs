//! The passes that frames run; pictures do not depend on how memory is used.

use crate::adapter::{SMALL, bits, gpu, renderer, root, set, shown};
use crate::program::Folder;
use frame_graph::plan::PlannedPass;
use frame_graph::{CompileOptions, SceneBindings};
use glam::Vec3;
use renderer::{Assets, Catalog, FrameOptions, Renderer};
use scene::Camera;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Sharing on, sharing off, and every object filled with NaN or another pattern before it is written: the same bits.
#[test]
fn pictures_are_identical_with_sharing_on_off_and_poisoned() {
    for (pipeline, scene) in
        [("ism-invtm", "cornell-box"), ("ism", "cornell-box-lights"), ("ism-uniform", "cornell-box-lamp")]
    {
        let Some(mut renderer) = renderer(pipeline, scene, (45, 31), SMALL) else { return };
        let mut pictures = Vec::new();
        for (sharing, poison) in
            [(true, None), (false, None), (true, Some(FrameOptions::NAN)), (false, Some(0x5a))]
        {
            renderer.set_compile_options(CompileOptions { sharing, ..CompileOptions::default() }).unwrap();
            renderer.set_frame_options(FrameOptions { poison, ..FrameOptions::default() });
            renderer.run_everything();
            renderer.frame().unwrap();
            let outputs = ["image", "indirect", "direct", "irradiance"];
            pictures.push(outputs.map(|output| bits(&renderer.output(output).unwrap())));
        }
        assert!(pictures[0][0].iter().any(|pixel| pixel[0] != 0), "{pipeline} renders something of {scene}");
        for other in &pictures[1..] {
            assert!(pictures[0] == *other, "{pipeline} on {scene} depends on how memory is used");
        }
        let memory = renderer.plan().unwrap().memory;
        assert!(memory.bound <= memory.shared && memory.shared <= memory.unshared);
    }
}

/// The threads of every compute shader in another order: the same bits.
#[test]
fn pictures_are_identical_with_threads_in_another_order() {
    let Some(gpu) = gpu() else { return };
    let assets = Assets::new(Some(root()));
    for (pipeline, scene, values) in [
        ("ism-invtm", "cornell-box-lights", SMALL),
        ("tcas", "cornell-box", SMALL),
        ("incremental-instant-radiosity", "cornell-box-lights", SMALL),
        ("reference", "cornell-box", &["samples=4"]),
    ] {
        let picture = |catalog: Catalog| {
            let catalog = Arc::new(catalog);
            let scene = renderer::load_scene(&catalog, scene).unwrap();
            let mut renderer = Renderer::new(gpu.clone(), catalog, scene, (45, 31)).unwrap();
            renderer.set_pipeline(pipeline, &set(values)).unwrap();
            renderer.frame_until_done(|_, _| ControlFlow::Continue(())).unwrap();
            bits(&renderer.output("image").unwrap())
        };
        let plain = picture(Catalog::new(assets.clone()));
        assert!(plain.iter().any(|pixel| pixel[0] != 0), "{pipeline} renders something of {scene}");
        let permuted = picture(Catalog::with_thread_order(assets.clone(), 2));
        assert!(plain == permuted, "{pipeline} on {scene} depends on the order of threads");
    }
}

/// A still scene costs nothing after the first frame; a camera that moves costs what depends on it.
#[test]
fn only_what_changed_runs() {
    let Some(mut renderer) = renderer("ism-invtm", "cornell-box", (32, 32), SMALL) else { return };
    let names: Vec<String> =
        renderer.plan().unwrap().passes.iter().map(|pass| pass.name.to_string()).collect();
    let ran = |report: &renderer::FrameReport| -> Vec<String> {
        names.iter().zip(&report.ran).filter(|(_, ran)| **ran).map(|(name, _)| name.clone()).collect()
    };
    // Hands maps on to those who look them up, and has nothing to run.
    let with_steps: Vec<_> = names.iter().filter(|name| *name != "shadows/settle").cloned().collect();
    assert_eq!(ran(renderer.frame().unwrap()), with_steps, "the first frame runs everything");
    assert_eq!(ran(renderer.frame().unwrap()), Vec::<String>::new(), "nothing has changed");
    let still = bits(&renderer.output("image").unwrap());
    let camera = renderer.scene().camera;
    let moved = Camera { position: camera.position + Vec3::splat(0.05), ..camera };
    renderer.set_camera(Some(moved), false);
    let after_move = ran(renderer.frame().unwrap());
    for name in ["rsm", "shadows/points"] {
        assert!(
            !after_move.iter().any(|ran| ran == name),
            "{name} does not depend on the camera: {after_move:?}"
        );
    }
    for name in ["view", "importance", "gather", "image"] {
        assert!(after_move.iter().any(|ran| ran == name), "{name} depends on the camera: {after_move:?}");
    }
    assert!(bits(&renderer.output("image").unwrap()) != still, "the picture follows the camera");
    renderer.set_camera(None, false);
    renderer.frame().unwrap();
    assert!(bits(&renderer.output("image").unwrap()) == still, "and comes back with it, bit for bit");
}

/// A sample of a picture runs what random numbers, the place within pixels or an input changes, and nothing whose memory another pass took.
#[test]
fn samples_run_nothing_again_that_is_the_same() {
    let small = &["lights=16", "rsm.size=32"][..];
    // With all of its lights, which share memory with sums that stay.
    for (pipeline, values) in [
        ("ism-invtm-accumulated", small),
        ("progressive-instant-radiosity", small),
        ("restir-vpl-accumulated", &[]),
    ] {
        let Some(mut renderer) = renderer(pipeline, "cornell-box-lights", (20, 15), values) else { return };
        let ran = (0..3).map(|_| renderer.frame().unwrap().ran.clone()).last().unwrap();
        let plan = renderer.plan().unwrap();
        let changes = |pass: &PlannedPass| {
            let read = [SceneBindings::CAMERA, SceneBindings::SAMPLE, SceneBindings::SEED];
            let reads = read.into_iter().any(|binding| pass.scene_bindings.contains(binding));
            reads || pass.inputs.iter().any(|input| ran[input.producer.0 as usize])
        };
        let again = plan.passes.iter().zip(&ran).filter(|(pass, ran)| **ran && !changes(pass));
        let again: Vec<_> = again.map(|(pass, _)| &*pass.name).collect();
        assert!(again.is_empty(), "{pipeline} runs {again:?} again");
        let rsm = plan.pass("rsm").expect("a reflective shadow map");
        assert!(!ran[rsm.0 as usize] && ran.contains(&true), "{pipeline}");
    }
}

/// A picture is done with a whole frame, which is reported: where maps are kept without progress, with the first; where one step
/// settles, with the one after it.
#[test]
fn the_last_frame_of_a_picture_is_whole_and_reported() {
    let small = ["lights=32", "map=16"];
    let one_step = [&small[..], &["lights/replacement.warm_up=1"]].concat();
    for (pipeline, values, wanted) in [
        ("instant-radiosity", &small[..], &[false][..]),
        ("incremental-instant-radiosity", &small, &[false]),
        ("smc-ir", &one_step, &[true, false]),
    ] {
        let Some(mut renderer) = renderer(pipeline, "cornell-box", (20, 15), values) else { return };
        let mut partial = Vec::new();
        renderer
            .frame_until_done(|report, _| {
                partial.push(report.partial);
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!(partial, wanted, "{pipeline}");
        let picture = bits(&renderer.output("indirect").unwrap());
        assert!(picture.iter().any(|pixel| pixel[0] != 0), "{pipeline} renders something");
    }
}

/// Frames that lead to a picture leave out what neither its progress nor a history buffer depends on; the picture is that of whole
/// frames.
#[test]
fn frames_that_settle_leave_out_what_they_do_not_need() {
    let smc = ["lights=32", "map=16", "lights/replacement.warm_up=5", "lights/replacement.moved=4"];
    let path = ["samples=5", "samples_per_frame=1"];
    let mean = ["frames=5", "lights=16", "map=16", "rsm.size=32"];
    for (pipeline, values, needed, left_out) in [
        ("smc-ir", &smc[..], "lights/valid", "gather"),
        // Maps that are kept catch up with their lights.
        ("smc-ir", &smc[..], "lights/valid", "shadows/maps"),
        ("reference", &path[..], "path", "image"),
        ("ism-invtm-accumulated", &mean[..], "image/indirect", "image/screen"),
    ] {
        let Some(mut leaving) = renderer(pipeline, "cornell-box", (20, 15), values) else { return };
        let place = |name: &str| {
            let mut passes = leaving.plan().unwrap().passes.iter();
            passes.position(|pass| pass.name.as_str() == name).unwrap()
        };
        let (needed, left_out) = (place(needed), place(left_out));
        let mut ran = Vec::new();
        leaving
            .frame_until_done(|report, _| {
                ran.push((report.ran[needed], report.ran[left_out], report.partial));
                ControlFlow::Continue(())
            })
            .unwrap();
        let (whole, partial) = ((true, true, false), (true, false, true));
        // Where maps catch up, several frames are expected from the beginning.
        let first = if pipeline == "smc-ir" { partial } else { whole };
        assert_eq!(ran, [first, partial, partial, partial, whole], "{pipeline}");
        let mut plain =
            renderer(pipeline, "cornell-box", (20, 15), values).expect("the adapter is still there");
        for _ in 0..ran.len() {
            plain.set_frame_index(0);
            plain.frame().unwrap();
        }
        let pictures =
            |renderer: &Renderer| ["image", "indirect"].map(|output| bits(&renderer.output(output).unwrap()));
        let [found, wanted] = [&leaving, &plain].map(pictures);
        assert!(found.iter().flatten().any(|pixel| pixel[0] != 0), "{pipeline} renders something");
        assert!(found == wanted, "{pipeline}: the picture depends on what was left out");
        // What follows from it goes on as well.
        let [found, wanted] = [&mut leaving, &mut plain].map(|renderer| {
            renderer.frame().unwrap();
            pictures(renderer)
        });
        assert!(found == wanted, "{pipeline}: the frame after depends on what was left out");
    }
}

/// A seed is a picture.
#[test]
fn seeds_repeat_and_differ() {
    let Some(mut renderer) = renderer("ism-invtm", "cornell-box", (24, 24), SMALL) else { return };
    let mut picture = |seed| {
        renderer.set_seed(seed);
        bits(&shown(&mut renderer, "indirect"))
    };
    let (first, other, again) = (picture(1), picture(2), picture(1));
    assert!(first == again, "the same seed gives the same bits");
    assert!(first != other, "another seed gives another picture");
}

/// Camera, lights and geometry of an animation reach the picture.
#[test]
fn animations_move() {
    let Some(mut renderer) = renderer("ism", "cornell-box-moving", (24, 24), SMALL) else { return };
    let first = bits(&shown(&mut renderer, "image"));
    renderer.set_frame_index(20);
    renderer.frame().unwrap();
    assert!(first != bits(&renderer.output("image").unwrap()));
}

/// Times are there where the adapter has timestamps, and every pass that ran has one.
#[test]
fn passes_are_timed() {
    let Some(mut renderer) = renderer("ism", "cornell-box", (24, 24), SMALL) else { return };
    if !renderer.gpu().has_timestamps() {
        return;
    }
    renderer.set_frame_options(FrameOptions { timed: true, ..FrameOptions::default() });
    let report = renderer.frame().unwrap();
    assert_eq!(report.times.len(), report.ran.len());
    assert!(report.times.iter().sum::<f64>() > 0.0);
    let second = renderer.frame().unwrap();
    assert!(second.times.iter().all(|time| *time == 0.0), "what does not run takes no time");
}

/// Odd and tiny frames work.
#[test]
fn frames_of_any_size() {
    for size in [(1, 1), (3, 1), (17, 9)] {
        let Some(mut renderer) = renderer("ism-invtm", "cornell-box", size, SMALL) else { return };
        let image = shown(&mut renderer, "image");
        assert_eq!((image.width(), image.height()), (size.0 as usize, size.1 as usize));
        assert!(image.pixels().iter().flatten().all(|v| v.is_finite()), "{size:?}");
        renderer.set_size((5, 7)).unwrap();
        renderer.frame().unwrap();
        assert_eq!(renderer.output("image").unwrap().width(), 5);
    }
}

/// A culled resource is made and shown where it is requested.
#[test]
fn what_is_culled_can_be_asked_for() {
    let Some(mut renderer) = renderer("ism-uniform", "cornell-box", (32, 32), SMALL) else { return };
    assert!(renderer.plan().unwrap().pass("importance").is_none(), "nothing reads the importance map");
    for wrong in ["importance.importanse", "importence"] {
        assert!(renderer.keep(wrong).is_err(), "{wrong}");
    }
    renderer.keep("importance").unwrap();
    renderer.frame().unwrap();
    let map = bits(&renderer.picture("importance", 0).unwrap());
    assert!(map.iter().any(|pixel| pixel[0] != 0), "the map is made");
}

/// What moves has motion, and none from the frame on after which it rests; without a new frame nothing changes.
#[test]
fn motion_ends_with_what_moves() {
    let text = r#"Pipeline(
        passes: { "view": Pass(kind: "gbuffer", set: { "motion": true }) },
        outputs: { "motion": "view.motion", "depth": "view.depth" },
    )"#;
    let Some(folder) = Folder::with_gpu(&[("motion.ron", text)]) else { return };
    let mut renderer = renderer(&folder.name("motion.ron"), "cornell-box-cloth", (45, 30), &[])
        .expect("the adapter is still there");
    let mut motion = |time: f32| {
        renderer.set_time(Some(time));
        let ran = renderer.frame().unwrap().ran.contains(&true);
        let image = renderer.output("motion").unwrap();
        let most =
            image.pixels().iter().flat_map(|pixel| &pixel[..2]).fold(0.0f32, |most, x| most.max(x.abs()));
        (ran, most)
    };
    // Projecting back rounds.
    let rests = |(ran, most): (bool, f32)| (ran, most < 1e-4);
    assert_eq!(rests(motion(1.0)), (true, true), "all was where it is before the first frame");
    let (ran, first) = motion(1.25);
    assert!(ran && first > 0.2, "{first} px");
    assert!(motion(1.5).1 > 0.05);
    assert_eq!(rests(motion(1.5)), (true, true), "the frame after the last movement");
    assert_eq!(rests(motion(1.5)), (false, true), "at rest nothing runs");
}
