//! Facts that a pass in WGSL alone hands on.

use crate::pass_types::TestPassTypes;
use frame_graph::plan::Plan;
use pass::reflected::ShaderPass;
use pass::{
    Extent, Fact, Format, Library, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext,
    Recording, ResourceDesc, Setting, Settings, UseContext, Value,
};
use shader_library::{MemoryFiles, Stage};
use std::sync::Arc;

const SIDE: Fact<u32> = Fact::required("side", "");
const TILES: Fact<u32> = Fact::optional("tiles", "");
const BOUND: Fact<f32> = Fact::optional("bound", "");

/// Makes maps with facts: `wide` others than `narrow`.
struct Maker;

impl Pass for Maker {
    fn kind(&self) -> &'static str {
        "maker"
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(Vec::new())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        let outputs = ["narrow", "wide"].map(|port| pass::output(port, "Maps", "")).to_vec();
        Ok(Ports { outputs, ..Ports::default() })
    }

    fn outputs(&self, _: &UseContext<'_>, _: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let maps = |port| {
            OutputDesc::one(port, ResourceDesc::texture_2d(Format::R32Float, Extent::FRAME)).fact(SIDE, 16)
        };
        Ok(vec![maps("narrow").fact(BOUND, 0.5), maps("wide").fact(TILES, 4).fact(BOUND, 0.5)])
    }

    fn record(&self, _: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::default())
    }
}

/// A compute shader of the user's.
const SHADER: ShaderPass = ShaderPass {
    kind: "shader",
    files: &[],
    about: "",
    stage: Stage::Compute,
    request: |path| pass::request(path, &[]),
    example: "",
};

const COPY: &str = "
    var before: texture_2d<f32>;
    var after: texture_storage_2d<r32float, write>;
    @compute @workgroup_size(8, 8) fn copy(@builtin(global_invocation_id) id: vec3<u32>) {
        textureStore(after, id.xy, textureLoad(before, id.xy, 0));
    }";

const ADD: &str = "
    var first: texture_2d<f32>;
    var second: texture_2d<f32>;
    var sum: texture_storage_2d<r32float, write>;
    @compute @workgroup_size(8, 8) fn add(@builtin(global_invocation_id) id: vec3<u32>) {
        textureStore(sum, id.xy, textureLoad(first, id.xy, 0) + textureLoad(second, id.xy, 0));
    }";

fn pass_types() -> TestPassTypes<'static> {
    let library =
        Library::new(Arc::new(MemoryFiles::new([("copy.wgsl", COPY), ("add.wgsl", ADD), ("two.wgsl", TWO)])));
    TestPassTypes { passes: &[&Maker, &SHADER], library }
}

/// The plan of a pipeline in which the pass `used` is this use of a shader, and whose output is `target`.
fn plan(used: &str, target: &str) -> Result<Plan, String> {
    pass_types().plan(&format!(
        "Pipeline(
            passes: {{ \"maker\": Pass(kind: \"maker\"), \"used\": Pass(kind: \"shader\", {used}) }},
            outputs: {{ \"image\": \"{target}\" }},
        )"
    ))
}

/// The facts of its output.
fn facts(used: &str) -> Result<Vec<(String, Value)>, String> {
    let plan = plan(used, "used")?;
    let pass = plan.passes.iter().find(|pass| &*pass.name == "used").expect("it is needed");
    Ok(pass.outputs[0].facts.iter().map(|(name, value)| (name.to_owned(), value.clone())).collect())
}

fn told(facts: &[(&str, Value)]) -> Vec<(String, Value)> {
    facts.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
}

#[test]
fn an_output_has_the_facts_of_the_input_of_its_interface() {
    let copy = "shader: \"copy.wgsl\", in: { \"before\": \"maker.wide\" }, out: { \"after\": Out(interface: \"Maps\") }";
    let wide = [("bound", Value::F32(0.5)), ("side", Value::U32(16)), ("tiles", Value::U32(4))];
    assert_eq!(facts(copy), Ok(told(&wide)));
    // A plain texture is no interface, and has none.
    let plain = "shader: \"copy.wgsl\", in: { \"before\": \"maker.wide\" }";
    assert_eq!(facts(plain), Ok(Vec::new()));
}

#[test]
fn a_use_says_others_or_none() {
    let copy = "shader: \"copy.wgsl\", in: { \"before\": \"maker.wide\" },
        out: { \"after\": Out(interface: \"Maps\", facts: { \"tiles\": 1, \"bound\": None }) }";
    assert_eq!(facts(copy), Ok(told(&[("side", Value::U32(16)), ("tiles", Value::U32(1))])));
}

#[test]
fn a_parameter_gives_a_fact_and_the_flattened_file_has_it() {
    let pipeline = "Pipeline(
        parameters: { \"tiles\": U32(default: 9) },
        passes: { \"used\": Pass(kind: \"shader\", shader: \"copy.wgsl\",
            out: { \"after\": Out(interface: \"Maps\", facts: { \"tiles\": \"$tiles\", \"bound\": None }) }) },
        outputs: { \"image\": \"used\" },
    )";
    let files = MemoryFiles::new([("p.ron", pipeline)]);
    let resolved = frame_graph::resolve("p.ron", &files, &Default::default()).expect("it is read");
    let text = resolved.to_ron(&pass_types(), false);
    assert!(text.contains("facts: { \"tiles\": 9, \"bound\": None }"), "{text}");
    let again = MemoryFiles::new([("p.ron", text.as_str())]);
    let again = frame_graph::resolve("p.ron", &again, &Default::default()).expect("it is read back");
    assert_eq!(again.to_ron(&pass_types(), false), text);
}

#[test]
fn inputs_that_disagree_are_an_error_until_the_use_says_which() {
    let add = |facts: &str| {
        format!(
            "shader: \"add.wgsl\", in: {{ \"first\": \"maker.narrow\", \"second\": \"maker.wide\" }},
            out: {{ \"sum\": Out(interface: \"Maps\"{facts}) }}"
        )
    };
    let error = facts(&add("")).unwrap_err();
    assert!(
        error.contains("`first` and `second` are, which differ in the fact `tiles`: none and 4"),
        "{error}"
    );
    assert!(error.contains("out: { \"sum\": Out(facts: { \"tiles\": 4 }) }"), "{error}");
    let said = facts(&add(", facts: { \"tiles\": 4 }"));
    let expected = [("bound", Value::F32(0.5)), ("side", Value::U32(16)), ("tiles", Value::U32(4))];
    assert_eq!(said, Ok(told(&expected)));
}

#[test]
fn a_wrong_fact_is_told_at_the_output() {
    let copy = |said: &str| {
        let used = format!(
            "shader: \"copy.wgsl\", in: {{ \"before\": \"maker.wide\" }}, out: {{ \"after\": Out({said}) }}"
        );
        facts(&used).unwrap_err()
    };
    let unknown = copy("interface: \"Maps\", facts: { \"tile\": 1 }");
    assert!(unknown.contains("the fact `tile`, which the interface `Maps` does not declare"), "{unknown}");
    assert!(unknown.contains("did you mean `tiles`?"), "{unknown}");
    assert!(unknown.contains("\"after\": Out(") && unknown.contains("^^^^^^^ here"), "{unknown}");
    let text = copy("interface: \"Maps\", facts: { \"tiles\": 0.5 }");
    assert!(text.contains("as 0.5; the interface `Maps` declares it as"), "{text}");
    let plain = copy("facts: { \"tiles\": 1 }");
    assert!(plain.contains("which is no interface"), "{plain}");
}

#[test]
fn a_fact_that_an_interface_promises_comes_from_somewhere() {
    let alone = "shader: \"copy.wgsl\", in: { \"before\": \"maker.wide\" },
        out: { \"after\": Out(interface: \"Maps\", facts: { \"side\": None }) }";
    let error = facts(alone).unwrap_err();
    assert!(error.contains("nothing gives its fact `side`, the side of a map"), "{error}");
    assert!(error.contains("Out(facts: { \"side\": … })"), "{error}");
}

/// Writes a picture and, under a name that begins with its, another.
const TWO: &str = "
    var before: texture_2d<f32>;
    var after: texture_storage_2d<r32float, write>;
    var after_variance: texture_storage_2d<r32float, write>;
    @compute @workgroup_size(8, 8) fn copy(@builtin(global_invocation_id) id: vec3<u32>) {
        textureStore(after, id.xy, textureLoad(before, id.xy, 0));
        textureStore(after_variance, id.xy, vec4(0.0));
    }";

#[test]
fn of_outputs_that_begin_alike_each_is_its_own() {
    let outputs = |out: &str| {
        let used = format!("shader: \"two.wgsl\", in: {{ \"before\": \"maker.wide\" }}, out: {{ {out} }}");
        let plan = plan(&used, "used.after")?;
        let pass = plan.passes.iter().find(|pass| &*pass.name == "used").expect("it is needed");
        let port =
            |port: &frame_graph::plan::PlannedPort| (port.port.to_string(), port.interface.to_string());
        Ok::<_, String>(pass.outputs.iter().map(port).collect::<Vec<_>>())
    };
    let expected = |after: &str, variance: &str| {
        Ok(vec![("after".into(), after.into()), ("after_variance".into(), variance.into())])
    };
    let both = "\"after\": Out(interface: \"Maps\"), \"after_variance\": Out(interface: \"Maps\")";
    assert_eq!(outputs(both), expected("Maps", "Maps"));
    // An interface of one texture has no members that could be meant.
    assert_eq!(outputs("\"after\": Out(interface: \"Maps\")"), expected("Maps", "Texture"));
    assert_eq!(outputs("\"after\": Out(format: \"r32float\")"), expected("Texture", "Texture"));
}
