//! Reload at a frame's edge: files are edited under a running headless loop.

use crate::adapter::{bits, renderer_in, shown};
use crate::program::Folder;
use renderer::{Reload, Renderer};
use shader_library::Watcher;
use std::time::{Duration, Instant};

/// A pipeline of one effect that a user writes, and of passes that remember.
const PIPELINE: &str = r#"Pipeline(
    passes: {
        "view": Pass(kind: "gbuffer"),
        "tint": Pass(kind: "fullscreen", shader: "shaders/tint.wgsl", in: { "view": "view" }),
        "count": Pass(
            kind: "compute", shader: "shaders/count.wgsl",
            in: { "before": "prev count.after" },
            history: (reset: [Reload, Resize]),
            out: { "after": Out(size: (1, 1)) },
        ),
    },
    outputs: { "image": "tint.result", "count": "count.after" },
)"#;

const TINT: &str = "#import \"tone.wgsl\"\nvar view_albedo: texture_2d<f32>;\n
@fragment
fn tint(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4(textureLoad(view_albedo, vec2<u32>(at.xy), 0).rgb * TONE, 1.0);
}\n";

const COUNT: &str = "struct Settings { before_age: u32 }
var<uniform> settings: Settings;
var before: texture_2d<f32>;
var after: texture_storage_2d<rgba32float, write>;
@compute @workgroup_size(1)
fn count() {
    let last = textureLoad(before, vec2(0u), 0);
    textureStore(after, vec2(0u), vec4(last.x + 1.0, f32(settings.before_age), 0.0, 0.0));
}\n";

fn tree() -> Folder {
    let tone = "const TONE: f32 = 1.0;\n";
    let shaders = [("shaders/tint.wgsl", TINT), ("shaders/tone.wgsl", tone), ("shaders/count.wgsl", COUNT)];
    Folder::new(&[&[("pipelines/own.ron", PIPELINE)], &shaders[..]].concat())
}

/// Runs frames until the watcher reports a change that the renderer takes in.
fn run_until_reload(renderer: &mut Renderer, watcher: &mut Watcher) -> Reload {
    let end = Instant::now() + Duration::from_secs(300);
    while Instant::now() < end {
        let changed = watcher.changed();
        if !changed.is_empty() {
            match renderer.reload(&changed) {
                Reload::Nothing => {}
                reload => return reload,
            }
        }
        renderer.frame().unwrap();
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("no change was reported in five minutes");
}

#[test]
fn edits_reach_the_next_frame_and_errors_keep_the_last_good_one() {
    let folder = tree();
    let Some(mut renderer) = renderer_in(&folder, "own", "cornell-box", (16, 16), &[]) else {
        return;
    };
    let mut watcher = Watcher::new(&[folder.to_path_buf()]).unwrap();
    let first = shown(&mut renderer, "image");
    assert!(first.pixels().iter().any(|pixel| pixel[0] > 0.0));

    // An imported module.
    folder.write("shaders/tone.wgsl", "const TONE: f32 = 0.5;\n");
    let Reload::Done(report) = run_until_reload(&mut renderer, &mut watcher) else {
        panic!("the edit is sound")
    };
    assert_eq!(report.changed.len(), 1, "one pass of three reads the module");
    assert!(report.kept, "the plan is the same: objects and histories stay");
    let half = shown(&mut renderer, "image");
    for (before, after) in first.pixels().iter().zip(half.pixels()) {
        assert!((before[0] * 0.5 - after[0]).abs() < 1e-3, "{before:?} {after:?}");
    }

    // A broken one: reported at the user's own line, and the last good picture goes on.
    folder.write("shaders/tone.wgsl", "const TONE: f32 = 0.25;\nconst X: u32 = 1.5;\n");
    let Reload::Failed(error) = run_until_reload(&mut renderer, &mut watcher) else {
        panic!("the edit is broken")
    };
    assert!(error.to_string().contains("shaders/tone.wgsl:2:"), "{error}");
    renderer.frame().unwrap();
    assert!(bits(&renderer.output("image").unwrap()) == bits(&half));

    // Mended.
    folder.write("shaders/tone.wgsl", "const TONE: f32 = 0.25;\n");
    assert!(matches!(run_until_reload(&mut renderer, &mut watcher), Reload::Done(_)));

    // The pipeline itself, broken and mended.
    folder.write("pipelines/own.ron", &PIPELINE.replace("gbuffer", "gbufer"));
    let Reload::Failed(error) = run_until_reload(&mut renderer, &mut watcher) else {
        panic!("there is no such kind")
    };
    assert!(
        error.to_string().contains("gbuffer") && error.to_string().contains("pipelines/own.ron:3:"),
        "{error}"
    );
    renderer.frame().unwrap();
    folder.write("pipelines/own.ron", PIPELINE);
    assert!(matches!(run_until_reload(&mut renderer, &mut watcher), Reload::Done(_)));
    renderer.frame().unwrap();
}

/// A `prev` link reads the frame before; a reset is reported, and gives zeros.
#[test]
fn histories_count_frames_and_end_when_they_must() {
    let folder = tree();
    let Some(mut renderer) = renderer_in(&folder, "own", "cornell-box", (8, 8), &[]) else {
        return;
    };
    let mut next = || {
        let texel = shown(&mut renderer, "count").pixels()[0];
        (texel[0], texel[1])
    };
    assert_eq!([next(), next(), next()], [(1.0, 0.0), (2.0, 1.0), (3.0, 2.0)]);
    renderer.set_size((9, 8)).unwrap();
    assert_eq!(shown(&mut renderer, "count").pixels()[0][0], 1.0, "a resize ends the past");
}

/// A scene file reloads as pipelines do, and one that is broken leaves the last good scene.
#[test]
fn scenes_reload_and_errors_keep_the_last_good_one() {
    let folder = tree();
    let scene = r#"Scene(
    geometry: BuiltIn("cornell-box"),
    camera: Camera(position: (0.278, 0.273, -0.8), target: (0.278, 0.273, 0.0), vertical_fov_deg: 39.3),
)"#;
    folder.write("scenes/own.ron", scene);
    let Some(mut renderer) = renderer_in(&folder, "own", "own", (16, 16), &[]) else {
        return;
    };
    let mut watcher = Watcher::new(&renderer.watched_folders()).unwrap();
    let picture = |renderer: &mut Renderer| bits(&shown(renderer, "image"));
    let first = picture(&mut renderer);

    folder.write("scenes/own.ron", &scene.replace("-0.8)", "zero)"));
    let Reload::Failed(error) = run_until_reload(&mut renderer, &mut watcher) else {
        panic!("the edit is broken")
    };
    assert!(error.to_string().contains("scenes/own.ron:3:45"), "{error}");
    assert!(picture(&mut renderer) == first, "the last good scene goes on");

    folder.write("scenes/own.ron", &scene.replace("-0.8)", "-0.6)"));
    assert!(matches!(run_until_reload(&mut renderer, &mut watcher), Reload::Done(_)));
    assert_eq!(renderer.scene().camera.position.z, -0.6);
    assert!(picture(&mut renderer) != first, "the camera stands elsewhere");

    // A scene that the pipeline cannot be linked with, as its own text is broken, waits until that is mended.
    folder.write("pipelines/own.ron", &PIPELINE.replace("gbuffer", "gbufer"));
    assert!(matches!(run_until_reload(&mut renderer, &mut watcher), Reload::Failed(_)));
    folder.write("scenes/own.ron", scene);
    assert!(matches!(run_until_reload(&mut renderer, &mut watcher), Reload::Failed(_)));
    assert_eq!(renderer.scene().camera.position.z, -0.6, "not half of it");
    folder.write("pipelines/own.ron", PIPELINE);
    assert!(matches!(run_until_reload(&mut renderer, &mut watcher), Reload::Done(_)));
    assert!(picture(&mut renderer) == first, "the scene as it was first");
}
