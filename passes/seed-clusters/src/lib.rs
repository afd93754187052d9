//! The next elements of Halton's sequence for clusters without a place.

pub mod cpu_reference;

use interfaces::clusters;
use pass::{
    Compute, Define, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    Setting, Settings, Threads, UseContext, optional, output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &SeedClusters;

/// See the crate.
#[derive(Debug)]
pub struct SeedClusters;

const SHADER: &str = "passes/seed-clusters/seed-clusters.wgsl";

pass::settings! {
    /// The settings of the pass type `seed-clusters`.
    pub struct SeedClustersSettings {
        /// Number k of clusters, each of which becomes a virtual area light; ACRSM has 16 to 512. More: light follows
        /// the surfaces more closely, but the time for shadows and gathering rises with k. Another number begins all
        /// clusters anew.
        count: u32 = 128, min: 1, max: 65_536;
        /// Whether every frame begins from the same seeds, as if there were no frame before.
        restart: bool = false;
    }
}

impl Pass for SeedClusters {
    fn info(&self) -> Info {
        Info {
            kind: "seed-clusters",
            about: "Gives clusters without a place the next elements of Halton's sequence.",
            paper: "ACRSM §4.4",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(SeedClustersSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![optional(
                "clusters",
                "Clusters",
                "The clusters of the frame before. Without them, and where their number is another, all are new.",
            )],
            outputs: vec![output("seeded", "Clusters", "The same, none of which waits to be seeded.")],
            ..Ports::default()
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        Ok(vec![clusters::output(use_cx, "seeded", SeedClustersSettings::read(cx.settings).count)?])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = SeedClustersSettings::read(cx.settings);
        let past = cx.connected("clusters") && !settings.restart;
        let shader = cx.shader(SHADER, &[("PAST", Define::Bool(past))]);
        Ok(Recording::one(Compute::new(shader, "seed", Threads::Row(settings.count))))
    }
}
