//! Direct light, shadowed by the maps that are rendered from the lights.

use pass::{
    Compute, Define, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, UseContext, input, output,
    setting,
};

pub mod cpu_reference;

/// The pass.
pub const PASS: &dyn Pass = &DirectLight;

/// Shades the G-buffer by every light of the scene.
#[derive(Debug)]
pub struct DirectLight;

const SHADER: &str = "passes/direct-light/direct-light.wgsl";

impl Pass for DirectLight {
    fn info(&self) -> Info {
        Info {
            kind: "direct-light",
            about: "Computes the direct light of all lights, with filtered shadows from the reflective shadow map.",
            paper: "percentage-closer filtering: Reeves, Salesin & Cook 1987",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        setting::of_shader(cx.shaders, SHADER)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("view", "GBuffer", "The surfaces to light."),
                input(
                    "rsm",
                    "ReflectiveShadowMap",
                    "What the lights see; its positions are the shadow maps.",
                ),
            ],
            outputs: vec![output("direct", "Radiance", "Direct light, reflected towards the camera.")],
            scene_bindings: SceneBindings::CAMERA.and(SceneBindings::LIGHTS).and(SceneBindings::SCENE),
        })
    }

    fn outputs(&self, _: &UseContext<'_>, _: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        Ok(vec![OutputDesc::one(
            "direct",
            ResourceDesc::texture_2d(Format::Rgba32Float, Extent::like("view")),
        )])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let shader = cx.shader(SHADER, &[("SPECULAR", Define::Bool(cx.has_member("view", "specular")))]);
        Ok(Recording::one(Compute::per_texel(shader, "direct_light", cx.size("direct"))))
    }
}
