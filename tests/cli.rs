//! The command line as a user types it.

use crate::adapter::{gpu, names_in, root};
use crate::program::{Done, Folder, QUICK, command, command_of_tree, lightloom, render, run_in, wait_for};
use metrics::Image;
use std::path::Path;
use std::process::{Command, Stdio};

fn image(folder: &Folder, name: &str) -> Image {
    Image::read(folder.at(name)).unwrap()
}

#[test]
fn renders_in_any_folder_and_prints_where() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    for file in ["box.png", "deep/box.exr", "box.pfm"] {
        let done = render(&folder, "ism-invtm", file, &[]).success();
        let path = Path::new(done.out.lines().last().unwrap());
        assert!(path.is_absolute() && path.is_file(), "{done}");
    }
    let image = image(&folder, "deep/box.exr");
    assert_eq!((image.width(), image.height()), (24, 16));
    assert!(image.pixels().iter().any(|pixel| pixel[0] > 0.0));
}

#[test]
fn a_picture_reports_the_losses_of_its_pipeline_once() {
    let removed = "Pipeline(extends: \"ism.ron\", patch: [Remove(\"filter\")])";
    let Some(folder) = Folder::with_gpu(&[("rm.ron", removed)]) else { return };
    let done = render(&folder, "rm.ron", "a.png", &["--exposure", "1", "--json"]).success();
    assert_eq!(done.err.matches("W001").count(), 1, "{done}");
    done.json();
}

#[test]
fn several_outputs_of_one_run_are_files_of_their_own() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let both = ["--output", "image", "--output", "indirect", "--output", "view.depth"];
    render(&folder, "ism", "box.exr", &both).success();
    for output in ["image", "indirect", "view.depth"] {
        render(&folder, "ism", "one.exr", &["--output", output]).success();
        let several = image(&folder, &format!("box-{output}.exr"));
        assert_eq!(several.pixels(), image(&folder, "one.exr").pixels(), "{output}");
    }
    assert!(!folder.at("box.exr").exists());
}

#[test]
fn frames_beyond_the_last_number_are_refused() {
    let last = ["--first-frame", "4294967295"];
    let done = render(&Folder::new(&[]), "ism", "a.exr", &last);
    done.failure(1, &["frames have numbers up to 4294967294"]);
}

#[test]
fn sequences_are_numbered() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    render(&folder, "ism", "walk/###.png", &["--frames", "3", "--first-frame", "9"]).success();
    for name in ["walk/009.png", "walk/010.png", "walk/011.png"] {
        assert!(folder.at(name).is_file(), "{name}");
    }
}

#[test]
fn times_memory_and_clamped_energy_are_in_the_json() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let json = render(&folder, "ism-invtm", "t.exr", &["--time", "--frames", "2", "--json"]).json();
    assert!(json["passes"].as_array().unwrap().len() > 8, "{json}");
    assert!(json["clamped_energy"].as_f64().unwrap() >= 0.0);
    assert!(json["memory"]["shared"].as_u64().unwrap() <= json["memory"]["unshared"].as_u64().unwrap());
}

/// The phases of a start lie between the start of the process and its first picture, and all that takes long is among
/// them.
#[test]
fn the_time_to_the_first_picture_is_reported() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let json = render(&folder, "ism-invtm", "t.png", &["--time", "--json"]).json();
    let whole = json["start"]["first_picture_ms"].as_f64().unwrap();
    let phases = json["start"]["phases"].as_array().unwrap();
    let ms = |phase: &serde_json::Value, key: &str| phase[key].as_f64().unwrap();
    for phase in phases {
        let [from, to, busy] = ["from_ms", "to_ms", "busy_ms"].map(|key| ms(phase, key));
        assert!(0.0 <= from && from <= to && to <= whole && busy >= 0.0, "{phase} of {whole} ms");
    }
    assert!(phases.is_sorted_by_key(|phase| ms(phase, "from_ms")), "{phases:?}");
    let mut names: Vec<&str> = phases.iter().filter_map(|phase| phase["phase"].as_str()).collect();
    // Their order depends on the threads.
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
    assert!(covered > 0.8 * whole, "{covered} of {whole} ms are reported: {phases:?}");
    let text = render(&folder, "ism-invtm", "t.png", &["--time"]).out;
    for name in expected.into_iter().chain(["start", "first picture"]) {
        assert!(text.lines().any(|line| line.starts_with(name)), "{name}: {text}");
    }
    assert!(render(&folder, "ism-invtm", "t.png", &["--json"]).json()["start"].is_null());
}

/// A message names the mistake and the nearest name, with exit code 1; wrong use has exit code 2.
#[test]
fn mistakes_are_reported() {
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
    let folder = Folder::new(&[]);
    let needs_gpu = |arguments: &[&str]| arguments[0] == "render";
    for (arguments, code, word) in
        cases.iter().filter(|(arguments, ..)| !needs_gpu(arguments) || gpu().is_some())
    {
        run_in(&folder, arguments).failure(*code, &[word]);
    }
    assert_eq!(std::fs::read_dir(&*folder).unwrap().count(), 0, "nothing was left behind");
}

#[test]
fn every_pipeline_is_checked_for_a_scene_without_a_gpu() {
    let pipelines = names_in("pipelines");
    let names = pipelines.iter().map(String::as_str);
    assert_all_is_good(&["check", "--scene", "cornell-box"].into_iter().chain(names).collect::<Vec<_>>());
}

#[test]
#[ignore = "slow"]
fn everything_built_in_is_checked_without_a_gpu() {
    assert_all_is_good(&["check"]);
}

fn assert_all_is_good(arguments: &[&str]) {
    let done = Done::of(command(&root()).args(arguments).env("VK_DRIVER_FILES", "/nonexistent"));
    done.success().says(&["ism-invtm"]);
}

/// The example of the guide: 25 lines at most, and a different picture.
#[test]
fn the_guides_effect_is_short_and_works() {
    let lines = |path: &str| {
        let text = std::fs::read_to_string(root().join(path)).unwrap();
        text.lines().filter(|line| !line.trim().is_empty()).count()
    };
    let lines = lines("docs/examples/vignette.ron") + lines("docs/examples/vignette.wgsl");
    assert!(lines <= 25, "{lines} lines");
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    for (pipeline, name) in [("docs/examples/vignette.ron", "effect.png"), ("ism-invtm", "plain.png")] {
        let arguments = ["render", pipeline, "cornell-box", "-o", &folder.name(name), "--output", "display"];
        lightloom(&[&arguments, QUICK].concat()).success();
    }
    assert!(image(&folder, "effect.png").pixels()[0][0] <= image(&folder, "plain.png").pixels()[0][0]);
    let compared = run_in(&folder, &["compare", "effect.png", "plain.png", "--json"]).json();
    assert!(compared["rmse"].as_f64().unwrap() > 0.0);
}

/// Shaders of one's own may lie anywhere, and import their neighbours and the tree's.
#[test]
fn a_shader_is_found_by_its_absolute_path() {
    let effect = "#import \"shade.wgsl\"\n#import \"color.wgsl\"\nvar image: texture_2d<f32>;\n@fragment\n\
         fn main(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {\n\
         return textureLoad(image, vec2<u32>(at.xy), 0) * SHADE / PI;\n}\n";
    let folder = Folder::new(&[("shade.wgsl", "const SHADE: f32 = 0.5;\n"), ("effect.wgsl", effect)]);
    let shader = folder.name("effect.wgsl").replace('\\', "/");
    let pass = format!(
        "Pass(kind: \"fullscreen\", shader: \"{shader}\", out: {{ \"result\": Out(interface: \"Display\") }})"
    );
    let insert =
        format!("Insert(name: \"shade\", pass: {pass}, between: (\"image.display\", \"out.display\"))");
    folder.write("mine.ron", &format!("Pipeline(extends: \"ism.ron\", patch: [{insert}])"));
    run_in(&folder, &["check", "mine.ron"]).success();
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
        let printed = lightloom(&["diff", pipeline, other]).out;
        let passes: Vec<&str> = printed.lines().filter(|line| line.contains("pass ")).collect();
        assert_eq!(passes, [format!("~ {change}")], "{printed}");
    }
    // 512² pixels are `--size`; 1,024 maps of 64² are the texels of an atlas of 2048²; one of 4×2 subsets a pixel.
    let printed = lightloom(&["resolve", "tcas"]).out;
    for (name, value) in [("lights", "1024"), ("map", "64"), ("interleave_x", "4"), ("interleave_y", "2")] {
        let line = printed.lines().find(|line| line.trim_start().starts_with(&format!("\"{name}\": U32(")));
        assert!(line.is_some_and(|line| line.contains(&format!("default: {value}"))), "{name}: {line:?}");
    }
}

/// Chains of no step have no last one.
#[test]
fn chains_of_no_step_are_refused() {
    let done = lightloom(&["graph", "tcas", "cornell-box", "--set", "lights.steps=0"]);
    done.failure(1, &["`steps` is from 1 to 1024, and 0 is not"]);
}

#[test]
fn graphs_lists_and_differences_are_printed() {
    let folder = Folder::new(&[]);
    for (extension, begin) in [("svg", "<svg"), ("dot", "digraph"), ("json", "{"), ("txt", "plan")] {
        let file = format!("graph.{extension}");
        lightloom(&["graph", "ism-invtm", "-o", &folder.name(&file)]).success();
        assert!(folder.read(&file).trim_start().starts_with(begin), "{extension}");
    }
    lightloom(&["diff", "ism", "ism-invtm"]).says(&["importance"]);
    lightloom(&["diff", "ism", "ism"]).says(&["no difference"]);
    lightloom(&["resolve", "ism-invtm"]).says(&["pipelines/ism.ron:"]);
    let listed = [
        ("pipelines", "ism-invtm"),
        ("scenes", "cornell-box"),
        ("passes", "gather"),
        ("interfaces", "GBuffer"),
        ("measures", "rel-mse"),
    ];
    for (command, word) in listed {
        lightloom(&[command]).says(&[word]);
        assert!(!lightloom(&[command, "--json"]).json().as_array().unwrap().is_empty());
    }
    for kind in ["gather", "splat", "fullscreen"] {
        lightloom(&["passes", kind]).success();
    }
    let lights = lightloom(&["interfaces", "VirtualLights"]).success();
    lights.says(&[
        "var<storage, read> PORT: VirtualLights;",
        "flux: vec3<f32>,",
        "output of sample-uniform",
        "input of ",
    ]);
    let view = lightloom(&["interfaces", "GBuffer", "--json"]).success().json();
    assert_eq!(view["members"][0]["declaration"], "var PORT_depth: texture_2d<f32>;");
    lightloom(&["interfaces", "GBufer"]).failure(1, &["did you mean `GBuffer`?"]);
}

#[test]
fn a_new_variant_is_right_as_it_is_written() {
    let folder = Folder::new(&[]);
    let new = |name: &str, base: &str| run_in(&folder, &["new", name, "--extends", base]);
    new("mine", "ism").success().says(&["lightloom check mine.ron"]);
    assert!(folder.read("mine.ron").contains("// Set(\"rsm.size\", 256), // Side of a layer\n"));
    run_in(&folder, &["check", "mine.ron"]).success();
    run_in(&folder, &["diff", "ism", "mine.ron"]).says(&["no difference"]);
    new("mine.ron", "ism").failure(1, &["mine.ron exists already"]);
    new("mine.txt", "ism").failure(1, &["a name that ends in .ron"]);
    new("other", "isn").failure(1, &["did you mean `ism`?"]);
    new("other", "cornell-box").failure(1, &["a pipeline is expected here"]);
    assert!(!folder.at("other.ron").exists());
}

/// What a package installs beside the program, from the program itself.
#[test]
fn completions_a_manual_and_a_long_version_are_printed() {
    let folder = Folder::new(&[]);
    let script = run_in(&folder, &["completions", "bash"]).success().says(&["--tonemap", "complete -F"]);
    let mut bash = std::process::Command::new("bash");
    let is_taken = bash.args(["-n", "-c", &script.out]).status().is_ok_and(|status| status.success());
    assert!(is_taken, "bash refuses the script");
    for (shell, word) in [("zsh", "#compdef lightloom"), ("fish", "complete -c lightloom")] {
        run_in(&folder, &["completions", shell]).success().says(&[word]);
    }
    run_in(&folder, &["completions", "csh"]).failure(2, &["possible values: bash"]);
    let pages = run_in(&folder, &["--json", "man", "-o", "man"]).success().json();
    assert!(pages["pages"].as_array().unwrap().len() > 25);
    for (page, word) in
        [("lightloom", "SUBCOMMANDS"), ("lightloom-render", "tonemap"), ("lightloom-study-merge", "root")]
    {
        let text = folder.read(&format!("man/{page}.1"));
        assert!(text.contains(".TH") && text.contains(word), "{page}: {text}");
    }
    let version = run_in(&folder, &["--version"]).success();
    version.says(&[
        &format!("lightloom {}", env!("CARGO_PKG_VERSION")),
        "commit: ",
        "features: ",
        "adapters: ",
    ]);
    assert_eq!(run_in(&folder, &["-V"]).success().out.lines().count(), 1);
}

/// On a terminal alone, work that takes long shows that it goes on.
#[test]
#[cfg(unix)]
fn progress_is_shown_on_a_terminal_alone() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let render = [&["render", "ism", "cornell-box", "-o", "r.png"], QUICK].concat();
    let piped = run_in(&folder, &render).success();
    assert!(!piped.err.contains("rendering"), "{piped}");
    let line = [&[env!("CARGO_BIN_EXE_lightloom")], &render[..]].concat().join(" ");
    // `script` gives its command a terminal.
    let mut script = Command::new("script");
    script.current_dir(&*folder).args(["--quiet", "--return", "--command", &line, "/dev/null"]);
    match script.output() {
        Ok(output) => {
            let shown = String::from_utf8_lossy(&output.stdout).into_owned();
            assert!(output.status.success() && shown.contains("rendering"), "{shown}");
        }
        Err(error) => println!("skipped: `script` does not run: {error}"),
    }
}

/// The filter of the guide: five iterations in WGSL and RON alone, in place of the blur.
#[test]
fn the_guides_filter_needs_no_rust() {
    let levels = [0, 1, 2, 3, 4].map(|level| format!("filter/level-{level}: compute"));
    let listed = lightloom(&["graph", "docs/examples/a-trous.ron", "cornell-box"]).success();
    listed.says(&levels.each_ref().map(String::as_str));
    // An option of its shader is a setting like any other, with the words that it declares.
    let set = |value: &str| lightloom(&["graph", "docs/examples/a-trous.ron", "cornell-box", "--set", value]);
    // Switched off, an iteration hands its input on.
    set("iterations=3").says(&["filter/level-4: off", "filter/level-2: compute"]);
    set("filter/level-0.edges=geometry").success();
    set("filter/level-0.edges=light").failure(1, &["`edges` is one of \"all\", \"geometry\""]);
}

#[test]
fn settings_of_passes_inside_parts_can_be_set() {
    let set = |value: &str| lightloom(&["graph", "ism-invtm", "cornell-box", "--set", value]);
    set("shadows/splat.kernel=surfel").success();
    set("shadows/splat.kernel=surfle").failure(1, &["`kernel` is one of"]);
    set("shadows/splat.kernle=surfel").failure(1, &["did you mean `kernel`?"]);
}

#[cfg(unix)]
#[test]
fn a_watched_picture_follows_its_files() {
    let scene = "Scene(geometry: BuiltIn(\"cornell-box\"), camera: Camera(position: (0.278, 0.273, -0.8), \
                 target: (0.278, 0.273, 0), vertical_fov_deg: 39), lights: [Point(position: (0.278, 0.4, 0.2), \
                 intensity: (0.1, 0.1, 0.1))])";
    // Both files are named from the working folder, which is not the tree.
    let pipeline = |more: &str| format!("Pipeline(extends: \"ism.ron\", patch: [{more}])");
    let Some(folder) = Folder::with_gpu(&[("own.ron", scene), ("mine.ron", &pipeline(""))]) else { return };
    let mut child = command_of_tree(&folder)
        .args(["render", "mine.ron", "own.ron", "-o", "own.png", "--watch"])
        .args(QUICK)
        .stdout(Stdio::null())
        .stderr(std::fs::File::create(folder.at("messages")).unwrap())
        .spawn()
        .unwrap();
    let messages = || folder.read("messages");
    let save_in_place = |name: &str, text: &str| std::fs::write(folder.at(name), text).unwrap();
    let picture = || std::fs::read(folder.at("own.png")).unwrap_or_default();
    wait_for(&mut child, "picture", || messages().contains("watching"));
    let first = picture();

    save_in_place("own.ron", &scene.replace("vertical_fov_deg: 39", "vertical_fov_deg: 390"));
    wait_for(&mut child, "message", || messages().contains("own.ron:1:"));
    assert!(messages().contains("expected degrees between 0 and 180, found 390"), "{}", messages());
    assert!(picture() == first, "the last good picture stays");

    save_in_place("own.ron", &scene.replace("vertical_fov_deg: 39", "vertical_fov_deg: 60"));
    wait_for(&mut child, "other picture", || picture() != first);
    assert!(Image::read(folder.at("own.png")).is_ok(), "a picture is whole whenever it is read");

    let second = picture();
    save_in_place("mine.ron", &pipeline("Set(\"image.exposure\", 3.0)"));
    wait_for(&mut child, "picture by another pipeline", || picture() != second && !picture().is_empty());

    let ended = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(ended.success());
    assert_eq!(child.wait().unwrap().code(), Some(0), "{}", messages());
}
