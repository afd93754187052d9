//! How long it takes from a parsed file to a plan, and to decide what a frame runs.

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use frame_graph::port::{OutputContext, OutputDesc, PassTypes, Use};
use frame_graph::resolve::Files;
use frame_graph::{
    Change, CompileOptions, Content, Description, Extent, Format, FrameState, Graph, InputPort, Interface,
    LinkContext, Member, OutputPort, Overrides, PassTypeError, Plan, Ports, Resolved, ResourceDesc,
    SceneBindings, Setting, Settings, Source, Value, ValueType, compile, link, parse, resolve_description,
};
use std::fmt::Write as _;
use std::hint::black_box;
use std::sync::Arc;

const INTERFACES: &[Interface] =
    &[Interface::new("Irradiance", "", &[Member::required("", Content::Texture(Format::Rgba16Float), "")])];

/// Two pass types: one that makes light from nothing, and one that mixes two.
struct Two {
    settings: Arc<[Setting]>,
    source: Arc<Ports>,
    mix: Arc<Ports>,
}

impl Two {
    fn new() -> Two {
        let setting = Setting {
            name: "strength".into(),
            ty: ValueType::F32,
            default: Value::F32(1.0),
            min: Some(0.0),
            max: Some(8.0),
            one_of: Vec::new(),
            unit: String::new(),
            doc: String::new(),
            declared: String::new(),
        };
        let input = |name: &str, optional| InputPort {
            name: name.into(),
            interface: "Irradiance".into(),
            optional,
            doc: String::new(),
        };
        let outputs = vec![OutputPort {
            name: "irradiance".into(),
            interface: "Irradiance".into(),
            doc: String::new(),
        }];
        Two {
            settings: vec![setting].into(),
            source: Arc::new(Ports {
                inputs: vec![],
                outputs: outputs.clone(),
                scene_bindings: SceneBindings::CAMERA,
            }),
            mix: Arc::new(Ports {
                inputs: vec![input("a", false), input("b", true)],
                outputs,
                scene_bindings: SceneBindings::NONE,
            }),
        }
    }
}

impl PassTypes for Two {
    fn names(&self) -> Vec<String> {
        vec!["mix".into(), "source".into()]
    }

    fn interfaces(&self) -> &[Interface] {
        INTERFACES
    }

    fn takes_shader(&self, kind: &str) -> Option<bool> {
        matches!(kind, "mix" | "source").then_some(false)
    }

    fn settings(&self, _use: Use<'_>) -> Result<Arc<[Setting]>, PassTypeError> {
        Ok(Arc::clone(&self.settings))
    }

    fn ports(&self, use_: Use<'_>, _settings: &Settings) -> Result<Arc<Ports>, PassTypeError> {
        Ok(Arc::clone(if use_.kind == "mix" { &self.mix } else { &self.source }))
    }

    fn outputs(&self, _context: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        Ok(vec![OutputDesc::one("irradiance", ResourceDesc::texture_2d(Format::Rgba16Float, Extent::FRAME))])
    }
}

struct NoFiles;

impl Files for NoFiles {
    fn read(&self, _path: &str) -> Option<Arc<Source>> {
        None
    }

    fn list(&self) -> Vec<String> {
        Vec::new()
    }
}

/// A pipeline of `count` passes: each reads the one before and one further back, one in eight has a setting.
fn text(count: usize) -> String {
    let mut text = String::from("Pipeline(passes: {\n");
    for i in 0..count {
        let set = if i % 8 == 0 { ", set: { \"strength\": 2.0 }" } else { "" };
        let _ = match i {
            0 => writeln!(text, "\"pass-0\": Pass(kind: \"source\"),"),
            _ => {
                let back = i.saturating_sub(1 + i % 5);
                let other = if i % 3 == 0 { format!(", \"b\": \"pass-{back}\"") } else { String::new() };
                writeln!(
                    text,
                    "\"pass-{i}\": Pass(kind: \"mix\", in: {{ \"a\": \"pass-{}\"{other} }}{set}),",
                    i - 1
                )
            }
        };
    }
    let _ = write!(text, "}}, outputs: {{ \"image\": \"pass-{}\" }})", count - 1);
    text
}

/// What a program keeps; what it does not keep is not dropped within the time.
fn plan(description: &Description, kinds: &Two, context: &LinkContext) -> (Plan, Graph, Resolved) {
    let resolved =
        resolve_description("bench.ron", description, &NoFiles, &Overrides::default()).expect("resolves");
    let graph = link(&resolved, kinds, context).expect("links");
    let plan = compile(&graph, &CompileOptions::default()).expect("compiles");
    (plan, graph, resolved)
}

fn benches(c: &mut Criterion) {
    let kinds = Two::new();
    let context = LinkContext { frame: (1920, 1080), ..LinkContext::default() };
    for count in [100, 1000] {
        let source = Source::new("bench.ron", text(count));
        let description = parse(Arc::clone(&source)).expect("parses");
        c.bench_function(&format!("parse {count}"), |b| {
            b.iter_with_large_drop(|| parse(black_box(Arc::clone(&source))));
        });
        c.bench_function(&format!("description to plan {count}"), |b| {
            b.iter_with_large_drop(|| plan(black_box(&description), &kinds, &context));
        });
        let resolve = || {
            resolve_description("bench.ron", &description, &NoFiles, &Overrides::default()).expect("resolves")
        };
        c.bench_function(&format!("resolve {count}"), |b| b.iter_with_large_drop(resolve));
        let resolved = resolve();
        c.bench_function(&format!("link {count}"), |b| {
            b.iter_with_large_drop(|| link(black_box(&resolved), &kinds, &context));
        });
        let graph = link(&resolved, &kinds, &context).expect("links");
        c.bench_function(&format!("compile {count}"), |b| {
            b.iter_with_large_drop(|| compile(black_box(&graph), &CompileOptions::default()));
        });
        let (plan, ..) = plan(&description, &kinds, &context);
        c.bench_function(&format!("begin a frame {count}"), |b| {
            let change = Change { scene_bindings: SceneBindings::CAMERA, ..Change::default() };
            b.iter_batched_ref(
                || FrameState::new(&plan),
                |state| state.begin(&plan, black_box(&change)).runs.len(),
                BatchSize::SmallInput,
            );
        });
    }
}

criterion_group! {
    name = all;
    config = Criterion::default().warm_up_time(std::time::Duration::from_millis(500)).measurement_time(std::time::Duration::from_secs(2)).sample_size(30);
    targets = benches
}
criterion_main!(all);
