// The interface Clusters: clusters of texels of a reflective shadow map, each of which becomes an area light. They go from
// frame to frame, so where each of them stands in its life is stored too. [ACRSM §4, Tab. 5.2]

/// The cluster is waiting to be seeded: it is new, it has lost its texels, or it was merged and no split has taken it.
const CLUSTER_TO_SEED: u32 = 0u;
/// `uv` is a seed in the unit square, which is yet to be warped into a layer. [ACRSM §4.5]
const CLUSTER_SEEDED: u32 = 1u;
/// `uv` and `layer` are a place that a split has chosen; what lies there is yet to be read. [ACRSM §4.8]
const CLUSTER_PLACED: u32 = 2u;
/// The centre has all its attributes.
const CLUSTER_ALIVE: u32 = 3u;

/// The texel of a cluster without texels.
const NO_TEXEL: u32 = 0xffffffffu;

/// A cluster of texels of a reflective shadow map.
struct Cluster {
    /// Centre in world space [m]: the mean of the texels' positions.
    position: vec3<f32>,
    /// Area A [m²]; 0 without texels.
    area: f32,
    /// Direction of the mean of the texels' normals, unit.
    normal: vec3<f32>,
    /// Mean importance ρ of the texels.
    importance: f32,
    /// Flux of all its texels [W].
    flux: vec3<f32>,
    /// Distance from the centre to the farthest texel [m].
    radius: f32,
    /// Flux of the texel at the centre [W].
    centre_flux: vec3<f32>,
    /// That texel, counted through rows and layers: the one of the cluster that is nearest to `uv`. NO_TEXEL without texels.
    texel: u32,
    /// Mean position of the texels in their layer [texels]; the centre of the first texel is at 0.5. A seed: in the unit
    /// square.
    uv: vec2<f32>,
    /// Layer of the reflective shadow map.
    layer: u32,
    /// Number K of texels.
    texels: u32,
    /// Elements of the sequence of seeds that it has used.
    generation: u32,
    /// One of CLUSTER_….
    state: u32,
    /// δ of ACRSM Eq. 4.6; 0 before it is evaluated.
    delta: f32,
    /// Mean of δ over the neighbours, ACRSM Eq. 4.7; 0 before it is evaluated.
    mean_delta: f32,
    /// What a normal map adds to the unit normals of its texels: the mean by their flux.
    bend: vec3<f32>,
    pad0: u32,
}

/// Properties of all clusters.
struct ClustersHeader {
    /// Number k of clusters; 0 before the first frame.
    count: u32,
    /// How many have texels.
    alive: u32,
    /// How many have lost their texels in this frame.
    vanished: u32,
    /// How many were merged at the beginning of this frame.
    merged: u32,
    /// How many were split at the beginning of this frame.
    split: u32,
    /// Frames since the clusters began.
    iteration: u32,
    /// The greatest area [m²]: A_max of Eq. 4.6.
    greatest_area: f32,
    /// Mean of area · importance over the clusters with texels [m²].
    mean_share: f32,
    /// Variance of area · importance over the clusters with texels [m⁴].
    share_variance: f32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
    /// Flux of the texels that are in a cluster [W].
    mapped_flux: vec3<f32>,
    pad3: u32,
    /// Flux of all texels [W].
    map_flux: vec3<f32>,
    pad4: u32,
}

struct Clusters {
    header: ClustersHeader,
    clusters: array<Cluster>,
}
