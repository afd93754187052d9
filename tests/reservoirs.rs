//! Virtual lights chosen by reservoirs, against a gather of all lights by rays: the same mean, whatever is reused.

use crate::adapter::{done, energy, renderer};
use bytemuck::pod_collect_to_vec;
use glam::Vec3;
use interfaces::reservoirs::Reservoir;
use metrics::statistics::Summary;
use renderer::Renderer;
use scene::Camera;

const SIZE: (u32, u32) = (64, 48);

/// Groups of frames. What one frame has too much of for its few lights, another that reuses them has not: so means of groups differ
/// less than frames do.
const GROUPS: u32 = 8;

const FRAMES: u32 = 6;

const SET: &[&str] = &["lights=64", "rsm.size=64", "candidates=16", "map=16"];

/// restir-vpl, with an output in which every pixel takes all lights.
const BESIDE_ALL: &str = r#"Pipeline(
    extends: "restir-vpl.ron",
    about: "Chosen lights beside all lights",
    passes: {
        "rays": Pass(kind: "visibility-ray-traced"),
        "all": Pass(
            kind: "gather",
            in: { "view": "view", "lights": "lights", "visibility": "rays" },
            set: { "interleave_x": 1, "interleave_y": 1, "area_bound": 4.0 },
        ),
    },
    outputs: { "all": "all", "chosen": "gather.irradiance" },
)"#;

fn beside_all(scene: &str, size: (u32, u32), values: &[&str]) -> Option<Renderer> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("beside-all.ron");
    std::fs::write(&path, BESIDE_ALL).unwrap();
    let mut renderer = renderer(&path.to_string_lossy(), scene, size, &[SET, values].concat())?;
    renderer.keep_only(["all", "chosen"]).unwrap();
    Some(renderer)
}

/// The energy of all lights, and of chosen ones, in the next frame.
fn energies(renderer: &mut Renderer) -> [f64; 2] {
    renderer.frame().unwrap();
    ["all", "chosen"].map(|name| energy(&renderer.output(name).unwrap()))
}

/// Runs frames, and asserts that chosen lights give as much as all lights, in the mean over the frames after the first. `before` changes
/// what is rendered in a frame.
fn assert_same_energy(name: &str, values: &[&str], scene: &str, before: impl Fn(&mut Renderer, u32)) {
    let Some(mut renderer) = beside_all(scene, SIZE, values) else { return };
    let (mut all, mut off) = (0.0, vec![0.0; GROUPS as usize]);
    for frame in 0..=GROUPS * FRAMES {
        before(&mut renderer, frame);
        let [every, chosen] = energies(&mut renderer);
        if frame > 0 {
            all += every / f64::from(GROUPS * FRAMES);
            off[((frame - 1) / FRAMES) as usize] += (chosen - every) / f64::from(FRAMES);
        }
    }
    let Summary { mean, half_width_95, .. } = Summary::of(&off).unwrap();
    let (off, half) = (mean / all, half_width_95 / all);
    eprintln!("{name}: RATIO energy {:.4} ± {half:.4}", 1.0 + off);
    assert!(half < 0.015, "{name}: an energy of {} ± {half} decides nothing", 1.0 + off);
    assert!(off.abs() < 0.005 + half, "{name}: energy {} ± {half}", 1.0 + off);
}

fn nothing_moves(_: &mut Renderer, _: u32) {}

/// Moves the camera to the side, by more than what a pixel shows.
fn walks(renderer: &mut Renderer, frame: u32, cut: bool) {
    let camera = renderer.scene().camera;
    let by = Vec3::new(0.02, 0.01, 0.0) * (frame % 8) as f32;
    renderer.set_camera(Some(Camera { position: camera.position + by, ..camera }), cut);
}

#[test]
fn what_pixels_choose_has_the_energy_of_all_lights() {
    let still = ["most=0.0", "neighbours=0"];
    assert_same_energy("alone", &still, "cornell-box", nothing_moves);
    assert_same_energy("by the tree", &[&still[..], &["tree=true"]].concat(), "cornell-box", nothing_moves);
    assert_same_energy("guessed", &[&still[..], &["guess=true"]].concat(), "cornell-box", nothing_moves);
    assert_same_energy("with pixels around", &["most=0.0"], "cornell-box", nothing_moves);
}

#[test]
fn reuse_over_frames_has_the_energy_of_all_lights() {
    let reuse = ["most=3.0", "neighbours=3"];
    assert_same_energy("still", &reuse, "cornell-box", nothing_moves);
    assert_same_energy("surfaces come into view", &reuse, "cornell-box", |r, frame| walks(r, frame, false));
    assert_same_energy("a cut in each frame", &reuse, "cornell-box", |r, frame| walks(r, frame, true));
    assert_same_energy("all moves", &reuse, "cornell-box-moving", |r, frame| {
        r.set_time(Some(frame as f32 / 15.0));
    });
}

/// The mean over frames, against path tracing: maps, lights, choices and rays share nothing with it but the scene.
#[test]
#[ignore = "slow"]
fn the_mean_over_frames_has_the_energy_of_path_tracing() {
    let size = (32, 24);
    let path = ["bounces=1", "samples=4096", "samples_per_frame=64"];
    let Some(mut paths) = renderer("reference", "cornell-box", size, &path) else { return };
    done(&mut paths);
    let exact = energy(&paths.output("indirect").unwrap());
    let ratio = |seed| {
        let values = ["lights=256", "candidates=8", "frames=256"];
        let mut renderer = renderer("restir-vpl-accumulated", "cornell-box", size, &values).unwrap();
        renderer.set_seed(seed);
        done(&mut renderer);
        energy(&renderer.output("indirect").unwrap()) / exact
    };
    let ratios: Vec<f64> = (0..6).map(ratio).collect();
    let Summary { mean, half_width_95, .. } = Summary::of(&ratios).unwrap();
    eprintln!("RATIO energy {mean:.4} ± {half_width_95:.4}");
    assert!(half_width_95 < 0.005 && (mean - 1.0).abs() < 0.005 + half_width_95, "{ratios:?}");
}

/// M stays at its cap while nothing but the camera moves, and the mean where it is.
#[test]
#[ignore = "slow"]
fn nothing_drifts_over_ten_thousand_frames() {
    let values = ["lights=16", "rsm.size=32", "candidates=16", "most=20.0", "neighbours=3"];
    let Some(mut renderer) = beside_all("cornell-box", (16, 12), &values) else { return };
    let mut ratios = Vec::new();
    for _ in 0..10 {
        let [mut all, mut chosen] = [0.0; 2];
        for frame in 0..1000 {
            walks(&mut renderer, frame, false);
            let of_frame = energies(&mut renderer);
            all += of_frame[0];
            chosen += of_frame[1];
        }
        ratios.push(chosen / all);
    }
    eprintln!("RATIO {ratios:.4?}");
    let Summary { mean, half_width_95, .. } = Summary::of(&ratios).unwrap();
    assert!(half_width_95 < 0.03 && (mean - 1.0).abs() < 0.005 + half_width_95, "{mean} ± {half_width_95}");
    let (early, late) = ratios.split_at(5);
    let [early, late] = [early, late].map(|half| Summary::of(half).unwrap());
    let spread = early.half_width_95.hypot(late.half_width_95);
    assert!((early.mean - late.mean).abs() < 1.5 * spread, "{} then {}", early.mean, late.mean);
    let id = renderer.plan().unwrap().resource("gather.verified").unwrap();
    let reservoirs: Vec<Reservoir> = pod_collect_to_vec(&renderer.resource_bytes(id).unwrap());
    // A frame, and at most 20 before it, of the pixel and of three around it.
    let most = 16.0 * 21.0 * 4.0;
    let off = reservoirs.iter().find(|r| !(r.count <= most && r.weight.is_finite()));
    assert!(off.is_none(), "{off:?}");
}
