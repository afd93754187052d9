//! Visibility of virtual lights by one ray to each of them.

use interfaces::visibility;
use pass::{
    Info, Module, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    SceneBindings, Setting, Settings, UseContext, Value, setting,
};

/// The pass type `visibility-ray-traced`.
pub const PASS: &dyn Pass = &VisibilityRayTraced;

/// Exact visibility: what shadow maps are compared with.
#[derive(Debug)]
pub struct VisibilityRayTraced;

const MODULE: &str = "shaders/visibility-ray-traced.wgsl";

/// The option of the module that selects how rays are traced; in lower case, the name of the setting.
const RAYS: &str = "RAYS";

/// Loop iterations of a ray, for consumers that must limit those of one dispatch. Threads that run together
/// all take as many as the longest of them: groups of eight rays through 10⁵ triangles took up to this many.
const LOOP_ITERATIONS: u32 = 400;

impl Pass for VisibilityRayTraced {
    fn info(&self) -> Info {
        Info {
            kind: "visibility-ray-traced",
            about: "Computes the visibility of each virtual light with a ray: exact.",
            paper: "SMC-IR §5.4",
            shaders: &[MODULE],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        setting::of_options(cx.shaders, MODULE, &[RAYS])
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![pass::optional(
                "lights",
                "VirtualLights",
                "Not read: here so that the pass type takes the place of one that renders maps of them.",
            )],
            outputs: vec![pass::output("visibility", "Visibility", "Only the module that traces a ray.")],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let masked = cx.traits.0.get("masked").and_then(Value::as_bool).unwrap_or(false);
        let module = Module::new(MODULE)
            .option(RAYS, setting::value_of_option(cx.settings, RAYS))
            .option("MASKED", Value::Bool(masked));
        Ok(vec![
            OutputDesc::of("visibility", Vec::new())
                .module(module)
                .fact(visibility::LOOP_ITERATIONS, LOOP_ITERATIONS),
        ])
    }

    fn record(&self, _: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::default())
    }
}
