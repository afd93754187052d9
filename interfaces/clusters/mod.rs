//! Clusters of the texels of a reflective shadow map, which go from frame to frame.

use bytemuck::{Pod, Zeroable};
use pass::{Content, Fact, Figure, Interface, Member, OutputDesc, PassTypeError, Struct, UseContext};

/// The number of clusters.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of clusters");

const CLUSTERS: Struct = Struct::new("interfaces/clusters/clusters.wgsl", "Clusters");

/// The interface `Clusters`.
pub const INTERFACE: Interface = Interface::new(
    "Clusters",
    "Clusters of the texels of a reflective shadow map, each of which becomes an area light.",
    &[Member::required("", Content::Struct(CLUSTERS), "what is true of all clusters, and the clusters")],
)
.with_facts(&[COUNT.decl()])
.with_folder("interfaces/clusters")
.with_figures(&[
    Figure::new("alive", "clusters that have texels", ""),
    Figure::new("vanished", "clusters that have lost their texels", ""),
    Figure::new("merged", "clusters that were merged", ""),
    Figure::new("split", "clusters that were split", ""),
    Figure::new("mean_share", "mean of area times importance over the clusters", "m²"),
    Figure::new("share_variance", "variance of area times importance over the clusters", "m⁴"),
]);

/// Where a cluster stands: the constants `CLUSTER_…` of clusters.wgsl.
pub mod state {
    /// It waits to be seeded.
    pub const TO_SEED: u32 = 0;
    /// Its place is a seed in the unit square.
    pub const SEEDED: u32 = 1;
    /// Its place is one that a split has chosen.
    pub const PLACED: u32 = 2;
    /// Its centre has all its attributes.
    pub const ALIVE: u32 = 3;
}

/// The texel of a cluster that has none: `NO_TEXEL` of clusters.wgsl.
pub const NO_TEXEL: u32 = u32::MAX;

/// `struct Cluster` of clusters.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Cluster {
    /// Centre in world space \[m\].
    pub position: [f32; 3],
    /// Area \[m²\].
    pub area: f32,
    /// Mean normal, unit.
    pub normal: [f32; 3],
    /// Mean importance of the texels.
    pub importance: f32,
    /// Flux of all texels \[W\].
    pub flux: [f32; 3],
    /// Distance from the centre to the farthest texel \[m\].
    pub radius: f32,
    /// Flux of the texel at the centre \[W\].
    pub centre_flux: [f32; 3],
    /// That texel, counted through rows and layers; [`NO_TEXEL`] without texels.
    pub texel: u32,
    /// Mean position of the texels in their layer \[texels\]; of a seed, its place in the unit square.
    pub uv: [f32; 2],
    /// The layer.
    pub layer: u32,
    /// Number of texels.
    pub texels: u32,
    /// Elements of the sequence of seeds that it has used.
    pub generation: u32,
    /// One of [`state`].
    pub state: u32,
    /// δ of ACRSM Eq. 4.6.
    pub delta: f32,
    /// Its mean over the neighbours, Eq. 4.7.
    pub mean_delta: f32,
}

/// What precedes the clusters in `struct Clusters` of clusters.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ClustersHeader {
    /// Number of clusters; 0 before the first frame.
    pub count: u32,
    /// How many have texels.
    pub alive: u32,
    /// How many have lost their texels in this frame.
    pub vanished: u32,
    /// How many were merged at the beginning of this frame.
    pub merged: u32,
    /// How many were split at the beginning of this frame.
    pub split: u32,
    /// Frames since the clusters began.
    pub iteration: u32,
    /// The greatest area \[m²\].
    pub greatest_area: f32,
    /// Mean of area · importance over the clusters with texels \[m²\].
    pub mean_share: f32,
    /// Variance of it \[m⁴\].
    pub share_variance: f32,
    /// Unused; zero.
    pub pad: [u32; 3],
    /// Flux of the texels that are in a cluster \[W\].
    pub mapped_flux: [f32; 3],
    /// Unused; zero.
    pub pad3: u32,
    /// Flux of all texels \[W\].
    pub map_flux: [f32; 3],
    /// Unused; zero.
    pub pad4: u32,
}

/// Describes an output of `count` clusters.
///
/// # Errors
/// Where clusters.wgsl is refused.
pub fn output(cx: &UseContext<'_>, port: &str, count: u32) -> Result<OutputDesc, PassTypeError> {
    Ok(OutputDesc::one(port, cx.buffer(CLUSTERS, u64::from(count))?).fact(COUNT, count))
}

/// Returns the bytes of a buffer with these clusters.
pub fn to_bytes(header: &ClustersHeader, clusters: &[Cluster]) -> Vec<u8> {
    let header = ClustersHeader { count: clusters.len() as u32, ..*header };
    [bytemuck::bytes_of(&header), bytemuck::cast_slice(clusters)].concat()
}

/// Returns the header and the clusters in the bytes of a buffer; `None` where there are too few bytes for its count.
pub fn from_bytes(bytes: &[u8]) -> Option<(ClustersHeader, Vec<Cluster>)> {
    let (header, rest) = bytes.split_at_checked(size_of::<ClustersHeader>())?;
    let header: ClustersHeader = bytemuck::pod_read_unaligned(header);
    let clusters = rest.get(..(header.count as usize).checked_mul(size_of::<Cluster>())?)?;
    Some((header, bytemuck::pod_collect_to_vec(clusters)))
}
