//! Notes that `lightloom render` prints about its picture, and how light becomes a PNG.

use crate::program::{Done, Folder, command_of_tree};
use metrics::Image;
use serde_json::Value;

fn render(folder: &Folder, arguments: &[&str]) -> Done {
    let mut command = command_of_tree(folder);
    Done::of(command.args(["render", "--size", "24x16", "--set", "lights=64"]).args(arguments))
}

/// Returns the lines of the log of frames.
fn log(folder: &Folder) -> Vec<Value> {
    folder.read("frames.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn pixels_that_are_not_finite_are_reported_and_fail() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    // No compiler knows the value, which is a root of what is negative.
    let effect = "#import interface \"effect\"
        var picture: texture_2d<f32>;
        @fragment
        fn broken(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
            let seen = textureLoad(picture, vec2<u32>(at.xy), 0);
            return vec4(sqrt(vec3(-1.0) - seen.rgb), 1.0);
        }";
    folder.write("effect.wgsl", effect);
    let pipeline = r#"Pipeline(
        extends: "ism.ron",
        about: "A square root of what is negative",
        patch: [Insert(
            name: "broken",
            pass: Pass(kind: "fullscreen", shader: "effect.wgsl", out: { "result": Out(interface: "Radiance") }),
            between: ("image.image", "out.image"),
        )],
    )"#;
    folder.write("broken.ron", pipeline);
    // A screen's picture is made of 8 bits, which have no place for what is not finite.
    let shown = ["broken.ron", "cornell-box", "-o", "shown.png", "--output", "display"];
    render(&folder, &shown).failure(1, &["384 pixels are not finite: the first is (0, 0) of `image`"]);
    for file in ["x.exr", "x.png", "x.pfm"] {
        let words = "384 pixels are not finite: the first is (0, 0) of `image`";
        render(&folder, &["broken.ron", "cornell-box", "-o", file]).failure(1, &[words]);
        assert!(folder.at(file).exists(), "the picture shows where");
    }
    let done = render(&folder, &["broken.ron", "cornell-box", "-o", "x.exr", "--json"]);
    assert_eq!(done.json()["pixels_not_finite"], 384);
    let done = render(&folder, &["ism", "cornell-box", "-o", "y.exr", "--json"]).success();
    assert_eq!(done.json()["pixels_not_finite"], 0);
}

#[test]
fn a_camera_that_sees_nothing_is_reported() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
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
        folder.write(name, &text);
        let done = render(&folder, &["ism", name, "-o", "x.png"]).success();
        match expected {
            Some(expected) => assert!(done.err.contains(expected), "{name}: {done}"),
            None => assert!(!done.err.contains("note"), "{done}"),
        }
    }
}

#[test]
fn tone_mapping_is_that_of_the_pipeline_in_every_output() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let picture = |arguments: &[&str]| {
        render(&folder, &[&["ism", "cornell-box", "-o", "x.png"], arguments].concat()).success();
        Image::read(folder.at("x.png")).unwrap()
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
    render(&folder, &["ism", "cornell-box", "-o", "x.exr", "--exposure", "1"])
        .says(&["x.exr holds light as it is"]);
}

#[test]
fn results_of_the_last_frame_alone_are_named() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let render = |more: &[&str]| render(&folder, &[&["ism", "cornell-box", "-o"], more].concat()).success();
    render(&["x.png", "--frames", "3"]).says(&["x.png holds the last of 3 frames"]);
    let done = render(&["x.png", "--time"]);
    assert!(done.out.contains("GPU ms of the first frame"), "{done}");
    render(&["####.png", "--frames", "3", "--log", "frames.jsonl"]);
    let lines = log(&folder);
    assert_eq!(lines.iter().map(|line| line["frame"].as_u64().unwrap()).collect::<Vec<_>>(), [0, 1, 2]);
    let hash = |line: &Value| line["outputs"]["image"]["hash"].as_str().unwrap().to_owned();
    assert_eq!(hash(&lines[1]), hash(&lines[2]), "nothing moves");
    assert!(lines[2]["outputs"]["image"]["mean"].as_f64().unwrap() > 0.0);
    assert!(lines[2]["objects"].as_u64().unwrap() > 10);
}

/// Moving scenes once kept 0.7 MiB per frame with the lavapipe of Mesa 22.
#[test]
fn frames_in_which_a_light_moves_keep_no_memory() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
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
    folder.write("spot.ron", scene);
    let few = ["--set", "map=16", "--set", "rsm.size=32", "--frames", "120", "--log", "frames.jsonl"];
    render(&folder, &[&["ism-invtm", "spot.ron", "-o", "x.exr"][..], &few].concat()).success();
    let lines = log(&folder);
    let grown = |of: &str| Some(lines[119][of].as_i64()? - lines[29][of].as_i64()?);
    assert_eq!(grown("objects"), Some(0));
    // Only Linux reports it.
    if let Some(bytes) = grown("memory") {
        assert!(bytes < 8 << 20, "90 frames keep {bytes} bytes");
    }
    assert_ne!(
        lines[29]["outputs"]["image"]["hash"], lines[44]["outputs"]["image"]["hash"],
        "the light moves"
    );
}
