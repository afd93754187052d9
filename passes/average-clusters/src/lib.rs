#![doc = include_str!("../README.md")]

use gpu_algorithms::reduce;
use interfaces::{cluster_map, clusters};
use pass::{
    Compute, OutputContext, OutputDesc, Pass, PassTypeError, RecordContext, Recording, Threads, UseContext,
    most_items, reflected,
};

/// The pass type `average-clusters`.
pub const PASS: &dyn Pass = &AverageClusters;

struct AverageClusters;

const MAIN: &str = "average-clusters.wgsl";

/// The threads that share a cluster: `GROUP_SIZE` of shaders/algorithms/workgroup.wgsl.
const GROUP_SIZE: u32 = 256;

/// The most texels of a window. Its threads loop over them twice.
const MOST_TEXELS: u32 = most_items(2) * GROUP_SIZE;

/// Bytes of the `vec4<f32>` that the flux of the map is summed in.
const SUM_BYTES: u64 = 16;

impl Pass for AverageClusters {
    fn kind(&self) -> &'static str {
        "average-clusters"
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
        let rsm = cx.input("rsm").and_then(|rsm| rsm.member("flux")?.texture());
        let rsm = rsm.ok_or_else(|| PassTypeError::input("rsm", "expected a member `flux`"))?;
        let window = cx.fact("map", cluster_map::WINDOW).unwrap_or(0);
        let side = |of_map: u32| if window == 0 { of_map } else { window.min(of_map) };
        let (width, height) = (side(rsm.size.0), side(rsm.size.1));
        if u64::from(width) * u64::from(height) > u64::from(MOST_TEXELS) {
            let message = format!("a window of {width}×{height} texels is more than a workgroup averages");
            return Err(PassTypeError::input("map", message).help(format!(
                "set `window` of map-clusters to at most {}, or take a smaller reflective shadow map",
                MOST_TEXELS.isqrt()
            )));
        }
        let texels = rsm.size.0 * rsm.size.1 * rsm.layers;
        outputs.push(reduce::scratch(use_cx, "flux_sums", texels, SUM_BYTES)?);
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let count = cx.fact("clusters", clusters::COUNT)?;
        let step = |entry, threads| Compute::new(cx.file(MAIN), entry, threads);
        let ((width, height), layers) = (cx.size("rsm"), cx.layers("rsm"));
        let shader = cx.file("map-flux.wgsl");
        let flux = reduce::steps(&cx.use_context(), &shader, width * height * layers, "flux_sums")?;
        Ok(Recording::one(step("enclose", Threads::Grid([width, height, layers])))
            .then(step("average", Threads::Row(count * GROUP_SIZE)))
            .then(step("summarise", Threads::Row(1)))
            .then_all(flux))
    }
}
