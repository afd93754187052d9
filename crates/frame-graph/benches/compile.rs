//! How long it takes from a parsed file to a plan, and to decide what a frame runs.

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
use std::time::{Duration, Instant};

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

/// How long a measurement takes, after a quarter of it in which nothing is measured.
const TIME: Duration = Duration::from_secs(2);

/// Prints the median time of `run` on what `prepare` returns. Neither that nor the drop of the result is measured.
fn measure<I, R>(name: &str, mut prepare: impl FnMut() -> I, mut run: impl FnMut(&mut I) -> R) {
    let start = Instant::now();
    let mut times = Vec::new();
    while start.elapsed() < TIME {
        let mut input = prepare();
        let begin = Instant::now();
        let result = black_box(run(&mut input));
        let time = begin.elapsed();
        drop(result);
        if start.elapsed() > TIME / 4 {
            times.push(time);
        }
    }
    times.sort_unstable();
    let [least, median, most] = [0, times.len() / 2, times.len() - 1].map(|at| times[at].as_secs_f64() * 1e6);
    println!("{name:<28} {median:>10.2} us, {least:.2} to {most:.2}, {} runs", times.len());
}

fn main() {
    let kinds = Two::new();
    let context = LinkContext { frame: (1920, 1080), ..LinkContext::default() };
    for count in [100, 1000] {
        let source = Source::new("bench.ron", text(count));
        let description = parse(Arc::clone(&source)).expect("parses");
        measure(&format!("parse {count}"), || Arc::clone(&source), |source| parse(Arc::clone(source)));
        measure(
            &format!("description to plan {count}"),
            || (),
            |()| plan(black_box(&description), &kinds, &context),
        );
        let resolve = || {
            resolve_description("bench.ron", &description, &NoFiles, &Overrides::default()).expect("resolves")
        };
        measure(&format!("resolve {count}"), || (), |()| resolve());
        let resolved = resolve();
        measure(&format!("link {count}"), || (), |()| link(black_box(&resolved), &kinds, &context));
        let graph = link(&resolved, &kinds, &context).expect("links");
        measure(
            &format!("compile {count}"),
            || (),
            |()| compile(black_box(&graph), &CompileOptions::default()),
        );
        let (plan, ..) = plan(&description, &kinds, &context);
        measure(
            &format!("begin a frame {count}"),
            || FrameState::new(&plan),
            |state| {
                let change = Change { scene_bindings: SceneBindings::CAMERA, ..Change::default() };
                state.begin(&plan, black_box(&change)).runs.len()
            },
        );
    }
}
