//! Virtual lights at points on surfaces.

use interfaces::{surface_points, virtual_lights};
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, Setting, Settings, Threads, UseContext, input, output,
};

/// The pass type `lights-from-points`.
pub const PASS: &dyn Pass = &LightsFromPoints;

/// Lights of points whose radiosity and density are known.
#[derive(Debug)]
pub struct LightsFromPoints;

const SHADER: &str = "passes/lights-from-points/lights-from-points.wgsl";

impl Pass for LightsFromPoints {
    fn info(&self) -> Info {
        Info {
            kind: "lights-from-points",
            about: "Makes virtual lights of points on surfaces, by their radiosity and density.",
            paper: "SMC-IR Eq. 6",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(Vec::new())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("points", "SurfacePoints", "Where the lights are."),
                input("radiosity", "Radiosity", "What leaves the surface there."),
                input("density", "Density", "How densely the points lie."),
            ],
            outputs: vec![output(
                "lights",
                "VirtualLights",
                "A light for each point; dark where there is none.",
            )],
            ..Ports::default()
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let count = cx.fact("points", surface_points::COUNT)?;
        Ok(vec![
            virtual_lights::output(use_cx, "lights", count)?,
            OutputDesc::scratch("present", ResourceDesc::buffer(4)),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let count = cx.fact("points", surface_points::COUNT)?;
        let step =
            |entry, length: u32| Compute::new(cx.shader(SHADER, &[]), entry, Threads::Row(length.max(1)));
        Ok(Recording::one(step("count_points", 1)).then(step("make_lights", count)))
    }
}
