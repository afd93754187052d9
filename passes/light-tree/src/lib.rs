#![doc = include_str!("../README.md")]

use gpu_algorithms::{RadixSort, reduce};
use interfaces::{light_tree, virtual_lights};
use pass::{
    Compute, OutputDesc, Outputs, PassTypeError, RecordContext, Recording, ResourceDesc, Struct, Threads,
};

pass::from_wgsl!(outputs, record);

/// The lights that are in the tree, all together.
const SUMMARY: Struct = Struct::new("shaders/algorithms/summary.wgsl", "Summary");

/// Scratch of the reduction that makes the summary.
const SUMMARIES: &str = "summaries";

/// Returns the sort of this many lights along the curve.
fn sort(lights: u32) -> RadixSort<'static> {
    RadixSort {
        length: lights,
        count: Some("lights"),
        bits: 32,
        keys: "keys",
        values: None,
        sorted_keys: "keys",
        sorted_values: "order",
        scratch: "sort",
    }
}

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let lights = cx.fact("lights", virtual_lights::COUNT)?;
    let mut outputs = cx.declared_with(&[("leaves", light_tree::leaves(lights).into())])?;
    outputs.extend([
        reduce::scratch(&cx.use_cx, SUMMARIES, lights, cx.use_cx.size_of(SUMMARY)?)?,
        cx.scratch("summary", SUMMARY, 1)?,
        OutputDesc::scratch("order", ResourceDesc::buffer(4 * u64::from(lights.max(1)))),
    ]);
    outputs.extend(sort(lights).scratch(&cx.use_cx)?);
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let lights = cx.fact("lights", virtual_lights::COUNT)?;
    let leaves = light_tree::leaves(lights);
    let (use_cx, shader) = (cx.use_context(), cx.file("light-tree.wgsl"));
    // A step of a level of the tree, from the leaves on.
    let step = |entry, level: u32, threads: u32| {
        Compute::new(shader.clone(), entry, Threads::Row(threads)).value("level", level)
    };
    let levels =
        std::iter::successors(Some(leaves / 2), |level| Some(level / 2)).take_while(|level| *level > 0);
    Ok(Recording::of(reduce::steps(&use_cx, &cx.file("summary.wgsl"), lights, SUMMARIES)?)
        .then(step("place", leaves, lights.max(1)))
        .then_all(sort(lights).steps(&use_cx)?)
        .then(step("make_leaves", leaves, leaves))
        .then_all(levels.map(|level| step("make_level", level, level))))
}
