//! How often pass types are asked what they make.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use frame_graph::port::{OutputContext, OutputDesc, PassTypes, Use};
use frame_graph::{
    CompileOptions, Interface, LinkContext, Overrides, PassTypeError, Plan, Ports, Setting, Settings,
    compile, link, resolve,
};
use std::cell::Cell;
use std::fmt::Write as _;
use std::sync::Arc;

/// Counts the questions about outputs.
struct Counting(TestPassTypes, Cell<u32>);

impl PassTypes for Counting {
    fn names(&self) -> Vec<String> {
        self.0.names()
    }

    fn interfaces(&self) -> &[Interface] {
        self.0.interfaces()
    }

    fn takes_shader(&self, kind: &str) -> Option<bool> {
        self.0.takes_shader(kind)
    }

    fn settings(&self, use_: Use<'_>) -> Result<Arc<[Setting]>, PassTypeError> {
        self.0.settings(use_)
    }

    fn ports(&self, use_: Use<'_>, settings: &Settings) -> Result<Arc<Ports>, PassTypeError> {
        self.0.ports(use_, settings)
    }

    fn outputs(&self, context: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        self.1.set(self.1.get() + 1);
        self.0.outputs(context)
    }
}

/// Two chains of like blurs, one of them of small pictures; and how often pass types are asked.
fn chains(length: u32) -> (Plan, u32) {
    let mut text = String::from(
        r#"Pipeline(passes: {
"large-0": Pass(kind: "noise"),
"small-0": Pass(kind: "fullscreen", shader: "small.wgsl", out: { "out": (interface: "Irradiance", size: (8, 4)) }),
"#,
    );
    for i in 1..=length {
        for chain in ["large", "small"] {
            let before = i - 1;
            let _ = writeln!(
                text,
                r#""{chain}-{i}": Pass(kind: "blur", in: {{ "irradiance": "{chain}-{before}" }}),"#
            );
        }
    }
    let _ = write!(text, r#"}}, outputs: {{ "large": "large-{length}", "small": "small-{length}" }})"#);
    let resolved = resolve("chains.ron", &MemoryFiles::new(&[("chains.ron", &text)]), &Overrides::default());
    let kinds = Counting(TestPassTypes::new(), Cell::new(0));
    let context = LinkContext { frame: (64, 32), traits: traits() };
    let graph = link(&resolved.unwrap(), &kinds, &context).unwrap_or_else(|e| panic!("{e}"));
    (compile(&graph, &CompileOptions::default()).unwrap(), kinds.1.get())
}

#[test]
fn like_passes_are_asked_about_once_and_those_of_other_inputs_again() {
    let (_, few) = chains(4);
    let (plan, many) = chains(40);
    assert_eq!(many, few);
    for resource in &plan.resources {
        let small = resource.name.starts_with("small");
        let size = resource.desc.texture().unwrap().size;
        assert_eq!(size, if small { (8, 4) } else { (64, 32) }, "{}", resource.name);
    }
}
