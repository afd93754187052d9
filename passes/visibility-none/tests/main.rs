//! The module that it names answers what a consumer asks.

#[test]
fn it_names_a_module_and_makes_nothing() {
    let outputs = pass_test::outputs_of(visibility_none::PASS, &[], &[], &[]).expect("it never refuses");
    let [visibility] = &outputs[..] else { panic!("one output: {outputs:?}") };
    assert!(visibility.members.is_empty(), "there is no atlas");
    let Some(module) = visibility.facts.module() else { panic!("no module: {visibility:?}") };
    let request = pass::request("passes/gather/gather.wgsl", &[("VISIBILITY", pass::Define::Bool(true))]);
    let request = request.module("visibility", &module.path);
    let shader = pass_test::shaders().load(&request).unwrap_or_else(|error| panic!("{error}"));
    let atlas = shader.interface.globals.iter().any(|global| global.name == "visibility_atlas");
    assert!(!atlas, "the module binds nothing");
}
