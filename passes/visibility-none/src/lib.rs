//! Visibility 1 for every virtual light from everywhere.

use pass::{
    Info, Module, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    SceneBindings, Setting, Settings, UseContext,
};

/// The pass type `visibility-none`.
pub const PASS: &dyn Pass = &VisibilityNone;

/// Visibility without shadows: the baseline for the others, and exact in a scene without occluders.
pub struct VisibilityNone;

impl Pass for VisibilityNone {
    fn info(&self) -> Info {
        Info {
            kind: "visibility-none",
            about: "Declares every virtual light visible from everywhere.",
            paper: "",
            shaders: &["shaders/visibility-none.wgsl"],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(Vec::new())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![pass::optional(
                "lights",
                "VirtualLights",
                "Not read: here so that the pass type takes the place of one that renders maps of them.",
            )],
            outputs: vec![pass::output("visibility", "Visibility", "Only the module that returns 1.")],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, _: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        Ok(vec![OutputDesc::of("visibility", Vec::new()).module(Module::new("shaders/visibility-none.wgsl"))])
    }

    fn record(&self, _: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::default())
    }
}
