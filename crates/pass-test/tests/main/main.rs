//! The harness with small passes of its own: what it refuses, several frames, the past, the order of threads, and what was not written.

use pass::{Compute, OutputDesc, RecordContext, ResourceDesc, SceneBindings, Step, Threads};
use pass_test::{Harness, ResetCause, TestPass};
use std::sync::LazyLock;

const SHADER: &str = "crates/pass-test/tests/main/passes.wgsl";

/// Returns a pass of one entry point that writes one buffer, which is cleared first.
fn small(entry: &'static str, output: &str, bytes: u64, threads: [u32; 3]) -> TestPass {
    of_entry(entry, OutputDesc::one(output, ResourceDesc::buffer(bytes)).cleared(), threads)
}

/// Returns a pass of one entry point that writes one output.
fn of_entry(entry: &'static str, output: OutputDesc, threads: [u32; 3]) -> TestPass {
    let step = move |cx: &RecordContext<'_>| {
        vec![Step::Compute(Compute::new(cx.shader(SHADER, &[]), entry, Threads::Grid(threads)))]
    };
    TestPass::new("small").number("step", 1, 100).output(output).steps(step)
}

/// Reads a history buffer, and the frame.
static COUNT_ON: LazyLock<TestPass> = LazyLock::new(|| {
    small("count_on", "state", 16, [1, 1, 1]).input("past", "Buffer").reads(SceneBindings::FRAME)
});

/// `[sum, age, reset, index]` after the last frame.
fn counted(harness: Harness<'_>) -> Option<[u32; 4]> {
    Some(harness.run()?.read::<[u32; 4]>("state")[0])
}

fn state(sum: u32) -> Vec<(&'static str, ResourceDesc, Vec<u8>)> {
    vec![("", ResourceDesc::buffer(16), sum.to_le_bytes().to_vec())]
}

#[test]
fn what_a_pipeline_would_be_refused_for_is_refused() {
    let closed = || Harness::new(&*COUNT_ON).feedback("past", "state");
    let Some(range) = closed().set("step", 101).refusal() else { return };
    assert!(range.contains("at most 100"), "{range}");
    let name = closed().set("stepp", 1).refusal().unwrap();
    assert!(name.contains("did you mean `step`"), "{name}");
    let ty = closed().set("step", "one").refusal().unwrap();
    assert!(ty.contains("u32"), "{ty}");
    let unlinked = Harness::new(&*COUNT_ON).refusal().unwrap();
    assert!(unlinked.contains("past"), "{unlinked}");
    let texture = ResourceDesc::texture_2d(pass::Format::R32Float, (1, 1));
    let input = Harness::new(&*COUNT_ON).input("past", "Radiance", &[], vec![("", texture, Vec::new())]);
    let sort = input.refusal().unwrap();
    assert!(sort.contains("`small.past` takes a buffer, and this is a texture"), "{sort}");
}

#[test]
fn a_loop_goes_on_from_frame_to_frame() {
    let closed = || Harness::new(&*COUNT_ON).feedback("past", "state").set("step", 10);
    let Some(first) = counted(closed()) else { return };
    assert_eq!(first, [10, 0, 1, 0], "there is no past in the first frame");
    assert_eq!(counted(closed().frames(5).frame_index(7)), Some([50, 4, 0, 11]));
    assert_eq!(counted(closed().frames(5).event(3, ResetCause::Cut)), Some([20, 1, 0, 4]));
    assert_eq!(counted(closed().frames(4).event(3, ResetCause::Cut)), Some([10, 0, 3, 3]));
}

#[test]
fn a_past_has_the_age_it_is_given() {
    let Some(none) = counted(Harness::new(&*COUNT_ON).past("past", "Buffer", 0, state(100))) else { return };
    assert_eq!(none, [1, 0, 1, 0]);
    let old = Harness::new(&*COUNT_ON).past("past", "Buffer", 3, state(100));
    assert_eq!(counted(old), Some([101, 3, 0, 3]));
}

/// Every thread's work is done once, by whichever thread: the harness compares the two runs.
#[test]
fn another_order_of_threads_does_the_same_work() {
    let visit = small("visit", "visits", 4 * 40 * 12 * 6, [40, 12, 6]);
    let Some(outputs) = Harness::new(&visit).run() else { return };
    assert_eq!(outputs.read::<u32>("visits"), [1; 40 * 12 * 6]);
}

/// Set bits alone would be -1 to a sum.
#[test]
fn a_sum_that_begins_with_what_was_there_is_found() {
    let visits = OutputDesc::one("visits", ResourceDesc::buffer(4 * 40 * 12 * 6));
    let Some(found) = Harness::new(&of_entry("visit", visits, [40, 12, 6])).refusal() else { return };
    assert!(found.contains("or on what was not written"), "{found}");
    assert!(found.contains("0x5a5a5a5b"), "{found}");
}

#[test]
fn what_depends_on_the_order_of_threads_is_found() {
    let arrive = small("arrive", "arrivals", 16 + 4 * 256, [256, 1, 1]);
    let Some(found) = Harness::new(&arrive).refusal() else { return };
    assert!(found.starts_with("`small.arrivals` depends on the order of threads"), "{found}");
    let reason = "the list is not in order";
    let outputs = Harness::new(&arrive).depends_on_thread_order(reason).run().unwrap();
    let mut arrived = outputs.read::<u32>("arrivals")[1..257].to_vec();
    arrived.sort_unstable();
    assert!(arrived.into_iter().eq(0..256));
}
