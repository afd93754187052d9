//! Errors in the shaders that uses name point into them, and not into the file that imports them.

use crate::pass_types::TestPassTypes;
use pass::reflected::ShaderPass;
use pass::{Library, Traits, Value};
use shader_library::{MemoryFiles, Stage};
use std::sync::Arc;

/// The file that is run for a user's, which it imports.
const WRAPPER: &str = "#import interface \"effect\"

@vertex fn fullscreen(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
";

const FRAGMENTS: ShaderPass = ShaderPass {
    kind: "fragments",
    files: &[],
    about: "",
    stage: Stage::Fragment,
    request: |path| {
        let mut request = pass::request("wrapper.wgsl", &[]);
        request.modules.insert("effect".into(), path.into());
        request
    },
    example: "",
};

/// A pipeline of a user's shader.
const DARKER: &str = "Pipeline(
    passes: { \"darker\": Pass(kind: \"fragments\", shader: \"effect.wgsl\") },
    outputs: { \"image\": \"darker\" },
)";

/// The pass type, and a user's shader.
fn types(effect: &str) -> TestPassTypes<'static> {
    let files = MemoryFiles::new([("wrapper.wgsl", WRAPPER), ("effect.wgsl", effect)]);
    TestPassTypes { passes: &[&FRAGMENTS], library: Library::new(Arc::new(files)) }
}

#[test]
fn a_value_that_nothing_gives_names_the_users_file_and_its_entry_point() {
    let effect = "struct Settings {
    strength: f32,
}
var<uniform> settings: Settings;
@fragment fn darken() -> @location(0) vec4<f32> { return vec4(settings.strength); }";
    let types = types(effect);
    let (_, steps) = types.linked(DARKER, "fragments");
    let error = steps.expect_err("`strength` has no value");
    for part in [
        "effect.wgsl: nothing gives `settings.strength` a value",
        "effect.wgsl:2:5",
        "`/// What it does. [default: 1.0]`",
        "in pass `darker` of pass type `fragments`, entry point `darken`",
    ] {
        assert!(error.contains(part), "no `{part}` in\n{error}");
    }
    assert!(!error.contains("wrapper.wgsl"), "{error}");
}

#[test]
fn a_shader_that_is_not_there_is_told_where_it_is_named() {
    let error = types("")
        .plan(
            "Pipeline(
    passes: { \"darker\": Pass(kind: \"fragments\", shader: \"efect.wgsl\") },
    outputs: { \"image\": \"darker\" },
)",
        )
        .expect_err("there is no such file");
    for part in [
        "error[E021]: `darker`: there is no shader `efect.wgsl`",
        "p.ron:2:57",
        "did you mean `effect.wgsl`?",
        "looked beside the file that names it, then in the root",
    ] {
        assert!(error.contains(part), "no `{part}` in\n{error}");
    }
    assert!(!error.contains("wrapper.wgsl:"), "{error}");
}

#[test]
fn an_entry_point_that_the_scene_takes_away_names_the_users_file() {
    let effect = "// A comment on darken.
#option GLOSSY false
#if GLOSSY
@fragment fn shine() -> @location(0) vec4<f32> { return vec4(1.0); }
#else
@fragment fn darken() -> @location(0) vec4<f32> { return vec4(0.5); }
#endif";
    let types = types(effect);
    let glossy = Traits::new([("glossy".to_owned(), Value::Bool(true))].into());
    let (_, steps) = types.linked_for(DARKER, "fragments", &glossy);
    let error = steps.expect_err("a glossy scene has another entry point");
    for part in [
        "error[L002]: effect.wgsl has no Fragment entry point `darken`",
        "effect.wgsl:6:14",
        "in the variant GLOSSY = true it has",
        "`shine` (Fragment)",
        "in pass `darker` of pass type `fragments`, entry point `darken`",
    ] {
        assert!(error.contains(part), "no `{part}` in\n{error}");
    }
    assert!(!error.contains("wrapper.wgsl"), "{error}");
}
