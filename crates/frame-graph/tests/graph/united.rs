//! Variants of a pipeline in one graph.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use super::whole::{BASE, SHADOWS};
use frame_graph::{
    CompileOptions, Graph, LinkContext, Overrides, PassChange, Plan, Resolved, Value, compile, link,
    name_in_united, original_name, resolve, unite,
};

fn base() -> Resolved {
    let files = MemoryFiles::new(&[("base.ron", BASE), ("parts/shadows.ron", SHADOWS)]);
    resolve("base.ron", &files, &Overrides::default()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The plan of one output of all variants.
fn united(variants: &[Resolved], output: &str) -> Plan {
    let context = LinkContext { frame: (64, 48), traits: traits() };
    let linked = |variant: &Resolved| link(variant, &TestPassTypes::new(), &context);
    let graphs: Vec<Graph> =
        variants.iter().map(|variant| linked(variant).unwrap_or_else(|errors| panic!("{errors}"))).collect();
    let outputs = (0..variants.len()).map(|variant| name_in_united(output, variant)).collect();
    let options = CompileOptions { outputs, ..CompileOptions::default() };
    compile(&unite(&graphs), &options).unwrap_or_else(|errors| panic!("{errors}"))
}

fn names(plan: &Plan) -> Vec<&str> {
    plan.passes.iter().map(|pass| pass.name.as_str()).collect()
}

fn feeding<'p>(plan: &'p Plan, output: &str) -> Vec<&'p str> {
    let feeding = plan.feeding(output);
    plan.passes.iter().zip(feeding).filter(|(_, feeds)| *feeds).map(|(pass, _)| pass.name.as_str()).collect()
}

fn set(name: &str, value: Value) -> PassChange {
    PassChange::Set(vec![(name.to_owned(), value)])
}

#[test]
fn what_is_equal_runs_once() {
    let own = base();
    let plan = united(&[own.clone(), own.clone()], "indirect");
    assert_eq!(names(&plan), ["view", "lights", "shadows/splat", "gather", "filter"]);
    let [first, second] = ["indirect", "indirect#1"].map(|name| &plan.output(name).unwrap().members);
    assert_eq!(first, second);
}

#[test]
fn what_differs_has_copies_and_so_has_all_that_reads_it() {
    let own = base();
    let change = set("count", Value::U32(512));
    let more = own.changed([("lights", &change)]);
    let plan = united(&[own, more], "indirect");
    assert_eq!(feeding(&plan, "indirect"), ["view", "lights", "shadows/splat", "gather", "filter"]);
    let copies = ["view", "lights#1", "shadows/splat#1", "gather#1", "filter#1"];
    let mut of_copy = feeding(&plan, "indirect#1");
    of_copy.sort_unstable();
    let mut expected = copies.to_vec();
    expected.sort_unstable();
    assert_eq!(of_copy, expected);
    assert_eq!(names(&plan).len(), 9);
    let count = |name: &str| plan.passes[plan.pass(name).unwrap().0 as usize].settings.get("count").cloned();
    assert_eq!(count("lights"), Some(Value::U32(256)));
    assert_eq!(count("lights#1"), Some(Value::U32(512)));
    assert!(copies.map(original_name).iter().all(|name| !name.contains('#')));
}

/// A pass that reads its own past is the same in two variants only if all is that it has ever read.
#[test]
fn loops_through_history_are_compared_too() {
    let own = base();
    assert_eq!(names(&united(&[own.clone(), own.clone()], "image")).len(), 7);
    let change = set("count", Value::U32(512));
    let more = own.changed([("lights", &change)]);
    let plan = united(&[own, more], "image");
    assert!(names(&plan).contains(&"steady#1"), "{:?}", names(&plan));
    assert_eq!(plan.histories.len(), 2);
}

#[test]
fn a_pass_is_replaced_or_left_out() {
    let own = base();
    let replaced = PassChange::Replace { kind: "noise".to_owned(), set: Vec::new() };
    let left_out = PassChange::LeaveOut { input: "irradiance".to_owned() };
    let without = own.changed([("filter", &left_out)]);
    let plan = united(&[own.clone(), without], "indirect");
    assert_eq!(feeding(&plan, "indirect#1"), ["view", "lights", "shadows/splat", "gather"]);
    let noisy = own.changed([("filter", &replaced)]);
    let plan = united(&[own.clone(), noisy], "indirect");
    let copy = plan.pass("filter#1").unwrap();
    assert_eq!(plan.passes[copy.0 as usize].kind, "noise");
    assert_eq!(feeding(&plan, "indirect#1"), ["filter#1"]);
    // What is no pass stays as it is.
    let same = own.changed([("shadows", &replaced), ("nothing", &left_out)]);
    assert_eq!(names(&united(&[own, same], "indirect")).len(), 5);
}
