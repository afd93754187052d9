//! The module that it names answers what a consumer asks, and takes the options that go with it.

use pass::{Facts, Name, PortDesc, RecordContext, Settings, Use};
use pass_test::shaders;
use std::collections::BTreeMap;
use std::sync::Arc;

fn facts(masked: bool) -> Facts {
    let (settings, traits) = ([("rays", "bvh".into())], [("masked", masked.into())]);
    let outputs = pass_test::outputs_of(visibility_ray_traced::PASS, &settings, &[], &traits);
    let outputs = outputs.expect("it never refuses");
    let [visibility] = &outputs[..] else { panic!("one output: {outputs:?}") };
    assert!(visibility.members.is_empty(), "there is no atlas");
    visibility.facts.clone()
}

/// The shader of a consumer whose input has these facts.
#[test]
fn a_consumer_traces_rays() {
    for masked in [false, true] {
        let library = shaders();
        let input = PortDesc {
            name: Name::from("visibility"),
            interface: Name::from("Visibility"),
            members: Vec::new(),
            facts: Arc::new(facts(masked)),
            connected: true,
            past: false,
        };
        let (overrides, settings, traits) = (BTreeMap::new(), Settings::default(), pass::Traits::default());
        let context = RecordContext {
            main: None,
            name: "gather",
            use_: Use { kind: "gather", shader: None, inputs: &[], outputs: &overrides },
            settings: &settings,
            inputs: std::slice::from_ref(&input),
            outputs: &[],
            frame: (8, 8),
            traits: &traits,
            shaders: &library,
            interfaces: interfaces::INTERFACES,
        };
        let consumer = "passes/gather/gather.wgsl";
        let request = context.shader(consumer, &[("VISIBILITY", pass::Define::Bool(true))]);
        assert_eq!(request.defines.get("MASKED"), Some(&pass::Define::Bool(masked)));
        let shader = library.load(&request).unwrap_or_else(|error| panic!("{error}"));
        assert!(shader.interface.globals.iter().any(|global| global.name == "scene_bvh"));
        // What does not import the module is not asked to take its options.
        let other = context.shader(consumer, &[("VISIBILITY", pass::Define::Bool(false))]);
        assert_eq!(other.defines.get("MASKED"), None);
        library.load(&other).unwrap_or_else(|error| panic!("{error}"));
    }
}
