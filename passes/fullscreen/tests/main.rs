//! The pass type reads declarations from a shader, and reports wrong ones.

mod gpu;

use frame_graph::port::{InputDesc, OutputOverride};
use fullscreen::PASS;
use pass::{Clear, Extent, Format, ResourceDesc, SceneBindings, Step, Traits, Usage, Value};
use pass_test::ShaderUse;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

fn shader_use(wgsl: &str, inputs: &[&str]) -> ShaderUse<'static> {
    ShaderUse::new(PASS, wgsl, inputs)
}

fn said(interface: Option<&str>, format: Option<Format>) -> OutputOverride {
    OutputOverride { interface: interface.map(Into::into), format, ..OutputOverride::default() }
}

fn picture(name: &str, size: (u32, u32)) -> InputDesc {
    InputDesc {
        name: name.into(),
        interface: "Radiance".into(),
        members: vec![("".into(), ResourceDesc::texture_2d(Format::Rgba32Float, size))],
        facts: Arc::default(),
    }
}

const RED: &str = "@fragment fn red() -> @location(0) vec4<f32> { return vec4(1.0, 0.0, 0.0, 1.0); }";

#[test]
fn the_example_has_one_input_one_setting_and_a_display() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/examples");
    let wgsl = std::fs::read_to_string(root.join("vignette.wgsl")).unwrap();
    let ron = std::fs::read_to_string(root.join("vignette.ron")).unwrap();
    assert!(wgsl.lines().count() + ron.lines().count() <= 25, "an effect is at most 25 lines");

    let case = shader_use(&wgsl, &[]).out("result", said(Some("Display"), None));
    let settings = case.schema().unwrap();
    assert_eq!(settings.len(), 1);
    assert_eq!((&*settings[0].name, settings[0].default.clone()), ("strength", Value::F32(0.5)));
    let ports = case.ports(&[]).unwrap();
    assert_eq!((&*ports.inputs[0].name, &*ports.inputs[0].interface), ("picture", "Texture"));
    assert_eq!((&*ports.outputs[0].name, &*ports.outputs[0].interface), ("result", "Display"));
    assert_eq!(ports.scene_bindings, SceneBindings::NONE);
    let outputs = case.outputs(&[picture("picture", (32, 16))]).unwrap();
    let expected = ResourceDesc::texture_2d(Format::Rgba8Unorm, Extent::like("picture"));
    assert_eq!(outputs[0].members[0].1, expected);
}

#[test]
fn a_shader_without_inputs_fills_the_frame() {
    let outputs = shader_use(RED, &[]).outputs(&[]).unwrap();
    assert_eq!(outputs[0].members[0].1, ResourceDesc::texture_2d(Format::Rgba16Float, Extent::FRAME));
}

#[test]
fn a_link_fills_the_globals_that_begin_with_its_name() {
    let wgsl = "#import \"camera.wgsl\"
        var view_depth: texture_2d<f32>;
        var view_normal: texture_2d<f32>;
        var view: texture_2d<f32>;
        var<storage, read> weights: array<f32>;
        struct Result { @location(1) second: f32, @location(0) first: vec2<f32> }
        @fragment fn edges(@builtin(position) at: vec4<f32>) -> Result {
            let pixel = vec2<u32>(at.xy);
            let depth = textureLoad(view_depth, pixel, 0).x + textureLoad(view_normal, pixel, 0).x + weights[0];
            return Result(depth + textureLoad(view, pixel, 0).x, position_from_depth(pixel, textureDimensions(view), depth).xy);
        }";
    let case = shader_use(wgsl, &["view"]);
    let ports = case.ports(&[]).unwrap();
    let inputs: Vec<_> = ports.inputs.iter().map(|p| (p.name.to_string(), p.interface.to_string())).collect();
    assert_eq!(inputs, [("view".into(), "Any".into()), ("weights".into(), "Buffer".into())]);
    assert_eq!(ports.scene_bindings, SceneBindings::CAMERA);
    let outputs = case.outputs(&[]).unwrap();
    let formats: Vec<_> = outputs.iter().map(|o| (o.port.to_string(), o.members[0].1.clone())).collect();
    let frame = |format| ResourceDesc::texture_2d(format, Extent::FRAME);
    assert_eq!(
        formats,
        [("first".into(), frame(Format::Rg16Float)), ("second".into(), frame(Format::R16Float))]
    );
}

#[test]
fn results_named_alike_make_an_interface_in_its_own_formats() {
    let wgsl = "struct Result {
            @location(0) seen_depth: f32,
            @location(1) seen_normal: vec4<f32>,
            @location(2) seen_albedo: vec4<f32>,
        }
        @fragment fn surface() -> Result { return Result(1.0, vec4(0.0), vec4(0.5)); }";
    let case = shader_use(wgsl, &[]).out("seen", said(Some("GBuffer"), None));
    let outputs = case.outputs(&[]).unwrap();
    let members: Vec<_> =
        outputs[0].members.iter().map(|(name, desc, _)| (name.to_string(), desc.clone())).collect();
    let frame = |format| ResourceDesc::texture_2d(format, Extent::FRAME);
    let expected =
        [("depth", Format::R32Float), ("normal", Format::Rgba16Float), ("albedo", Format::Rgba16Float)];
    assert_eq!(members, expected.map(|(name, format)| (name.to_owned(), frame(format))));
    let lacking =
        shader_use(&wgsl.replace("seen_normal", "seen_bump"), &[]).out("seen", said(Some("GBuffer"), None));
    assert!(lacking.refusal().contains("`seen_bump` is no member of a `GBuffer`"), "{}", lacking.refusal());
}

#[test]
fn storage_that_it_writes_is_an_output_beside_its_results() {
    let wgsl = "var<storage, read_write> histogram: array<atomic<u32>, 256>;
        var view_depth: texture_2d<f32>;
        @fragment fn count(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
            atomicAdd(&histogram[u32(at.x)], 1u);
            return textureLoad(view_depth, vec2<u32>(at.xy), 0);
        }";
    let outputs = shader_use(wgsl, &["view"]).outputs(&[]).unwrap();
    let found: Vec<_> = outputs.iter().map(|o| (o.port.to_string(), o.members[0].2.clone())).collect();
    let cleared = Usage::ClearFirst(Clear::Zero);
    assert_eq!(found, [("result".into(), Usage::Overwrites), ("histogram".into(), cleared)]);
    assert_eq!(outputs[1].members[0].1, ResourceDesc::buffer(1024));
}

#[test]
fn it_records_one_draw_of_the_scenes_variant() {
    let wgsl = "#option TEXTURED false
        @fragment fn effect() -> @location(0) vec4<f32> { return vec4(1.0); }";
    let case = shader_use(wgsl, &[]);
    let traits = Traits::new(BTreeMap::from([("textured".into(), Value::Bool(true))]));
    let recording = case.record(&[], &[], &traits).unwrap();
    let [Step::Raster(draw)] = recording.steps.as_slice() else { panic!("one draw: {recording:?}") };
    assert_eq!(draw.fragment.as_deref(), Some("effect"));
    assert_eq!(draw.targets[0].resource, "result");
    assert_eq!(draw.shader.defines["TEXTURED"], pass::Define::Bool(true));
    let shader = case.library().load(&draw.shader).unwrap();
    assert!(shader.interface.entry("fullscreen").is_some());
}

#[test]
fn entry_points_draw_one_after_the_other() {
    let wgsl = "/// Along rows. [scratch]
        @fragment fn rows() -> @location(0) vec4<f32> { return vec4(0.5); }
        /// A variable cannot have the name of a function. [reads: rows]
        var rows_drawn: texture_2d<f32>;
        @fragment fn columns(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
            return textureLoad(rows_drawn, vec2<u32>(at.xy), 0);
        }";
    let case = shader_use(wgsl, &[]);
    let ports = case.ports(&[]).unwrap();
    assert_eq!(ports.outputs.iter().map(|port| &*port.name).collect::<Vec<_>>(), ["columns"]);
    assert!(ports.inputs.is_empty());
    let outputs = case.outputs(&[]).unwrap();
    let told: Vec<_> = outputs.iter().map(|output| (&*output.port, output.scratch)).collect();
    assert_eq!(told, [("rows", true), ("columns", false)]);
    let recording = case.record(&[], &[], &Traits::default()).unwrap();
    let drawn: Vec<(&str, &str)> = recording
        .steps
        .iter()
        .map(|step| match step {
            Step::Raster(draw) => (draw.fragment.as_deref().unwrap(), &*draw.targets[0].resource),
            Step::Compute(_) => panic!("draws alone: {step:?}"),
        })
        .collect();
    assert_eq!(drawn, [("rows", "rows"), ("columns", "columns")]);
}

#[test]
fn refusals_say_what_is_wrong_and_what_to_do() {
    let with = |line: &str| format!("{line}\n{RED}");
    let cases: &[(String, &[&str], &str)] = &[
        ("fn f() {}".into(), &[], "has no @fragment entry point"),
        (
            "struct Result { @location(0) color: vec4<f32> }
            @fragment fn red() -> Result { return Result(vec4(1.0)); }
            @fragment fn blue() -> Result { return Result(vec4(0.0)); }"
                .into(),
            &[],
            "two entry points have a result `color`",
        ),
        ("@fragment fn f() -> @location(0) vec4<f32> { return 1; }".into(), &[], "own.wgsl:1:"),
        (
            "@fragment fn f(@location(0) uv: vec2<f32>) -> @location(0) vec4<f32> { return vec4(uv, uv); }"
                .into(),
            &[],
            "the pixel is @builtin(position)",
        ),
        (
            "@fragment fn f() -> @location(1) vec4<f32> { return vec4(1.0); }".into(),
            &[],
            "@location(1) but not @location(0)",
        ),
        ("@fragment fn f() {}".into(), &[], "`f` has no result to draw"),
        (with("var smooth_sampler: sampler;"), &[], "`smooth_sampler` is a sampler"),
        (with("var<uniform> scale: f32;"), &[], "`scale` is a uniform"),
        (with("var colors: texture_2d<f32>;"), &["color"], "color | the shader has no global `color`"),
        (
            with("var<storage, read_write> sums: array<f32>;"),
            &["sums"],
            "sums | `sums` is written by the shader",
        ),
    ];
    for (wgsl, inputs, expected) in cases {
        let refusal = shader_use(wgsl, inputs).refusal();
        assert!(refusal.contains(expected), "{wgsl}\n{refusal}");
    }
    let outs: [(&str, Option<&str>, Option<Format>, &str); 4] = [
        (
            "results",
            None,
            None,
            "`out:` speaks of `results`, which the shader does not write | it writes `result`",
        ),
        ("result", Some("Radience"), None, "is no interface | there are `GBuffer`"),
        ("result", Some("GBuffer"), None, "its members would be written as `result_depth`"),
        (
            "result",
            None,
            Some(Format::R32Uint),
            "`result` is vec4<f32>, which a texture of r32uint does not hold",
        ),
    ];
    for (port, interface, format, expected) in outs {
        let refusal = shader_use(RED, &[]).out(port, said(interface, format)).refusal();
        assert!(refusal.contains(expected), "{refusal}");
    }
}
