//! Importance warping of the seeds of clusters.

pub mod cpu_reference;

use interfaces::{clusters, importance};
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, Setting, Settings, Struct, Threads, UseContext, Value, input, output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &WarpClusters;

/// See the crate.
#[derive(Debug)]
pub struct WarpClusters;

const SUM: &str = "passes/warp-clusters/sum.wgsl";
const WARP: &str = "passes/warp-clusters/warp.wgsl";

const SCALED: Struct = Struct::new("shaders/algorithms/scaled.wgsl", "Scaled");

pass::settings! {
    /// The settings of the pass type `warp-clusters`.
    pub struct WarpClustersSettings {
        /// Levels of the pyramid that a seed descends from the whole map; 0 is all, down to a texel. Within a square of the
        /// last of them seeds stay as even as they are. Fewer: seeds follow the importance less closely, and may fall to
        /// texels without any.
        levels: u32 = 0, min: 0, max: 15;
    }
}

/// Returns the level of the pyramid at which one square covers a layer of this size; 1 or more.
fn top((width, height): (u32, u32)) -> u32 {
    width.max(height).next_power_of_two().ilog2().max(1)
}

/// Returns columns and rows of a level.
fn size_at((width, height): (u32, u32), level: u32) -> (u32, u32) {
    (width.div_ceil(1 << level), height.div_ceil(1 << level))
}

impl Pass for WarpClusters {
    fn info(&self) -> Info {
        Info {
            kind: "warp-clusters",
            about: "Warps the seeds of clusters to where a reflective shadow map is important.",
            paper: "ACRSM §4.5, Alg. 5.3",
            shaders: &[SUM, WARP],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(WarpClustersSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("clusters", "Clusters", "Clusters, of which some are seeds or were placed by a split."),
                input("rsm", "ReflectiveShadowMap", "The texels that clusters consist of."),
                input("importance", "Importance", "What the number of seeds at a texel is proportional to."),
            ],
            outputs: vec![output(
                "warped",
                "Clusters",
                "The same, with seeds at texels and what lies there.",
            )],
            ..Ports::default()
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let (size, layers) = importance::shape(cx)?;
        let squares: u64 = (1..=top(size))
            .map(|level| size_at(size, level))
            .map(|(columns, rows)| u64::from(columns) * u64::from(rows) * u64::from(layers))
            .sum();
        let pyramid = ResourceDesc::buffer(squares * use_cx.size_of(SCALED)?);
        Ok(vec![
            clusters::output(use_cx, "warped", cx.fact("clusters", clusters::COUNT)?)?,
            OutputDesc::scratch("pyramid", pyramid),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let (size, layers) = (cx.size("rsm"), cx.layers("rsm"));
        let top = top(size);
        let sums = (1..=top).map(|level| {
            let (columns, rows) = size_at(size, level);
            Compute::new(cx.shader(SUM, &[]), "sum", Threads::Grid([columns, rows, layers]))
                .value("level", Value::U32(level))
        });
        let bottom = match WarpClustersSettings::read(cx.settings).levels {
            0 => 0,
            levels => top.saturating_sub(levels),
        };
        let count = cx.fact("clusters", clusters::COUNT)?;
        let warp = Compute::new(cx.shader(WARP, &[]), "warp", Threads::Row(count))
            .value("top", Value::U32(top))
            .value("bottom", Value::U32(bottom));
        Ok(Recording::of(sums).then(warp))
    }
}
