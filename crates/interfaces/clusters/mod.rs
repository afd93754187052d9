//! Clusters of the texels of a reflective shadow map, which go from frame to frame.

use pass::{Content, Fact, Figure, Interface, Member, OutputDesc, PassTypeError, Struct, UseContext};

/// The number of clusters.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of clusters");

const CLUSTERS: Struct = Struct::new("crates/interfaces/clusters/clusters.wgsl", "Clusters");

/// The interface `Clusters`.
pub const INTERFACE: Interface = Interface::new(
    "Clusters",
    "Clusters of the texels of a reflective shadow map, each of which becomes an area light.",
    &[Member::required("", Content::Struct(CLUSTERS), "what is true of all clusters, and the clusters")],
)
.with_facts(&[COUNT.decl()])
.with_folder("crates/interfaces/clusters")
.with_figures(&[
    Figure::new("alive", "clusters that have texels", ""),
    Figure::new("vanished", "clusters that have lost their texels", ""),
    Figure::new("merged", "clusters that were merged", ""),
    Figure::new("split", "clusters that were split", ""),
    Figure::new("mean_share", "mean of area times importance over the clusters", "m²"),
    Figure::new("share_variance", "variance of area times importance over the clusters", "m⁴"),
]);

/// The states of a cluster.
pub mod state {
    wgsl_structs::wgsl! {
        "clusters/clusters.wgsl" {
            pub const CLUSTER_TO_SEED as TO_SEED;
            pub const CLUSTER_SEEDED as SEEDED;
            pub const CLUSTER_PLACED as PLACED;
            pub const CLUSTER_ALIVE as ALIVE;
        }
    }
}

wgsl_structs::wgsl! {
    "clusters/clusters.wgsl" {
        pub const NO_TEXEL;
        pub struct Cluster;
        pub struct ClustersHeader;
    }
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
    crate::with_rows(bytes, |header: &ClustersHeader| header.count)
}
