//! Settings that one file of a pass declares and another reads are of one type in both.

use crate::pass_types::TestPassTypes;
use pass::{Compute, Library, Pass, PassTypeError, RecordContext, Recording, Threads, Value};
use shader_library::MemoryFiles;
use std::sync::Arc;

/// Writes a buffer by a file beside the one that declares the settings.
struct Fill {
    /// A value that the step gives, under a setting's name.
    own: Option<(&'static str, Value)>,
}

impl Pass for Fill {
    fn kind(&self) -> &'static str {
        "fill"
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let step = Compute::new(cx.file("steps.wgsl"), "fill", Threads::Row(1));
        let own = self.own.iter();
        Ok(Recording::one(own.fold(step, |step, (name, value)| step.value(name, value.clone()))))
    }
}

const PIPELINE: &str =
    r#"Pipeline(passes: { "fill": Pass(kind: "fill") }, outputs: { "filled": "fill.filled" })"#;

/// Declares the settings.
const DECLARES: &str = "#output filled: Buffer // It.
struct Settings {
    /// A number. [default: 4]
    count: u32,
    /// A factor. [default: 1.0]
    gain: f32,
    /// Whether. [bool, default: true]
    on: u32,
    /// One or two. [default: \"one\", one_of: [\"one\", \"two\"]]
    mode: u32,
    /// Two numbers. [default: (1.0, 2.0)]
    offset: vec2<f32>,
}
var<uniform> settings: Settings;
var<storage, read_write> filled: array<u32, 4>;
@compute @workgroup_size(1) fn main() { filled[0] = settings.count; }
";

/// Links a shader whose `struct Settings` has these members; errors are text.
fn link(members: &str, own: Option<(&'static str, Value)>) -> Result<(), String> {
    let shader = format!(
        "struct Settings {{\n    {members}\n}}\nvar<uniform> settings: Settings;\n\
         var<storage, read_write> filled: array<u32, 4>;\n\
         fn read(settings: Settings) {{}}\n\
         @compute @workgroup_size(1) fn fill() {{ read(settings); filled[0] = 1u; }}\n"
    );
    let files = [("passes/fill/fill.wgsl", DECLARES), ("passes/fill/steps.wgsl", shader.as_str())];
    let library = Library::new(Arc::new(MemoryFiles::new(files)));
    TestPassTypes { passes: &[&Fill { own }], library }.linked(PIPELINE, "fill").1.map(|_| ())
}

#[test]
fn members_of_their_settings_types_are_filled() {
    link("count: u32, gain: f32, on: u32, mode: u32, offset: vec2<f32>", None).unwrap();
    // As one would have to name it, were `count` reserved in WGSL.
    link("count_: u32", None).unwrap();
    let error = link("count_: f32", None).unwrap_err();
    assert!(error.contains("expected u32, found f32") && error.contains("steps.wgsl:2:5"), "{error}");
}

#[test]
fn a_member_of_another_type_than_its_setting_names_both_places_and_both_types() {
    // Also where the member could hold the default: 4 fits a float, and (1, 2) integers.
    for (member, found, expected, declared) in [
        ("count: f32", "f32", "u32", "passes/fill/fill.wgsl:4:5"),
        ("count: i32", "i32", "u32", "passes/fill/fill.wgsl:4:5"),
        ("gain: u32", "u32", "f32", "passes/fill/fill.wgsl:6:5"),
        ("on: f32", "f32", "u32", "passes/fill/fill.wgsl:8:5"),
        ("mode: i32", "i32", "u32", "passes/fill/fill.wgsl:10:5"),
        ("offset: vec2<u32>", "vec2<u32>", "vec2<f32>", "passes/fill/fill.wgsl:12:5"),
    ] {
        let error = link(member, None).expect_err(member);
        let name = member.split(':').next().unwrap();
        for part in [
            "L006".to_owned(),
            format!("`settings.{name}` is of another type than the setting `{name}`"),
            "steps.wgsl:2:5".to_owned(),
            format!("expected {expected}, found {found}"),
            format!("declared in {declared}"),
            "in pass `fill`".to_owned(),
        ] {
            assert!(error.contains(&part), "{member}: no `{part}` in\n{error}");
        }
    }
}

#[test]
fn a_value_of_the_step_is_no_setting_though_it_is_named_as_one() {
    link("count: f32", Some(("count", Value::F32(0.5)))).unwrap();
    link("count: f32", Some(("gain", Value::F32(0.5)))).expect_err("another one's");
}
