//! Assigns each texel of a reflective shadow map to the nearest cluster.

pub mod cpu_reference;

use gpu_algorithms::{LOOP_ITERATIONS, Part};
use interfaces::{cluster_map, clusters, importance};
use pass::{
    Compute, Define, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, Value,
    input, optional, output, setting,
};

/// The pass type `map-clusters`.
pub const PASS: &dyn Pass = &MapClusters { part: CLUSTERS_OF_PART };

/// The mapping of a step of k-means.
pub struct MapClusters {
    /// The most clusters that a dispatch takes.
    pub part: u32,
}

const SHADER: &str = "passes/map-clusters/map-clusters.wgsl";

/// The option of the shader that says what the distance of two normals is; in lower case, the name of the setting.
const NORMAL_DISTANCE: &str = "NORMAL_DISTANCE";

/// Clusters that a workgroup lists at a time: one for each thread.
const CHUNK: u32 = 256;

/// As many as a thread has loop iterations for: one for each cluster, and for each chunk one and eight more of a prefix
/// sum.
const CLUSTERS_OF_PART: u32 = LOOP_ITERATIONS / (CHUNK + 9) * CHUNK;

pass::settings! {
    /// The settings of the pass type `map-clusters` that are not the shader's alone.
    pub struct MapClustersSettings {
        /// Side of the square of texels around a cluster that it may take, in its own layer; 0 is the whole layer.
        /// Larger: more time, here and for the averages, with the square. Smaller: texels that no window reaches
        /// belong to no cluster, and few clusters cannot cover the map. ACRSM has 64 to 256.
        window: u32 = 128, min: 0, max: 8192, unit: "px";
        /// Weight of the distance between a texel and the cluster's centre, as a fraction of the scene's extent. The
        /// weights are divided by their sum. Larger: cells are rounder, and go around edges.
        // DEVIATION(weights): the thesis has none.
        position_weight: f32 = 0.4, min: 0.0, max: 1.0;
        /// Weight of the distance between normals, see `normal_distance`. Larger: fewer cells go around edges, but
        /// clusters pass an edge less readily where the light moves over it.
        normal_weight: f32 = 0.3, min: 0.0, max: 1.0;
        /// Weight of the difference of importance, which should be in [0, 1]; without an input `importance` it is 0.
        /// Larger: a cell has texels of more similar importance.
        importance_weight: f32 = 0.3, min: 0.0, max: 1.0;
        /// Weight of the distance between fluxes, that of the texel and that at the centre. Above 0: cells follow
        /// texture and shadow edges, and waver from frame to frame where albedo has fine structure (ACRSM §4.6).
        flux_weight: f32 = 0.0, min: 0.0, max: 1.0;
    }
}

impl MapClustersSettings {
    /// Returns the weights of positions, normals, importance and flux, which sum to 1.
    fn weights(&self, has_importance: bool) -> Result<[f32; 4], PassTypeError> {
        let importance = if has_importance { self.importance_weight } else { 0.0 };
        let weights = [self.position_weight, self.normal_weight, importance, self.flux_weight];
        let sum: f32 = weights.iter().sum();
        if sum > 0.0 {
            return Ok(weights.map(|weight| weight / sum));
        }
        Err(PassTypeError::setting(
            Self::position_weight,
            "all weights are 0, so all clusters are as near to each texel",
        ))
    }
}

impl Pass for MapClusters {
    fn info(&self) -> Info {
        Info {
            kind: "map-clusters",
            about: "Assigns each texel of a reflective shadow map to the nearest cluster.",
            paper: "ACRSM §4.6, Eq. 4.4-4.5",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = MapClustersSettings::schema();
        all.extend(setting::of_options(cx.shaders, SHADER, &[NORMAL_DISTANCE])?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("clusters", "Clusters", "The clusters; only those that are alive take texels."),
                input("rsm", "ReflectiveShadowMap", "The texels to assign."),
                optional("importance", "Importance", "In [0, 1]; without it, all texels have the same."),
            ],
            outputs: vec![output("map", "ClusterMap", "The cluster of each texel.")],
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let settings = MapClustersSettings::read(cx.settings);
        let has_importance = cx.input("importance").is_some();
        if has_importance {
            importance::shape(cx)?;
        }
        settings.weights(has_importance)?;
        let position = cx.input("rsm").and_then(|rsm| rsm.member("position")).and_then(ResourceDesc::texture);
        let position = position.ok_or_else(|| PassTypeError::input("rsm", "expected a member `position`"))?;
        let count = cx.fact("clusters", clusters::COUNT)?;
        let map = ResourceDesc::texture_2d_array(Format::R32Uint, Extent::like("rsm"), position.layers);
        let map = OutputDesc::one("map", map)
            .fact(cluster_map::COUNT, count)
            .fact(cluster_map::WINDOW, settings.window);
        let mut outputs = vec![map];
        if self.parts(count).len() > 1 {
            let texels = u64::from(position.size.0) * u64::from(position.size.1) * u64::from(position.layers);
            outputs.push(OutputDesc::scratch("nearest", ResourceDesc::buffer(8 * texels)));
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = MapClustersSettings::read(cx.settings);
        let weights = settings.weights(cx.connected("importance"))?;
        let parts = self.parts(cx.fact("clusters", clusters::COUNT)?);
        let shader = cx.shader(
            SHADER,
            &[
                cx.option(NORMAL_DISTANCE),
                ("IMPORTANCE", Define::Bool(weights[2] > 0.0)),
                ("FLUX", Define::Bool(weights[3] > 0.0)),
                ("PARTS", Define::Bool(parts.len() > 1)),
            ],
        );
        let ((width, height), layers) = (cx.size("map"), cx.layers("map"));
        let map = |part: Part| {
            Compute::new(shader.clone(), "map_texels", Threads::Grid([width, height, layers]))
                .value("weights", Value::Vector(weights.to_vec()))
                .value("begin", Value::U32(part.begin))
                .value("end", Value::U32(part.end))
                .value("last", Value::U32(u32::from(part.last)))
        };
        Ok(Recording::of(parts.map(map)))
    }
}

impl MapClusters {
    /// The dispatches that this many clusters take.
    fn parts(&self, count: u32) -> impl ExactSizeIterator<Item = Part> + use<> {
        gpu_algorithms::parts(count, self.part)
    }
}
