//! Passes that their WGSL declares: settings, ports, outputs and steps.

use crate::pass_types::TestPassTypes;
use frame_graph::port::{PassTypes, Use};
use pass::{
    FromWgsl, Library, OutputContext, OutputDesc, Pass, PassTypeError, Settings, Step, Threads, UseContext,
    Value, reflected,
};
use shader_library::MemoryFiles;
use std::collections::BTreeMap;
use std::sync::Arc;

const MAKE: FromWgsl = FromWgsl::new("make", "passes/make/src/lib.rs");
const SUM: FromWgsl = FromWgsl::new("sum", "passes/sum/src/lib.rs");

const MAKE_WGSL: &str = "// Makes numbers.
// [Somebody 1999]
//
// More is said here.

#output numbers: Numbers(count: settings.count * 2, scale: settings.scale when settings.scale > 0.0) // All of them,
    // one after the other.

struct Settings {
    /// How many pairs. [default: 4, min: 1]
    count: u32,
    /// By what they are multiplied. [default: 0.0]
    scale: f32,
}
var<uniform> settings: Settings;
var<storage, read_write> numbers: array<f32>;
@compute @workgroup_size(64) fn make(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&numbers) { numbers[id.x] = settings.scale; }
}
";

const SUM_WGSL: &str = "// Adds numbers.

#input numbers: Numbers
#input weights: Numbers optional like numbers
#output total: Numbers(count: 1, scale: numbers.scale?)

#option WEIGHTS false // whether there are weights
#option ROUNDS 3 // Rounds.
#option TEXTURED false
#option INNER false internal

/// Sums of blocks. [scratch, count: numbers.count / GROUP + 1]
var<storage, read_write> blocks: array<f32>;
var<storage, read> numbers: array<f32>;
#if WEIGHTS
var<storage, read> weights: array<f32>;
#endif
var<storage, read_write> total: array<f32>;
const GROUP: u32 = 4u;

/// [threads: numbers.count / GROUP + 1, repeat: rounds]
@compute @workgroup_size(1) fn add(@builtin(global_invocation_id) id: vec3<u32>) {
    blocks[id.x] = numbers[id.x];
#if WEIGHTS
    blocks[id.x] *= weights[id.x];
#endif
}
@compute @workgroup_size(1) fn finish() { total[0] = blocks[0]; }
";

/// The pass types, with these texts in place of their own.
fn types(make: &str, sum: &str) -> TestPassTypes<'static> {
    let files = MemoryFiles::new([("passes/make/make.wgsl", make), ("passes/sum/sum.wgsl", sum)]);
    TestPassTypes { passes: &[&MAKE, &SUM], library: Library::new(Arc::new(files)) }
}

const PIPELINE: &str = "Pipeline(
    passes: {
        \"make\": Pass(kind: \"make\", set: { \"count\": 8 }),
        \"sum\": Pass(kind: \"sum\", in: { \"numbers\": \"make\", \"weights\": \"make\" }),
    },
    outputs: { \"total\": \"sum\" },
)";

#[test]
fn the_header_documents_the_pass() {
    let types = types(MAKE_WGSL, SUM_WGSL);
    let about = MAKE.about(&types.library);
    assert_eq!((&*about.about, &*about.paper), ("Makes numbers.", "Somebody 1999"));
    assert_eq!(about.shaders, ["passes/make/make.wgsl"]);
}

#[test]
fn settings_are_members_and_those_options_that_nothing_else_decides() {
    let types = types(MAKE_WGSL, SUM_WGSL);
    let names = |pass: &dyn Pass| -> Vec<String> {
        let use_ = Use { kind: pass.kind(), shader: None, inputs: &[], outputs: &BTreeMap::new() };
        let settings = types.settings(use_).unwrap();
        settings.iter().map(|setting| setting.name.clone()).collect()
    };
    assert_eq!(names(&MAKE), ["count", "scale"]);
    assert_eq!(names(&SUM), ["rounds"]);
    let reserved =
        MAKE_WGSL.replace("count: u32", "count: u32,\n    /// Kept. [default: 1]\n    filter_: u32");
    let reserved = self::types(&reserved, SUM_WGSL);
    let use_ = Use { kind: "make", shader: None, inputs: &[], outputs: &BTreeMap::new() };
    assert_eq!(reserved.settings(use_).unwrap()[1].name, "filter");
}

#[test]
fn outputs_steps_and_options_follow_from_the_directives() {
    let types = types(MAKE_WGSL, SUM_WGSL);
    let (plan, steps) = types.linked(PIPELINE, "sum");
    // 16 numbers; a total; five blocks.
    let mut bytes: Vec<u64> = plan.resources.iter().map(|resource| resource.desc.bytes()).collect();
    bytes.sort_unstable();
    assert_eq!(bytes, [16, 32, 64]);
    let steps = steps.unwrap_or_else(|error| panic!("{error}"));
    let entries: Vec<(&str, Threads)> = steps
        .iter()
        .map(|step| match &step.step {
            Step::Compute(compute) => (compute.entry.as_str(), compute.threads.clone()),
            Step::Raster(_) => panic!("nothing is drawn"),
        })
        .collect();
    let add = ("add", Threads::Row(5));
    assert_eq!(entries, [add.clone(), add.clone(), add, ("finish", Threads::Row(1))]);
    assert!(steps[0].shader.variant().contains("WEIGHTS = true"), "{}", steps[0].shader.variant());
}

#[test]
fn errors_in_directives_name_file_and_line() {
    let cases = [
        ("settings.count * 2", "settings.cuont", "passes/make/make.wgsl:6:33: there is no setting `cuont`"),
        ("settings.count * 2", "settings.count *", "passes/make/make.wgsl:6:33: expected a name"),
        (
            "scale: settings",
            "scael: settings",
            "passes/make/make.wgsl:6:53: `scael` is no fact of the interface `Numbers`",
        ),
        ("numbers: Numbers(", "numbers Numbers(", "expected `:` and an interface"),
        ("numbers: Numbers(", "numbrs: Numbers(", "passes/make/make.wgsl:6:9: `numbrs` lacks a member"),
        ("#output", "#outputs", "did you mean `#output`?"),
    ];
    for (from, to, expected) in cases {
        let types = types(&MAKE_WGSL.replacen(from, to, 1), SUM_WGSL);
        let error = types.plan(PIPELINE).expect_err(to);
        assert!(error.contains(expected), "{to}: no `{expected}` in\n{error}");
    }
}

#[test]
fn an_option_may_ask_only_for_traits_that_scenes_have() {
    let asking = |name: &str| {
        let option =
            format!("#option RAYS bvh one_of [bvh, query] auto query where {name} // How.\n#option ROUNDS");
        types(MAKE_WGSL, &SUM_WGSL.replacen("#option ROUNDS", &option, 1)).plan(PIPELINE)
    };
    asking("RAY_QUERIES").unwrap_or_else(|error| panic!("{error}"));
    let error = asking("RAY_QUERYS").expect_err("no such trait");
    for expected in
        ["passes/sum/sum.wgsl:8:", "scenes have no trait `ray_querys`", "did you mean `ray_queries`?"]
    {
        assert!(error.contains(expected), "no `{expected}` in\n{error}");
    }
}

#[test]
fn inputs_that_are_declared_alike_have_as_many_elements() {
    let types = types(MAKE_WGSL, SUM_WGSL);
    let pipeline = PIPELINE
        .replace(
            "\"sum\": Pass",
            "\"few\": Pass(kind: \"make\", set: { \"count\": 2 }),\n        \"sum\": Pass",
        )
        .replace("\"weights\": \"make\"", "\"weights\": \"few\"");
    let error = types.plan(&pipeline).expect_err("too few");
    assert!(error.contains("`weights` has 4 elements, but `numbers` has 16 elements"), "{error}");
}

#[test]
fn a_fact_that_is_left_out_is_zero_unless_it_is_demanded() {
    let sum = SUM_WGSL
        .replace("const", "struct Settings { numbers_scale: f32 }\nvar<uniform> settings: Settings;\nconst")
        .replace("total[0] = blocks[0]", "total[0] = settings.numbers_scale * blocks[0]");
    let scaled = PIPELINE.replace("\"count\": 8", "\"count\": 8, \"scale\": 2.0");
    for (pipeline, expected) in [(PIPELINE, 0.0), (&*scaled, 2.0)] {
        let steps =
            types(MAKE_WGSL, &sum).linked(pipeline, "sum").1.unwrap_or_else(|error| panic!("{error}"));
        let finish = steps.last().unwrap();
        assert_eq!(finish.uniforms[0].values["numbers_scale"], Value::F32(expected));
    }
    let demanded = sum.replacen("numbers: Numbers\n", "numbers: Numbers with scale // Scaled numbers.\n", 1);
    let error = types(MAKE_WGSL, &demanded).plan(PIPELINE).expect_err("no scale");
    assert!(error.contains("what is linked to `numbers` has no fact `scale`"), "{error}");
    assert!(error.contains("Scaled numbers."), "{error}");
    types(MAKE_WGSL, &demanded).plan(&scaled).unwrap();
}

/// A pass of the tree may record draws of its own vertices; a user's fragments are drawn over the frame.
#[test]
fn results_of_fragments_are_members_whatever_their_vertices_give() {
    const DRAW: FromWgsl = FromWgsl::new("draw", "passes/draw/src/lib.rs");
    let text = "#output maps: Maps(side: 8, size: 8)
struct Corner { @builtin(position) clip: vec4<f32>, @location(0) level: f32 }
struct Texel { @location(0) maps: f32 }
@vertex fn project() -> Corner { return Corner(); }
@fragment fn draw(corner: Corner) -> Texel { return Texel(corner.level); }
";
    let library = Library::new(Arc::new(MemoryFiles::new([("passes/draw/draw.wgsl", text)])));
    let types = TestPassTypes { passes: &[&DRAW], library };
    let pipeline = "Pipeline(passes: { \"draw\": Pass(kind: \"draw\") }, outputs: { \"maps\": \"draw\" })";
    let plan = types.plan(pipeline).unwrap();
    let bytes: Vec<u64> = plan.resources.iter().map(|resource| resource.desc.bytes()).collect();
    assert_eq!(bytes, [8 * 8 * 4]);
}

/// Rust records the steps of other files, such as those of an algorithm, but what they write is declared with the rest.
#[test]
fn members_may_be_written_by_entry_points_that_another_file_imports() {
    const COPY: FromWgsl = FromWgsl::new("copy", "passes/copy/src/lib.rs");
    let files = MemoryFiles::new([
        ("passes/copy/copy.wgsl", "#output numbers: Numbers(count: 4)\n"),
        (
            "passes/copy/ones.wgsl",
            "#import \"shaders/fill.wgsl\"\nvar<storage, read_write> numbers: array<f32>;\n\
             fn store(i: u32) { numbers[i] = 1.0; }\n",
        ),
        ("shaders/fill.wgsl", "@compute @workgroup_size(1) fn fill() { store(0u); }\n"),
    ]);
    let types = TestPassTypes { passes: &[&COPY], library: Library::new(Arc::new(files)) };
    let pipeline = "Pipeline(passes: { \"copy\": Pass(kind: \"copy\") }, outputs: { \"numbers\": \"copy\" })";
    let plan = types.plan(pipeline).unwrap();
    assert_eq!(plan.resources[0].desc.bytes(), 16);
}

#[test]
fn settings_are_read_by_name() {
    use pass::ReadSettings;
    let settings = Settings([("count".to_owned(), Value::U32(3))].into());
    assert_eq!(settings.u32("count"), Ok(3));
    let error = settings.u32("cuont").unwrap_err();
    assert_eq!(error.help.as_deref(), Some("did you mean `count`?"));
    assert!(settings.text("count").is_err());
}

/// A pass that computes a value for its directives.
struct Computed;

impl Pass for Computed {
    fn kind(&self) -> &'static str {
        "make"
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let values = [("rows", Value::U32(3)), ("scale", Value::F32(9.0))];
        reflected::outputs_with(use_cx, &self.main_shader(&cx.use_)?, cx, &values)
    }
}

#[test]
fn directives_and_attributes_name_what_rust_computes() {
    let directive = "numbers: Numbers(count: rows, scale: scale)";
    let make = MAKE_WGSL
        .replace(
            "numbers: Numbers(count: settings.count * 2, scale: settings.scale when settings.scale > 0.0)",
            directive,
        )
        .replace(
            "var<storage, read_write> numbers",
            "/// [count: rows * 7]\nvar<storage, read_write> numbers",
        );
    let files = MemoryFiles::new([("passes/make/make.wgsl", &*make), ("passes/sum/sum.wgsl", SUM_WGSL)]);
    let types = TestPassTypes { passes: &[&Computed, &SUM], library: Library::new(Arc::new(files)) };
    let plan = types.plan(PIPELINE).unwrap_or_else(|error| panic!("{error}"));
    let make = plan.passes.iter().find(|pass| pass.kind == "make").expect("it is there");
    let facts: Vec<_> = make.outputs[0].facts.iter().collect();
    // A setting goes before what Rust computes, and the attribute of a member before the directive: 84 bytes, padded.
    assert_eq!(facts, [("count", &Value::U32(3)), ("scale", &Value::F32(0.0))]);
    assert!(plan.resources.iter().any(|resource| resource.desc.bytes() == 96));
}
