#![doc = include_str!("../README.md")]

use gpu_algorithms::{LOOP_ITERATIONS, Part};
use interfaces::{clusters, importance};
use pass::{
    Compute, OutputContext, OutputDesc, Pass, PassTypeError, ReadSettings, RecordContext, Recording,
    ResourceDesc, Settings, Threads, UseContext, reflected,
};

/// The pass type `map-clusters`.
pub const PASS: &dyn Pass = &MapClusters { part: CLUSTERS_OF_PART };

/// The mapping of a step of k-means.
pub struct MapClusters {
    /// The most clusters that a dispatch takes.
    pub part: u32,
}

/// Clusters that a workgroup lists at a time: one for each thread.
const CHUNK: u32 = 256;

/// The clusters for which a thread has loop iterations: one for each cluster, and for each chunk one and eight more of a
/// prefix sum.
const CLUSTERS_OF_PART: u32 = LOOP_ITERATIONS / (CHUNK + 9) * CHUNK;

/// The settings that are weights: of positions, normals, importance and flux.
const WEIGHTS: [&str; 4] = ["position_weight", "normal_weight", "importance_weight", "flux_weight"];

/// Returns the weights as the shader has them: they sum to 1, and importance that is not linked has none.
fn weights(settings: &Settings, has_importance: bool) -> Result<[f32; 4], PassTypeError> {
    let mut weights = [0.0; 4];
    for (weight, name) in weights.iter_mut().zip(WEIGHTS) {
        *weight = settings.f32(name)?;
    }
    weights[2] = if has_importance { weights[2] } else { 0.0 };
    let sum: f32 = weights.iter().sum();
    if sum > 0.0 {
        return Ok(weights.map(|weight| weight / sum));
    }
    Err(PassTypeError::setting(WEIGHTS[0], "all weights are 0, so all clusters are as near to each texel"))
}

impl Pass for MapClusters {
    fn kind(&self) -> &'static str {
        "map-clusters"
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let has_importance = cx.input("importance").is_some();
        if has_importance {
            importance::shape(cx)?;
        }
        weights(cx.settings, has_importance)?;
        let mut outputs = reflected::outputs(use_cx, &self.main_shader(&cx.use_)?, cx)?;
        if self.parts(cx.fact("clusters", clusters::COUNT)?).len() > 1 {
            let position = cx.input("rsm").and_then(|rsm| rsm.member("position")?.texture());
            let position =
                position.ok_or_else(|| PassTypeError::input("rsm", "expected a member `position`"))?;
            let texels = u64::from(position.size.0) * u64::from(position.size.1) * u64::from(position.layers);
            outputs.push(OutputDesc::scratch("nearest", ResourceDesc::buffer(8 * texels)));
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let weights = weights(cx.settings, cx.connected("importance"))?;
        let parts = self.parts(cx.fact("clusters", clusters::COUNT)?);
        let shader = cx
            .file("map-clusters.wgsl")
            .define("IMPORTANCE", weights[2] > 0.0)
            .define("FLUX", weights[3] > 0.0)
            .define("PARTS", parts.len() > 1);
        let ((width, height), layers) = (cx.size("map"), cx.layers("map"));
        let map = Compute::new(shader, "map_texels", Threads::Grid([width, height, layers]));
        let map = WEIGHTS.into_iter().zip(weights).fold(map, |map, (name, weight)| map.value(name, weight));
        let of_part = |part: Part| {
            map.clone().value("begin", part.begin).value("end", part.end).value("last", u32::from(part.last))
        };
        Ok(Recording::of(parts.map(of_part)))
    }
}

impl MapClusters {
    /// Returns the dispatches that this many clusters take.
    fn parts(&self, count: u32) -> impl ExactSizeIterator<Item = Part> + use<> {
        gpu_algorithms::parts(count, self.part)
    }
}
