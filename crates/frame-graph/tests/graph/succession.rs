//! What goes on where one plan takes the place of another.

use super::kinds::{MemoryFiles, TestPassTypes, traits, value};
use frame_graph::plan::{HistoryId, Plan};
use frame_graph::{
    Change, CompileOptions, FrameState, LinkContext, Overrides, ResetCause, Succession, compile, link,
    resolve,
};

/// A loop that accumulates what lights make, and what shows it.
const LOOP: &str = r#"Pipeline(passes: {
    "view": Pass(kind: "gbuffer"),
    "lights": Pass(kind: "lights", in: { "view": "view" }),
    "gather": Pass(kind: "gather", in: { "view": "view", "lights": "lights" }),
    "shown": Pass(kind: "composite", in: { "indirect": "gather" }),
    "sum": Pass(kind: "accumulate", in: { "color": "shown.image", "history": "prev sum" }),
    "image": Pass(kind: "blur", in: { "irradiance": "noise" }),
    "noise": Pass(kind: "noise"),
    "fixed": Pass(kind: "fullscreen", shader: "go-on.wgsl", in: { "own": "prev fixed" }, out: { "out": Out(size: (4, 4)) }, history: (reset: [Reload])),
}, outputs: { "sum": "sum", "image": "image", "fixed": "fixed" })"#;

fn plan_of(text: &str, set: &[(&str, &str)], frame: (u32, u32), options: &CompileOptions) -> Plan {
    let set = set.iter().map(|(path, text)| ((*path).to_owned(), value(text))).collect();
    let files = MemoryFiles::new(&[("p.ron", text)]);
    let resolved = resolve("p.ron", &files, &Overrides(set)).unwrap_or_else(|e| panic!("{e}"));
    let graph = link(&resolved, &TestPassTypes::new(), &LinkContext { frame, traits: traits() });
    compile(&graph.unwrap_or_else(|e| panic!("{e}")), options).unwrap_or_else(|e| panic!("{e}"))
}

fn plan(set: &[(&str, &str)]) -> Plan {
    plan_of(LOOP, set, (64, 64), &CompileOptions::default())
}

/// The name of the resource of a history.
fn name(plan: &Plan, history: usize) -> &str {
    &plan.resources[plan.histories[history].resource.0 as usize].name
}

fn changed(plan: &Plan, succession: &Succession) -> Vec<String> {
    succession.changed.iter().map(|id| plan.passes[id.0 as usize].name.to_string()).collect()
}

/// Runs three frames of `old`, then one of `new`: for each history of `new`, its age and why it ended.
fn after(old: &Plan, new: &Plan, events: &[ResetCause]) -> Vec<(String, u32, Option<ResetCause>)> {
    let mut state = FrameState::new(old);
    for _ in 0..3 {
        state.begin(old, &Change::default());
    }
    let succession = Succession::between(old, new);
    let mut next = state.succeed(new, &succession);
    let change = Change { passes: succession.changed.clone(), events: events.to_vec(), ..Change::default() };
    let schedule = next.begin(new, &change);
    assert!(schedule.runs.iter().all(|run| *run), "nothing is held but pasts");
    let slots = schedule.histories.iter().enumerate();
    slots.map(|(h, slot)| (name(new, h).to_owned(), slot.age, slot.reset)).collect()
}

fn found(list: &[(&str, u32, Option<ResetCause>)]) -> Vec<(String, u32, Option<ResetCause>)> {
    list.iter().map(|(name, age, reset)| ((*name).to_owned(), *age, *reset)).collect()
}

/// A value gives a plan another name, and the same structure; what it ends are the pasts that follow from it.
#[test]
fn a_value_ends_only_the_pasts_that_follow_from_it() {
    let base = plan(&[]);
    let radius = plan(&[("image.radius", "2.0")]);
    assert_ne!(base.id, radius.id);
    assert_eq!(base.structure, radius.structure);
    let succession = Succession::between(&base, &radius);
    assert_eq!(changed(&radius, &succession), ["image"]);
    assert_eq!(succession.histories, [Ok(HistoryId(0)), Ok(HistoryId(1))]);
    assert_eq!(after(&base, &radius, &[]), found(&[("sum.color", 3, None), ("fixed.out", 3, None)]));
    // What feeds the loop, at whatever distance.
    let reload = Some(ResetCause::Reload);
    for set in [("shown.exposure", "1.0"), ("lights.mode", "importance")] {
        let other = plan(&[set]);
        assert_eq!(base.structure, other.structure);
        assert_eq!(after(&base, &other, &[]), found(&[("sum.color", 0, reload), ("fixed.out", 3, None)]));
    }
    // The same in a plan that goes on: without another plan in between.
    let mut state = FrameState::new(&base);
    state.begin(&base, &Change::default());
    let reported = |pass: &str| Change { passes: vec![base.pass(pass).unwrap()], ..Change::default() };
    assert_eq!(state.begin(&base, &reported("image")).histories[0].reset, None);
    assert_eq!(state.begin(&base, &reported("lights")).histories[0].reset, reload);
    assert_eq!(
        state.begin(&base, &Change { again: reported("lights").passes, ..Change::default() }).histories[0]
            .reset,
        None
    );
    // A value that is set between frames ends only what says so.
    let set = |pass: &str| Change { values: reported(pass).passes, ..Change::default() };
    let schedule = state.begin(&base, &set("lights"));
    assert_eq!(schedule.histories[0].reset, None);
    assert!(schedule.runs[base.pass("lights").unwrap().0 as usize]);
    let asks = LOOP.replace("\"prev sum\" }", "\"prev sum\" }, history: (reset: [Setting])");
    let asks = plan_of(&asks, &[], (64, 64), &CompileOptions::default());
    let mut state = FrameState::new(&asks);
    state.begin(&asks, &Change::default());
    assert_eq!(state.begin(&asks, &reported("lights")).histories[0].reset, None);
    assert_eq!(state.begin(&asks, &set("image")).histories[0].reset, None);
    assert_eq!(state.begin(&asks, &set("lights")).histories[0].reset, Some(ResetCause::Setting));
}

/// A frame of another size ends what is sized by it, with the cause that is true; the rest goes on, unless it asks
/// for the event.
#[test]
fn a_resize_ends_what_has_another_size() {
    let base = plan(&[]);
    let larger = plan_of(LOOP, &[], (65, 64), &CompileOptions::default());
    assert_ne!(base.structure, larger.structure);
    assert_eq!(changed(&larger, &Succession::between(&base, &larger)), Vec::<String>::new());
    let expected = [("sum.color", 0, Some(ResetCause::Resize)), ("fixed.out", 3, None)];
    assert_eq!(after(&base, &larger, &[ResetCause::Resize]), found(&expected));
    let asks = LOOP.replace("reset: [Reload]", "reset: [Reload, Resize]");
    let both = plan_of(&asks, &[], (65, 64), &CompileOptions::default());
    let resize = Some(ResetCause::Resize);
    let expected = [("sum.color", 0, resize), ("fixed.out", 0, resize)];
    assert_eq!(after(&base, &both, &[ResetCause::Resize]), found(&expected));
}

/// Kept resources, further passes and further readers of a past end nothing.
#[test]
fn what_else_is_in_a_plan_ends_no_past() {
    let base = plan(&[]);
    let keep = CompileOptions { keep: vec!["gather".into()], ..CompileOptions::default() };
    let kept = plan_of(LOOP, &[], (64, 64), &keep);
    assert_ne!(base.structure, kept.structure);
    let both = [("sum.color", 3, None), ("fixed.out", 3, None)];
    assert_eq!(after(&base, &kept, &[]), found(&both));
    let more = LOOP.replace("outputs: {", r#"outputs: { "more": "more","#).replace(
        r#""noise": "#,
        r#""more": Pass(kind: "accumulate", in: { "color": "fixed.out", "history": "prev fixed" }), "noise": "#,
    );
    let more = plan_of(&more, &[], (64, 64), &CompileOptions::default());
    let fixed = |plan: &Plan| (0..plan.histories.len()).find(|h| name(plan, *h) == "fixed.out").unwrap();
    // One object before, two now.
    assert!(base.histories[fixed(&base)].in_place && !more.histories[fixed(&more)].in_place);
    assert_eq!(after(&base, &more, &[])[fixed(&more)], ("fixed.out".to_owned(), 3, None));
    // And back, to a plan without the loop, and from there: then it is new.
    assert_eq!(after(&more, &base, &[])[fixed(&base)], ("fixed.out".to_owned(), 3, None));
    let without = LOOP.replace(r#", "sum": "sum""#, "").replace(r#""sum": "sum", "#, "");
    let without = plan_of(&without, &[], (64, 64), &CompileOptions::default());
    assert_eq!(after(&base, &without, &[]), found(&[("fixed.out", 3, None)]));
    let reload = Some(ResetCause::Reload);
    assert_eq!(after(&without, &base, &[])[0], ("sum.color".to_owned(), 0, reload));
    // Another scene may bring another plan: then that is the cause.
    let scene = Some(ResetCause::Scene);
    assert_eq!(after(&without, &base, &[ResetCause::Scene])[0], ("sum.color".to_owned(), 0, scene));
}

/// Another link into what feeds a past is a change; so is another pass type, another format.
#[test]
fn links_and_kinds_are_part_of_what_a_past_is() {
    let base = plan(&[]);
    let reload = Some(ResetCause::Reload);
    for (from, to) in [
        (r#""color": "shown.image""#, r#""color": "image""#),
        (
            r#"kind: "composite", in: { "indirect": "gather" }"#,
            r#"kind: "composite", in: { "indirect": "noise" }"#,
        ),
    ] {
        assert!(LOOP.contains(from), "{from}");
        let other = plan_of(&LOOP.replace(from, to), &[], (64, 64), &CompileOptions::default());
        assert_eq!(after(&base, &other, &[])[0], ("sum.color".to_owned(), 0, reload), "{to}");
    }
}

/// Before the first frame of all, that is the cause, whatever was loaded before.
#[test]
fn the_first_frame_is_the_first_frame() {
    let base = plan(&[]);
    let larger = plan_of(LOOP, &[], (65, 64), &CompileOptions::default());
    let mut state = FrameState::new(&base).succeed(&larger, &Succession::between(&base, &larger));
    let schedule = state.begin(&larger, &Change::default());
    assert!(schedule.histories.iter().all(|slot| slot.reset == Some(ResetCause::FirstFrame)));
}
