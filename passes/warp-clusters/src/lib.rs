#![doc = include_str!("../README.md")]

use interfaces::clusters;
use pass::{
    Compute, OutputContext, OutputDesc, Pass, PassTypeError, RecordContext, Recording, ResourceDesc, Struct,
    Threads, UseContext, reflected,
};

/// The pass type `warp-clusters`.
pub const PASS: &dyn Pass = &WarpClusters;

struct WarpClusters;

const SCALED: Struct = Struct::new("shaders/algorithms/scaled.wgsl", "Scaled");

/// Returns the level of the pyramid at which one square covers a layer of this size; 1 or more.
fn top((width, height): (u32, u32)) -> u32 {
    width.max(height).next_power_of_two().ilog2().max(1)
}

/// Returns columns and rows of a level.
fn size_at((width, height): (u32, u32), level: u32) -> (u32, u32) {
    (width.div_ceil(1 << level), height.div_ceil(1 << level))
}

impl Pass for WarpClusters {
    fn kind(&self) -> &'static str {
        "warp-clusters"
    }

    fn files(&self) -> pass::Files {
        pass::files!()
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let rsm = cx.input("rsm").and_then(|rsm| rsm.member("flux")?.texture());
        let (size, layers) = rsm.map_or(((1, 1), 1), |rsm| (rsm.size, rsm.layers));
        let squares: u64 = (1..=top(size))
            .map(|level| size_at(size, level))
            .map(|(columns, rows)| u64::from(columns) * u64::from(rows) * u64::from(layers))
            .sum();
        let pyramid = ResourceDesc::buffer(squares * use_cx.size_of(SCALED)?);
        let mut outputs = reflected::outputs(use_cx, &self.main_shader(&cx.use_)?, cx)?;
        outputs.push(OutputDesc::scratch("pyramid", pyramid));
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let (size, layers) = (cx.size("rsm"), cx.layers("rsm"));
        let shader = cx.file("warp-clusters.wgsl");
        let step = |entry, threads, level| Compute::new(shader.clone(), entry, threads).value("level", level);
        let sums = (1..=top(size)).map(|level| {
            let (columns, rows) = size_at(size, level);
            step("sum", Threads::Grid([columns, rows, layers]), level)
        });
        let count = cx.fact("clusters", clusters::COUNT)?;
        Ok(Recording::of(sums).then(step("warp", Threads::Row(count), top(size))))
    }
}
