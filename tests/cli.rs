//! The command line as a user types it.

use crate::adapter::{gpu, root};
use metrics::Image;
use std::path::Path;
use std::process::{Command, Output};

fn lightloom(arguments: &[&str]) -> Output {
    run_in(&root(), arguments)
}

pub(crate) fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lightloom")).args(arguments).current_dir(folder).output().unwrap()
}

pub(crate) fn out(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

pub(crate) fn err(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub(crate) const QUICK: &[&str] = &["--size", "24x16", "--set", "lights=32", "--set", "rsm.size=32"];

pub(crate) fn render(folder: &Path, pipeline: &str, file: &str, more: &[&str]) -> Output {
    run_in(folder, &[&["render", pipeline, "cornell-box", "-o", file], QUICK, more].concat())
}

#[test]
fn renders_in_any_folder_and_says_where() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for file in ["box.png", "deep/box.exr", "box.pfm"] {
        let done = render(folder.path(), "ism-invtm", file, &[]);
        assert!(done.status.success(), "{}", err(&done));
        let said = out(&done);
        let path = Path::new(said.lines().last().unwrap());
        assert!(path.is_absolute() && path.is_file(), "{said}");
    }
    let image = Image::read(folder.path().join("deep/box.exr")).unwrap();
    assert_eq!((image.width(), image.height()), (24, 16));
    assert!(image.pixels().iter().any(|pixel| pixel[0] > 0.0));
}

#[test]
fn a_picture_tells_what_its_pipeline_lost_once() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let removed = "Pipeline(extends: \"ism.ron\", patch: [Remove(\"filter\")])";
    std::fs::write(folder.path().join("rm.ron"), removed).unwrap();
    let done = render(folder.path(), "rm.ron", "a.png", &["--exposure", "1", "--json"]);
    assert!(done.status.success(), "{}", err(&done));
    assert_eq!(err(&done).matches("W001").count(), 1, "{}", err(&done));
    let _: serde_json::Value = serde_json::from_str(&out(&done)).expect("JSON alone");
}

#[test]
fn several_outputs_of_one_run_are_files_of_their_own() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let both = ["--output", "image", "--output", "indirect", "--output", "view.depth"];
    let done = render(folder.path(), "ism", "box.exr", &both);
    assert!(done.status.success(), "{}", err(&done));
    for output in ["image", "indirect", "view.depth"] {
        let one = render(folder.path(), "ism", "one.exr", &["--output", output]);
        assert!(one.status.success(), "{}", err(&one));
        let [a, b] = [format!("box-{output}.exr"), "one.exr".to_owned()]
            .map(|name| Image::read(folder.path().join(name)).unwrap());
        assert_eq!(a.pixels(), b.pixels(), "{output}");
    }
    assert!(!folder.path().join("box.exr").exists());
}

#[test]
fn frames_beyond_the_last_number_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let last = ["--first-frame", "4294967295"];
    let done = render(folder.path(), "ism", "a.exr", &last);
    assert_eq!(done.status.code(), Some(1));
    assert!(err(&done).contains("frames have numbers up to 4294967294"), "{}", err(&done));
}

#[test]
fn sequences_are_numbered() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let done = render(folder.path(), "ism", "walk/###.png", &["--frames", "3", "--first-frame", "9"]);
    assert!(done.status.success(), "{}", err(&done));
    for name in ["009.png", "010.png", "011.png"] {
        assert!(folder.path().join("walk").join(name).is_file(), "{name}");
    }
}

#[test]
fn times_memory_and_clamped_energy_are_told_to_programs() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let done = render(folder.path(), "ism-invtm", "t.exr", &["--time", "--frames", "2", "--json"]);
    let json: serde_json::Value =
        serde_json::from_str(&out(&done)).unwrap_or_else(|_| panic!("{}{}", out(&done), err(&done)));
    assert!(json["passes"].as_array().unwrap().len() > 8, "{json}");
    assert!(json["clamped_energy"].as_f64().unwrap() >= 0.0);
    assert!(json["memory"]["shared"].as_u64().unwrap() <= json["memory"]["unshared"].as_u64().unwrap());
}

/// The phases of a start lie between the start of the process and its first picture, and all that takes long is among
/// them.
#[test]
fn the_time_to_the_first_picture_is_told() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let done = render(folder.path(), "ism-invtm", "t.png", &["--time", "--json"]);
    let json: serde_json::Value =
        serde_json::from_str(&out(&done)).unwrap_or_else(|_| panic!("{}{}", out(&done), err(&done)));
    let whole = json["start"]["first_picture_ms"].as_f64().unwrap();
    let phases = json["start"]["phases"].as_array().unwrap();
    let ms = |phase: &serde_json::Value, key: &str| phase[key].as_f64().unwrap();
    for phase in phases {
        let [from, to, busy] = ["from_ms", "to_ms", "busy_ms"].map(|key| ms(phase, key));
        assert!(0.0 <= from && from <= to && to <= whole && busy >= 0.0, "{phase} of {whole} ms");
    }
    assert!(phases.is_sorted_by_key(|phase| ms(phase, "from_ms")), "{phases:?}");
    let mut names: Vec<&str> = phases.iter().filter_map(|phase| phase["phase"].as_str()).collect();
    // What comes first depends on the threads.
    names.sort_unstable();
    let expected = [
        "GPU pipelines",
        "adapter and device",
        "encoded and written",
        "frames",
        "graph linked and planned",
        "plan on the GPU",
        "program",
        "read back",
        "scene",
        "scene on the GPU",
        "shaders in wgpu",
        "shaders read and composed",
        "shaders validated and reflected",
        "steps linked",
    ];
    assert_eq!(names, expected);
    // One thread is always in one of them, but for some milliseconds.
    let (mut covered, mut end) = (0.0, 0.0);
    for phase in phases {
        let to = ms(phase, "to_ms");
        covered += (to - ms(phase, "from_ms").max(end)).max(0.0);
        end = to.max(end);
    }
    assert!(covered > 0.8 * whole, "{covered} of {whole} ms are told: {phases:?}");
    let text = out(&render(folder.path(), "ism-invtm", "t.png", &["--time"]));
    for name in expected.into_iter().chain(["start", "first picture"]) {
        assert!(text.lines().any(|line| line.starts_with(name)), "{name}: {text}");
    }
    let untimed = render(folder.path(), "ism-invtm", "t.png", &["--json"]);
    assert!(serde_json::from_str::<serde_json::Value>(&out(&untimed)).unwrap()["start"].is_null());
}

/// What is wrong, the nearest name, exit code 1; wrong use, exit code 2.
#[test]
fn mistakes_are_told() {
    let cases: [(&[&str], i32, &str); 12] = [
        (&["render", "ism-invmt", "cornell-box", "-o", "x.png"], 1, "ism-invtm"),
        (&["render", "ism", "cornel-box", "-o", "x.png"], 1, "cornell-box"),
        (&["render", "ism", "cornell-box", "-o", "x.jpg"], 2, ".png"),
        (&["render", "ism", "cornell-box", "-o", "x.png", "--set", "lights"], 2, "parameter=value"),
        (&["render", "ism", "cornell-box", "-o", "x.png", "--exposure", "nan"], 2, "-40 to 40"),
        (&["--root", "no/such/folder", "passes"], 2, "no such folder"),
        (&["render", "ism", "cornell-box", "-o", "x.png", "--set", "light=3"], 1, "lights"),
        (&["render", "ism", "cornell-box", "-o", "x.png", "--set", "gather.clamp=many"], 1, "gather.clamp"),
        (&["render", "ism", "cornell-box", "-o", "x.png", "--size", "0x4"], 2, "WIDTHxHEIGHT"),
        (&["rendr"], 2, "render"),
        (&["passes", "gathr"], 1, "gather"),
        (&["compare", "nowhere.exr", "nowhere.exr"], 1, "nowhere.exr"),
    ];
    let folder = tempfile::tempdir().unwrap();
    let needs_gpu = |arguments: &[&str]| arguments[0] == "render";
    for (arguments, code, word) in
        cases.iter().filter(|(arguments, ..)| !needs_gpu(arguments) || gpu().is_some())
    {
        let done = run_in(folder.path(), arguments);
        assert_eq!(done.status.code(), Some(*code), "{arguments:?}: {}", err(&done));
        assert!(err(&done).contains(word), "{arguments:?}: {}", err(&done));
        assert!(!err(&done).contains("panicked"), "{arguments:?}: {}", err(&done));
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing was left behind");
}

#[test]
fn everything_built_in_is_proved_without_a_gpu() {
    let done = Command::new(env!("CARGO_BIN_EXE_lightloom"))
        .arg("check")
        .env("VK_DRIVER_FILES", "/nonexistent")
        .current_dir(root())
        .output()
        .unwrap();
    assert!(done.status.success(), "{}{}", out(&done), err(&done));
    assert!(out(&done).contains("ism-invtm"));
}

/// The example of the guide: 25 lines at most, and a different picture.
#[test]
fn the_guides_effect_is_short_and_works() {
    let lines: usize = ["docs/examples/vignette.ron", "docs/examples/vignette.wgsl"]
        .iter()
        .map(|path| {
            std::fs::read_to_string(root().join(path))
                .unwrap()
                .lines()
                .filter(|line| !line.trim().is_empty())
                .count()
        })
        .sum();
    assert!(lines <= 25, "{lines} lines");
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    for (pipeline, name) in [("docs/examples/vignette.ron", "effect.png"), ("ism-invtm", "plain.png")] {
        let done = lightloom(
            &[&["render", pipeline, "cornell-box", "-o", &file(name), "--output", "display"], QUICK].concat(),
        );
        assert!(done.status.success(), "{}", err(&done));
    }
    let corner = |name: &str| Image::read(folder.path().join(name)).unwrap().pixels()[0][0];
    assert!(corner("effect.png") <= corner("plain.png"));
    let compared = lightloom(&["compare", &file("effect.png"), &file("plain.png"), "--json"]);
    let json: serde_json::Value = serde_json::from_str(&out(&compared)).unwrap();
    assert!(json["rmse"].as_f64().unwrap() > 0.0);
}

/// Shaders of one's own may lie anywhere, and import their neighbours and the tree's.
#[test]
fn a_shader_is_found_by_its_absolute_path() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("shade.wgsl", "const SHADE: f32 = 0.5;\n");
    write(
        "effect.wgsl",
        "#import \"shade.wgsl\"\n#import \"color.wgsl\"\nvar image: texture_2d<f32>;\n@fragment\n\
         fn main(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {\n\
         return textureLoad(image, vec2<u32>(at.xy), 0) * SHADE / PI;\n}\n",
    );
    let shader = folder.path().join("effect.wgsl").to_string_lossy().replace('\\', "/");
    let pass = format!(
        "Pass(kind: \"fullscreen\", shader: \"{shader}\", out: {{ \"result\": Out(interface: \"Display\") }})"
    );
    let insert =
        format!("Insert(name: \"shade\", pass: {pass}, between: (\"image.display\", \"out.display\"))");
    write("mine.ron", &format!("Pipeline(extends: \"ism.ron\", patch: [{insert}])"));
    let checked = run_in(folder.path(), &["check", "mine.ron"]);
    assert!(checked.status.success(), "{}{}", out(&checked), err(&checked));
}

/// TCAS §6: the pipelines that it compares differ in the sampler alone, and stored points are another one's difference.
#[test]
fn the_pipelines_of_tcas_differ_in_one_entry() {
    for (pipeline, other, change) in [
        ("ism-invtm", "tcas", "pass lights: sample-inverse-transform → sample-metropolis"),
        ("ism-invtm", "ism-uniform", "pass lights: sample-inverse-transform → sample-uniform"),
        ("ism-uniform", "tcas", "pass lights: sample-uniform → sample-metropolis"),
        ("tcas", "tcas-stored", "pass shadows/points: points-on-the-fly → scene-points"),
    ] {
        let printed = out(&lightloom(&["diff", pipeline, other]));
        let passes: Vec<&str> = printed.lines().filter(|line| line.contains("pass ")).collect();
        assert_eq!(passes, [format!("~ {change}")], "{printed}");
    }
    // 512² pixels are `--size`; 1,024 maps of 64² are the texels of an atlas of 2048²; one of 4×2 subsets a pixel.
    for (name, value) in [("lights", "1024"), ("map", "64"), ("interleave_x", "4"), ("interleave_y", "2")] {
        let printed = out(&lightloom(&["resolve", "tcas"]));
        let said = printed.lines().find(|line| line.trim_start().starts_with(&format!("\"{name}\": U32(")));
        assert!(said.is_some_and(|line| line.contains(&format!("default: {value}"))), "{name}: {said:?}");
    }
}

/// Chains of no step have no last one.
#[test]
fn chains_of_no_step_are_refused() {
    let done = lightloom(&["graph", "tcas", "cornell-box", "--set", "lights.steps=0"]);
    assert!(!done.status.success());
    let told = String::from_utf8_lossy(&done.stderr);
    assert!(told.contains("`steps` is from 1 to 1024, and 0 is not"), "{told}");
}

#[test]
fn graphs_lists_and_differences_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    for (extension, begin) in [("svg", "<svg"), ("dot", "digraph"), ("json", "{"), ("txt", "plan")] {
        let path = folder.path().join(format!("graph.{extension}"));
        let done = lightloom(&["graph", "ism-invtm", "-o", &path.to_string_lossy()]);
        assert!(done.status.success(), "{}", err(&done));
        assert!(std::fs::read_to_string(&path).unwrap().trim_start().starts_with(begin), "{extension}");
    }
    assert!(out(&lightloom(&["diff", "ism", "ism-invtm"])).contains("importance"));
    assert!(out(&lightloom(&["diff", "ism", "ism"])).contains("no difference"));
    assert!(out(&lightloom(&["resolve", "ism-invtm"])).contains("pipelines/ism.ron:"));
    let listed = [
        ("pipelines", "ism-invtm"),
        ("scenes", "cornell-box"),
        ("passes", "gather"),
        ("measures", "rel-mse"),
    ];
    for (command, word) in listed {
        assert!(out(&lightloom(&[command])).contains(word));
        let json: serde_json::Value = serde_json::from_str(&out(&lightloom(&[command, "--json"]))).unwrap();
        assert!(!json.as_array().unwrap().is_empty());
    }
    for kind in ["gather", "splat", "fullscreen"] {
        assert!(lightloom(&["passes", kind]).status.success());
    }
}

/// The filter of the guide: five iterations of a part in WGSL and RON alone, in place of the blur.
#[test]
fn the_guides_filter_repeats_a_part_without_rust() {
    let listed = lightloom(&["graph", "docs/examples/a-trous.ron", "cornell-box"]);
    let printed = out(&listed);
    assert!(listed.status.success(), "{}", err(&listed));
    for copy in 0..5 {
        assert!(printed.contains(&format!("filter/{copy}/smooth")), "{printed}");
    }
    assert!(!printed.contains("filter/5/"), "{printed}");
    // An option of its shader is a setting like any other, with the words that it declares.
    let set = |value: &str| lightloom(&["graph", "docs/examples/a-trous.ron", "cornell-box", "--set", value]);
    assert!(set("filter/smooth.edges=geometry").status.success());
    let wrong = set("filter/smooth.edges=light");
    assert!(
        err(&wrong).contains("`edges` is one of \"all\", \"geometry\""),
        "{}{}",
        out(&wrong),
        err(&wrong)
    );
}

#[test]
fn settings_of_passes_inside_parts_can_be_set() {
    let set = |value: &str| lightloom(&["graph", "ism-invtm", "cornell-box", "--set", value]);
    let done = set("shadows/splat.kernel=surfel");
    assert!(done.status.success(), "{}", err(&done));
    let wrong = set("shadows/splat.kernel=surfle");
    assert!(err(&wrong).contains("`kernel` is one of"), "{}{}", out(&wrong), err(&wrong));
    let misspelt = set("shadows/splat.kernle=surfel");
    assert!(err(&misspelt).contains("did you mean `kernel`?"), "{}{}", out(&misspelt), err(&misspelt));
}

/// Waits until `ready`, while the process runs.
fn wait_for(child: &mut std::process::Child, what: &str, ready: impl Fn() -> bool) {
    let start = std::time::Instant::now();
    while !ready() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before {what}");
        assert!(start.elapsed().as_secs() < 60, "no {what} in a minute");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
}

#[cfg(unix)]
#[test]
fn a_watched_picture_follows_its_files() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let scene = "Scene(geometry: BuiltIn(\"cornell-box\"), camera: Camera(position: (0.278, 0.273, -0.8), \
                 target: (0.278, 0.273, 0), vertical_fov_deg: 39), lights: [Point(position: (0.278, 0.4, 0.2), \
                 intensity: (0.1, 0.1, 0.1))])";
    std::fs::write(at("own.ron"), scene).unwrap();
    // Both files are named from the working folder, which is not the tree.
    let pipeline = |more: &str| format!("Pipeline(extends: \"ism.ron\", patch: [{more}])");
    std::fs::write(at("mine.ron"), pipeline("")).unwrap();
    let told = std::fs::File::create(at("told")).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_lightloom"))
        .args([
            "--root",
            &root().to_string_lossy(),
            "render",
            "mine.ron",
            "own.ron",
            "-o",
            "own.png",
            "--watch",
        ])
        .args(QUICK)
        .current_dir(folder.path())
        .stdout(std::process::Stdio::null())
        .stderr(told)
        .spawn()
        .unwrap();
    let said = || std::fs::read_to_string(at("told")).unwrap();
    let picture = || std::fs::read(at("own.png")).unwrap_or_default();
    wait_for(&mut child, "picture", || said().contains("watching"));
    let first = picture();

    std::fs::write(at("own.ron"), scene.replace("vertical_fov_deg: 39", "vertical_fov_deg: 390")).unwrap();
    wait_for(&mut child, "message", || said().contains("own.ron:1:"));
    assert!(said().contains("expected degrees between 0 and 180, found 390"), "{}", said());
    assert!(picture() == first, "the last good picture stays");

    std::fs::write(at("own.ron"), scene.replace("vertical_fov_deg: 39", "vertical_fov_deg: 60")).unwrap();
    wait_for(&mut child, "other picture", || picture() != first);
    assert!(metrics::Image::read(at("own.png")).is_ok(), "a picture is whole whenever it is read");

    let second = picture();
    std::fs::write(at("mine.ron"), pipeline("Set(\"image.exposure\", 3.0)")).unwrap();
    wait_for(&mut child, "picture by another pipeline", || picture() != second && !picture().is_empty());

    let ended = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(ended.success());
    assert_eq!(child.wait().unwrap().code(), Some(0), "{}", said());
}
