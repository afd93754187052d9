//! Frames of a plan: objects, histories, targets, uniforms, timers, errors.

use crate::harness::{Running, TestPass, Workshop, every_frame, gpu, shader, texture, words};
use executor::{ExecutorError, FrameOptions, Timings};
use frame_graph::ResetCause;
use frame_graph::plan::ResourceId;
use pass::{
    Clear, Compute, Draw, Extent, Fact, Format, Load, OutputDesc, Raster, ResourceDesc, Step, Target,
    Threads, Usage, Value,
};
use std::time::{Duration, Instant};

const POISON: FrameOptions = FrameOptions { timed: false, monitored: false, poison: Some(FrameOptions::NAN) };

/// One thread that runs this body, with these globals.
fn compute(globals: &str, body: &str) -> String {
    format!("{globals}\n@compute @workgroup_size(1) fn main() {{ {body} }}")
}

fn run(path: &str) -> Compute {
    Compute::new(shader(path), "main", Threads::Grid([1; 3]))
}

fn cleared(mut output: OutputDesc, clear: Clear) -> OutputDesc {
    output.members[0].2 = Usage::ClearFirst(clear);
    output
}

/// A pipeline of one pass that has the steps and outputs of `kind`, all of which are outputs of the pipeline.
fn alone(kind: TestPass, ports: &[&str], shaders: &[(&str, &str)]) -> Option<Running> {
    let outputs: Vec<String> = ports.iter().map(|port| format!("\"{port}\": \"use.{port}\"")).collect();
    Workshop::new(vec![kind], shaders).start(r#""use": Pass(kind: "kind")"#, &outputs.join(", "))
}

/// Writes the second of four words.
const SECOND: &str = "var<storage, read_write> out: array<u32>;";

#[test]
fn what_asks_for_it_is_cleared_in_every_frame() {
    let layered = ResourceDesc::texture_2d_array(Format::Rgba32Float, Extent::Fixed(2, 1), 3);
    let kind = TestPass::new("kind")
        .output(cleared(OutputDesc::one("out", words(4)), Clear::Zero))
        .output(cleared(OutputDesc::one("layers", layered), Clear::Color([0.5, -1.0, 2.0, 0.25])))
        .output(cleared(OutputDesc::one("depth", texture(Format::Depth32Float)), Clear::Color([0.75; 4])))
        .steps(|_| vec![Step::Compute(run("second.wgsl"))]);
    let second = compute(SECOND, "out[1] += 5u;");
    let ports = ["out", "layers", "depth"];
    let Some(mut running) = alone(kind, &ports, &[("second.wgsl", &second)]) else { return };
    for options in [FrameOptions::default(), POISON, FrameOptions::default()] {
        running.frame_of_all(options);
        assert_eq!(running.read("use.out"), [0, 5, 0, 0]);
        assert_eq!(running.read_floats("use.layers"), [0.5, -1.0, 2.0, 0.25].repeat(6));
        assert_eq!(running.read_floats("use.depth"), [0.75; 32]);
    }
}

/// Poison fills buffers and textures, whatever their rows, before the pass runs; what it then writes stays.
#[test]
fn poison_is_in_all_that_is_not_written() {
    let odd = ResourceDesc::texture_2d_array(Format::R32Float, Extent::Fixed(3, 2), 2);
    let kind = TestPass::new("kind")
        .output(OutputDesc::one("out", words(4)))
        .output(OutputDesc::one("layers", odd))
        .steps(|_| vec![Step::Compute(run("second.wgsl"))]);
    let second = compute(SECOND, "out[1] = 5u;");
    let Some(mut running) = alone(kind, &["out", "layers"], &[("second.wgsl", &second)]) else { return };
    running.frame_of_all(POISON);
    assert_eq!(running.read("use.out"), [u32::MAX, 5, u32::MAX, u32::MAX]);
    assert_eq!(running.read("use.layers"), [u32::MAX; 12]);
}

/// WGSL says that workgroup memory is zero when a dispatch begins, whatever one before it has left there.
#[test]
fn workgroup_memory_begins_as_zero() {
    let memory = "var<workgroup> shared_words: array<u32, 64>;\n";
    let fill = format!(
        "{memory} var<storage, read_write> filled: array<u32>;
         @compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32) {{
             shared_words[i] = 0xffffffffu;
             workgroupBarrier();
             filled[i] = shared_words[63u - i];
         }}"
    );
    let read = format!(
        "{memory} var<storage, read_write> out: array<u32>;
         @compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32) {{
             out[i] = shared_words[i];
         }}"
    );
    let kind = TestPass::new("kind")
        .output(OutputDesc::one("out", words(64)))
        .output(OutputDesc::one("filled", words(64)))
        .steps(|_| vec![Step::Compute(run("fill.wgsl")), Step::Compute(run("read.wgsl"))]);
    let shaders = [("fill.wgsl", &*fill), ("read.wgsl", &*read)];
    let Some(mut running) = alone(kind, &["out", "filled"], &shaders) else { return };
    running.frame_of_all(POISON);
    assert_eq!(running.read("use.filled"), [u32::MAX; 64]);
    assert_eq!(running.read("use.out"), [0; 64]);
}

/// A chain of passes whose resources could all lie in two objects.
fn chain(length: u32) -> (Vec<TestPass>, String, String) {
    let texel = OutputDesc::one("out", texture(Format::R32Uint));
    let kind = every_frame(TestPass::new("kind").optional("before", "Texture").output(texel)).steps(|cx| {
        let shader = shader(if cx.connected("before") { "next.wgsl" } else { "first.wgsl" });
        vec![Step::Compute(Compute::per_texel(shader, "main", cx.frame))]
    });
    let passes = (1..=length).map(|i| {
        let from = if i > 1 { format!(", in: {{ \"before\": \"p{}\" }}", i - 1) } else { String::new() };
        format!("\"p{i}\": Pass(kind: \"kind\"{from})")
    });
    (vec![kind], passes.collect::<Vec<_>>().join(", "), format!("\"out\": \"p{length}.out\""))
}

const CHAIN: &[(&str, &str)] = &[
    (
        "first.wgsl",
        "var out: texture_storage_2d<r32uint, write>;
         @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
             textureStore(out, at.xy, vec4(1u + at.x + 8u * at.y));
         }",
    ),
    (
        "next.wgsl",
        "var before: texture_2d<u32>;
         var out: texture_storage_2d<r32uint, write>;
         @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
             textureStore(out, at.xy, 3u * textureLoad(before, at.xy, 0) + 1u);
         }",
    ),
];

#[test]
fn sharing_leaves_the_same_bits() {
    let (kinds, passes, outputs) = chain(7);
    let mut workshop = Workshop::new(kinds, CHAIN);
    let mut pictures = Vec::new();
    let mut held = Vec::new();
    for sharing in [true, false] {
        workshop.options.sharing = sharing;
        let Some(mut running) = workshop.start(&passes, &outputs) else { return };
        for options in [FrameOptions::default(), POISON] {
            running.frame_of_all(options);
            pictures.push(running.read("p7.out"));
        }
        held.push(running.0.held_bytes());
    }
    let expected = (1..=32).map(|first: u32| (0..6).fold(first, |x, _| 3 * x + 1)).collect::<Vec<_>>();
    assert!(pictures.iter().all(|picture| *picture == expected), "{pictures:?}");
    assert_eq!(held, [3 * 128, 7 * 128], "two objects change places, and the output has one of its own");
}

/// Writes the age of the history buffer, the cause of its reset, and its content plus one.
const AGES: &str = "
    struct Settings { past_age: f32, past_reset: u32 }
    var<uniform> settings: Settings;
    var<storage, read> past: array<u32>;
    var<storage, read_write> out: array<u32>;";

#[test]
fn histories_age_and_end() {
    let kind = TestPass::new("kind")
        .optional("past", "Buffer")
        .output(OutputDesc::one("out", words(4)))
        .steps(|_| vec![Step::Compute(run("ages.wgsl"))]);
    let ages = compute(
        AGES,
        "out[0] = u32(settings.past_age); out[1] = settings.past_reset; out[2] = past[2] + 1u; out[3] = past[3];",
    );
    let workshop = Workshop::new(vec![kind], &[("ages.wgsl", &ages)]);
    let passes = r#""use": Pass(kind: "kind", in: { "past": "prev use" }, history: (reset: [Cut]))"#;
    let Some(mut running) = workshop.start(passes, r#""out": "use.out""#) else { return };
    for (age, reset) in [(0, 1), (1, 0), (2, 0)] {
        running.frame();
        assert_eq!(running.read("use.out"), [age, reset, age + 1, 0]);
    }
    running.frame_after(ResetCause::Scene);
    assert_eq!(running.read("use.out"), [3, 0, 4, 0], "the link does not name it");
    for copy in 0..2 {
        running.frame_after(ResetCause::Cut);
        assert_eq!(running.read("use.out"), [0, 3, 1, 0], "in either copy: {copy}");
        running.frame();
        assert_eq!(running.read("use.out"), [1, 0, 2, 0]);
        running.frame();
    }
}

/// History buffers begin as zero in every layer.
#[test]
fn history_buffers_begin_as_zero() {
    let desc = ResourceDesc::texture_2d_array(Format::Rgba32Float, Extent::Fixed(1, 1), 2);
    let add = "
        var past: texture_2d_array<f32>;
        var out: texture_storage_2d_array<rgba32float, write>;
        @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
            let sum = vec4(0.5, 1.0, 2.0, 4.0) + textureLoad(past, at.xy, at.z, 0);
            textureStore(out, at.xy, at.z, sum);
        }";
    let sum = TestPass::new("sum").optional("past", "Texture").output(OutputDesc::one("out", desc));
    let sum = sum
        .steps(|_| vec![Step::Compute(Compute::new(shader("add.wgsl"), "main", Threads::Grid([1, 1, 2])))]);
    let workshop = Workshop::new(vec![sum], &[("add.wgsl", add)]);
    let passes = r#""use": Pass(kind: "sum", in: { "past": "prev use" }, history: (reset: [Cut]))"#;
    let Some(mut running) = workshop.start(passes, r#""out": "use.out""#) else { return };
    for frame in 1..4 {
        running.frame_with_poison();
        let texel = [0.5, 1.0, 2.0, 4.0].map(|add| add * frame as f32);
        assert_eq!(running.read_floats("use.out"), texel.repeat(2), "frame {frame}");
    }
}

/// Covers the frame up to a share of its width with a color.
const COVER: &str = "
    struct Settings { width: f32, color: f32 }
    var<uniform> settings: Settings;
    @vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
        let side = vec2(f32(i == 1u || i == 2u || i == 4u), f32(i == 2u || i >= 4u));
        return vec4(side.x * 2.0 * settings.width - 1.0, side.y * 2.0 - 1.0, 0.0, 1.0);
    }
    @fragment fn color() -> @location(0) vec4<f32> {
        return vec4(settings.color, 0.0, 0.0, 1.0);
    }";

#[test]
fn draws_reach_their_layer_and_keep_what_is_there() {
    let cover = |layer: u32, load: Load, width: f32, color: f32| {
        Step::Raster(Raster {
            shader: shader("cover.wgsl"),
            vertex: "corner".into(),
            fragment: Some("color".into()),
            targets: vec![Target { resource: "layers".into(), layer, load }],
            depth: None,
            draw: Draw::Vertices { vertices: 6, instances: 1 },
            values: vec![("width".into(), Value::F32(width)), ("color".into(), Value::F32(color))],
            bind: Vec::new(),
            windows: Vec::new(),
        })
    };
    let layers = ResourceDesc::texture_2d_array(Format::R32Float, Extent::Fixed(4, 1), 3);
    let kind = TestPass::new("kind").output(OutputDesc::one("layers", layers)).steps(move |_| {
        vec![
            cover(2, Load::Clear([5.0, 0.0, 0.0, 0.0]), 0.25, 1.0),
            cover(0, Load::Clear([6.0, 0.0, 0.0, 0.0]), 0.75, 2.0),
            cover(0, Load::Keep, 0.5, 3.0),
            cover(1, Load::Clear([7.0, 0.0, 0.0, 0.0]), 1.0, 4.0),
        ]
    });
    let Some(mut running) = alone(kind, &["layers"], &[("cover.wgsl", COVER)]) else { return };
    for _ in 0..2 {
        running.frame_of_all(POISON);
        let [first, second, third] = [[3.0, 3.0, 2.0, 6.0], [4.0; 4], [1.0, 5.0, 5.0, 5.0]];
        assert_eq!(running.read_floats("use.layers"), [first, second, third].concat());
    }
}

/// The uniform holds what the steps say, the seed of the pass, and the size of its ports; another seed of the run makes the
/// pass run again.
#[test]
fn uniforms_follow_the_seed() {
    let report = "
        struct Settings { seed: u32, given: vec2<f32>, picture_size: vec2<u32> }
        var<uniform> settings: Settings;
        var<storage, read_write> out: array<u32>;
        @compute @workgroup_size(1) fn main() {
            out[0] = settings.seed;
            out[1] = u32(settings.given.x * 10.0 + settings.given.y);
            out[2] = settings.picture_size.x;
            out[3] = settings.picture_size.y;
        }";
    let kind = TestPass::new("kind")
        .output(OutputDesc::one("out", words(4)))
        .output(OutputDesc::scratch("picture", texture(Format::R32Float)))
        .steps(|_| vec![Step::Compute(run("report.wgsl").value("given", Value::Vector(vec![4.0, 2.0])))]);
    let Some(mut running) = alone(kind, &["out"], &[("report.wgsl", report)]) else { return };
    assert_eq!(running.frame().ran, [true]);
    assert_eq!(running.read("use.out"), [0, 42, 8, 4]);
    assert_eq!(running.frame().ran, [false], "nothing has changed");
    running.0.set_sample(17, 0);
    assert_eq!(running.frame().ran, [true]);
    assert_eq!(running.read("use.out"), [pass::pass_seed(17, "use"), 42, 8, 4]);
    running.0.set_sample(17, 0);
    assert_eq!(running.frame().ran, [false], "the seed is the same");
}

/// A uniform that has the number of the sample has the same seed in all samples, and the others one of each.
#[test]
fn uniforms_follow_the_sample() {
    let report = "
        struct Settings { seed: u32, sample: u32 }
        var<uniform> settings: Settings;
        var<storage, read_write> out: array<u32>;
        @compute @workgroup_size(1) fn main() {
            out[0] = settings.seed;
            out[1] = settings.sample;
        }";
    let without = report.replace(", sample: u32", "").replace("settings.sample", "0u");
    let kind = |file: &'static str| {
        TestPass::new(&file[..file.len() - 5])
            .output(OutputDesc::one("out", words(2)))
            .steps(move |_| vec![Step::Compute(run(file))])
    };
    let kinds = vec![kind("sampled.wgsl"), kind("seeded.wgsl")];
    let workshop = Workshop::new(kinds, &[("sampled.wgsl", report), ("seeded.wgsl", &without)]);
    let passes = r#""sampled": Pass(kind: "sampled"), "seeded": Pass(kind: "seeded")"#;
    let outputs = r#""a": "sampled.out", "b": "seeded.out""#;
    let Some(mut running) = workshop.start(passes, outputs) else { return };
    let mut read = |sample: u32| {
        running.0.set_sample(17, sample);
        assert_eq!(running.frame().ran, [true, true]);
        ["sampled.out", "seeded.out"].map(|output| running.read(output)[..2].to_vec())
    };
    let [first, third] = [read(0), read(2)];
    assert_eq!(first, [[pass::pass_seed(17, "sampled"), 0], [pass::pass_seed(17, "seeded"), 0]]);
    assert_eq!(third[0], [first[0][0], 2]);
    assert_ne!(third[1][0], first[1][0]);
    running.0.set_sample(17, 2);
    assert_eq!(running.frame().ran, [false, false], "the sample is the same");
}

#[test]
fn what_runs_is_timed() {
    if gpu().is_none_or(|gpu| !gpu.has_timestamps()) {
        return;
    }
    let (mut kinds, passes, outputs) = chain(3);
    kinds.push(TestPass::new("still").output(cleared(OutputDesc::one("out", words(4)), Clear::Zero)));
    let workshop = Workshop::new(kinds, CHAIN);
    let (passes, outputs) =
        (format!(r#"{passes}, "still": Pass(kind: "still")"#), format!(r#"{outputs}, "still": "still.out""#));
    let Some(mut running) = workshop.start(&passes, &outputs) else { return };
    assert!(running.frame().times.is_empty(), "not asked for");
    let report = running.frame_of_all(FrameOptions { timed: true, ..FrameOptions::default() }).clone();
    assert_eq!(report.ran, [true; 4]);
    assert_eq!(report.times.len(), 4);
    let still = running.0.plan().unwrap().pass("still").unwrap().0 as usize;
    for (pass, time) in report.times.iter().enumerate() {
        assert!(time.is_finite() && *time < 1e4, "{:?}", report.times);
        assert_eq!(*time > 0.0, pass != still, "a pass without steps takes no time: {:?}", report.times);
    }
}

/// Waits for the GPU, and returns the newest times: those of this frame or a newer one. The device is that of other tests too, and the poll of
/// one of them may be what is about to report them.
fn finished(running: &mut Running, frame: u64) -> Timings {
    running.0.gpu().wait().unwrap();
    let deadline = Instant::now() + Duration::from_secs(20);
    loop {
        match running.0.timings() {
            Some(timings) if timings.frame >= frame => return timings.clone(),
            timings => assert!(Instant::now() < deadline, "frame {frame} is not reported: {timings:?}"),
        }
        std::thread::yield_now();
    }
}

/// Times of monitored frames come without waiting, are those of the frame that they name, and of newer frames as time goes
/// on. Where nothing is read and the GPU does not finish, frames go on all the same.
#[test]
fn monitored_frames_report_their_times_later() {
    if gpu().is_none_or(|gpu| !gpu.has_timestamps()) {
        return;
    }
    let (kinds, passes, outputs) = chain(3);
    let Some(mut running) = Workshop::new(kinds, CHAIN).start(&passes, &outputs) else { return };
    let monitored = FrameOptions { monitored: true, ..FrameOptions::default() };
    assert_eq!(running.0.timings(), None, "no frame was timed");
    running.frame();
    running.0.gpu().wait().unwrap();
    assert_eq!(running.0.timings(), None, "no frame was timed");
    let first = running.frame_of_all(monitored).frame;
    assert_eq!(first, 1, "frames are counted from 0");
    for _ in 0..20 {
        let report = running.frame_of_all(monitored);
        assert!(report.times.is_empty(), "nobody waits");
    }
    let last = running.frame_of_all(monitored).frame;
    let timings = finished(&mut running, first);
    assert!((first..=last).contains(&timings.frame), "{timings:?}");
    assert!(timings.times.len() == 3 && timings.times.iter().all(|time| *time > 0.0), "{timings:?}");
    let later = running.0.timings().unwrap();
    assert!(later.frame > timings.frame || *later == timings, "they stay until there are newer ones");
    // With the GPU idle there is a buffer free for every frame.
    for _ in 0..6 {
        let frame = running.frame_of_all(monitored).frame;
        assert_eq!(finished(&mut running, frame).frame, frame);
    }
    let timed = running.frame_of_all(FrameOptions { timed: true, ..monitored }).clone();
    let timings = running.0.timings().unwrap();
    assert_eq!(
        (timings.frame, &timings.times),
        (timed.frame, &timed.times),
        "what is waited for is the newest"
    );
}

#[test]
fn resources_are_written_and_read() {
    let kind = TestPass::new("kind")
        .output(OutputDesc::one("out", words(4)))
        .output(OutputDesc::one("odd", ResourceDesc::texture_2d(Format::R32Uint, Extent::Fixed(3, 2))));
    let Some(running) = alone(kind, &["out", "odd"], &[]) else { return };
    let words = |range: std::ops::Range<u32>| range.collect::<Vec<u32>>();
    running.0.write(running.id("use.out"), bytemuck::cast_slice(&words(1..5)));
    running.0.write(running.id("use.odd"), bytemuck::cast_slice(&words(10..16)));
    assert_eq!(running.read("use.out"), words(1..5));
    assert_eq!(running.read("use.odd"), words(10..16));
    let refused = running.0.read(ResourceId(2)).unwrap_err();
    assert!(matches!(refused, ExecutorError::ReadBack { .. }), "{refused}");
    assert!(running.0.object(ResourceId(2)).is_none());
}

/// A resource that the adapter cannot hold is refused with its name and the limit, and the plan before goes on.
#[test]
fn a_plan_that_does_not_load_replaces_nothing() {
    let limits = match gpu() {
        Some(gpu) => gpu.limits(),
        None => return,
    };
    let sized = |name, desc| {
        let count: Fact<u32> = Fact::required("count", "");
        TestPass::new(name).output(OutputDesc::one("out", desc).fact(count, 7))
    };
    let layers = limits.max_texture_array_layers + 1;
    let bytes = limits.max_storage_buffer_binding_size + 4;
    let (mut kinds, passes, outputs) = chain(2);
    kinds
        .push(sized("layers", ResourceDesc::texture_2d_array(Format::R32Float, Extent::Fixed(1, 1), layers)));
    kinds
        .push(sized("bytes", ResourceDesc::buffer(bytes)).steps(|_| vec![Step::Compute(run("second.wgsl"))]));
    let second = compute(SECOND, "out[1] = 5u;");
    let shaders = [CHAIN, &[("second.wgsl", &second)]].concat();
    let workshop = Workshop::new(kinds, &shaders);
    let Some(mut running) = workshop.start(&passes, &outputs) else { return };
    running.frame();
    let (held, picture) = (running.0.held_bytes(), running.read("p2.out"));
    for (kind, limit) in
        [("layers", "max_texture_array_layers"), ("bytes", "max_storage_buffer_binding_size")]
    {
        let pipeline = format!(r#"{passes}, "too-large": Pass(kind: "{kind}")"#);
        let linked = workshop.link(&pipeline, &format!(r#"{outputs}, "x": "too-large.out""#)).unwrap();
        match running.load(linked).unwrap_err() {
            ExecutorError::Limit { resource, limit: found, from, .. } => {
                assert_eq!((resource.as_str(), found), ("too-large.out", limit));
                assert_eq!(from, "\n  what it holds: count = 7");
            }
            other => panic!("{other}"),
        }
        assert_eq!(running.0.plan().unwrap().passes.len(), 2);
        assert_eq!(running.0.held_bytes(), held);
        running.frame_of_all(POISON);
        assert_eq!(running.read("p2.out"), picture);
    }
}

/// The same plan again makes no pipeline, keeps all objects, and runs what its steps make new.
#[test]
fn loading_again_keeps_what_is_the_same() {
    let (kinds, passes, outputs) = chain(3);
    let workshop = Workshop::new(kinds, CHAIN);
    let Some(mut running) = workshop.start(&passes, &outputs) else { return };
    running.frame();
    let report = running.load(workshop.link(&passes, &outputs).unwrap()).unwrap();
    assert!(report.kept && report.changed.is_empty() && report.pipelines == 0, "{report:?}");
    let (kinds, passes, outputs) = chain(4);
    let longer = Workshop::new(kinds, CHAIN).link(&passes, &outputs).unwrap();
    let report = running.load(longer).unwrap();
    assert!(!report.kept && report.pipelines == 0, "the shaders are the same: {report:?}");
    assert_eq!(report.changed.len(), 1, "one pass more: {report:?}");
    running.frame();
    let expected = (1..=32).map(|first: u32| (0..3).fold(first, |x, _| 3 * x + 1)).collect::<Vec<_>>();
    assert_eq!(running.read("p4.out"), expected);
}

/// An executor on a device with shared pipelines makes none that one before it has made, though that one is gone, and renders
/// the same.
#[test]
fn an_executor_takes_the_pipelines_of_one_before() {
    let Some(gpu) = gpu() else { return };
    let gpu = gpu.with_shared_pipelines();
    let (kinds, passes, outputs) = chain(3);
    let workshop = Workshop::new(kinds, CHAIN);
    let run = |gpu: executor::Gpu| {
        let mut running = Running(executor::Executor::new(gpu));
        let report = running.load(workshop.link(&passes, &outputs).unwrap()).unwrap();
        running.frame();
        (report.pipelines, running.read("p3.out"))
    };
    let (made, first) = run(gpu.clone());
    assert!(made > 0, "a set of its own begins empty");
    assert_eq!(run(gpu.clone()), (0, first.clone()));
    assert_eq!(run(gpu.with_shared_pipelines()), (made, first), "another set");
}
