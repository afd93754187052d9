//! Virtual lights sampled in proportion to an importance map by the inverse transform method.

pub mod cpu_reference;

use gpu_algorithms::segmented_scan;
use interfaces::{importance, virtual_lights};
use pass::setting;
use pass::{
    Compute, Define, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, Value,
    input, output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &SampleInverseTransform;

/// See the crate.
pub struct SampleInverseTransform;

const CUMULATE: &str = "passes/sample-inverse-transform/cumulate.wgsl";
const DRAW: &str = "passes/sample-inverse-transform/draw.wgsl";

pass::settings! {
    /// The settings of the pass type `sample-inverse-transform` that are not draw.wgsl's alone.
    pub struct SampleInverseTransformSettings {
        /// Number N of virtual lights. Error falls as N^-½; the time for shadows and gathering rises with N.
        count: u32 = 1024, min: 1, max: 2_097_152;
    }
}

impl Pass for SampleInverseTransform {
    fn info(&self) -> Info {
        Info {
            kind: "sample-inverse-transform",
            about: "Samples virtual lights in proportion to an importance map by the inverse transform method.",
            paper: "TCAS §4.2",
            shaders: &[CUMULATE, DRAW],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = SampleInverseTransformSettings::schema();
        all.extend(setting::of_shader(cx.shaders, DRAW)?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("rsm", "ReflectiveShadowMap", "The texels to sample."),
                input("importance", "Importance", "What the probability of a texel is proportional to."),
            ],
            outputs: vec![output(
                "lights",
                "VirtualLights",
                "N lights; none where the importance is 0 everywhere.",
            )],
            scene_bindings: SceneBindings::LIGHTS,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let count = SampleInverseTransformSettings::read(cx.settings).count;
        let ((_, height), layers) = importance::shape(cx)?;
        let cdf = |entries: u32| ResourceDesc::buffer(4 * u64::from(entries));
        let totals = |segments: u32| ResourceDesc::buffer(8 * u64::from(segments));
        Ok(vec![
            virtual_lights::output(use_cx, "lights", count)?,
            OutputDesc::scratch(
                "row_cdf",
                ResourceDesc::texture_2d_array(Format::R32Float, Extent::like("rsm"), layers),
            ),
            OutputDesc::scratch("row_totals", totals(height * layers)),
            OutputDesc::scratch("column_cdf", cdf(height * layers)),
            OutputDesc::scratch("layer_totals", totals(layers)),
            OutputDesc::scratch("layer_cdf", cdf(layers)),
            OutputDesc::scratch("total", totals(1)),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let (_, height) = cx.size("row_cdf");
        let layers = cx.layers("row_cdf");
        let cumulate = |rows| cx.shader(CUMULATE, &[("ROWS", Define::Bool(rows))]);
        let rows = segmented_scan(&cumulate(true), height, layers).bind("totals", "row_totals");
        let run = |length: u32, segments: u32| {
            segmented_scan(&cumulate(false), segments, 1).value("segment_length", Value::U32(length))
        };
        let columns = run(height, layers)
            .bind("parts", "row_totals")
            .bind("cdf", "column_cdf")
            .bind("totals", "layer_totals");
        let maps =
            run(layers, 1).bind("parts", "layer_totals").bind("cdf", "layer_cdf").bind("totals", "total");
        let count = SampleInverseTransformSettings::read(cx.settings).count;
        let draw = Compute::new(cx.shader(DRAW, &[]), "draw", Threads::Row(count));
        Ok(Recording::one(rows).then(columns).then(maps).then(draw))
    }
}
