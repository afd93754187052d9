//! Inputs of passes that cluster the texels of a reflective shadow map.

use crate::{Harness, buffer};
use interfaces::clusters::{self, Cluster, ClustersHeader};
use pass::{Format, ResourceDesc};

/// A texel of a reflective shadow map, as its textures hold it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RsmTexel {
    /// Position in world space \[m\], and distance along the axis of the layer \[m\].
    pub position: [f32; 4],
    /// Normal.
    pub normal: [f32; 3],
    /// Flux \[W\], and area \[m²\].
    pub flux: [f32; 4],
}

/// A texture of 32-bit floats for each texel of a map.
fn array(format: Format, size: (u32, u32), texels: usize) -> ResourceDesc {
    ResourceDesc::texture_2d_array(format, size, texels as u32 / (size.0 * size.1))
}

impl Harness<'_> {
    /// Gives the input port `rsm` these texels, layer after layer. Normals are single floats, so that references have the
    /// same.
    pub fn rsm(self, size: (u32, u32), texels: &[RsmTexel]) -> Self {
        let member = |of: &dyn Fn(&RsmTexel) -> [f32; 4]| {
            let texture = array(Format::Rgba32Float, size, texels.len());
            (texture, texels.iter().flat_map(|texel| bytemuck::bytes_of(&of(texel)).to_vec()).collect())
        };
        let members = [
            ("position", member(&|texel| texel.position)),
            ("normal", member(&|RsmTexel { normal: [x, y, z], .. }| [*x, *y, *z, 0.0])),
            ("flux", member(&|texel| texel.flux)),
        ];
        let members = members.into_iter().map(|(name, (desc, bytes))| (name, desc, bytes)).collect();
        self.input("rsm", "ReflectiveShadowMap", &[], members)
    }

    /// Gives the input port `importance` a map of importance, layer after layer.
    pub fn importance(self, size: (u32, u32), importance: &[f32]) -> Self {
        let map = array(Format::R32Float, size, importance.len());
        let members = vec![("map", map, bytemuck::cast_slice(importance).to_vec())];
        self.input("importance", "Importance", &[], members).module("shaders/importance-stored.wgsl")
    }

    /// Gives the input port `clusters`.
    pub fn clusters(self, header: &ClustersHeader, clusters: &[Cluster]) -> Self {
        let bytes = clusters::to_bytes(header, clusters);
        let members = vec![("", buffer(bytes.len() as u64), bytes)];
        self.input("clusters", "Clusters", &[("count", clusters.len() as u32)], members)
    }

    /// Gives the input port `map`: the cluster of each texel, of `count` clusters.
    pub fn cluster_map(self, size: (u32, u32), map: &[u32], count: u32) -> Self {
        let texture = array(Format::R32Uint, size, map.len());
        let members = vec![("", texture, bytemuck::cast_slice(map).to_vec())];
        self.input("map", "ClusterMap", &[("count", count)], members)
    }
}
