//! The module that it names answers what a consumer asks.

use pass::{OutputContext, Settings, Use, UseContext};
use pass_test::shaders;
use std::collections::BTreeMap;

#[test]
fn it_names_a_module_and_makes_nothing() {
    let (library, overrides) = (shaders(), BTreeMap::new());
    let use_ = Use { kind: "visibility-none", shader: None, inputs: &[], outputs: &overrides };
    let outputs = visibility_none::PASS
        .outputs(
            &UseContext { use_, shaders: &library, interfaces: interfaces::INTERFACES },
            &OutputContext {
                use_,
                settings: &Settings::default(),
                inputs: &[],
                frame: (8, 8),
                traits: &pass::Traits::default(),
            },
        )
        .expect("it never refuses");
    let [visibility] = &outputs[..] else { panic!("one output: {outputs:?}") };
    assert!(visibility.members.is_empty(), "there is no atlas");
    let Some(module) = visibility.facts.module() else { panic!("no module: {visibility:?}") };
    let request = pass::request("passes/gather/gather.wgsl", &[("VISIBILITY", pass::Define::Bool(true))]);
    let request = request.module("visibility", &module.path);
    let shader = library.load(&request).unwrap_or_else(|error| panic!("{error}"));
    let atlas = shader.interface.globals.iter().any(|global| global.name == "visibility_atlas");
    assert!(!atlas, "the module binds nothing");
}
