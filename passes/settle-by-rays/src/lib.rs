#![doc = include_str!("../README.md")]

use pass::{OutputDesc, Outputs, PassTypeError, Value};

pass::from_wgsl!(outputs);

/// The lookups say which of them take a ray, so that readers can trace rays one after the other.
fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let deferring = |output: OutputDesc| match output.facts.module().cloned() {
        Some(module) => output.module(module.option("DEFERS", Value::Bool(true))),
        None => output,
    };
    Ok(cx.declared()?.into_iter().map(deferring).collect())
}
