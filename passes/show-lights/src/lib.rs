//! Shows where virtual lights lie on the surfaces in view.

use interfaces::virtual_lights;
use pass::{
    Compute, Define, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, input,
    optional, output, setting,
};

/// The pass type `show-lights`.
pub const PASS: &dyn Pass = &ShowLights;

/// A picture of the places of virtual lights.
#[derive(Debug)]
pub struct ShowLights;

const SHADER: &str = "passes/show-lights/show-lights.wgsl";

impl Pass for ShowLights {
    fn info(&self) -> Info {
        Info {
            kind: "show-lights",
            about: "Shows where virtual lights lie on the surfaces in view, over what they light.",
            paper: "",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        setting::of_shader(cx.shaders, SHADER)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("lights", "VirtualLights", "The lights, whose places get a dot each."),
                input("view", "GBuffer", "The surfaces to show them on."),
                optional(
                    "irradiance",
                    "Irradiance",
                    "What is shown under the dots in false colours; else grey.",
                ),
            ],
            outputs: vec![output("display", "Display", "Dots over false colours.")],
            scene_bindings: SceneBindings::CAMERA,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let display = ResourceDesc::texture_2d(Format::Rgba8Unorm, Extent::like("view"));
        let pixels = u64::from(cx.frame.0) * u64::from(cx.frame.1);
        Ok(vec![
            OutputDesc::one("display", display),
            OutputDesc::scratch("nearest", ResourceDesc::buffer(4 * pixels)),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let size = cx.size("display");
        let lights = cx.fact("lights", virtual_lights::COUNT)?;
        let shader = cx.shader(SHADER, &[("IRRADIANCE", Define::Bool(cx.connected("irradiance")))]);
        let row = |entry, length| Compute::new(shader.clone(), entry, Threads::Row(length));
        Ok(Recording::one(row("clear", size.0 * size.1))
            .then(row("place", lights.max(1)))
            .then(Compute::per_texel(shader.clone(), "show", size)))
    }
}
