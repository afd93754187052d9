//! How densely points lie on surfaces, by the areas of their Voronoi cells.

use interfaces::{areas, density, surface_points};
use pass::{
    Compute, Define, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, Value, input, optional, output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &VoronoiAreas;

/// See the crate.
#[derive(Debug)]
pub struct VoronoiAreas;

const SHADER: &str = "passes/voronoi-areas/voronoi-areas.wgsl";

pass::settings! {
    /// The settings of the pass type `voronoi-areas`.
    pub struct VoronoiAreasSettings {
        /// The most frames that an area is the mean of. More: areas are smoother, but follow later where points come and go
        /// around, and where others are seen.
        frames: u32 = 32, min: 1, max: 4096;
    }
}

impl Pass for VoronoiAreas {
    fn info(&self) -> Info {
        Info {
            kind: "voronoi-areas",
            about: "Estimates how densely points lie on surfaces, by the area of their Voronoi cells.",
            paper: "",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(VoronoiAreasSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("points", "SurfacePoints", "The points that have a density."),
                input("samples", "SurfacePoints", "Samples of the surfaces on which the points lie."),
                input("sample_density", "Density", "How densely these lie."),
                input("owners", "Owners", "The point that is nearest to each of them."),
                optional(
                    "past",
                    "Areas",
                    "`areas` of the frame before: with it, areas are averaged over frames.",
                ),
            ],
            outputs: vec![
                output("density", "Density", "Density of each point; 0 where that is empty."),
                output("areas", "Areas", "What each point stands for, for the next frame."),
            ],
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let count = cx.fact("points", surface_points::COUNT)?;
        Ok(vec![
            density::output("density", count),
            areas::output(use_cx, "areas", count)?,
            OutputDesc::scratch("present", ResourceDesc::buffer(8)),
            OutputDesc::scratch("sums", ResourceDesc::buffer(8 * u64::from(count.max(1)))),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let points = cx.fact("points", surface_points::COUNT)?;
        let samples = cx.fact("samples", surface_points::COUNT)?;
        let shader = cx.shader(SHADER, &[("PAST", Define::Bool(cx.connected("past")))]);
        let step = |entry, length: u32| {
            Compute::new(shader.clone(), entry, Threads::Row(length.max(1)))
                .value("samples_count", Value::U32(samples))
        };
        Ok(Recording::of([
            step("count", 1),
            step("clear", points),
            step("share", samples),
            step("settle", points),
        ]))
    }
}
