//! Maps, seeds, and runs of the pass.

use crate::cpu_reference::{Pyramid, Texel};
use interfaces::clusters::{self, Cluster, ClustersHeader, NO_TEXEL, state};
use pass_test::random::{halton3, hash, hash2, unit_float};
use pass_test::{Harness, Outputs, RsmTexel};
use warp_clusters::PASS;

/// A lit texel whose members all identify it.
pub(crate) fn texel(index: u32, importance: f32) -> Texel {
    Texel {
        position: Some([index as f32, 2.0, -1.0]),
        normal: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][index as usize % 3],
        flux: [index as f32, 0.5, 3.0],
        importance,
    }
}

/// A map of this importance, all of it lit.
pub(crate) fn map(importance: &[f32], size: [u32; 2]) -> Pyramid {
    Pyramid::new((0..).zip(importance).map(|(i, f)| texel(i, *f)).collect(), size)
}

/// Importance over two decades, with zeros, and a row of zeros.
pub(crate) fn importance(size: [u32; 2], layers: u32) -> Vec<f32> {
    (0..layers * size[0] * size[1])
        .map(|i| {
            let bits = hash2(i, 23);
            let empty = (i / size[0] % size[1] == 3 && size[1] > 4) || bits.is_multiple_of(4);
            if empty { 0.0 } else { 10.0_f32.powf(2.0 * unit_float(hash(bits)) as f32) }
        })
        .collect()
}

/// The first elements of the sequence.
pub(crate) fn halton(count: u32) -> Vec<[f64; 2]> {
    (1..=count).map(|element| [halton3(element, 0)[0], halton3(element, 0)[1]]).collect()
}

/// Points that are independent.
pub(crate) fn independent(count: u32, salt: u32) -> Vec<[f64; 2]> {
    (0..count).map(|i| [0, 1].map(|axis| unit_float(hash2(hash2(i, salt), axis)))).collect()
}

/// Clusters with these seeds.
pub(crate) fn seeds(of: &[[f64; 2]]) -> Vec<Cluster> {
    let seed = |uv: &[f64; 2]| Cluster {
        uv: uv.map(|x| x as f32),
        texel: NO_TEXEL,
        generation: 1,
        state: state::SEEDED,
        ..Cluster::default()
    };
    of.iter().map(seed).collect()
}

/// Settings, and what precedes the clusters.
#[derive(Clone, Copy, Default)]
pub(crate) struct Run {
    pub(crate) levels: u32,
    pub(crate) seed: u32,
    pub(crate) header: ClustersHeader,
}

/// Runs the pass.
pub(crate) fn outputs(map: &Pyramid, clusters: &[Cluster], run: Run) -> Option<Outputs> {
    let size = (map.size[0], map.size[1]);
    let texel = |texel: &Texel| {
        let ([x, y, z], [r, g, b]) = (texel.position.unwrap_or_default(), texel.flux);
        let depth = if texel.position.is_some() { 4.0 } else { 0.0 };
        // Normals of half floats are not quite unit.
        let normal = texel.normal.map(|x| 1.0005 * x);
        RsmTexel { position: [x, y, z, depth], normal, flux: [r, g, b, 0.25] }
    };
    let texels: Vec<RsmTexel> = map.texels.iter().map(texel).collect();
    let importance: Vec<f32> = map.texels.iter().map(|texel| texel.importance).collect();
    Harness::new(PASS)
        .set("levels", run.levels)
        .seed(run.seed)
        .clusters(&run.header, clusters)
        .rsm(size, &texels)
        .importance(size, &importance)
        .run()
}

/// Runs the pass and returns what became of the clusters.
pub(crate) fn run(map: &Pyramid, clusters: &[Cluster], run: Run) -> Option<Vec<Cluster>> {
    let bytes: Vec<u8> = outputs(map, clusters, run)?.read("warped");
    let (header, warped) =
        clusters::from_bytes(&bytes).expect("there are as many clusters as the header says");
    assert_eq!(header, ClustersHeader { count: clusters.len() as u32, ..run.header });
    Some(warped)
}

/// Returns the clusters that seeds became.
pub(crate) fn warped(map: &Pyramid, of: &[[f64; 2]], levels: u32) -> Option<Vec<Cluster>> {
    run(map, &seeds(of), Run { levels, ..Run::default() })
}
