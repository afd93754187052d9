//! Outputs of passes as they are described, without a GPU.

use frame_graph::port::InputDesc;
use pass::{
    Facts, Module, OutputContext, OutputDesc, Pass, PassTypeError, ResourceDesc, Settings, Traits, Use,
    UseContext, Value,
};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Describes the outputs of a pass in a frame of 8², with these settings, inputs and traits of the scene.
///
/// # Errors
/// What the pass refuses.
pub fn outputs_of(
    pass: &dyn Pass,
    settings: &[(&str, Value)],
    inputs: &[InputDesc],
    traits: &[(&str, Value)],
) -> Result<Vec<OutputDesc>, PassTypeError> {
    let named = |values: &[(&str, Value)]| {
        values.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
    };
    let (settings, traits) = (Settings(named(settings)), Traits::new(named(traits)));
    let linked: Vec<String> = inputs.iter().map(|input| input.name.to_string()).collect();
    let use_ = Use { kind: pass.kind(), shader: None, inputs: &linked, outputs: &BTreeMap::new() };
    let shaders = crate::shaders();
    let context = OutputContext { use_, settings: &settings, inputs, frame: (8, 8), traits: &traits };
    pass.outputs(&UseContext { use_, shaders: &shaders, interfaces: interfaces::INTERFACES }, &context)
}

/// Describes an input `maps` of the interface `Visibility`.
pub fn maps(
    members: &[&str],
    member: &ResourceDesc,
    facts: &[(&'static str, Value)],
    module: Option<Module>,
) -> InputDesc {
    let mut facts: Facts = facts.iter().cloned().collect();
    if let Some(module) = module {
        facts.set_module(module);
    }
    InputDesc {
        name: "maps".into(),
        interface: "Visibility".into(),
        members: members.iter().map(|name| ((*name).to_owned(), member.clone())).collect(),
        facts: Arc::new(facts),
    }
}
