//! Groups virtual lights into clusters, each of which becomes an area light.

pub mod cpu_reference;

use interfaces::{owners, virtual_lights};
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, setting,
};

/// The pass type `cluster-lights`.
pub const PASS: &dyn Pass = &ClusterLights;

/// k-means over positions and normals.
pub struct ClusterLights;

const SHADER: &str = "passes/cluster-lights/cluster-lights.wgsl";

/// The option of the shader that says how far a light is from a cluster; in lower case, the name of the setting.
const METRIC: &str = "METRIC";

pass::settings! {
    /// The settings of the pass type `cluster-lights` that are not the shader's alone.
    pub struct ClusterLightsSettings {
        /// The most clusters; there are no more than lights. More: smaller area lights, but more maps and time.
        // A thread goes over all clusters: see gpu_algorithms::LOOP_ITERATIONS.
        count: u32 = 64, min: 1, max: 32_768;
        /// The most iterations. Those after the one in which no light changed its cluster have no work.
        iterations: u32 = 32, min: 1, max: 256;
    }
}

impl Pass for ClusterLights {
    fn info(&self) -> Info {
        Info {
            kind: "cluster-lights",
            about: "Groups virtual lights into clusters, each of which becomes an area light.",
            paper: "Dong et al. 2009; ACRSM §3.2.5, Eq. 3.7",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = ClusterLightsSettings::schema();
        all.extend(setting::of_options(cx.shaders, SHADER, &[METRIC])?);
        all.extend(setting::of_shader(cx.shaders, SHADER)?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![pass::input("lights", "VirtualLights", "The lights to group.")],
            outputs: vec![
                pass::output("clusters", "VirtualLights", "An area light for each cluster."),
                pass::output("owners", "Owners", "The cluster of each light."),
            ],
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let lights = cx.fact("lights", virtual_lights::COUNT)?;
        let clusters = ClusterLightsSettings::read(cx.settings).count.min(lights);
        Ok(vec![
            virtual_lights::output(use_cx, "clusters", clusters)?,
            owners::output("owners", lights),
            OutputDesc::scratch("changes", ResourceDesc::buffer(4)),
            OutputDesc::scratch("dispatches", ResourceDesc::buffer(24)),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let lights = cx.fact("lights", virtual_lights::COUNT)?;
        let shader = cx.shader(SHADER, &[cx.option(METRIC)]);
        let step = |entry, threads| Compute::new(shader.clone(), entry, threads);
        let indirect = |offset| Threads::Indirect { buffer: "dispatches".into(), offset };
        let mut recording = Recording::one(step("seed", Threads::Row(lights.max(1))));
        for _ in 0..ClusterLightsSettings::read(cx.settings).iterations {
            recording = recording
                .then(step("assign", indirect(0)))
                .then(step("settle", Threads::Row(1)))
                .then(step("update", indirect(12)));
        }
        Ok(recording)
    }
}
