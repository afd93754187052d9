#![doc = include_str!("../README.md")]

use gpu_algorithms::reduce;
use pass::{
    Compute, OutputContext, OutputDesc, Pass, PassTypeError, ReadSettings, RecordContext, Recording,
    ResourceDesc, UseContext, reflected,
};

/// The pass type `path-tracer`.
pub const PASS: &dyn Pass = &PathTracer;

struct PathTracer;

/// The most rays of a pixel in one dispatch, if a ray takes some hundreds of loop iterations.
const RAYS: u32 = pass::most_items(256);

impl Pass for PathTracer {
    fn kind(&self) -> &'static str {
        "path-tracer"
    }

    fn files(&self) -> pass::Files {
        pass::files!()
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let mut outputs = reflected::outputs(use_cx, &self.main_shader(&cx.use_)?, cx)?;
        outputs.push(reduce::scratch(use_cx, "estimate_sums", cx.frame.0 * cx.frame.1, 16)?);
        outputs.push(OutputDesc::scratch("luminance_sum", ResourceDesc::buffer(4)));
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let size = cx.size("samples");
        // A ray to each light, one to an emitter, one to the environment and one onwards, at each surface.
        let others = ["emissive", "environment"].map(|name| u32::from(cx.trait_bool(name)));
        let to_lights = cx.trait_u32("lights") + others.iter().sum::<u32>();
        let rays = (1 + to_lights) * (1 + cx.settings.u32("bounces")?);
        let at_once = cx.settings.u32("samples_per_frame")?.min((RAYS / rays).max(1));
        let paths = Compute::per_texel(cx.file("path-tracer.wgsl"), "trace_paths", size)
            .value("samples_per_frame", at_once)
            // An output that nothing reads is not worth a ray.
            .value("direct", u32::from(cx.connected("image") || cx.connected("direct")));
        let mut recording = Recording::one(paths);
        for sum in ["luminance", "error"] {
            let shader = cx.file("estimate.wgsl").define("SUM", sum);
            let steps = reduce::steps(&cx.use_context(), &shader, size.0 * size.1, "estimate_sums")?;
            recording =
                recording.then_all(steps.into_iter().map(|step| step.value("samples_per_frame", at_once)));
        }
        Ok(recording.then(Compute::per_texel(cx.file("mean.wgsl"), "mean", size)))
    }
}
