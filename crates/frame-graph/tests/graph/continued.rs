//! Outputs that begin as the content of an input.

use super::handed::{plan, plan_with};
use frame_graph::plan::{Begins, HistoryId, Plan};
use frame_graph::{Change, CompileOptions, FrameState};

const STATE: &str = r#"
    "noise": Pass(kind: "noise"),
    "state": Pass(kind: "fullscreen", shader: "go-on.wgsl", in: { "i0": "noise", "own": Prev(port: "state", reset: [Cut]) }),
"#;

fn begins(plan: &Plan, pass: &str) -> Begins {
    plan.passes[plan.pass(pass).unwrap().0 as usize].continues[0].from
}

/// Where nobody else reads the past, one object holds both, and nothing is copied.
#[test]
fn a_past_that_one_pass_writes_on_in_is_one_object() {
    let plan = plan(STATE, r#""a": "state""#);
    assert_eq!(begins(&plan, "state"), Begins::InPlace(HistoryId(0)));
    let history = &plan.histories[0];
    assert!(history.in_place && history.copies[0] == history.copies[1]);
    let bytes = plan.resources[history.resource.0 as usize].desc.bytes();
    assert_eq!(plan.memory.persistent, bytes);
    assert!(plan.to_text().contains("continues state.out as its own past, in place"));
    // The version is new in every frame: it is made of the one before.
    let mut state = FrameState::new(&plan);
    for _ in 0..3 {
        assert!(state.begin(&plan, &Change::default()).runs.iter().all(|run| *run));
    }
}

/// Where another pass reads it too, the past stays whole, and a copy is written on in.
#[test]
fn a_past_that_others_read_is_copied() {
    let with = |pass: &str| plan(&format!("{STATE} {pass}"), r#""a": "state", "b": "other""#);
    let other = with(
        r#""other": Pass(kind: "fullscreen", shader: "a.wgsl", in: { "i0": Prev(port: "state", reset: [Cut]) })"#,
    );
    assert_eq!(begins(&other, "state"), Begins::CopyOfPast(HistoryId(0)));
    assert!(!other.histories[0].in_place && other.histories[0].copies[0] != other.histories[0].copies[1]);
    // Of this frame's state there may be any number of readers.
    let now = with(r#""other": Pass(kind: "fullscreen", shader: "a.wgsl", in: { "i0": "state" })"#);
    assert_eq!(begins(&now, "state"), Begins::InPlace(HistoryId(0)));
    // A reader that is culled is none.
    let text = format!(
        r#"{STATE} "other": Pass(kind: "fullscreen", shader: "a.wgsl", in: {{ "i0": Prev(port: "state", reset: [Cut]) }})"#
    );
    assert_eq!(begins(&plan(&text, r#""a": "state""#), "state"), Begins::InPlace(HistoryId(0)));
}

/// What is continued may be of another pass, of this frame or the last.
#[test]
fn what_another_pass_made_is_copied() {
    let passes = r#"
        "noise": Pass(kind: "noise"),
        "now": Pass(kind: "fullscreen", shader: "go-on.wgsl", in: { "own": "noise" }),
        "then": Pass(kind: "fullscreen", shader: "go-on.wgsl", in: { "own": Prev(port: "noise") }),
    "#;
    let plan = plan(passes, r#""a": "now", "b": "then""#);
    assert_eq!(begins(&plan, "now"), Begins::Copy(plan.resource("noise.irradiance").unwrap()));
    assert_eq!(begins(&plan, "then"), Begins::CopyOfPast(HistoryId(0)));
    assert_eq!(plan.to_json()["passes"][1]["continues"][0]["in_place"], false);
}

#[test]
fn what_is_continued_has_the_same_shape() {
    let passes = r#""half": Pass(kind: "fullscreen", shader: "go-on.wgsl", in: { "own": Prev(port: "noise") }, out: { "out": Out(size: "frame / 2") }),
        "noise": Pass(kind: "noise")"#;
    let error = plan_with(passes, r#""a": "half""#, &CompileOptions::default()).unwrap_err();
    assert_eq!(error.0[0].code, "E035");
    assert!(error.to_string().contains("continues its input `own`"), "{error}");
}
