//! The language server, asked by an editor.

mod editor;

use crate::adapter::root;
use crate::program::{Folder, lightloom, run_in};
use editor::{Editor, edited, position};
use serde_json::{Value, json};

const EFFECT: &str = "struct Settings {\n    /// Darkening. [default: 0.5, min: 0.0, max: 1.0]\n    strength: f32,\n}\nvar<uniform> settings: Settings;\nvar picture: texture_2d<f32>;\n\n@fragment\nfn effect(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {\n    return textureLoad(picture, vec2<u32>(at.xy), 0) * settings.strength;\n}\n";
const BASE: &str = "Pipeline(\n    extends: \"ism.ron\",\n    parameters: { \"shade\": F32(default: 0.5, min: 0.0, max: 1.0, doc: \"How dark\") },\n    patch: [Insert(\n        name: \"effect\",\n        pass: Pass(kind: \"fullscreen\", shader: \"effect.wgsl\", set: { \"strength\": \"$shade\" }, out: { \"result\": Out(interface: \"Display\") }),\n        between: (\"image.display\", \"out.display\"),\n    )],\n)\n";

fn folder() -> Folder {
    Folder::new(&[("effect.wgsl", EFFECT), ("base.ron", BASE)])
}

#[test]
fn names_are_offered_that_fit() {
    let variant = |patch: &str| format!("Pipeline(extends: \"ism.ron\", patch: [{patch}");
    let lights =
        |rest: &str| variant(&format!("Replace(\"lights\", Pass(kind: \"sample-metropolis\", {rest}"));
    let study = |rest: &str| format!("Study(scenes: [\"atrium\"], pipelines: [\"ism\"], {rest}");
    let ron: [(String, &[&str], &[&str]); 31] = [
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
        ("\"camera.wgsl\"", "\"cam‸era.wgsl\"", "shaders/camera.wgsl:1".to_owned()),
        ("settings.clamp when", "settings.cla‸mp when", line("passes/gather/gather.wgsl", "    clamp: f32,")),
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
    let cases: [(&str, String, &[&str]); 11] = [
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
    let folder =
        Folder::new(&[("effect.wgsl", EFFECT), ("base.ron", BASE), ("part.ron", part), ("user.ron", user)]);
    let checked = |name: &str| {
        run_in(&folder, &["--root", &root().to_string_lossy(), "check", name, "--scene", "cornell-box"])
    };
    checked("user.ron").success();
    let editor = Editor::of_tree(&folder);
    let cases = [
        ("base.ron", "\"sha‸de\": F32", "gloom", 5),
        ("base.ron", "name: \"eff‸ect\"", "vignette", 3),
        ("part.ron", "\"da‸rk\": F32", "depth", 3),
        ("user.ron", "\"part/sh‸ade.", "inner", 3),
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

#[test]
fn mistakes_are_underlined_while_they_are_typed() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let wrong = variant("Set(\"interleve_x\", 2)");
    editor.open("my.ron", &wrong);
    let errors = editor.errors("my.ron", 0);
    assert_eq!(errors.len(), 1, "{errors:?}");
    let message = errors[0]["message"].as_str().unwrap();
    assert!(message.contains("did you mean `interleave_x`?"), "{message}");
    let context = json!({ "range": errors[0]["range"], "context": { "diagnostics": errors } });
    let actions = editor.at("codeAction", "my.ron", &json!({}), context);
    assert_eq!(actions[0]["title"], "change to `interleave_x`");
    let edits = &actions[0]["edit"]["changes"][editor.uri("my.ron")];
    assert_eq!(edited(&wrong, edits), wrong.replace("interleve_x", "interleave_x"));
    // Typed character by character, in a text beyond the basic plane.
    let begin = "// 😀 é\r\nPipeline(extends: \"ism.ron\", about: \"😀\", patch: [])";
    editor.set("my.ron", 1, begin);
    assert_eq!(editor.errors("my.ron", 1), [] as [Value; 0]);
    let mut text = begin.to_owned();
    for (version, typed) in (2..).zip("Remove(\"filtr\")".chars()) {
        let at = position(&text.replacen("])", "‸])", 1));
        let change = json!([{ "range": { "start": at, "end": at }, "text": typed.to_string() }]);
        editor.change("my.ron", version, change);
        text = text.replacen("])", &format!("{typed}])"), 1);
    }
    let errors = editor.errors("my.ron", 16);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(errors[0]["range"]["start"], position(&text.replacen("\"filtr", "‸\"filtr", 1)));
    assert!(errors[0]["message"].as_str().unwrap().contains("`filtr`"), "{errors:?}");
    // A base that is not saved.
    editor.set("my.ron", 20, "Pipeline(extends: \"base.ron\")");
    assert_eq!(editor.errors("my.ron", 20), [] as [Value; 0]);
    editor.open("base.ron", &BASE.replace("\"strength\"", "\"strenth\""));
    let errors = editor.errors_until("base.ron", |errors| !errors.is_empty());
    assert!(errors[0]["message"].as_str().unwrap().contains("`strength`"), "{errors:?}");
    editor.close("base.ron");
    editor.errors_until("base.ron", <[Value]>::is_empty);
}

#[test]
fn mistakes_in_wgsl_are_underlined() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let cases = [
        ("fn f() -> f32 { return nosuch; }", "nosuch", "nosuch"),
        ("#import \"nowhere.wgsl\"", "\"nowhere.wgsl\"", "nowhere.wgsl"),
        (
            "/// Sums. [scrach]\nvar<storage, read_write> sums: array<u32, 4>;\n@compute @workgroup_size(1) fn f() { sums[0] = 1u; }",
            "scrach",
            "did you mean `scratch`?",
        ),
        ("#input view: GBufer // V.", "GBufer", "did you mean `GBuffer`?"),
        (
            "struct Settings {\n    /// A. [default: 2.0, max: 1.0]\n    a: f32,\n}\nvar<uniform> settings: Settings;\n@compute @workgroup_size(1) fn f() { _ = settings.a; }",
            "",
            "default",
        ),
    ];
    for (version, (text, at, word)) in cases.iter().enumerate() {
        match version {
            0 => drop(editor.open("x.wgsl", text)),
            _ => drop(editor.set("x.wgsl", version as i32, text)),
        }
        let errors = editor.errors("x.wgsl", version as i64);
        let message = errors.first().map(|error| error["message"].to_string()).unwrap_or_default();
        assert!(message.contains(word), "{text}: {errors:?}");
        if !at.is_empty() {
            assert_eq!(
                errors[0]["range"]["start"],
                position(&text.replacen(at, &format!("‸{at}"), 1)),
                "{text}"
            );
        }
    }
    // In a file that another one imports, and in the pipeline that uses it.
    editor.set("x.wgsl", 9, "fn shade() -> f32 { return 1.0; }");
    assert_eq!(editor.errors("x.wgsl", 9), [] as [Value; 0]);
    editor.open(
        "effect.wgsl",
        &EFFECT.replace("* settings", "* shade() * settings").replacen(
            "struct",
            "#import \"x.wgsl\"\nstruct",
            1,
        ),
    );
    assert_eq!(editor.errors("effect.wgsl", 0).len(), 0);
    editor.open("base.ron", BASE);
    assert_eq!(editor.errors("base.ron", 0), [] as [Value; 0]);
    editor.set("x.wgsl", 10, "fn shad() -> f32 { return 1.0; }");
    let errors = editor.errors_until("effect.wgsl", |errors| !errors.is_empty());
    assert!(errors[0]["message"].as_str().unwrap().contains("shade"), "{errors:?}");
}

/// All shipped WGSL is good by itself.
#[test]
#[ignore = "slow"]
fn shipped_wgsl_has_no_mistakes() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let files = renderer::Assets::new(Some(root()));
    let all = ["shaders", "passes", "crates/interfaces"].map(|folder| files.list(folder, "wgsl")).concat();
    for path in all.iter().filter(|path| !path.contains("/tests/") && !path.contains("precision")) {
        let name = format!("tree:{path}");
        editor.open(&name, &std::fs::read_to_string(root().join(path)).unwrap());
        let errors = editor.errors(&name, 0);
        assert!(errors.is_empty(), "{path}: {errors:?}");
        editor.close(&name);
    }
}

/// A broken file has the errors that `check` prints, at the same places.
#[test]
fn the_editor_and_check_agree_on_broken_files() {
    let of_crate = |name: &str| root().join("crates").join(name).join("tests/broken");
    let mut broken = Vec::new();
    for folder in ["frame-graph", "scene", "study"].map(of_crate) {
        let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
        let mut files: Vec<_> = files.filter(|file| file.extension().is_some_and(|e| e == "ron")).collect();
        files.sort();
        // Every third, and more than thirty.
        broken.extend(files.into_iter().step_by(3));
    }
    assert!(broken.len() > 30, "{}", broken.len());
    let folder = folder();
    let names: Vec<String> = broken.iter().map(|path| path.to_string_lossy().into_owned()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let tree = root().to_string_lossy().into_owned();
    let checked =
        run_in(&folder, &[&["--root", &tree, "--json", "check", "--scene", "cornell-box"], &*names].concat());
    let checked = checked.json();
    let editor = Editor::of_tree(&folder);
    for row in checked["checked"].as_array().unwrap() {
        let path = row["name"].as_str().unwrap();
        let name = format!("tree:{}", path.strip_prefix(&format!("{tree}/")).unwrap());
        let text = std::fs::read_to_string(path).unwrap();
        // Files that are no pipeline, scene or study have no sort.
        if !["Pipeline", "Scene", "Study"].iter().any(|word| text.contains(&format!("{word}("))) {
            continue;
        }
        editor.open(&name, &text);
        let shown = editor.errors(&name, 0);
        let say = |error: &Value| error["message"].as_str().unwrap().lines().next().unwrap().to_owned();
        let is_error = |error: &&Value| error["severity"] == 1 || error["severity"] == "error";
        let mut shown: Vec<String> = shown.iter().filter(is_error).map(say).collect();
        let in_file = |error: &&Value| {
            error["file"].is_null()
                || error["file"].as_str().unwrap().ends_with(path.rsplit('/').next().unwrap())
        };
        let mut printed: Vec<String> =
            row["errors"].as_array().unwrap().iter().filter(is_error).filter(in_file).map(say).collect();
        shown.sort();
        printed.sort();
        shown.dedup();
        printed.dedup();
        assert_eq!(shown, printed, "{path}");
        editor.close(&name);
    }
}

#[test]
fn files_that_others_change_are_read_again() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let changed = |name: &str, kind: u32| {
        let change = json!({ "uri": editor.uri(name), "type": kind });
        editor.tell("workspace/didChangeWatchedFiles", json!({ "changes": [change] }));
    };
    editor.open("base.ron", BASE);
    assert_eq!(editor.errors("base.ron", 0), [] as [Value; 0]);
    let fails = |word: &'static str| {
        move |errors: &[Value]| errors.iter().any(|error| error["message"].as_str().unwrap().contains(word))
    };
    folder.write("effect.wgsl", &EFFECT.replace("strength: f32", "force: f32"));
    changed("effect.wgsl", 2);
    editor.errors_until("base.ron", fails("`strength`"));
    folder.write("effect.wgsl", EFFECT);
    changed("effect.wgsl", 2);
    editor.errors_until("base.ron", <[Value]>::is_empty);
    std::fs::rename(folder.at("effect.wgsl"), folder.at("other.wgsl")).unwrap();
    changed("effect.wgsl", 3);
    changed("other.wgsl", 1);
    editor.errors_until("base.ron", fails("effect.wgsl"));
    editor.set("base.ron", 1, &BASE.replace("effect.wgsl", "other.wgsl"));
    editor.errors_until("base.ron", <[Value]>::is_empty);
    // An open file that is deleted is still open, and one that extends it is right.
    std::fs::remove_file(folder.at("base.ron")).unwrap();
    changed("base.ron", 3);
    editor.open("my.ron", "Pipeline(extends: \"base.ron\")");
    assert_eq!(editor.errors("my.ron", 0), [] as [Value; 0]);
    editor.close("base.ron");
    editor.errors_until("my.ron", fails("base.ron"));
}

#[test]
fn loops_and_files_outside_are_errors() {
    let outside = Folder::new(&[("base.ron", "Pipeline(extends: \"ism.ron\")")]);
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    editor.open("a.ron", "Pipeline(extends: \"b.ron\")");
    editor.open("b.ron", "Pipeline(extends: \"a.ron\")");
    let says =
        |errors: &[Value], word: &str| errors.iter().any(|e| e["message"].as_str().unwrap().contains(word));
    editor.errors_until("b.ron", |errors| says(errors, "extends itself"));
    editor.close("a.ron");
    editor.close("b.ron");
    let path = outside.name("base.ron");
    editor.open("my.ron", &format!("Pipeline(extends: \"{path}\")"));
    editor.errors_until("my.ron", |errors| says(errors, "neither in the folder"));
    // A file of another folder is checked as it stands there.
    let other = format!("../{}/other.ron", outside.file_name().unwrap().to_string_lossy());
    editor.open(&other, "Pipeline(extends: \"base.ron\", patch: [Remove(\"nosuch\")])");
    editor.errors_until(&other, |errors| says(errors, "nosuch"));
}

/// Two editors in one folder, which nobody may write to.
#[cfg(unix)]
#[test]
fn two_editors_work_in_a_folder_that_cannot_be_written() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = folder();
    let allow = |mode| std::fs::set_permissions(&*folder, std::fs::Permissions::from_mode(mode)).unwrap();
    allow(0o555);
    let editors = [Editor::of_tree(&folder), Editor::alone(&folder)];
    for (editor, name) in editors.iter().zip(["filtr", "gathr"]) {
        editor.open("my.ron", &variant(&format!("Remove(\"{name}\")")));
    }
    for (editor, name) in editors.iter().zip(["filtr", "gathr"]) {
        let errors = editor.errors("my.ron", 0);
        assert!(errors[0]["message"].as_str().unwrap().contains(name), "{errors:?}");
    }
    for editor in editors {
        assert_eq!(editor.end(), Some(0));
    }
    allow(0o755);
}

/// The server ends when it is asked to, whatever is still to be answered or checked, and when the editor is gone.
#[test]
fn the_server_ends_in_the_middle_of_its_work() {
    let folder = folder();
    let mut editor = Editor::of_tree(&folder);
    editor.open("scene.ron", "Scene(geometry: BuiltIn(\"hall-1m\"))");
    for id in 100..150 {
        let params = json!({ "textDocument": { "uri": editor.uri("base.ron") }, "position": { "line": 0, "character": 0 } });
        editor.send(lsp_server::Request::new(id.into(), "textDocument/references".to_owned(), params).into());
    }
    editor.send(lsp_server::Request::new(200.into(), "shutdown".to_owned(), Value::Null).into());
    editor.tell("exit", Value::Null);
    assert_eq!(editor.child.wait().unwrap().code(), Some(0));
    let mut gone = Editor::of_tree(&folder);
    gone.hang_up();
    assert!(gone.child.wait().unwrap().code().is_some());
}
