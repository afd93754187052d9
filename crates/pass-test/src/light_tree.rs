//! Trees over virtual lights, built on the CPU.

use crate::{Harness, INFINITELY_FAR, elements};
use glam::{DVec3, Vec3};
use interfaces::light_tree::{self, LightNode, LightTreeHeader, NO_LIGHT};
use interfaces::virtual_lights::VirtualLight;

/// Returns a tree over these lights in their order, without those that are dark. Its bounds are those of all lights below a node.
pub fn light_tree(lights: &[VirtualLight]) -> (LightTreeHeader, Vec<LightNode>) {
    let lit: Vec<u32> = (0..lights.len() as u32).filter(|i| brightness(&lights[*i as usize]) > 0.0).collect();
    let leaves = light_tree::leaves(lights.len() as u32);
    let below_root = light_tree::leaves(lit.len() as u32);
    let header = LightTreeHeader {
        count: lit.len() as u32,
        leaves,
        root: leaves / below_root,
        ..LightTreeHeader::default()
    };
    let node = |index: u32| {
        let height = leaves.ilog2() - index.max(1).ilog2();
        let first = ((index << height) - leaves) as usize;
        let end = (first + (1 << height)).min(lit.len());
        node_of(lights, lit.get(first..end).unwrap_or_default(), index >= leaves)
    };
    let nodes =
        (0..2 * leaves).map(|index| if index == 0 { node_of(lights, &[], false) } else { node(index) });
    (header, nodes.collect())
}

impl Harness<'_> {
    /// Gives the input port `tree` a tree over these lights.
    pub fn light_tree(self, lights: &[VirtualLight]) -> Self {
        let (header, nodes) = light_tree(lights);
        let members = elements(&light_tree::to_bytes(&header, &nodes));
        self.input("tree", "LightTree", &[("leaves", header.leaves)], members)
    }
}

/// Returns the luminance of the flux of a light.
fn brightness(light: &VirtualLight) -> f32 {
    std::iter::zip([0.2126, 0.7152, 0.0722], light.flux).map(|(weight, flux)| weight * flux).sum()
}

fn node_of(lights: &[VirtualLight], indices: &[u32], is_leaf: bool) -> LightNode {
    let below = || indices.iter().map(|i| &lights[*i as usize]);
    let near = || below().filter(|light| light.kind != INFINITELY_FAR);
    let positions = || near().map(|light| Vec3::from(light.position));
    let normals = || below().map(|light| Vec3::from(light.normal).as_dvec3());
    let axis = normals().sum::<DVec3>().normalize_or(DVec3::Z);
    let cosine = normals().map(|normal| axis.dot(normal)).fold(1.0, f64::min);
    LightNode {
        low: positions().fold(Vec3::splat(3e38), Vec3::min).to_array(),
        flux: near().map(brightness).sum(),
        high: positions().fold(Vec3::splat(-3e38), Vec3::max).to_array(),
        far: below().filter(|light| light.kind == INFINITELY_FAR).map(brightness).sum(),
        axis: axis.as_vec3().to_array(),
        // A node of several lights is a little wider, for rounding.
        cosine: if indices.len() > 1 { (cosine as f32 - 1e-6).max(-1.0) } else { 1.0 },
        area: near().map(|light| light.area).fold(3e38, f32::min),
        light: if is_leaf { indices.first().copied().unwrap_or(NO_LIGHT) } else { NO_LIGHT },
        ..LightNode::default()
    }
}
