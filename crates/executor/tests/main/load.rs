//! Loading a plan in place of another: what goes on, what runs again, and how much is held.

use crate::harness::{Running, TestPass, Workshop, every_frame, gpu, shader, texture, words};
use executor::{Executor, ExecutorError, FrameOptions};
use frame_graph::ResetCause;
use pass::{Compute, Extent, Format, OutputDesc, ResourceDesc, Step, Threads};

const POISON: FrameOptions = FrameOptions { timed: false, monitored: false, poison: Some(FrameOptions::NAN) };

fn one(path: &str) -> Vec<Step> {
    vec![Step::Compute(Compute::new(shader(path), "main", Threads::Grid([1; 3])))]
}

const SHADERS: &[(&str, &str)] = &[
    (
        "count.wgsl",
        "struct Settings { step: u32, past_age: u32, past_reset: u32 }
         var<uniform> settings: Settings;
         var<storage, read> past: array<u32>;
         var<storage, read_write> sum: array<u32>;
         @compute @workgroup_size(1) fn main() {
             sum[0] = past[0] + settings.step;
             sum[1] = settings.past_age;
             sum[2] = settings.past_reset;
             sum[3] = 0u;
         }",
    ),
    (
        "scale.wgsl",
        "struct Settings { factor: u32 }
         var<uniform> settings: Settings;
         var<storage, read> shown: array<u32>;
         var<storage, read_write> out: array<u32>;
         @compute @workgroup_size(1) fn main() { out[0] = shown[0] * settings.factor; }",
    ),
    (
        "write-on.wgsl",
        "var<storage, read_write> state: array<u32>;
         @compute @workgroup_size(1) fn main() {
             state[0] += 1u;
             state[state[0]] = 7u;
         }",
    ),
];

/// A counter that remembers, and what shows it.
fn counter() -> Workshop {
    let count = TestPass::new("count").optional("past", "Buffer").number("step", 1, u32::MAX);
    let count = every_frame(count.output(OutputDesc::one("sum", words(4)))).steps(|_| one("count.wgsl"));
    let scale = TestPass::new("scale").optional("shown", "Buffer").number("factor", 1, u32::MAX);
    let scale = scale.output(OutputDesc::one("out", words(4))).steps(|_| one("scale.wgsl"));
    let sized = TestPass::new("sized").output(OutputDesc::one("image", texture(Format::Rgba32Float)));
    Workshop::new(vec![count, scale, sized], SHADERS)
}

fn passes(step: u32, factor: u32) -> String {
    format!(
        r#""count": Pass(kind: "count", in: {{ "past": "prev count" }}, set: {{ "step": {step} }}, history: (reset: [Reload])),
        "scale": Pass(kind: "scale", in: {{ "shown": "count" }}, set: {{ "factor": {factor} }})"#
    )
}

const OUTPUTS: &str = r#""out": "scale", "sum": "count""#;

fn load(workshop: &Workshop, running: &mut Running, passes: &str, outputs: &str) -> executor::LoadReport {
    let linked = workshop.link(passes, outputs).unwrap_or_else(|error| panic!("{error}"));
    running.load(linked).unwrap_or_else(|error| panic!("{error}"))
}

/// A value that the past does not follow from ends nothing and makes nothing again; one that it follows from ends it,
/// and the shader gets the cause.
#[test]
fn a_value_keeps_what_does_not_follow_from_it() {
    let workshop = counter();
    let Some(mut running) = workshop.start(&passes(1, 1), OUTPUTS) else { return };
    for _ in 0..3 {
        running.frame();
    }
    assert_eq!((running.read("scale.out")[0], running.read("count.sum")), (3, vec![3, 2, 0, 0]));
    let report = load(&workshop, &mut running, &passes(1, 10), OUTPUTS);
    assert!(report.kept, "{report:?}");
    assert_eq!((report.pipelines, report.steps, report.histories, report.changed.len()), (0, 0, 1, 1));
    running.frame();
    assert_eq!((running.read("scale.out")[0], running.read("count.sum")), (40, vec![4, 3, 0, 0]));
    let report = load(&workshop, &mut running, &passes(2, 10), OUTPUTS);
    assert_eq!((report.kept, report.steps), (true, 0));
    running.frame();
    assert_eq!((running.read("scale.out")[0], running.read("count.sum")), (20, vec![2, 0, 5, 0]));
}

/// Further passes, other outputs, other sizes: what is sized by none of it goes on, and no more is held than the
/// larger plan takes.
#[test]
fn another_structure_keeps_pasts_and_holds_one_generation() {
    let mut workshop = counter();
    let Some(mut running) = workshop.start(&passes(1, 1), OUTPUTS) else { return };
    running.frame_of_all(POISON);
    running.frame();
    let more = format!(r#"{}, "more": Pass(kind: "sized")"#, passes(1, 1));
    let outputs = format!(r#"{OUTPUTS}, "more": "more""#);
    workshop.frame = (64, 64);
    let report = load(&workshop, &mut running, &more, &outputs);
    assert_eq!((report.kept, report.histories), (false, 1));
    assert_eq!(running.read("count.sum"), [2, 1, 0, 0], "the newest version is what is read before a frame");
    running.frame_of_all(POISON);
    assert_eq!(running.read("count.sum"), [3, 2, 0, 0]);
    // Two objects of the counter, one that it is shown by, one picture.
    let held = |pixels: u64| 3 * 16 + pixels * 16;
    assert_eq!(running.0.held_bytes(), held(64 * 64));
    for frame in [(96, 64), (16, 16), (97, 64)] {
        workshop.frame = frame;
        load(&workshop, &mut running, &more, &outputs);
        running.frame();
        assert_eq!(running.0.held_bytes(), held(u64::from(frame.0) * u64::from(frame.1)));
    }
    assert_eq!(running.0.most_held_bytes(), held(97 * 64), "no two generations are held at once");
    assert_eq!(running.read("count.sum"), [6, 5, 0, 0]);
    // An event that its link does not name ends nothing.
    running.frame_after(ResetCause::Resize);
    assert_eq!(running.read("count.sum"), [7, 6, 0, 0]);
}

/// A plan that does not fit leaves the plan before as it was.
#[test]
fn a_plan_beyond_the_limits_changes_nothing() {
    let workshop = counter();
    let Some(mut running) = workshop.start(&passes(1, 1), OUTPUTS) else { return };
    running.frame();
    let before = running.0.held_bytes();
    let huge = TestPass::new("huge").output(OutputDesc::one(
        "out",
        ResourceDesc::texture_2d(Format::Rgba8Unorm, Extent::Fixed(32_768, 1)),
    ));
    let linked = Workshop::new(vec![huge], &[]).link(r#""huge": Pass(kind: "huge")"#, r#""out": "huge""#);
    let Err(error) = running.load(linked.unwrap_or_else(|error| panic!("{error}"))) else {
        return; // An adapter that takes it.
    };
    assert!(matches!(error, ExecutorError::Limit { .. }), "{error}");
    assert_eq!(running.0.held_bytes(), before);
    running.frame();
    assert_eq!(running.read("count.sum"), [2, 1, 0, 0]);
}

/// A plan that needs more memory than there is leaves the plan before: made again where its objects had been given back, so that
/// a past that the refused plan has goes on, and one that it has not begins again.
#[test]
fn a_plan_beyond_the_memory_restores_the_one_before() {
    let workshop = || {
        // 256 GiB, of a size that adapters allow.
        let layers = ResourceDesc::texture_2d_array(Format::Rgba32Float, Extent::Fixed(16_384, 16_384), 64);
        let huge = TestPass::new("huge").output(OutputDesc::one("out", layers));
        counter().with(huge)
    };
    let huge = r#""huge": Pass(kind: "huge")"#;
    let with_past = format!("{}, {huge}", passes(1, 1));
    for (refused, outputs, age) in
        [(&*with_past, r#""out": "huge", "sum": "count""#, 2), (huge, r#""out": "huge""#, 0)]
    {
        // The driver itself is asked.
        let Some(gpu) = gpu().map(|gpu| gpu.with_memory(u64::MAX)) else { return };
        let mut running = workshop().start_on(gpu, &passes(1, 1), OUTPUTS);
        running.frame();
        running.frame();
        let before = running.0.held_bytes();
        let linked = workshop().link(refused, outputs).unwrap_or_else(|error| panic!("{error}"));
        let Err(error) = running.load(linked) else {
            return; // An adapter that gives memory when it is written.
        };
        if matches!(error, ExecutorError::Limit { .. }) {
            return; // An adapter with smaller textures.
        }
        assert!(matches!(error, ExecutorError::OutOfMemory { .. }), "{error}");
        assert_eq!(running.0.held_bytes(), before);
        assert_eq!(running.frame_with_poison().ran, [true; 2], "objects that were made again hold nothing");
        let reset = if age == 0 { 5 } else { 0 };
        assert_eq!(running.read("count.sum"), [age + 1, age, reset, 0]);
        assert_eq!(running.read("scale.out")[0], age + 1);
        running.frame();
        assert_eq!(running.read("count.sum"), [age + 2, age + 1, 0, 0]);
    }
}

/// A pass type `state` that writes one more word of what it continues in each frame, and a pass type `scale` that reads it.
fn continuing() -> Workshop {
    let state = OutputDesc::one("state", words(8)).continuing("past");
    let write_on = every_frame(TestPass::new("state").optional("past", "Buffer").output(state));
    let write_on = write_on.steps(|_| one("write-on.wgsl"));
    let scale = TestPass::new("scale").optional("shown", "Buffer").number("factor", 1, u32::MAX);
    let scale = scale.output(OutputDesc::one("out", words(4))).steps(|_| one("scale.wgsl"));
    Workshop::new(vec![write_on, scale], SHADERS)
}

/// State that is written on in: in one object where nobody else reads its past, by a copy where somebody does; the
/// same either way, poisoned or not, and it begins as zero.
#[test]
fn state_is_continued_in_place_and_by_a_copy() {
    let workshop = continuing();
    let own = r#""state": Pass(kind: "state", in: { "past": "prev state" }, history: (reset: [Cut]))"#;
    let other = r#", "other": Pass(kind: "scale", in: { "shown": "prev state" })"#;
    for (other, output, objects) in [("", "", 1), (other, r#", "other": "other""#, 2)] {
        let (passes, outputs) = (format!("{own}{other}"), format!(r#""state": "state"{output}"#));
        let Some(mut running) = workshop.start(&passes, &outputs) else { return };
        let plan = running.0.plan().unwrap();
        let copies = plan.histories[0].copies;
        assert_eq!(if copies[0] == copies[1] { 1 } else { 2 }, objects);
        running.frame();
        running.frame_with_poison();
        running.frame();
        assert_eq!(running.read("state.state"), [3, 7, 7, 7, 0, 0, 0, 0]);
        running.frame_after(ResetCause::Cut);
        assert_eq!(running.read("state.state"), [1, 7, 0, 0, 0, 0, 0, 0]);
        running.frame();
        assert_eq!(running.read("state.state"), [2, 7, 7, 0, 0, 0, 0, 0]);
    }
}

/// From one object to two and back, the content goes on.
#[test]
fn state_goes_on_where_it_gets_another_reader() {
    let workshop = continuing();
    let own = r#""state": Pass(kind: "state", in: { "past": "prev state" })"#;
    let both = format!(r#"{own}, "other": Pass(kind: "scale", in: {{ "shown": "prev state" }})"#);
    let Some(mut running) = workshop.start(own, r#""state": "state""#) else { return };
    running.frame();
    load(&workshop, &mut running, &both, r#""state": "state", "other": "other""#);
    running.frame();
    running.frame();
    assert_eq!((running.read("state.state")[0], running.read("other.out")[0]), (3, 2));
    load(&workshop, &mut running, own, r#""state": "state""#);
    running.frame();
    assert_eq!(running.read("state.state"), [4, 7, 7, 7, 7, 0, 0, 0]);
}

/// A pass that only hands on has no steps and does not run; its readers read what was handed on.
#[test]
fn what_is_handed_on_is_the_resource_itself() {
    let count = TestPass::new("count").optional("past", "Buffer").number("step", 1, u32::MAX);
    let count = every_frame(count.output(OutputDesc::one("sum", words(4)))).steps(|_| one("count.wgsl"));
    let scale = TestPass::new("scale").optional("shown", "Buffer").number("factor", 1, u32::MAX);
    let scale = scale.output(OutputDesc::one("out", words(4))).steps(|_| one("scale.wgsl"));
    let relay = TestPass::new("relay")
        .optional("shown", "Buffer")
        .output_of("Buffer", OutputDesc::hand_on("seen", "shown"));
    let workshop = Workshop::new(vec![count, scale, relay], SHADERS);
    let passes = r#"
        "count": Pass(kind: "count", in: { "past": "prev second" }),
        "first": Pass(kind: "relay", in: { "shown": "count" }),
        "second": Pass(kind: "relay", in: { "shown": "first" }),
        "scale": Pass(kind: "scale", in: { "shown": "second" }, set: { "factor": 5 }),
    "#;
    let Some(mut running) = workshop.start(passes, r#""out": "scale", "seen": "second""#) else { return };
    running.frame();
    let report = running.frame_with_poison();
    assert_eq!(report.ran, [true, false, false, true]);
    assert_eq!((running.read("scale.out")[0], running.read("second.seen")[0]), (10, 2));
    assert_eq!(running.id("first.seen"), running.id("count.sum"));
}

#[test]
fn a_plan_larger_than_the_memory_is_refused_before_anything_is_created() {
    let Some(gpu) = gpu() else { return };
    let fill =
        "var<storage, read_write> out: array<u32>; @compute @workgroup_size(1) fn main() { out[0] = 1u; }";
    let of = |kind: &'static str, bytes| {
        let output = OutputDesc::one("out", ResourceDesc::buffer(bytes)).cleared();
        TestPass::new(kind).output(output).steps(|_| one("fill.wgsl"))
    };
    let workshop = Workshop::new(vec![of("small", 1024), of("large", 1 << 20)], &[("fill.wgsl", fill)]);
    let both = || {
        workshop
            .link(r#""a": Pass(kind: "small"), "b": Pass(kind: "large")"#, r#""a": "a", "b": "b""#)
            .unwrap()
    };
    let mut running = Running(Executor::new(gpu.clone().with_memory(1 << 20)));
    let refused = running.load(both()).unwrap_err().to_string();
    let words =
        "the pipeline needs 1.0 MiB, and the adapter has 1.0 MiB; its largest resource, b.out, needs 1.0 MiB";
    assert_eq!(refused, words);
    assert_eq!(running.0.most_held_bytes(), 0);
    running.0 = Executor::new(gpu.with_memory((1 << 20) + 1024));
    running.load(both()).unwrap();
}
