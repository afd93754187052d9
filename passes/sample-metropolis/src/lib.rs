//! Virtual lights sampled in proportion to an importance map by independent Metropolis-Hastings chains.

pub mod cpu_reference;

use gpu_algorithms::{parts, reduce};
use interfaces::{importance, virtual_lights};
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Struct, Threads, UseContext, Value, input, output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &SampleMetropolis;

/// See the crate.
pub struct SampleMetropolis;

const SAMPLE: &str = "passes/sample-metropolis/sample-metropolis.wgsl";
const MEAN: &str = "passes/sample-metropolis/mean.wgsl";

const SCALED: Struct = Struct::new("shaders/algorithms/scaled.wgsl", "Scaled");

pass::choice! {
    /// The estimate of the mean importance in a light's weight; the values are those of the shader option
    /// `WEIGHTS`.
    pub enum Weights {
        /// The mean over the chain's own proposals.
        LocalMean = "local-mean",
        /// The importance of the first proposal.
        Single = "single",
        /// The mean over the proposals of all chains.
        None = "none",
        /// The mean over the chain's own proposals, one of which is chosen in proportion to its importance.
        Reservoir = "reservoir",
    }
}

pass::settings! {
    /// The settings of the pass type `sample-metropolis`.
    pub struct SampleMetropolisSettings {
        /// Number N of virtual lights, one per chain. Error falls as N^-½; the time for shadows and gathering
        /// rises with N.
        count: u32 = 1024, min: 1, max: 2_097_152;
        /// Number M of samples of a chain, of which the last is the light. Larger: lights follow the
        /// importance more closely; time rises with N M. 1: uniform sampling. 5 suffices (TCAS §4.3.1).
        // The N M elements of the sequence are numbered with 32 bits.
        steps: u32 = 5, min: 1, max: 1024;
        /// The estimate of the mean importance in a light's weight. local-mean: the mean over the chain's
        /// proposals, which removes most of the start-up bias. single: the importance of the first proposal,
        /// which is unbiased, but light intensities vary more (Veach & Guibas 1997). none: the mean over the
        /// proposals of all chains, which leaves the start-up bias. reservoir: as local-mean, but the light is
        /// one of the chain's proposals chosen in proportion to its importance instead of by Metropolis-Hastings
        /// (Talbot, Cline & Egbert 2005): unbiased, at the same cost.
        weights: Weights = Weights::LocalMean;
    }
}

impl Pass for SampleMetropolis {
    fn info(&self) -> Info {
        Info {
            kind: "sample-metropolis",
            about: "Samples virtual lights in proportion to an importance map by independent Metropolis-Hastings chains.",
            paper: "TCAS §4.3, Alg. 1",
            shaders: &[MEAN, SAMPLE],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(SampleMetropolisSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("rsm", "ReflectiveShadowMap", "The texels to sample."),
                input("importance", "Importance", "What the probability of a texel tends to with M."),
            ],
            outputs: vec![output(
                "lights",
                "VirtualLights",
                "N lights; those of chains that met no importance are dark.",
            )],
            scene_bindings: SceneBindings::LIGHTS,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        importance::shape(cx)?;
        let settings = SampleMetropolisSettings::read(cx.settings);
        let count = settings.count;
        let proposed = u64::from(chains_of_part(&settings)) * u64::from(settings.steps);
        let mut outputs = vec![
            virtual_lights::output(use_cx, "lights", count)?,
            OutputDesc::scratch("proposed", ResourceDesc::buffer(4 * proposed)),
        ];
        if settings.weights == Weights::None {
            outputs.push(reduce::scratch(use_cx, "sums", proposals(&settings), use_cx.size_of(SCALED)?)?);
            outputs.push(OutputDesc::scratch("sum", use_cx.buffer(SCALED, 1)?));
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = SampleMetropolisSettings::read(cx.settings);
        let shader = cx.shader(SAMPLE, &[("WEIGHTS", settings.weights.into())]);
        let mut steps = Vec::new();
        if settings.weights == Weights::None {
            let mean = cx.shader(MEAN, &[]);
            steps.extend(reduce::steps(&cx.use_context(), &mean, proposals(&settings), "sums")?);
        }
        for part in parts(settings.count, chains_of_part(&settings)) {
            let chains = part.end.min(settings.count) - part.begin;
            steps.extend([("propose", chains * settings.steps), ("sample", chains)].map(
                |(entry, threads)| {
                    Compute::new(shader.clone(), entry, Threads::Row(threads))
                        .value("first", Value::U32(part.begin))
                        .value("chains", Value::U32(chains))
                },
            ));
        }
        Ok(Recording::of(steps))
    }
}

/// The most proposals whose importance is stored at once.
const STORED: u32 = 1 << 22;

/// Number of chains that are followed at once.
fn chains_of_part(settings: &SampleMetropolisSettings) -> u32 {
    (STORED / settings.steps).min(settings.count)
}

/// Number of proposals of all chains.
fn proposals(settings: &SampleMetropolisSettings) -> u32 {
    settings.count * settings.steps
}
