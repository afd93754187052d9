//! Makes a virtual light of each cluster of texels of a reflective shadow map.

pub mod cpu_reference;

use gpu_algorithms::reduce;
use interfaces::{clusters, virtual_lights};
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, Value, input, optional, output,
    setting,
};

/// The pass type `lights-from-clusters`.
pub const PASS: &dyn Pass = &LightsFromClusters;

/// Virtual area lights.
pub struct LightsFromClusters;

const SHADER: &str = "passes/lights-from-clusters/lights-from-clusters.wgsl";

/// The options of the shader that say what the flux of a light comes from, and where it is; in lower case, the names of the
/// settings.
const ENERGY: &str = "ENERGY";
const PLACE: &str = "PLACE";

pass::settings! {
    /// The settings of the pass type `lights-from-clusters` that are not the shader's alone.
    pub struct LightsFromClustersSettings {
        /// Whether lights have the area of their clusters, by which `gather` bounds what is near; otherwise they are
        /// points.
        area: bool = true;
    }
}

impl Pass for LightsFromClusters {
    fn info(&self) -> Info {
        Info {
            kind: "lights-from-clusters",
            about: "Makes a virtual light of each cluster of texels of a reflective shadow map.",
            paper: "ACRSM §4.3, §5.3.3",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = LightsFromClustersSettings::schema();
        all.extend(setting::of_options(cx.shaders, SHADER, &[ENERGY, PLACE])?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("clusters", "Clusters", "The clusters, averaged."),
                optional("rsm", "ReflectiveShadowMap", "Its texels, for lights at the place of one."),
            ],
            outputs: vec![output("lights", "VirtualLights", "A light per cluster, dark without texels.")],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let count = cx.fact("clusters", clusters::COUNT)?;
        if cx.settings.get("place").and_then(Value::as_text) == Some("texel") && cx.input("rsm").is_none() {
            return Err(PassTypeError::input("rsm", "lights are at a texel each, and there are no texels")
                .help("link the reflective shadow map, or take `place: \"mean\"`"));
        }
        Ok(vec![
            virtual_lights::output(use_cx, "lights", count)?,
            OutputDesc::scratch("unscaled", ResourceDesc::buffer(16)),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let area = LightsFromClustersSettings::read(cx.settings).area;
        let shader = cx.shader(SHADER, &[cx.option(ENERGY), cx.option(PLACE), ("AREA", area.into())]);
        let count = cx.fact("clusters", clusters::COUNT)?;
        let make = Compute::new(shader.clone(), "make_lights", Threads::Row(count));
        Ok(Recording::one(reduce::few(&shader)).then(make))
    }
}
