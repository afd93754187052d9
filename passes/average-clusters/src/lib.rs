//! Moves each cluster to the mean of its texels.

pub mod cpu_reference;

use gpu_algorithms::{LOOP_ITERATIONS, reduce};
use interfaces::{cluster_map, clusters, importance};
use pass::{
    Compute, Define, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, Value, input, optional, output,
    setting,
};

/// The pass type `average-clusters`.
pub const PASS: &dyn Pass = &AverageClusters;

/// The averaging of a step of k-means.
pub struct AverageClusters;

const AVERAGE: &str = "passes/average-clusters/average.wgsl";
const MAP_FLUX: &str = "passes/average-clusters/map-flux.wgsl";
const SUMMARY: &str = "passes/average-clusters/summary.wgsl";

/// The option of the shader that says what the area of a cluster is; in lower case, the name of the setting.
const AREA: &str = "AREA";

/// The threads that share a cluster: `GROUP_SIZE` of shaders/algorithms/workgroup.wgsl.
const GROUP_SIZE: u32 = 256;

/// The most texels of a window. Its threads go through them twice.
const MOST_TEXELS: u32 = LOOP_ITERATIONS / 2 * GROUP_SIZE;

/// Bytes of the `vec4<f32>` that the flux of the map is summed in.
const SUM_BYTES: u64 = 16;

/// Width, height and layers of the input `rsm`.
///
/// # Errors
/// Where the map of clusters or of importance has another shape.
fn shape(cx: &OutputContext<'_>) -> Result<(u32, u32, u32), PassTypeError> {
    let of = |input: &str, member: &str| {
        let texture = cx.input(input)?.member(member).and_then(ResourceDesc::texture)?;
        Some((texture.size.0, texture.size.1, texture.layers))
    };
    let rsm = of("rsm", "flux").ok_or_else(|| PassTypeError::input("rsm", "expected a member `flux`"))?;
    if cx.input("importance").is_some() {
        importance::shape(cx)?;
    }
    match of("map", "") {
        Some(map) if map != rsm => Err(PassTypeError::input(
            "map",
            format!(
                "the clusters of {}×{} texels in {} layers are mapped, but the reflective shadow map has {}×{} in {}",
                map.0, map.1, map.2, rsm.0, rsm.1, rsm.2
            ),
        )
        .help("link the reflective shadow map that the clusters were mapped in")),
        _ => Ok(rsm),
    }
}

impl Pass for AverageClusters {
    fn info(&self) -> Info {
        Info {
            kind: "average-clusters",
            about: "Moves each cluster of texels of a reflective shadow map to the mean of its texels.",
            paper: "ACRSM §4.7",
            shaders: &[AVERAGE, MAP_FLUX, SUMMARY],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        setting::of_options(cx.shaders, AVERAGE, &[AREA])
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("clusters", "Clusters", "The clusters as their texels were mapped."),
                input("map", "ClusterMap", "The cluster of each texel."),
                input("rsm", "ReflectiveShadowMap", "What the texels hold."),
                optional("importance", "Importance", "Averaged too; without it, each texel has 1."),
            ],
            outputs: vec![output("averaged", "Clusters", "The clusters around the means of their texels.")],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let (width, height, layers) = shape(cx)?;
        let window = cx.fact("map", cluster_map::WINDOW).unwrap_or(0);
        let side = |of_map: u32| if window == 0 { of_map } else { window.min(of_map) };
        if u64::from(side(width)) * u64::from(side(height)) > u64::from(MOST_TEXELS) {
            let message = format!(
                "a window of {}×{} texels is more than a workgroup averages",
                side(width),
                side(height)
            );
            return Err(PassTypeError::input("map", message).help(format!(
                "set `window` of map-clusters to at most {}, or take a smaller reflective shadow map",
                MOST_TEXELS.isqrt()
            )));
        }
        Ok(vec![
            clusters::output(use_cx, "averaged", cx.fact("clusters", clusters::COUNT)?)?,
            reduce::scratch(use_cx, "flux_sums", width * height * layers, SUM_BYTES)?,
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let count = cx.fact("clusters", clusters::COUNT)?;
        let window = cx.fact("map", cluster_map::WINDOW).unwrap_or(0);
        let importance = Define::Bool(cx.connected("importance"));
        let shader = cx.shader(AVERAGE, &[cx.option(AREA), ("IMPORTANCE", importance)]);
        let average = Compute::new(shader, "average", Threads::Row(count * GROUP_SIZE))
            .value("window", Value::U32(window));
        let ((width, height), layers) = (cx.size("rsm"), cx.layers("rsm"));
        let use_cx = cx.use_context();
        let flux = reduce::steps(&use_cx, &cx.shader(MAP_FLUX, &[]), width * height * layers, "flux_sums")?;
        let summary = Compute::new(cx.shader(SUMMARY, &[]), "summarise", Threads::Row(1));
        Ok(Recording::one(average).then_all(flux).then(summary))
    }
}
