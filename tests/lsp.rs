//! The language server, asked by an editor.

mod editor;
mod mistakes;

use crate::adapter::root;
use crate::program::{Folder, lightloom, run_in};
use editor::{Editor, edited};
use serde_json::{Value, json};

const EFFECT: &str = "struct Settings {\n    /// Darkening. [default: 0.5, min: 0.0, max: 1.0]\n    strength: f32,\n}\nvar<uniform> settings: Settings;\nvar picture: texture_2d<f32>;\n\n@fragment\nfn effect(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {\n    return textureLoad(picture, vec2<u32>(at.xy), 0) * settings.strength;\n}\n";
const BASE: &str = "Pipeline(\n    extends: \"ism.ron\",\n    parameters: { \"shade\": F32(default: 0.5, min: 0.0, max: 1.0, doc: \"How dark\") },\n    patch: [Insert(\n        name: \"effect\",\n        pass: Pass(kind: \"fullscreen\", shader: \"effect.wgsl\", set: { \"strength\": \"$shade\" }, out: { \"result\": Out(interface: \"Display\") }),\n        between: (\"image.display\", \"out.display\"),\n    )],\n)\n";

fn folder() -> Folder {
    Folder::new(&[("effect.wgsl", EFFECT), ("base.ron", BASE), ("box.glb", ""), ("sky.hdr", "")])
}

#[test]
fn names_are_offered_that_fit() {
    let variant = |patch: &str| format!("Pipeline(extends: \"ism.ron\", patch: [{patch}");
    let lights =
        |rest: &str| variant(&format!("Replace(\"lights\", Pass(kind: \"sample-metropolis\", {rest}"));
    let study = |rest: &str| format!("Study(scenes: [\"atrium\"], pipelines: [\"ism\"], {rest}");
    let ron: [(String, &[&str], &[&str]); 33] = [
        ("‸".into(), &["Pipeline", "Scene", "Study"], &[]),
        ("Pipeline(‸".into(), &["extends", "passes", "patch"], &["kind"]),
        ("Pipeline(extends: \"ism.ron\", ‸\n)".into(), &["patch"], &["extends"]),
        (variant("‸"), &["Replace", "Insert", "Set", "Remove"], &["Pass"]),
        (variant("Replace(\"‸"), &["lights", "shadows", "filter", "importance"], &["map"]),
        (variant("Replace(\"lights\", ‸"), &["Pass", "Sub"], &["Set"]),
        (
            variant("Replace(\"lights\", Pass(kind: \"‸"),
            &["sample-uniform", "sample-metropolis"],
            &["gather", "tonemap"],
        ),
        (variant("Replace(\"lights\", Pass(‸"), &["kind", "in", "set", "history"], &["file"]),
        (
            variant("Replace(\"lights\", Sub(file: \"‸"),
            &["parts/clusters.ron", "base.ron"],
            &["scenes/atrium.ron"],
        ),
        (lights("in: { \"‸"), &["rsm", "importance"], &["view"]),
        (lights("in: { \"rsm\": \"‸"), &["rsm"], &["view", "shadows"]),
        (lights("set: { \"‸"), &["count", "steps"], &["clamp"]),
        (lights("set: { ‸"), &["count"], &[]),
        (lights("set: { \"count\": \"$‸"), &["$lights", "$map"], &["$count"]),
        (lights("set: { \"count\": \"$lights * $m‸"), &["$map"], &[]),
        (lights("off: ‸"), &["Input"], &[]),
        (lights("history: (reset: [‸"), &["Cut", "Moved"], &["Pass"]),
        (lights("when: \"‸"), &["scene.glossy", "$lights"], &[]),
        (variant("Set(\"‸"), &["lights", "gather.clamp", "shadows.map", "shadows/fill.levels"], &[]),
        (variant("Set(\"gather.geometry\", ‸"), &["\"bounded\"", "\"disc\""], &["true"]),
        (variant("Remove(\"‸"), &["filter"], &[]),
        (
            variant(
                "Insert(name: \"x\", pass: Pass(kind: \"‸\"), between: (\"gather\", \"filter.irradiance\"))",
            ),
            &["geometry-aware-blur"],
            &["gather", "tonemap"],
        ),
        (
            variant("Insert(name: \"x\", between: (\"image.display\", \"‸"),
            &["out.display", "filter.irradiance"],
            &["filter"],
        ),
        ("Pipeline(extends: \"‸".into(), &["ism.ron", "base.ron", "parts/deferred.ron"], &["my.ron"]),
        ("Pipeline(extends: \"ism.ron\", parameters: { \"‸".into(), &["lights", "map"], &[]),
        (
            "Pipeline(passes: { \"x\": Pass(kind: \"compute\", shader: \"‸".into(),
            &["effect.wgsl"],
            &["my.ron"],
        ),
        (
            "Pipeline(passes: { \"x\": Pass(kind: \"compute\", out: { \"o\": Out(interface: \"‸".into(),
            &["Display", "GBuffer"],
            &[],
        ),
        (
            "Pipeline(passes: { \"x\": Pass(kind: \"compute\", out: { \"o\": Out(format: \"‸".into(),
            &["rgba16float"],
            &[],
        ),
        (study("measures: [\"‸"), &["rmse", "tid"], &[]),
        (study("set: { \"‸"), &["lights", "rsm.size"], &[]),
        ("Scene(geometry: BuiltIn(\"‸".into(), &["atrium", "cornell-box"], &["ism"]),
        ("Scene(geometry: File(\"‸".into(), &["box.glb"], &["sky.hdr"]),
        ("Scene(environment: Environment(map: File(\"‸".into(), &["sky.hdr"], &["box.glb"]),
    ];
    let wgsl: [(&str, &[&str], &[&str]); 8] = [
        ("#import \"‸", &["camera.wgsl", "random.wgsl"], &["x.wgsl"]),
        ("#‸", &["option ", "input "], &[]),
        ("#input view: ‸", &["GBuffer", "Display"], &["camera.wgsl"]),
        ("#input view: GBuffer // V.\nvar ‸", &["view_depth", "camera"], &["view"]),
        ("#input maps: Visibility // V.\n#import interface \"‸", &["maps"], &["camera.wgsl"]),
        ("/// A. [scr‸", &["scratch", "threads", "default"], &[]),
        (
            "struct Settings {\n /// A. [default: 1.0]\n a: f32,\n}\nvar<uniform> settings: Settings;\nfn f() { settings.‸",
            &["a"],
            &["camera"],
        ),
        ("const ONE: u32 = 1;\nfn two() { ‸ }", &["ONE", "two"], &[]),
    ];
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let ron = ron.iter().map(|(text, with, without)| ("my.ron", text.as_str(), with, without));
    let wgsl = wgsl.iter().map(|(text, with, without)| ("x.wgsl", *text, with, without));
    for (name, text, with, without) in ron.chain(wgsl) {
        let at = editor.open(name, text);
        let answer = editor.at("completion", name, &at, json!({}));
        let items = answer.as_array().unwrap_or_else(|| panic!("{text}: {answer}"));
        let labels: Vec<&str> = items.iter().map(|item| item["label"].as_str().unwrap()).collect();
        for label in *with {
            assert!(labels.contains(label), "no {label} at {text}: {labels:?}");
        }
        for label in *without {
            assert!(!labels.contains(label), "{label} at {text}");
        }
        editor.close(name);
    }
    let at = editor.open("my.ron", &lights("set: { \"‸"));
    let answer = editor.at("completion", "my.ron", &at, json!({}));
    let steps = answer.as_array().unwrap().iter().find(|item| item["label"] == "steps").unwrap();
    assert_eq!(steps["detail"], "u32, 1 to 1024, default 5");
    assert!(steps["documentation"]["value"].as_str().unwrap().len() > 20, "{steps}");
    assert_eq!(editor.end(), Some(0));
}

/// What is offered replaces what is typed, and no more.
#[test]
fn an_offer_completes_what_is_typed() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let pass =
        |rest: &str| variant(&format!("Replace(\"lights\", Pass(kind: \"sample-metropolis\", {rest}))"));
    let cases = [
        (variant("Replace(\"‸\")"), "lights", "Replace(\"lights\")"),
        (variant("Replace(\"li‸ghts\", Pass())"), "shadows", "Replace(\"shadows\", Pass())"),
        (variant("Re‸"), "Replace", "[Replace(]"),
        (variant("Re‸(\"x\")"), "Remove", "[Remove(\"x\")]"),
        (pass("set: { \"‸\" }"), "count", "set: { \"count\" }"),
        (pass("set: { ‸ }"), "count", "set: { \"count\" }"),
        (pass("set: { \"count\": \"$li‸\" }"), "$lights", "\"count\": \"$lights\" }"),
        (pass("set: { \"count\": \"$lights * $m‸ + 1\" }"), "$map", "\"$lights * $map + 1\""),
        (pass("set: { \"count\": \"‸\" }"), "$map", "\"count\": \"$map\" }"),
        (pass("se‸"), "set", ", set: ))"),
        (pass("se‸: { }"), "set", ", set: { }))"),
        (variant("Set(\"gather.geometry\", \"d‸\")"), "\"disc\"", "geometry\", \"disc\")"),
        (variant("Set(\"gather.geometry\", ‸)"), "\"disc\"", "geometry\", \"disc\")"),
        (pass("in: { \"😀\": \"x\", \"rsm\": \"r‸\" }"), "rsm", "\"rsm\": \"rsm\" }"),
    ];
    for (marked, label, expected) in &cases {
        let at = editor.open("my.ron", marked);
        let answer = editor.at("completion", "my.ron", &at, json!({}));
        let items = answer.as_array().unwrap_or_else(|| panic!("{marked}: {answer}"));
        let item = items
            .iter()
            .find(|item| item["label"] == *label)
            .unwrap_or_else(|| panic!("{marked}: {items:?}"));
        let text = edited(&marked.replace('‸', ""), &json!([item["textEdit"]]));
        assert!(text.contains(expected), "{marked} is {text}");
        editor.close("my.ron");
    }
}

/// Returns the file and the line, from 1, of a location.
fn place(location: &Value) -> String {
    let uri = location["uri"].as_str().unwrap_or_default();
    let file: Vec<&str> = uri.rsplit('/').take(2).collect();
    format!("{}/{}:{}", file[1], file[0], location["range"]["start"]["line"].as_u64().unwrap_or(999) + 1)
}

/// A variant, with one mark for each question.
fn variant(patch: &str) -> String {
    format!("Pipeline(\n    extends: \"ism-invtm.ron\",\n    patch: [{patch}],\n)\n")
}

#[test]
fn a_name_leads_to_its_declaration() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let line = |path: &str, text: &str| {
        let whole = std::fs::read_to_string(root().join(path)).unwrap();
        let at =
            whole.lines().position(|line| line.contains(text)).unwrap_or_else(|| panic!("{text} in {path}"));
        let file: Vec<&str> = path.rsplit('/').take(2).collect();
        format!("{}/{}:{}", file[1], file[0], at + 1)
    };
    let of_folder = |name: &str, line: usize| {
        format!("{}/{name}:{line}", folder.canonicalize().unwrap().file_name().unwrap().to_string_lossy())
    };
    let cases = [
        (
            variant("Replace(\"lig‸hts\", Pass(kind: \"sample-uniform\"))"),
            line("pipelines/parts/deferred.ron", "\"lights\": Pass"),
        ),
        (
            variant("Set(\"gather.clamp\", \"$lig‸hts\")"),
            line("pipelines/parts/deferred.ron", "\"lights\": U32("),
        ),
        (
            variant("Replace(\"lights\", Sub(file: \"parts/clus‸ters.ron\"))"),
            "parts/clusters.ron:1".to_owned(),
        ),
        (
            variant("Replace(\"lights\", Pass(kind: \"sample-uni‸form\"))"),
            "sample-uniform/sample-uniform.wgsl:1".to_owned(),
        ),
        (
            variant("Set(\"shadows/fi‸ll.levels\", 2)"),
            line("pipelines/parts/imperfect-shadow-maps-on-the-fly.ron", "\"fill\": Pass("),
        ),
        (variant("Set(\"shad‸ows/fill.levels\", 2)"), line("pipelines/parts/deferred.ron", "\"shadows\":")),
        (
            variant("Set(\"shadows.m‸ap\", 64)"),
            line("pipelines/parts/imperfect-shadow-maps-on-the-fly.ron", "\"map\": U32("),
        ),
        (variant("Set(\"gather.cl‸amp\", 0.5)"), line("passes/gather/gather.wgsl", "    clamp: f32,")),
        (
            variant(
                "Insert(name: \"x\", pass: Pass(kind: \"fullscreen\", shader: \"eff‸ect.wgsl\"), between: (\"image.display\", \"out.display\"))",
            ),
            of_folder("effect.wgsl", 1),
        ),
        ("Pipeline(extends: \"ba‸se.ron\")".to_owned(), of_folder("base.ron", 1)),
        (
            "Pipeline(extends: \"base.ron\", patch: [Remove(\"ef‸fect\")])".to_owned(),
            of_folder("base.ron", 5),
        ),
        ("Study(scenes: [\"atr‸ium\"], pipelines: [\"ism\"])".to_owned(), "scenes/atrium.ron:1".to_owned()),
        (
            "Study(scenes: [\"atrium\"], pipelines: [\"ism\"], set: { \"shadows.m‸ap\": 64 })".to_owned(),
            line("pipelines/parts/imperfect-shadow-maps-on-the-fly.ron", "\"map\": U32("),
        ),
        ("Study(scenes: [\"atrium\"], pipelines: [\"is‸m\"])".to_owned(), "pipelines/ism.ron:1".to_owned()),
    ];
    for (text, expected) in &cases {
        let at = editor.open("my.ron", text);
        let found = editor.at("definition", "my.ron", &at, json!({}));
        assert_eq!(place(&found), *expected, "{text}: {found}");
        editor.close("my.ron");
    }
    let gather = std::fs::read_to_string(root().join("passes/gather/gather.wgsl")).unwrap();
    for (from, to, expected) in [
        ("\"gather-lights.wgsl\"", "\"gather-‸lights.wgsl\"", "shaders/gather-lights.wgsl:1".to_owned()),
        (
            "clamp: settings.clamp",
            "clamp: settings.cla‸mp",
            line("passes/gather/gather.wgsl", "    clamp: f32,"),
        ),
    ] {
        let at = editor.open("tree:passes/gather/gather.wgsl", &gather.replacen(from, to, 1));
        let found = editor.at("definition", "tree:passes/gather/gather.wgsl", &at, json!({}));
        assert_eq!(place(&found), expected, "{to}: {found}");
    }
}

#[test]
fn a_name_is_explained_with_its_value_and_origin() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let cases: [(&str, String, &[&str]); 12] = [
        ("my.ron", "Study(scenes: [\"atr‸ium\"], pipelines: [\"ism\"])".to_owned(), &["Colonnaded"]),
        ("my.ron", variant("Set(\"gather.cl‸amp\", 0.25)"), &["f32, 0 to 1", "Value: `0.25`, given at", "my.ron:3:33", "Declared at"]),
        ("my.ron", variant("Set(\"gather.clamp\", \"$lig‸hts\")"), &["u32", "Value: `1024`", "deferred.ron"]),
        ("my.ron", variant("Set(\"gat‸her.clamp\", 0.1)"), &["gather", "virtual lights", "Declared at"]),
        ("my.ron", variant("Remove(\"shad‸ows\")"), &["sub-graph"]),
        ("my.ron", variant("Replace(\"lights\", Pass(kind: \"sample-uni‸form\"))"), &["in `rsm`: ", "out `lights`: VirtualLights", "set `count`: u32"]),
        ("my.ron", variant("Replace(\"lights\", Sub(file: \"parts/clus‸ters.ron\"))"), &["pipelines/parts/clusters.ron"]),
        ("my.ron", variant("Replace(\"lights\", Pass(kind: \"sample-uniform\", set: { \"cou‸nt\": 64 }))"), &["Value: `64`, given at"]),
        ("my.ron", "Study(measures: [\"rm‸se\"], pipelines: [\"ism\"])".to_owned(), &["RMSE"]),
        ("my.ron", "Study(pipelines: [\"ism\"], set: { \"lig‸hts\": 3 })".to_owned(), &["u32", "Value: `1024`"]),
        ("x.wgsl", "#input view: GBuffer // The surfaces.\nvar view_dep‸th: texture_2d<f32>;".to_owned(), &["view: GBuffer", "The surfaces.", "texture"]),
        ("x.wgsl", "struct Settings {\n    /// How dark. [default: 0.5, min: 0.0]\n    str‸ength: f32,\n}\nvar<uniform> settings: Settings;".to_owned(), &["f32, at least 0, default 0.5", "How dark"]),
    ];
    for (name, text, words) in &cases {
        let at = editor.open(name, text);
        let found = editor.at("hover", name, &at, json!({}));
        let said = found["contents"]["value"].as_str().unwrap_or_default();
        for word in *words {
            assert!(said.contains(word), "no {word} of {text}: {said}");
        }
        editor.close(name);
    }
}

/// A base, a variant of it, a part and a pipeline that uses both: a name that is changed is changed in all.
#[test]
fn a_pass_and_a_parameter_are_renamed_everywhere() {
    let part = "Pipeline(\n    parameters: { \"dark\": F32() },\n    inputs: { \"image\": \"Display\" },\n    passes: { \"shade\": Pass(kind: \"fullscreen\", shader: \"effect.wgsl\", in: { \"picture\": \"in.image\" }, set: { \"strength\": \"$dark\" }, out: { \"result\": Out(interface: \"Display\") }) },\n    outputs: { \"result\": \"shade\" },\n)\n";
    let user = "Pipeline(extends: \"base.ron\", patch: [\n    Set(\"shade\", 0.25),\n    Insert(name: \"part\", pass: Sub(file: \"part.ron\", set: { \"dark\": \"$shade * 0.5\" }), between: (\"effect\", \"out.display\")),\n    Set(\"part/shade.strength\", 0.75),\n    Set(\"effect.strength\", \"$shade\"),\n])\n";
    let study = "// A (study).\nStudy(\n    scenes: [\"cornell-box\"], pipelines: [\"user.ron\"], output: \"display\", size: (64, 64),\n    set: { \"shade\": 0.5 },\n    vary: Grid({ \"part/shade.strength\": [0.25, 0.5], \"effect.strength\": [0.1] }),\n    phases: { \"dark\": [\"effect\"] },\n    budget: Frames(1), measures: [\"gpu-ms\"],\n)\n";
    let folder = Folder::new(&[
        ("effect.wgsl", EFFECT),
        ("base.ron", BASE),
        ("part.ron", part),
        ("user.ron", user),
        ("study.ron", study),
    ]);
    let checked = |name: &str| {
        run_in(&folder, &["--root", &root().to_string_lossy(), "check", name, "--scene", "cornell-box"])
    };
    checked("user.ron").success();
    checked("study.ron").success();
    let editor = Editor::of_tree(&folder);
    let cases = [
        ("base.ron", "\"sha‸de\": F32", "gloom", 6),
        ("base.ron", "name: \"eff‸ect\"", "vignette", 5),
        ("part.ron", "\"da‸rk\": F32", "depth", 3),
        ("user.ron", "\"part/sh‸ade.", "inner", 4),
    ];
    for (name, marked, new, count) in cases {
        let text = folder.read(name);
        let at = editor.open(name, &text.replacen(&marked.replace('‸', ""), marked, 1));
        let uses = editor.at("references", name, &at, json!({ "context": { "includeDeclaration": true } }));
        assert_eq!(uses.as_array().unwrap().len(), count, "{marked}: {uses}");
        assert!(editor.at("prepareRename", name, &at, json!({}))["start"].is_object());
        let changes = editor.at("rename", name, &at, json!({ "newName": new }));
        for (uri, edits) in changes["changes"].as_object().unwrap_or_else(|| panic!("{changes}")) {
            let name = uri.rsplit('/').next().unwrap();
            folder.write(name, &edited(&folder.read(name), edits));
        }
        editor.close(name);
        checked("user.ron").success();
        checked("study.ron").success();
        assert!(!folder.read("user.ron").contains(&format!("\"{}\"", marked.replace('‸', ""))));
    }
    let at = editor.open("base.ron", &folder.read("base.ron").replacen("\"gloom\"", "\"glo‸om\"", 1));
    let refused =
        |new: &str| editor.at("rename", "base.ron", &at, json!({ "newName": new }))["error"].to_string();
    assert!(refused("a b").contains("is no name"), "{}", refused("a b"));
    assert!(refused("lights").contains("is declared at"), "{}", refused("lights"));
}

#[test]
fn what_is_built_in_is_shown_and_not_renamed() {
    let folder = folder();
    let editor = Editor::alone(&folder);
    let at = editor.open("my.ron", &variant("Replace(\"lig‸hts\", Pass(kind: \"sample-uniform\"))"));
    let found = editor.at("definition", "my.ron", &at, json!({}));
    let uri = found["uri"].as_str().unwrap().to_owned();
    let shown = std::path::PathBuf::from(uri.strip_prefix("file://").unwrap());
    assert!(shown.ends_with("pipelines/parts/deferred.ron") && shown.is_file(), "{uri}");
    let refused = editor.at("rename", "my.ron", &at, json!({ "newName": "x" }));
    assert!(refused["error"].to_string().contains("is built into the program"), "{refused}");
    assert_eq!(editor.end(), Some(0));
    assert!(!shown.exists(), "what is shown goes with the server");
}

#[test]
fn outlines_layout_and_values_are_shown() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    editor.open("base.ron", BASE);
    let symbols = editor.at("documentSymbol", "base.ron", &json!({}), json!({}));
    let text = symbols.to_string();
    for name in ["shade", "effect", "F32", "Insert"] {
        assert!(text.contains(name), "{name}: {text}");
    }
    editor.open("effect.wgsl", EFFECT);
    let symbols = editor.at("documentSymbol", "effect.wgsl", &json!({}), json!({})).to_string();
    assert!(symbols.contains("\"effect\"") && symbols.contains("\"Settings\""), "{symbols}");
    let rough = "Pipeline( extends:\"ism.ron\" ,\r\n// 😀\r\nparameters:{\"lights\":U32( ),}\r\n)";
    editor.open("rough.ron", rough);
    let options = json!({ "options": { "tabSize": 4, "insertSpaces": true } });
    let edits = editor.at("formatting", "rough.ron", &json!({}), options.clone());
    let smooth = edited(rough, &edits);
    assert_eq!(
        smooth,
        "Pipeline(extends: \"ism.ron\",\r\n    // 😀\r\n    parameters: { \"lights\": U32(), },\r\n)\r\n"
    );
    folder.write("rough.ron", rough);
    run_in(&folder, &["fmt", "--check", "rough.ron"]).failure(1, &["rough.ron", "1 to be laid out"]);
    run_in(&folder, &["fmt", "rough.ron"]).success();
    assert_eq!(folder.read("rough.ron"), smooth, "the command and the editor agree");
    run_in(&folder, &["fmt", "--check", "."]).success();
    editor.set("rough.ron", 1, "Pipeline(");
    assert_eq!(editor.at("formatting", "rough.ron", &json!({}), options), json!([]), "what is broken stays");
    run_in(&folder, &["fmt", "effect.wgsl"]).failure(1, &["effect.wgsl:1:", "1 cannot be laid out"]);
    let text = "Pipeline(extends: \"ism.ron\", parameters: { \"lights\": U32(max: 2048) }, patch: [Set(\"gather.interleave_x\", \"$interleave_x / 2\")])";
    editor.open("hints.ron", text);
    let range =
        json!({ "range": { "start": { "line": 0, "character": 0 }, "end": { "line": 9, "character": 0 } } });
    let hints = editor.at("inlayHint", "hints.ron", &json!({}), range);
    let found: Vec<&str> =
        hints.as_array().unwrap().iter().map(|hint| hint["label"].as_str().unwrap()).collect();
    assert_eq!(found, ["default: 1024", "= 8"], "{hints}");
}

#[test]
fn the_tree_is_laid_out() {
    lightloom(&["fmt", "--check", "pipelines", "scenes", "studies", "docs", "examples", "tools"]).success();
}
