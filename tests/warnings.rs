//! What renders, and perhaps not as its user expects: values without effect, light that is left out, units; and names that
//! mean something else than is asked for. No GPU takes part.

use crate::program::{Done, Folder, lightloom, run_in};
use frame_graph::{LinkContext, Overrides, Value};
use renderer::{Assets, Catalog, Compiled};

/// Returns the warnings about a pipeline of the tree, for a scene that has these traits too.
fn warnings_with(pipeline: &str, traits: &[&str]) -> String {
    let catalog = Catalog::new(Assets::new(None));
    let mut known = renderer::load_scene(&catalog, "cornell-box").expect("it is built in").traits();
    known.values.extend(traits.iter().map(|name| ((*name).to_owned(), Value::Bool(true))));
    let context = LinkContext { frame: (16, 16), traits: known };
    let (set, options) = (Overrides::default(), renderer::compile_options());
    let compiled = Compiled::new(&catalog, pipeline, &set, &context, &options);
    let compiled = compiled.unwrap_or_else(|errors| panic!("{errors}"));
    compiled.warnings(&catalog, pipeline, &set, &context, &options).to_string()
}

#[test]
fn light_that_a_pipeline_leaves_out_is_noted() {
    assert_eq!(warnings_with("ism", &[]), "");
    let emitters = warnings_with("ism", &["emissive"]);
    assert!(emitters.contains("note[W004]: the scene has surfaces that emit"), "{emitters}");
    let sky = warnings_with("ism", &["environment"]);
    assert!(sky.contains("note[W004]: the scene has an environment: it is seen"), "{sky}");
    let glossy = warnings_with("ism", &["glossy"]);
    assert!(
        glossy.contains("note[W004]: the scene is glossy, and nothing is linked to `image.glossy`"),
        "{glossy}"
    );
    // Photons come from emitters too.
    assert_eq!(warnings_with("instant-radiosity", &["emissive"]), "");
    assert_eq!(warnings_with("ism-area-light", &["emissive"]), "");
    assert_eq!(warnings_with("ism-environment", &["environment"]), "");
    assert_eq!(warnings_with("reference", &["emissive", "environment", "glossy"]), "");
}

#[test]
fn a_value_for_a_pass_that_does_not_run_is_reported() {
    let culled = lightloom(&["graph", "acrsm", "--set", "cells.dot=5"]).success();
    culled.says(&["warning[W003]: `cells.dot` has no effect", "no output that is rendered needs `cells`"]);
    // The value that it has anyway, and one that counts.
    for set in ["cells.dot=3", "gather.clamp=0.125"] {
        let done = lightloom(&["graph", "acrsm", "--set", set]).success();
        assert!(done.err.is_empty(), "{set}: {done}");
    }
}

#[test]
fn an_axis_that_changes_nothing_is_reported() {
    let study = |axes: &str| {
        format!(
            "Study(about: \"x\", scenes: [\"cornell-box\"], pipelines: [\"acrsm\"], output: \"image\", \
             vary: {axes}, size: (8, 8), budget: Frames(1), measures: [\"gpu-ms\"])"
        )
    };
    let vain = study("Grid({ \"cells.dot\": [1.0, 2.0], \"lights\": [32, 64] })");
    let mine = Folder::new(&[("vain.ron", &vain), ("good.ron", &study("Grid({ \"lights\": [32, 64] })"))]);
    let found = run_in(&mine, &["check", "vain.ron"]).success();
    assert_eq!(found.out.matches("W003").count(), 1, "{found}");
    found.says(&["the axis `cells.dot` has no effect on `acrsm`"]);
    let good = run_in(&mine, &["check", "good.ron"]).success();
    assert!(!good.out.contains("W003"), "{good}");
}

#[test]
fn known_outputs_hold_what_their_names_say() {
    let outputs = |outputs: &str| format!("Pipeline(extends: \"ism.ron\", outputs: {{ {outputs} }})");
    let mine = Folder::new(&[
        ("bad.ron", &outputs(r#""image": "image.display", "indirect": "view", "irradiance": "image.image""#)),
        ("good.ron", &outputs(r#""image": "direct", "shown": "image.display""#)),
    ]);
    run_in(&mine, &["check", "bad.ron"]).failure(
        1,
        &[
            "error[E035]: the output `image` is a `Radiance`",
            "this is a `Display`",
            "error[E035]: the output `indirect` is a `Radiance`",
            "error[E035]: the output `irradiance` is an `Irradiance`",
        ],
    );
    run_in(&mine, &["check", "good.ron"]).success();
}

/// A triangle whose texture is missing, in a scene that is 4 km wide.
const TRIANGLE: &str = r#"{
    "asset": { "version": "2.0" },
    "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
    "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
    "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
    "textures": [{ "source": 0 }], "images": [{ "uri": "nowhere.png" }],
    "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                    "min": [0, 0, 0], "max": [4000, 4000, 0] }],
    "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
    "buffers": [{ "byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAB6RQAAAAAAAAAAAAAAAAAAekUAAAAA" }]
}"#;

#[test]
fn check_notes_what_is_left_out_of_a_scene() {
    let broken = TRIANGLE.replace("\"bufferView\": 0,", "\"bufferView\": 7,");
    let mine = Folder::new(&[("a.gltf", TRIANGLE), ("b.gltf", &broken)]);
    let done = run_in(&mine, &["check", "a.gltf"]).success();
    done.says(&["note: texture image `nowhere.png` is taken as white", "lengths are in metres"]);
    let json = run_in(&mine, &["check", "a.gltf", "--json"]).json();
    assert!(json["checked"][0]["notes"].as_array().is_some_and(|notes| notes.len() >= 2), "{json}");
    let failed = run_in(&mine, &["render", "ism", "b.gltf", "-o", "b.png", "--json"]);
    let errors: serde_json::Value = serde_json::from_str(&failed.err).expect("JSON");
    assert_eq!(errors["errors"][0]["file"], "b.gltf", "{errors}");
}

#[test]
fn a_name_of_another_sort_is_said_to_be_one() {
    let study = "Study(about: \"x\")";
    let mine = Folder::new(&[("s.ron", study)]);
    let cases: [(&[&str], &str); 7] = [
        (
            &["render", "cornell-box", "ism", "-o", "x.png"],
            "`cornell-box` is a scene; a pipeline is expected here",
        ),
        (&["render", "ism", "ism", "-o", "x.png"], "`ism` is a pipeline; a scene is expected here"),
        (
            &["render", "s.ron", "cornell-box", "-o", "x.png"],
            "`s.ron` is a study; a pipeline is expected here",
        ),
        (&["study", "ism", "-o", "x"], "`ism` is a pipeline; a study is expected here"),
        (&["graph", "atrium"], "`atrium` is a scene"),
        (&["resolve", "ism-fig-4"], "`ism-fig-4` is a study"),
        (&["diff", "ism", "atrium"], "`atrium` is a scene"),
    ];
    for (arguments, words) in cases {
        run_in(&mine, arguments).failure(1, &[words]);
    }
}

#[test]
fn a_file_that_does_not_say_what_it_is_is_read_as_what_is_expected() {
    let mine = Folder::new(&[("empty.ron", "// nothing\n"), ("word.ron", "Stdy(about: \"x\")")]);
    let cases: [(&[&str], &str); 4] = [
        (&["study", "empty.ron", "-o", "x"], "expected `Study(…)`"),
        (&["render", "ism", "empty.ron", "-o", "x.png"], "expected `Scene(…)`"),
        (&["graph", "empty.ron"], "expected `Pipeline(…)`"),
        (&["study", "word.ron", "-o", "x"], "expected `Study(…)`"),
    ];
    for (arguments, words) in cases {
        let done = run_in(&mine, arguments).failure(1, &[words]);
        assert!(!done.to_string().contains("is expected here"), "{done}");
    }
}

#[test]
fn a_format_that_is_not_that_of_the_interface_is_reported() {
    let shader = "var irradiance: texture_2d<f32>;\n@fragment\nfn one(@builtin(position) at: vec4<f32>) -> \
                  @location(0) vec4<f32> { return textureLoad(irradiance, vec2<u32>(at.xy), 0); }\n";
    let variant = |format: &str| {
        let pass = format!(
            "Pass(kind: \"fullscreen\", shader: \"one.wgsl\", out: {{ \"result\": Out(interface: \"Irradiance\"{format}) }})"
        );
        let patch =
            format!("Insert(name: \"mean\", pass: {pass}, between: (\"filter\", \"image.indirect\"))");
        format!("Pipeline(extends: \"ism.ron\",\npatch: [{patch}])")
    };
    let study = "Study(about: \"x\", scenes: [\"cornell-box\"], pipelines: [\"bad.ron\"], output: \"image\", \
                 size: (8, 8), budget: Frames(1), measures: [\"gpu-ms\"])";
    let mine = Folder::new(&[
        ("one.wgsl", shader),
        ("bad.ron", &variant(", format: \"rgba8unorm\"")),
        ("same.ron", &variant(", format: \"rgba32float\"")),
        ("none.ron", &variant("")),
        ("study.ron", study),
    ]);
    let words = ["warning[W005]: `mean.result` is `rgba8unorm`", "bad.ron:2:", "expected `rgba32float`"];
    for arguments in [&["check", "bad.ron"][..], &["check", "study.ron"], &["graph", "bad.ron"]] {
        let found = run_in(&mine, arguments).success().says(&words);
        assert_eq!(found.to_string().matches("W005").count(), 1, "{found}");
    }
    for good in ["same.ron", "none.ron"] {
        let done = run_in(&mine, &["check", good]).success();
        assert!(!done.out.contains("W005"), "{done}");
    }
}

/// A copy of a reflective shadow map without what the scene's or the reader's choice makes part of it.
#[test]
fn a_copy_that_lacks_an_optional_member_is_reported() {
    let shader = |members: &[(&str, &str)]| {
        let declared = members.iter().map(|(name, format)| {
            format!(
                "var rsm_{name}: texture_2d_array<f32>;\nvar copy_{name}: texture_storage_2d_array<{format}, write>;\n"
            )
        });
        let stored = members.iter().map(|(name, _)| {
            format!("textureStore(copy_{name}, id.xy, id.z, textureLoad(rsm_{name}, id.xy, id.z, 0));\n")
        });
        format!(
            "{}@compute @workgroup_size(8, 8)\nfn copy(@builtin(global_invocation_id) id: vec3<u32>) {{\n{}}}\n",
            declared.collect::<String>(),
            stored.collect::<String>()
        )
    };
    let pipeline = |shader: &str| {
        let copy = format!(
            "Pass(kind: \"compute\", shader: \"{shader}\", in: {{ \"rsm\": \"rsm\" }},\n\
             out: {{ \"copy\": Out(interface: \"ReflectiveShadowMap\") }})"
        );
        let reader =
            "Pass(kind: \"importance-map\", in: { \"rsm\": \"copy\" }, set: { \"measure\": \"flux\" })";
        format!(
            "Pipeline(extends: \"ism.ron\", passes: {{ \"copy\": {copy} }}, patch: [Replace(\"importance\", {reader})])"
        )
    };
    let needed = [("position", "rgba32float"), ("normal", "rgba16float"), ("flux", "rgba32float")];
    let whole = [&needed[..], &[("albedo", "rgba16float")]].concat();
    let mine = Folder::new(&[
        ("less.wgsl", &shader(&needed)),
        ("less.ron", &pipeline("less.wgsl")),
        ("whole.wgsl", &shader(&whole)),
        ("whole.ron", &pipeline("whole.wgsl")),
    ]);
    let words = [
        "warning[W006]: `copy.copy` has no `albedo`, which its input `rsm` has",
        "less.ron:2:",
        "`copy_albedo`",
    ];
    let graph = |pipeline| run_in(&mine, &["graph", pipeline, "cornell-box", "-o", "graph.svg"]).success();
    let found = graph("less.ron").says(&words);
    assert_eq!(found.to_string().matches("W006").count(), 1, "{found}");
    assert!(!graph("whole.ron").to_string().contains("W006"));
    // In some of the scenes surfaces are glossy.
    run_in(&mine, &["check", "whole.ron"]).success().says(&["has no `specular`"]);
}

#[test]
fn a_file_that_is_there_and_cannot_be_read_is_not_said_to_be_missing() {
    let mine =
        Folder::new(&[("mesh.obj", "v 0 0 0"), ("base.ron", "Pipeline(extends: \"latin.ron\", patch: [])")]);
    std::fs::write(mine.at("latin.ron"), b"// one\nPipeline(about: \"\xe9\")").expect("written");
    let cases: [(&[&str], &str); 5] = [
        (&["check", "latin.ron"], "`latin.ron` cannot be read: it is not UTF-8 (line 2)"),
        (&["check", "base.ron"], "`latin.ron` cannot be read: it is not UTF-8 (line 2)"),
        (&["study", "latin.ron", "-o", "x"], "`latin.ron` cannot be read: it is not UTF-8 (line 2)"),
        (&["check", "mesh.obj"], "such files end in .ron, .glb, .gltf, .pbrt or .xml"),
        (&["render", "ism", "mesh.obj", "-o", "x.png"], "a scene is a .ron, .glb, .gltf, .pbrt or .xml file"),
    ];
    for (arguments, words) in cases {
        let done = run_in(&mine, arguments).failure(1, &[words]);
        assert!(!done.to_string().contains("there is no"), "{done}");
    }
}

#[test]
fn numbers_below_zero_are_values_and_no_flags() {
    for (flag, value, words) in [
        ("--size", "-64x48", "must be WIDTHxHEIGHT"),
        ("--first-frame", "-3", "0..=4294967295"),
        ("--frames", "-3", "1..=4294967295"),
    ] {
        let done = lightloom(&["render", "ism", "cornell-box", "-o", "x.png", flag, value]);
        let done = done.failure(2, &["invalid value", words]);
        assert!(!done.err.contains("unexpected argument"), "{done}");
    }
}

#[cfg(feature = "window")]
#[test]
fn a_window_without_an_adapter_is_refused_with_advice() {
    let mut view = crate::program::command(&crate::adapter::root());
    let done = Done::of(view.args(["view", "ism", "cornell-box"]).env("VK_DRIVER_FILES", "/nonexistent"));
    let done = done.failure(1, &["error: no graphics adapter was found", "mesa-vulkan-drivers"]);
    assert_eq!(done.err.lines().count(), 1, "{done}");
}

/// Names, excerpts and paths that move the cursor, ring the bell or change the title of a terminal are written out.
#[test]
fn control_characters_of_files_do_not_reach_the_terminal() {
    let title = "\u{1b}]0;owned\u{7}";
    let pipeline =
        format!("Pipeline(passes: {{ \"a\": Pass(kind: \"no{title}such\") }}, outputs: {{ \"b\": \"a\" }})");
    let gltf = TRIANGLE.replace("nowhere.png", "no\\u001b[31mwhere.png");
    let mine = Folder::new(&[("a.ron", &pipeline), ("a.gltf", &gltf)]);
    let cases: [(&[&str], &str); 3] = [
        (&["check", "a.ron"], "\\u001b]0;owned\\u0007"),
        (&["check", "a.gltf"], "no\\u001b[31mwhere.png"),
        (&["check", "no\u{9b}31msuch.ron"], "no\\u009b31msuch.ron"),
    ];
    for (arguments, words) in cases {
        let done = run_in(&mine, arguments).says(&[words]);
        assert!(!done.to_string().contains(['\u{1b}', '\u{7}', '\u{9b}']), "{done}");
    }
}

/// Waits for no writer.
#[cfg(unix)]
#[test]
fn a_file_that_has_no_end_is_refused_at_once() {
    let mine = Folder::new(&[("a.gltf", &TRIANGLE.replace("nowhere.png", "fifo"))]);
    for name in ["fifo", "fifo.ron"] {
        assert!(Done::of(std::process::Command::new("mkfifo").arg(mine.at(name))).code == Some(0));
    }
    run_in(&mine, &["check", "fifo.ron"]).failure(1, &["`fifo.ron` cannot be read: it is no regular file"]);
    run_in(&mine, &["check", "a.gltf"]).says(&["`fifo` is taken as white", "it is no file"]);
    std::os::unix::fs::symlink("/dev/zero", mine.at("zero.ron")).expect("a link");
    run_in(&mine, &["check", "zero.ron"]).failure(1, &["it is no regular file"]);
}

/// A folder that is passed on may hold links that lead out of it.
#[cfg(unix)]
#[test]
fn a_link_that_leads_outside_is_refused() {
    let pipeline = "Pipeline(extends: \"link.ron\", patch: [])";
    let gltf = TRIANGLE.replace("nowhere.png", "link.png");
    let mine = Folder::new(&[("in/a.ron", pipeline), ("in/a.gltf", &gltf), ("secret", "root:x:0:0")]);
    for name in ["in/link.ron", "in/link.png"] {
        std::os::unix::fs::symlink(mine.at("secret"), mine.at(name)).expect("a link");
    }
    let elsewhere = Folder::new(&[]);
    for (name, code) in [("in/a.ron", 1), ("in/a.gltf", 0)] {
        let done = run_in(&elsewhere, &["check", &mine.name(name)]);
        assert_eq!(done.code, Some(code), "{done}");
        let done = done.says(&["is neither in the folder of the file that names it"]);
        assert!(!done.to_string().contains("root:x"), "{done}");
    }
}

/// A link to a file does not lead to the files beside that one.
#[cfg(unix)]
#[test]
fn a_shader_that_is_not_beside_a_link_is_explained() {
    let pipeline = "Pipeline(extends: \"ism.ron\", patch: [Insert(name: \"one\", pass: Pass(kind: \"fullscreen\", \
                    shader: \"one.wgsl\"), between: (\"filter\", \"image.indirect\"))])";
    let mine = Folder::new(&[("there/a.ron", pipeline), ("here/b.txt", "")]);
    std::os::unix::fs::symlink(mine.at("there/a.ron"), mine.at("here/a.ron")).expect("a link");
    let done = run_in(&mine, &["check", "here/a.ron"])
        .failure(1, &["error[E021]", "`here/a.ron` is a symbolic link"]);
    let looked = done.err.lines().chain(done.out.lines()).find(|line| line.contains("looked beside"));
    assert!(looked.is_some_and(|line| line.contains(", and in ") && !line.contains("radiosity")), "{done}");
}

#[test]
fn a_difference_in_samples_is_shown() {
    let expected = "+ samples picture: another in each frame, for image/image, image/direct, image/indirect";
    let done = lightloom(&["diff", "ism-invtm", "ism-invtm-accumulated"]).success();
    assert_eq!(
        done.out.lines().filter(|line| line.contains("samples picture")).collect::<Vec<_>>(),
        [expected]
    );
    assert!(!lightloom(&["diff", "ism", "ism-invtm"]).out.contains("samples picture"));
}

#[test]
fn too_many_lights_are_named_as_such() {
    let catalog = Catalog::new(Assets::new(None));
    let mut traits = renderer::load_scene(&catalog, "cornell-box").expect("it is built in").traits();
    traits.values.insert("light_layers".to_owned(), Value::U32(6000));
    let context = LinkContext { frame: (16, 16), traits };
    let options = renderer::compile_options();
    let refused = Compiled::new(&catalog, "ism", &Overrides::default(), &context, &options);
    let refused = refused.err().map(|errors| errors.to_string()).unwrap_or_default();
    assert!(
        refused.contains("the lights of the scene need 6000 layers, of which a point light has six"),
        "{refused}"
    );
}
