//! Virtual lights sampled uniformly from the texels of a reflective shadow map.

pub mod cpu_reference;

use interfaces::virtual_lights;
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    SceneBindings, Setting, Settings, Threads, UseContext, input, output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &SampleUniform;

/// See the crate.
pub struct SampleUniform;

pass::settings! {
    /// The settings of the pass type `sample-uniform`.
    pub struct SampleUniformSettings {
        /// Number N of virtual lights. Error falls as N^-½; the time for shadows and gathering rises with N.
        count: u32 = 1024, min: 1, max: 2_097_152;
    }
}

impl Pass for SampleUniform {
    fn info(&self) -> Info {
        Info {
            kind: "sample-uniform",
            about: "Samples virtual lights uniformly from the texels of a reflective shadow map.",
            paper: "TCAS §6.2",
            shaders: &["passes/sample-uniform/sample-uniform.wgsl"],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(SampleUniformSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![input("rsm", "ReflectiveShadowMap", "The texels to sample.")],
            outputs: vec![output("lights", "VirtualLights", "N lights; those from empty texels are dark.")],
            scene_bindings: SceneBindings::LIGHTS,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let count = SampleUniformSettings::read(cx.settings).count;
        Ok(vec![virtual_lights::output(use_cx, "lights", count)?])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let shader = cx.shader("passes/sample-uniform/sample-uniform.wgsl", &[]);
        let count = SampleUniformSettings::read(cx.settings).count;
        Ok(Recording::one(Compute::new(shader, "sample", Threads::Row(count))))
    }
}
