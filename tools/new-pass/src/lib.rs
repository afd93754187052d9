//! Radiance times a gain: one dispatch over a texture.

use pass::{
    Compute, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext,
    Recording, ResourceDesc, SceneBindings, Setting, Settings, UseContext, input, output, setting,
};

pub mod cpu_reference;

/// The pass.
pub const PASS: &dyn Pass = &NewPass;

/// Radiance times a gain.
#[derive(Debug)]
pub struct NewPass;

const SHADER: &str = "tools/new-pass/new-pass.wgsl";

impl Pass for NewPass {
    fn info(&self) -> Info {
        Info { kind: "new-pass", about: "Radiance times a gain.", paper: "", shaders: &[SHADER] }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        setting::of_shader(cx.shaders, SHADER)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![input("radiance", "Radiance", "What is multiplied.")],
            outputs: vec![output("image", "Radiance", "The product.")],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, _: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let image = ResourceDesc::texture_2d(Format::Rgba32Float, Extent::like("radiance"));
        Ok(vec![OutputDesc::one("image", image)])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::one(Compute::per_texel(cx.shader(SHADER, &[]), "scale", cx.size("image"))))
    }
}
