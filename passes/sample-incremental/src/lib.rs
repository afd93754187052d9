//! Virtual lights that stay while their source lights them, and a few of which are placed anew in each frame.

use gpu_algorithms::reduce;
use interfaces::{surface_points, virtual_lights};
use pass::{
    Compute, Define, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Struct, Threads, UseContext, optional, output, setting,
};

/// The pass type `sample-incremental`.
pub const PASS: &dyn Pass = &SampleIncremental;

/// The lights of incremental instant radiosity.
#[derive(Debug)]
pub struct SampleIncremental;

const VERIFY: &str = "passes/sample-incremental/verify.wgsl";
const CELLS: &str = "passes/sample-incremental/cells.wgsl";
const RELAX: &str = "passes/sample-incremental/relax.wgsl";
const CHOOSE: &str = "passes/sample-incremental/choose.wgsl";
const COUNT: &str = "passes/sample-incremental/count.wgsl";
const EMIT: &str = "passes/sample-incremental/emit.wgsl";

/// A struct that the steps share.
const fn shared(name: &'static str) -> Struct {
    Struct::new("passes/sample-incremental/slots.wgsl", name)
}

pass::settings! {
    /// The settings of the pass type `sample-incremental` that are not options of its shaders.
    pub struct SampleIncrementalSettings {
        /// Number I of virtual lights. Error falls as I^-½; the time for shadows and gathering rises with I, that for cells
        /// with I².
        count: u32 = 2048, min: 1, max: 4096;
        /// The most lights that are placed in a frame; Laine et al. have 4 to 8. More: lights follow their source sooner, and
        /// flicker more.
        moved: u32 = 8, min: 1, max: 256;
        /// Directions for each light, by which cells are counted. More: fluxes follow the areas of cells more closely, and the
        /// time for cells grows.
        probes: u32 = 64, min: 1, max: 256;
    }
}

impl Pass for SampleIncremental {
    fn info(&self) -> Info {
        Info {
            kind: "sample-incremental",
            about: "Keeps virtual lights while their source lights them, and places a few anew where they are too far apart.",
            paper: "ACRSM §3.2.3, Laine et al. 2007",
            shaders: &[VERIFY, CELLS, RELAX, CHOOSE, COUNT, EMIT],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = SampleIncrementalSettings::schema();
        all.extend(setting::of_options(cx.shaders, EMIT, &["ALBEDO", "RAYS"])?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![optional(
                "past",
                "SurfacePoints",
                "`prev` of `points`: the lights of the frame before. Without it, all are placed in each frame.",
            )],
            outputs: vec![
                output("lights", "VirtualLights", "A light for each slot; dark where it is on no surface."),
                output(
                    "points",
                    "SurfacePoints",
                    "Where the lights are; marked and counted are those that are new in this frame.",
                ),
            ],
            scene_bindings: SceneBindings::SCENE.and(SceneBindings::LIGHTS),
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let settings = SampleIncrementalSettings::read(cx.settings);
        let (slots, probes) = (settings.count, settings.count * settings.probes);
        let words =
            |name: &str, count: u32| OutputDesc::scratch(name, ResourceDesc::buffer(4 * u64::from(count)));
        let structs =
            |name: &str, structure: &'static str, count: u32| -> Result<OutputDesc, PassTypeError> {
                Ok(OutputDesc::scratch(name, use_cx.buffer(shared(structure), u64::from(count))?))
            };
        Ok(vec![
            virtual_lights::output(use_cx, "lights", slots)?,
            surface_points::output(use_cx, "points", slots)?,
            structs("shares", "Share", slots)?,
            structs("sites", "Site", slots)?,
            structs("neighbours", "Nearest", slots)?,
            structs("cells", "Cell", slots)?.cleared(),
            words("waiting", slots),
            structs("probes", "Probe", probes)?,
            words("owners", probes),
            structs("choice", "Choice", 1)?,
            structs("hole", "Hole", 1)?,
            reduce::scratch(use_cx, "holes", probes, use_cx.size_of(shared("Hole"))?)?,
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = SampleIncrementalSettings::read(cx.settings);
        let (slots, probes) = (settings.count, settings.count * settings.probes);
        let of_scene = |define: &'static str, name: &str| (define, Define::Bool(cx.trait_bool(name)));
        let rays = [of_scene("TEXTURED", "textured"), of_scene("MASKED", "masked"), cx.option("RAYS")];
        let verifying = [&rays[..], &[("PAST", Define::Bool(cx.connected("past")))]].concat();
        let emitting = [&rays[..], &[cx.option("ALBEDO")]].concat();
        let step = |file, defines: &[_], entry, threads| {
            Compute::new(cx.shader(file, defines), entry, Threads::Row(threads))
        };
        let together = cx.use_context().constant(CELLS, "TOGETHER")?;
        let relax = reduce::steps(&cx.use_context(), &cx.shader(RELAX, &[]), probes, "holes")?;
        let mut recording = Recording::one(step(VERIFY, &verifying, "verify", slots))
            .then(step(CELLS, &[], "assign", probes.div_ceil(together)))
            .then(step(CELLS, &[], "separate", slots))
            .then(step(CHOOSE, &[], "begin", 1));
        for _ in 0..settings.moved.min(slots) {
            recording = recording.then_all(relax.clone()).then(step(CHOOSE, &[], "choose", 1));
        }
        Ok(recording.then(step(COUNT, &[], "count", probes)).then(step(EMIT, &emitting, "emit", slots)))
    }
}
