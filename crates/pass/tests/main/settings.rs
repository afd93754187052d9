//! Settings that Rust declares and WGSL reads too are of one type in both.

use crate::pass_types::TestPassTypes;
use pass::{
    Compute, Extent, Info, Library, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext,
    Recording, ResourceDesc, Setting, Settings, Threads, UseContext, Value, setting,
};
use shader_library::MemoryFiles;
use std::sync::Arc;

pass::choice! {
    enum Mode {
        One = "one",
        Two = "two",
    }
}

/// Of the macro below: what errors name.
const LINE: u32 = line!() + 2;

pass::settings! {
    struct FillSettings {
        count: u32 = 4;
        gain: f32 = 1.0;
        on: bool = true;
        mode: Mode = Mode::One;
    }
}

/// Writes a buffer. Its shader declares settings, and so does Rust.
struct Fill {
    /// A value that the step gives, under a setting's name.
    own: Option<(&'static str, Value)>,
}

impl Pass for Fill {
    fn info(&self) -> Info {
        Info { kind: "fill", about: "", paper: "", shaders: &[] }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = FillSettings::schema();
        all.extend(setting::of_shader(cx.shaders, "declares.wgsl")?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports { outputs: vec![pass::output("filled", "Buffer", "")], ..Ports::default() })
    }

    fn outputs(&self, _: &UseContext<'_>, _: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        Ok(vec![OutputDesc::one("filled", ResourceDesc::<Extent>::buffer(16))])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let step = Compute::new(cx.shader("fill.wgsl", &[]), "fill", Threads::Row(1));
        let own = self.own.iter();
        Ok(Recording::one(own.fold(step, |step, (name, value)| step.value(name, value.clone()))))
    }
}

const PIPELINE: &str =
    r#"Pipeline(passes: { "fill": Pass(kind: "fill") }, outputs: { "filled": "fill.filled" })"#;

/// A shader that no step runs, for what its comments declare.
const DECLARES: &str = "struct Settings {
    /// A setting. [default: (1.0, 2.0)]
    offset: vec2<f32>,
}
var<uniform> settings: Settings;
@compute @workgroup_size(1) fn main() { _ = settings.offset; }
";

/// Links a shader whose `struct Settings` has these members; an error is told as text.
fn link(members: &str, own: Option<(&'static str, Value)>) -> Result<(), String> {
    let shader = format!(
        "struct Settings {{\n    {members}\n}}\nvar<uniform> settings: Settings;\n\
         var<storage, read_write> filled: array<u32>;\n\
         fn read(settings: Settings) {{}}\n\
         @compute @workgroup_size(1) fn fill() {{ read(settings); filled[0] = 1u; }}\n"
    );
    let files = [("fill.wgsl", shader.as_str()), ("declares.wgsl", DECLARES)];
    let library = Library::new(Arc::new(MemoryFiles::new(files)));
    TestPassTypes { passes: &[&Fill { own }], library }.linked(PIPELINE, "fill").1.map(|_| ())
}

#[test]
fn members_of_their_settings_types_are_filled() {
    link("count: u32, gain: f32, on: u32, mode: u32, offset: vec2<f32>", None).unwrap();
    // As one would have to name it, were `count` reserved in WGSL.
    link("count_: u32", None).unwrap();
    let error = link("count_: f32", None).unwrap_err();
    assert!(error.contains("expected u32, found f32") && error.contains("fill.wgsl:2:5"), "{error}");
}

#[test]
fn a_member_of_another_type_than_its_setting_names_both_places_and_both_types() {
    let here = format!("{}:{LINE}", file!());
    // Also where the member could hold the default: 4 fits a float, and (1, 2) integers.
    for (member, found, expected, declared) in [
        ("count: f32", "f32", "u32", here.as_str()),
        ("count: i32", "i32", "u32", here.as_str()),
        ("gain: u32", "u32", "f32", here.as_str()),
        ("on: f32", "f32", "u32", here.as_str()),
        ("mode: i32", "i32", "u32", here.as_str()),
        ("offset: vec2<u32>", "vec2<u32>", "vec2<f32>", "declares.wgsl:3:5"),
    ] {
        let error = link(member, None).expect_err(member);
        let name = member.split(':').next().unwrap();
        for part in [
            "L006".to_owned(),
            format!("`settings.{name}` is of another type than the setting `{name}`"),
            "fill.wgsl:2:5".to_owned(),
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
