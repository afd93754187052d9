//! The same rays through the same triangles by a native traversal, the one of obvhs: nodes of eight children
//! (Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs") by SIMD
//! instructions, on all cores.

use super::{Goal, Row, Spread, TIMED};
use anyhow::Result;
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;
use rayon::prelude::*;
use scene::Scene;
use std::time::{Duration, Instant};

/// As `FAR` of shaders/ray-tracing.wgsl.
const FAR: f32 = 3.0e38;

/// Rays that a thread takes at a time.
const TAKEN: usize = 2048;

/// A scene with the rays of each timed pass, and the milliseconds that they took in each run.
pub(super) struct Native {
    bvh: CwBvh,
    /// In the order of the leaves.
    triangles: Vec<Triangle>,
    rays: [Vec<Ray>; TIMED.len()],
    times: [Vec<f64>; TIMED.len()],
    hits: [u64; TIMED.len()],
}

impl Native {
    /// Builds the best tree that obvhs has. `bytes` returns the rays of a timed pass, as shaders/bench/ray.wgsl has
    /// them.
    pub(super) fn new(scene: &Scene, bytes: impl Fn(&str) -> Result<Vec<u8>>) -> Result<Native> {
        let corner = |vertex: u32| Vec3A::from(scene.vertices[vertex as usize].position);
        let triangle = |t: &[u32]| Triangle { v0: corner(t[0]), v1: corner(t[1]), v2: corner(t[2]) };
        let triangles: Vec<Triangle> = scene.indices.chunks_exact(3).map(triangle).collect();
        let bvh =
            build_cwbvh_from_tris(&triangles, BvhBuildParams::very_slow_build(), &mut Duration::default());
        let triangles = bvh.primitive_indices.iter().map(|index| triangles[*index as usize]).collect();
        let mut rays = [const { Vec::new() }; TIMED.len()];
        for (rays, (pass, _)) in rays.iter_mut().zip(TIMED) {
            *rays = existing(&bytes(pass)?);
        }
        Ok(Native {
            bvh,
            triangles,
            rays,
            times: [const { Vec::new() }; TIMED.len()],
            hits: [0; TIMED.len()],
        })
    }

    /// Traces all rays once.
    pub(super) fn run(&mut self) {
        for (k, (pass, _)) in TIMED.iter().enumerate() {
            let start = Instant::now();
            let hits = |rays: &[Ray]| -> u64 {
                let any = pass.ends_with("-any");
                rays.iter()
                    .map(|ray| u64::from(if any { self.occluded(ray) } else { self.closest(ray) }))
                    .sum()
            };
            self.hits[k] = self.rays[k].par_chunks(TAKEN).map(hits).sum();
            self.times[k].push(start.elapsed().as_secs_f64() * 1e3);
        }
    }

    /// Whether there is a closest hit.
    fn closest(&self, ray: &Ray) -> bool {
        let mut hit = RayHit::none();
        self.bvh.ray_traverse(*ray, &mut hit, |ray, index| self.triangles[index].intersect(ray))
    }

    fn occluded(&self, ray: &Ray) -> bool {
        !self.bvh.ray_traverse_miss(*ray, |ray, index| self.triangles[index].intersect(ray))
    }

    /// The rates, and how many times as fast as the shader they are: of the runs in which both were timed, one after
    /// the other. `shader` has the milliseconds of each timed pass in each run.
    pub(super) fn rows(&self, shader: &[Vec<f64>; TIMED.len()], scene: &str) -> Vec<Row> {
        let mut rows = Vec::new();
        for (k, (_, what)) in TIMED.iter().enumerate() {
            let rate = Spread::of(self.times[k].clone()).under(self.rays[k].len() as f64 / 1e3);
            let counts = vec![("rays", self.rays[k].len() as u64), ("hits", self.hits[k])];
            rows.push(Row::new(format!("{what}, {scene}, native"), rate, "Mray/s").counts(counts));
            let ratios = shader[k].iter().zip(&self.times[k]).map(|(shader, native)| shader / native);
            let name = format!("{what}, {scene}, native over shader");
            rows.push(
                Row::new(name, Spread::of(ratios.collect()), "×")
                    .goal(Goal::AtMost(3.0), "own, where a CPU runs shaders"),
            );
        }
        rows
    }
}

/// The rays that exist of a buffer of rays.
fn existing(bytes: &[u8]) -> Vec<Ray> {
    let words = |ray: &[u8]| -> [u32; 8] {
        std::array::from_fn(|k| {
            u32::from_le_bytes([ray[4 * k], ray[4 * k + 1], ray[4 * k + 2], ray[4 * k + 3]])
        })
    };
    let vector = |words: &[u32; 8], first: usize| {
        Vec3A::from_array(std::array::from_fn(|axis| f32::from_bits(words[first + axis])))
    };
    let rays = bytes.chunks_exact(32).map(words).filter(|words| words[3] != 0);
    rays.map(|words| Ray::new(vector(&words, 0), vector(&words, 4), 0.0, FAR)).collect()
}
