//! What `lightloom render` says of the picture that it made, and how light becomes a PNG.

use crate::adapter::{gpu, root};
use metrics::Image;
use std::path::Path;
use std::process::{Command, Output};

fn render(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lightloom"))
        .args(["render", "--size", "24x16", "--set", "lights=64", "--root"])
        .arg(root())
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn pixels_that_are_not_finite_are_told_and_fail() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    // No compiler knows the value, which is a root of what is negative.
    let effect = "#import interface \"effect\"
        var picture: texture_2d<f32>;
        @fragment
        fn broken(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
            let seen = textureLoad(picture, vec2<u32>(at.xy), 0);
            return vec4(sqrt(vec3(-1.0) - seen.rgb), 1.0);
        }";
    std::fs::write(folder.path().join("effect.wgsl"), effect).unwrap();
    let pipeline = r#"Pipeline(
        extends: "ism.ron",
        about: "A square root of what is negative",
        patch: [Insert(
            name: "broken",
            pass: Pass(kind: "fullscreen", shader: "effect.wgsl", out: { "result": Out(interface: "Radiance") }),
            between: ("image.image", "out.image"),
        )],
    )"#;
    std::fs::write(folder.path().join("broken.ron"), pipeline).unwrap();
    for file in ["x.exr", "x.png", "x.pfm"] {
        let done = render(folder.path(), &["broken.ron", "cornell-box", "-o", file]);
        let text = said(&done);
        assert_eq!(done.status.code(), Some(1), "{file}: {text}");
        assert!(text.contains("384 pixels are not finite: the first is (0, 0) of `image`"), "{file}: {text}");
        assert!(folder.path().join(file).exists(), "the picture shows where");
    }
    let done = render(folder.path(), &["broken.ron", "cornell-box", "-o", "x.exr", "--json"]);
    let told: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(told["pixels_not_finite"], 384);
    let done = render(folder.path(), &["ism", "cornell-box", "-o", "y.exr", "--json"]);
    let told: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!((done.status.code(), &told["pixels_not_finite"]), (Some(0), &0.into()));
}

#[test]
fn a_camera_that_sees_nothing_is_told() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let scene = |camera: &str, light: &str| {
        format!(
            "Scene(about: \"A room\", geometry: BuiltIn(\"cornell-box\"), camera: {camera}, lights: [{light}])"
        )
    };
    let spot = "Spot(name: \"spot\", position: (0.13, 0.5, 0.1), direction: (1.0, -0.75, 0.55), \
                intensity: (0.8, 0.8, 0.8), outer_deg: 30)";
    let away = "Spot(name: \"spot\", position: (0.278, 0.273, -0.1), direction: (0.0, 0.0, -1.0), \
                intensity: (0.8, 0.8, 0.8), outer_deg: 30)";
    let far = "Camera(position: (278.0, 273.0, -800.0), target: (278.0, 273.0, 0.1), vertical_fov_deg: 39)";
    let near = "Camera(position: (0.278, 0.273, -0.8), target: (0.278, 0.273, 0.0), vertical_fov_deg: 39)";
    let cases = [
        (
            "far.ron",
            scene(far, spot),
            Some("nothing is seen: the camera at (278, 273, -800) looks at (278, 273, 0.1)"),
        ),
        ("dark.ron", scene(near, away), Some("no light reaches what is seen")),
        ("lit.ron", scene(near, spot), None),
    ];
    for (name, text, expected) in cases {
        std::fs::write(folder.path().join(name), text).unwrap();
        let done = render(folder.path(), &["ism", name, "-o", "x.png"]);
        assert_eq!(done.status.code(), Some(0), "{}", said(&done));
        match expected {
            Some(expected) => assert!(said(&done).contains(expected), "{name}: {}", said(&done)),
            None => assert!(!said(&done).contains("note"), "{}", said(&done)),
        }
    }
}

#[test]
fn tone_mapping_is_that_of_the_pipeline_in_every_output() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let picture = |arguments: &[&str]| {
        let done = render(folder.path(), &[&["ism", "cornell-box", "-o", "x.png"], arguments].concat());
        assert_eq!(done.status.code(), Some(0), "{}", said(&done));
        Image::read(folder.path().join("x.png")).unwrap()
    };
    // A step of 8 bits: the GPU rounds otherwise.
    let same = |a: &Image, b: &Image| {
        let encoded = |image: &Image| -> Vec<[f32; 3]> {
            image.pixels().iter().map(|p| [p[0], p[1], p[2]].map(metrics::srgb_from_linear)).collect()
        };
        let (a, b) = (encoded(a), encoded(b));
        a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1.5 / 255.0)
    };
    let plain = picture(&[]);
    assert!(same(&plain, &picture(&["--output", "display"])), "a PNG of light is what a screen shows");
    for (set, flags) in [
        (&["--set", "image.exposure=2"][..], &["--exposure", "2"][..]),
        (&["--set", "image.tonemap=aces"], &["--tonemap", "aces"]),
        (&["--set", "image.tonemap=filmic", "--set", "image.white=2"], &["--tonemap", "filmic:2"]),
        (&["--set", "image.tonemap=none"], &["--tonemap", "none"]),
        (&["--set", "image.tonemap=reinhard-simple"], &["--tonemap", "reinhard-simple"]),
    ] {
        let all: Vec<Image> = [set, flags]
            .into_iter()
            .flat_map(|said| [said.to_vec(), [said, &["--output", "display"]].concat()])
            .map(|arguments| picture(&arguments))
            .collect();
        assert!(!same(&plain, &all[0]), "{set:?} changes the picture");
        for other in &all[1..] {
            assert!(same(&all[0], other), "{set:?} and {flags:?} give one picture in every output");
        }
    }
    let done = render(folder.path(), &["ism", "cornell-box", "-o", "x.exr", "--exposure", "1"]);
    assert!(said(&done).contains("x.exr holds light as it is"), "{}", said(&done));
}

#[test]
fn what_only_the_last_frame_shows_is_told() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let done = render(folder.path(), &["ism", "cornell-box", "-o", "x.png", "--frames", "3"]);
    assert!(said(&done).contains("x.png holds the last of 3 frames"), "{}", said(&done));
    let done = render(folder.path(), &["ism", "cornell-box", "-o", "x.png", "--time"]);
    assert!(String::from_utf8_lossy(&done.stdout).contains("GPU ms of the first frame"), "{done:?}");
    let log = folder.path().join("frames.jsonl");
    let done = render(
        folder.path(),
        &["ism", "cornell-box", "-o", "####.png", "--frames", "3", "--log", "frames.jsonl"],
    );
    assert_eq!(done.status.code(), Some(0), "{}", said(&done));
    let lines: Vec<serde_json::Value> = std::fs::read_to_string(log)
        .unwrap()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.iter().map(|line| line["frame"].as_u64().unwrap()).collect::<Vec<_>>(), [0, 1, 2]);
    let hash = |line: &serde_json::Value| line["outputs"]["image"]["hash"].as_str().unwrap().to_owned();
    assert_eq!(hash(&lines[1]), hash(&lines[2]), "nothing moves");
    assert!(lines[2]["outputs"]["image"]["mean"].as_f64().unwrap() > 0.0);
    assert!(lines[2]["objects"].as_u64().unwrap() > 10);
}

/// Where something moves, each frame of the lavapipe of Mesa 22 once kept 0.7 MiB.
#[test]
fn frames_in_which_a_light_moves_keep_no_memory() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let scene = "Scene(
        about: \"A spot that goes to and fro\",
        geometry: BuiltIn(\"cornell-box\"),
        camera: Camera(position: (0.278, 0.273, -0.8), target: (0.278, 0.273, 0.0), vertical_fov_deg: 39),
        lights: [Spot(name: \"spot\", position: (0.13, 0.5, 0.1), direction: (1.0, -0.75, 0.55),
            intensity: (0.8, 0.8, 0.8), outer_deg: 30)],
        keyframes: Keyframes(frames_per_second: 30, repeat: true, lights: { \"spot\": [
            Key(time: 0.0, position: (0.13, 0.5, 0.1)),
            Key(time: 0.5, position: (0.3, 0.45, 0.2)),
            Key(time: 1.0, position: (0.13, 0.5, 0.1)),
        ] }),
    )";
    std::fs::write(folder.path().join("spot.ron"), scene).unwrap();
    let few = ["--set", "map=16", "--set", "rsm.size=32", "--frames", "120", "--log", "frames.jsonl"];
    let done = render(folder.path(), &[&["ism-invtm", "spot.ron", "-o", "x.exr"][..], &few].concat());
    assert_eq!(done.status.code(), Some(0), "{}", said(&done));
    let text = std::fs::read_to_string(folder.path().join("frames.jsonl")).unwrap();
    let lines: Vec<serde_json::Value> =
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let grown = |of: &str| Some(lines[119][of].as_i64()? - lines[29][of].as_i64()?);
    assert_eq!(grown("objects"), Some(0));
    // Other systems than Linux do not tell.
    if let Some(bytes) = grown("memory") {
        assert!(bytes < 8 << 20, "90 frames keep {bytes} bytes");
    }
    assert_ne!(
        lines[29]["outputs"]["image"]["hash"], lines[44]["outputs"]["image"]["hash"],
        "the light moves"
    );
}
