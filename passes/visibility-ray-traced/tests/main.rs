//! The module that it names answers what a consumer asks, and takes the options that go with it.

use pass::{Facts, Name, OutputContext, PortDesc, RecordContext, Settings, Use, UseContext, Value};
use pass_test::shaders;
use std::collections::BTreeMap;
use std::sync::Arc;

fn facts(masked: bool) -> Facts {
    let (library, overrides) = (shaders(), BTreeMap::new());
    let use_ = Use { kind: "visibility-ray-traced", shader: None, inputs: &[], outputs: &overrides };
    let traits = pass::Traits(BTreeMap::from([("masked".to_owned(), Value::Bool(masked))]));
    let settings = Settings(BTreeMap::from([("rays".to_owned(), Value::Text("bvh".into()))]));
    let context = OutputContext { use_, settings: &settings, inputs: &[], frame: (8, 8), traits: &traits };
    let outputs = visibility_ray_traced::PASS
        .outputs(&UseContext { use_, shaders: &library, interfaces: interfaces::INTERFACES }, &context)
        .expect("it never refuses");
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
