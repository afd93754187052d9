//! Inputs of passes that cluster the texels of a reflective shadow map.

use crate::{Harness, elements, member};
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
        let texture = |name, of: &dyn Fn(&RsmTexel) -> [f32; 4]| {
            let content: Vec<[f32; 4]> = texels.iter().map(of).collect();
            member(name, array(Format::Rgba32Float, size, texels.len()), &content)
        };
        let members = vec![
            texture("position", &|texel| texel.position),
            texture("normal", &|RsmTexel { normal: [x, y, z], .. }| [*x, *y, *z, 0.0]),
            texture("flux", &|texel| texel.flux),
        ];
        self.input("rsm", "ReflectiveShadowMap", &[], members)
    }

    /// Gives the input port `importance` a map of importance, layer after layer.
    pub fn importance(self, size: (u32, u32), importance: &[f32]) -> Self {
        let map = array(Format::R32Float, size, importance.len());
        let members = vec![member("map", map, importance)];
        self.input("importance", "Importance", &[], members).module("shaders/importance-stored.wgsl")
    }

    /// Gives the input port `sums` the sums of a map of importance, layer after layer, as `sum-importance` makes them.
    pub fn importance_sums(self, size: (u32, u32), importance: &[f32]) -> Self {
        let weight = |x: &f32| if *x > 0.0 { f64::from(x.min(f32::MAX)) } else { 0.0 };
        let weights: Vec<f64> = importance.iter().map(weight).collect();
        let (rows, row_totals) = sums(&weights, size.0 as usize);
        let (mut totals, map_totals) = sums(&row_totals, size.1 as usize);
        totals.extend(sums(&map_totals, map_totals.len()).0);
        let mut members = vec![member("rows", array(Format::R32Float, size, importance.len()), &rows)];
        members.extend(elements(&totals).into_iter().map(|(_, desc, bytes)| ("totals", desc, bytes)));
        self.input("sums", "ImportanceSums", &[], members)
    }

    /// Gives the input port `clusters`.
    pub fn clusters(self, header: &ClustersHeader, clusters: &[Cluster]) -> Self {
        let members = elements(&clusters::to_bytes(header, clusters));
        self.input("clusters", "Clusters", &[("count", clusters.len() as u32)], members)
    }

    /// Gives the input port `map`: the cluster of each texel, of `count` clusters.
    pub fn cluster_map(self, size: (u32, u32), map: &[u32], count: u32) -> Self {
        let texture = array(Format::R32Uint, size, map.len());
        let members = vec![member("", texture, map)];
        self.input("map", "ClusterMap", &[("count", count)], members)
    }
}

/// Returns the sums of each segment of `length` weights in a unit near its greatest weight, and the segments' totals.
fn sums(weights: &[f64], length: usize) -> (Vec<f32>, Vec<f64>) {
    let mut sums = Vec::with_capacity(weights.len());
    let mut totals = Vec::new();
    for segment in weights.chunks_exact(length) {
        let greatest = segment.iter().copied().fold(0.0, f64::max);
        let unit = if greatest > 0.0 { greatest.log2().floor().exp2() } else { 1.0 };
        let mut sum = 0.0;
        sums.extend(segment.iter().map(|weight| {
            sum += weight;
            (sum / unit) as f32
        }));
        totals.push(sum);
    }
    (sums, totals)
}
