//! Modules bring all that they need: a uniform of their own, options, and the scene bindings.

use crate::pass_types::{TILE, TILES, TestPassTypes};
use frame_graph::plan::Plan;
use pass::{
    Compute, Extent, Fact, Format, FromWgsl, Library, LinkedSteps, Module, OutputContext, OutputDesc, Pass,
    PassTypeError, Ports, RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Source,
    Threads, UseContext, Value,
};
use shader_library::{GlobalKind, MemoryFiles};
use std::sync::Arc;

/// Brings the module, and the facts that it has by default.
struct Maps {
    facts: &'static [(Fact<u32>, u32)],
}

impl Pass for Maps {
    fn kind(&self) -> &'static str {
        "maps"
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(Vec::new())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports { outputs: vec![pass::output("answer", "Answer", "")], ..Ports::default() })
    }

    fn outputs(&self, _: &UseContext<'_>, _: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let module = Module::new("answer.wgsl").option("DOUBLED", Value::Bool(true));
        let buffer = OutputDesc::one("answer", ResourceDesc::<Extent>::buffer(16)).module(module);
        let facts = self.facts.iter();
        Ok(vec![facts.fold(buffer, |output, (fact, value)| output.fact(*fact, *value))])
    }

    fn record(&self, _: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::default())
    }
}

/// Imports whatever module is linked, and knows nothing of it.
struct Reader;

impl Pass for Reader {
    fn kind(&self) -> &'static str {
        "reader"
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(Vec::new())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![pass::input("answer", "Answer", "")],
            outputs: vec![pass::output("image", "Texture", "")],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, _: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let size = Extent::Fixed(8, 8);
        Ok(vec![OutputDesc::one("image", ResourceDesc::texture_2d(Format::R32Float, size))])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let step = Compute::new(cx.shader("reader.wgsl", &[]), "answer_all", Threads::Grid([8, 8, 1]));
        Ok(Recording::one(step.value("first.count", Value::U32(7))))
    }
}

const PIPELINE: &str = r#"Pipeline(
    passes: {
        "maps": Pass(kind: "maps"),
        "reader": Pass(kind: "reader", in: { "answer": "maps" }),
    },
    outputs: { "image": "reader" },
)"#;

const READER: &str = r#"
#import interface "answer"

struct Range {
    count: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

struct Settings {
    image_size: vec2<u32>,
    @align(16) first: Range,
}

var<uniform> settings: Settings;
var image: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn answer_all(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < settings.image_size) {
        textureStore(image, id.xy, vec4(f32(answer_at(id.x + settings.first.count))));
    }
}
"#;

/// Reads the camera, and by a function of an import the lights; another import's function is not called.
const ANSWER: &str = r#"
#option DOUBLED false

#import "bindings.wgsl"

struct AnswerFacts {
    seed: u32,
    tile: u32,
    pad: u32,
}

var<uniform> answer_facts: AnswerFacts;
var<storage, read> answer: array<u32>;

fn answer_at(index: u32) -> u32 {
    let tile = answer_facts.tile + u32(camera.width) + light();
#if DOUBLED
    return answer[index % 4u] * tile * 2u + answer_facts.seed;
#else
    return answer[index % 4u] * tile + answer_facts.seed;
#endif
}
"#;

const BINDINGS: &str = r#"
struct Camera { width: f32 }
struct Frame { index: u32 }

var<uniform> camera: Camera;
var<uniform> frame: Frame;
var<storage, read> scene_lights: array<u32>;

fn light() -> u32 {
    return scene_lights[0];
}

fn number() -> u32 {
    return frame.index;
}
"#;

fn linked(facts: &'static [(Fact<u32>, u32)]) -> (Plan, Result<LinkedSteps, String>) {
    let files = [("answer.wgsl", ANSWER), ("reader.wgsl", READER), ("bindings.wgsl", BINDINGS)];
    let library = Library::new(Arc::new(MemoryFiles::new(files)));
    let maps = Maps { facts };
    TestPassTypes { passes: &[&maps, &Reader], library }.linked(PIPELINE, "reader")
}

#[test]
fn a_module_has_a_uniform_filled_from_the_facts_of_its_port() {
    let (_, steps) = linked(&[(TILE, 5), (TILES, 6)]);
    let [step] = &steps.unwrap_or_else(|error| panic!("{error}"))[..] else { panic!("one step") };
    let fill = |name: &str| {
        let (index, global) = step.shader.interface.global(name).expect("it is declared");
        assert!(matches!(global.kind, GlobalKind::Uniform { .. }));
        let bound = step.bindings.iter().find(|bound| bound.global == index).expect("it is used");
        let Source::Uniform(index) = bound.source else { panic!("{:?}", bound.source) };
        step.uniforms[index].bytes(9, |_, _| 0)
    };
    let words = |bytes: Vec<u8>| -> Vec<u32> {
        bytes.chunks(4).map(|word| u32::from_le_bytes(word.try_into().expect("four bytes"))).collect()
    };
    assert_eq!(words(fill("answer_facts")), [9, 5, 0], "seed, tile and padding");
    assert_eq!(
        words(fill("settings")),
        [8, 8, 0, 0, 7, 0, 0, 0],
        "a struct inside is filled by `first.count`"
    );
}

#[test]
fn a_reader_depends_on_the_scene_bindings_that_the_module_reads() {
    let (plan, steps) = linked(&[(TILE, 5)]);
    steps.unwrap_or_else(|error| panic!("{error}"));
    let of =
        |kind: &str| plan.passes.iter().find(|pass| pass.kind == kind).expect("it is there").scene_bindings;
    // Not on the frame's number: what could ask for it is imported and not called.
    assert_eq!(of("reader"), SceneBindings::CAMERA.and(SceneBindings::LIGHTS));
    assert_eq!(of("maps"), SceneBindings::NONE, "who makes the module does not run for it");
}

#[test]
fn a_missing_fact_names_the_module_the_producer_and_the_nearest() {
    let (_, steps) = linked(&[(TILES, 5)]);
    let error = steps.expect_err("`tile` has no value");
    for part in [
        "L006",
        "answer.wgsl:8:5",
        "nothing gives `answer_facts.tile` a value",
        "did you mean `tiles`?",
        "`maps` of the pass type `maps`",
        "linked to `answer`",
    ] {
        assert!(error.contains(part), "no `{part}` in\n{error}");
    }
}

/// Imports the module only where it is linked.
const ASK: FromWgsl = FromWgsl::new("reader", "passes/ask/src/lib.rs");

const ASK_WGSL: &str = r#"// Asks for answers.

#input answer: Answer optional
#output image: Texture

#option ANSWER false // whether something answers

#if ANSWER
#import interface "answer"
#endif

var image: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn answer_all(@builtin(global_invocation_id) id: vec3<u32>) {
    var found = 0u;
#if ANSWER
    found = answer_at(id.x);
#endif
    textureStore(image, id.xy, vec4(f32(found)));
}
"#;

#[test]
fn a_module_that_is_imported_on_a_condition_has_the_options_of_its_producer() {
    let files = [("answer.wgsl", ANSWER), ("passes/ask/reader.wgsl", ASK_WGSL), ("bindings.wgsl", BINDINGS)];
    let library = Library::new(Arc::new(MemoryFiles::new(files)));
    let maps = Maps { facts: &[(TILE, 5)] };
    let (_, steps) = TestPassTypes { passes: &[&maps, &ASK], library }.linked(PIPELINE, "reader");
    let steps = steps.unwrap_or_else(|error| panic!("{error}"));
    let variant = steps[0].shader.variant();
    assert!(variant.contains("ANSWER = true") && variant.contains("DOUBLED = true"), "{variant}");
}
