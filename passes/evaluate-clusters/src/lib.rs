//! The balance of clusters: those that are too small go to where others are too large.

pub mod cpu_reference;

use gpu_algorithms::{LOOP_ITERATIONS, parts};
use interfaces::clusters;
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, Setting, Settings, Struct, Threads, UseContext, Value, input, output, setting,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &EvaluateClusters;

/// See the crate.
#[derive(Debug)]
pub struct EvaluateClusters;

const MEASURE: &str = "passes/evaluate-clusters/measure.wgsl";
const COMPARE: &str = "passes/evaluate-clusters/compare.wgsl";
const RANK: &str = "passes/evaluate-clusters/rank.wgsl";
const MOVE: &str = "passes/evaluate-clusters/move.wgsl";

const CENTRE: Struct = Struct::new("passes/evaluate-clusters/centre.wgsl", "Centre");
const OUTCOME: Struct = Struct::new("passes/evaluate-clusters/centre.wgsl", "Outcome");

impl Pass for EvaluateClusters {
    fn info(&self) -> Info {
        Info {
            kind: "evaluate-clusters",
            about: "Takes clusters from where they are too small to where they are too large.",
            paper: "ACRSM §4.8, Eq. 4.6-4.8",
            shaders: &[MEASURE, COMPARE, RANK, MOVE],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = setting::of_shader(cx.shaders, COMPARE)?;
        all.extend(setting::of_shader(cx.shaders, RANK)?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![input(
                "clusters",
                "Clusters",
                "The clusters of the frame before: a link with `prev`.",
            )],
            outputs: vec![output(
                "evaluated",
                "Clusters",
                "The same. Some are placed within others, some wait to be seeded.",
            )],
            ..Ports::default()
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let count = cx.fact("clusters", clusters::COUNT)?;
        let of_each = |name: &str, bytes: u64| {
            OutputDesc::scratch(name, ResourceDesc::buffer(u64::from(count) * bytes))
        };
        Ok(vec![
            clusters::output(use_cx, "evaluated", count)?,
            of_each("centres", use_cx.size_of(CENTRE)?),
            of_each("sums", 8),
            of_each("fates", 4),
            of_each("splits", 4),
            OutputDesc::scratch("outcome", use_cx.buffer(OUTCOME, 1)?),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let count = cx.fact("clusters", clusters::COUNT)?;
        let one_group = |path, entry| Compute::new(cx.shader(path, &[]), entry, Threads::Row(1));
        let of_each = |path, entry| Compute::new(cx.shader(path, &[]), entry, Threads::Row(count));
        let compare = parts(count, LOOP_ITERATIONS).map(|part| {
            of_each(COMPARE, "compare")
                .value("begin", Value::U32(part.begin))
                .value("end", Value::U32(part.end))
        });
        Ok(Recording::one(one_group(MEASURE, "measure"))
            .then_all(compare)
            .then(one_group(RANK, "rank"))
            .then(of_each(MOVE, "move_clusters")))
    }
}
