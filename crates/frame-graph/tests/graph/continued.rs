//! Outputs that begin as the content of an input.

use super::handed::{plan, plan_with};
use frame_graph::plan::{Begins, HistoryId, Plan};
use frame_graph::{Change, CompileOptions, FrameState, ResetCause, SceneBindings};

const STATE: &str = r#"
    "noise": Pass(kind: "noise"),
    "state": Pass(kind: "fullscreen", shader: "go-on.wgsl", in: { "i0": "noise", "own": "prev state" }, history: (reset: [Cut])),
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
    let other = with(r#""other": Pass(kind: "fullscreen", shader: "a.wgsl", in: { "i0": "prev state" })"#);
    assert_eq!(begins(&other, "state"), Begins::CopyOfPast(HistoryId(0)));
    assert!(!other.histories[0].in_place && other.histories[0].copies[0] != other.histories[0].copies[1]);
    // Of this frame's state there may be any number of readers.
    let now = with(r#""other": Pass(kind: "fullscreen", shader: "a.wgsl", in: { "i0": "state" })"#);
    assert_eq!(begins(&now, "state"), Begins::InPlace(HistoryId(0)));
    // A reader that is culled is none.
    let text = format!(
        r#"{STATE} "other": Pass(kind: "fullscreen", shader: "a.wgsl", in: {{ "i0": "prev state" }})"#
    );
    assert_eq!(begins(&plan(&text, r#""a": "state""#), "state"), Begins::InPlace(HistoryId(0)));
}

/// What is continued may be of another pass, of this frame or the last.
#[test]
fn what_another_pass_made_is_copied() {
    let passes = r#"
        "noise": Pass(kind: "noise"),
        "now": Pass(kind: "fullscreen", shader: "go-on.wgsl", in: { "own": "noise" }),
        "then": Pass(kind: "fullscreen", shader: "go-on.wgsl", in: { "own": "prev noise" }),
    "#;
    let plan = plan(passes, r#""a": "now", "b": "then""#);
    assert_eq!(begins(&plan, "now"), Begins::Copy(plan.resource("noise.irradiance").unwrap()));
    assert_eq!(begins(&plan, "then"), Begins::CopyOfPast(HistoryId(0)));
    assert_eq!(plan.to_json()["passes"][1]["continues"][0]["in_place"], false);
}

#[test]
fn what_is_continued_has_the_same_shape() {
    let passes = r#""half": Pass(kind: "fullscreen", shader: "go-on.wgsl", in: { "own": "prev noise" }, out: { "out": Out(size: "frame / 2") }),
        "noise": Pass(kind: "noise")"#;
    let error = plan_with(passes, r#""a": "half""#, &CompileOptions::default()).unwrap_err();
    assert_eq!(error.0[0].code, "E035");
    assert!(error.to_string().contains("continues its input `own`"), "{error}");
}

/// A loop rests once nothing else has changed for long enough, and goes on with the next change.
#[test]
fn a_loop_rests_while_nothing_changes() {
    let policy = "reset: [Cut], rest: 3, catches_up: true";
    let passes = STATE.replace("reset: [Cut]", policy).replace("\"noise\")", "\"gbuffer\")");
    let plan = plan(&passes, r#""a": "state""#);
    assert_eq!(begins(&plan, "state"), Begins::CopyOfPast(HistoryId(0)), "what it was made of is kept");
    let text = plan.to_text();
    assert!(
        text.contains("reset by Cut; rests after 3 still frames; waits while a picture settles"),
        "{text}"
    );
    assert_eq!(plan.to_json()["histories"][0]["catches_up"], true);
    let mut state = FrameState::new(&plan);
    let mut run = |change: &Change| {
        let schedule = state.begin(&plan, change);
        let slot = schedule.histories[0];
        (schedule.runs.clone(), slot.age, slot.current)
    };
    let nothing = Change::default();
    let frames: Vec<_> = (0..7).map(|_| run(&nothing)).collect();
    let stateful: Vec<bool> = frames.iter().map(|(runs, ..)| runs[1]).collect();
    assert_eq!(stateful, [true, true, true, true, false, false, false]);
    assert_eq!(frames[3].1, 3);
    assert_eq!((frames[4].1, frames[6].2), (3, frames[3].2), "neither its age nor its content goes on");
    // Run once more, it writes what it wrote: over the same copy, out of the same past.
    let again = run(&Change { all: true, ..Change::default() });
    assert_eq!(again, (vec![true; 2], 3, frames[3].2));
    assert!(!run(&nothing).0[1]);
    let feeds = plan.pass("noise").unwrap();
    let changed = run(&Change { again: vec![feeds], ..Change::default() });
    assert_eq!((changed.0, changed.1), (vec![true; 2], 4));
    assert_ne!(changed.2, frames[3].2);
    assert!(run(&nothing).0[1]);
}

/// What waits runs when it may, with all that has happened in between; its history buffer is as it left it.
#[test]
fn what_waits_runs_later() {
    let passes = STATE.replace("\"noise\")", "\"gbuffer\")");
    let plan = plan(&passes, r#""a": "state", "b": "noise""#);
    let mut state = FrameState::new(&plan);
    let mut run = |change: &Change| {
        let schedule = state.begin(&plan, change);
        (schedule.runs.clone(), schedule.histories[0])
    };
    let only = plan.feeding("b");
    assert_eq!(only, [true, false]);
    let waiting = Change { only, ..Change::default() };
    let (runs, slot) = run(&waiting);
    assert_eq!((runs, slot.reset), (vec![true, false], None), "at first, all would run");
    let (runs, slot) = run(&Change::default());
    assert_eq!((runs, slot.reset), (vec![false, true], Some(ResetCause::FirstFrame)));
    let cut = Change { events: vec![ResetCause::Cut], ..waiting.clone() };
    let (runs, waited) = run(&cut);
    assert_eq!((runs, waited.reset, waited.current), (vec![false; 2], None, slot.current));
    run(&waiting);
    let (runs, after) = run(&Change::default());
    assert_eq!((runs, after.reset, after.age), (vec![false, true], Some(ResetCause::Cut), 0));
    assert_eq!(run(&Change::default()).1.reset, None, "once");
}

/// Frames that are samples of one picture go on until all that keeps them rests; a seed that is set once is news.
#[test]
fn samples_end_where_all_rests() {
    let passes = STATE.replace("reset: [Cut]", "reset: [Cut], rest: 3").replace("\"noise\")", "\"gbuffer\")");
    let plan = plan(&passes, r#""a": "state""#);
    let (mut state, reseeded) = (FrameState::new(&plan), vec![plan.pass("noise").unwrap()]);
    let mut run = |change: &Change| state.begin(&plan, change).runs.clone();
    let sample = Change { resampled: SceneBindings::CAMERA, reseeded: reseeded.clone(), ..Change::default() };
    let frames: Vec<_> = (0..6).map(|_| run(&sample)).collect();
    assert!(frames[..4].iter().all(|runs| *runs == [true, true]), "{frames:?}");
    assert!(frames[4..].iter().all(|runs| *runs == [false, false]), "{frames:?}");
    let moved = Change { scene_bindings: SceneBindings::CAMERA, ..sample.clone() };
    assert_eq!(run(&moved), [true, true]);
    assert_eq!(run(&sample), [true, true], "it goes on for as many frames again");
    let still: Vec<_> = (0..4).map(|_| run(&sample)).collect();
    assert_eq!(still[3], [false, false]);
    assert_eq!(run(&Change { reseeded, ..Change::default() }), [true, true]);
}

/// Runs a plan until it rests; returns its state, and what runs in a frame for which the passes of these names are to run again.
fn at_rest(plan: &Plan) -> impl FnMut(&[&str]) -> Vec<bool> {
    let mut state = FrameState::new(plan);
    let mut run = move |again: &[&str]| {
        let again = again.iter().map(|name| plan.pass(name).unwrap()).collect();
        state.begin(plan, &Change { again, ..Change::default() }).runs.clone()
    };
    (0..8).for_each(|_| drop(run(&[])));
    assert!(run(&[]).iter().all(|runs| !runs));
    run
}

/// What runs at rest reads what it read before: the newest is still new to it.
#[test]
fn what_runs_at_rest_has_not_seen_the_newest() {
    let passes = r#"
        "view": Pass(kind: "gbuffer"),
        "state": Pass(kind: "fullscreen", shader: "go-on.wgsl", in: { "i0": "view", "own": "prev state" }, history: (reset: [Cut], rest: 2)),
        "late": Pass(kind: "fullscreen", shader: "a.wgsl", in: { "i0": "prev state" })"#;
    let plan = plan(passes, r#""a": "state", "b": "late""#);
    let mut run = at_rest(&plan);
    let late = plan.pass("late").unwrap().0 as usize;
    assert!(run(&["late"])[late]);
    assert!(run(&["view"])[late], "the loop goes on, and what was its newest is the past");
}

/// What is fed by the past of something wakes a frame later than that.
#[test]
fn what_follows_from_a_past_wakes_with_it() {
    let passes = r#"
        "view": Pass(kind: "gbuffer"),
        "second": Pass(kind: "fullscreen", shader: "a.wgsl", in: { "i0": "prev view" }, history: (rest: 2)),
        "third": Pass(kind: "fullscreen", shader: "a.wgsl", in: { "i0": "prev second" })"#;
    let plan = plan(passes, r#""a": "view", "b": "third""#);
    let mut run = at_rest(&plan);
    let at = |name: &str| plan.pass(name).unwrap().0 as usize;
    assert!(run(&["view"])[at("view")]);
    assert!(run(&[])[at("second")]);
    assert!(run(&[])[at("third")]);
    assert!(run(&[]).iter().all(|runs| !runs));
}
