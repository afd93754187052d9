//! Geometry, rays, and the hits that they must have.

use glam::{DVec3, Vec3};
use ray_tracing::Bvh;
use scene::Scene;

/// Triangles by their vertices.
#[derive(Clone, Default)]
pub(crate) struct Mesh {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) indices: Vec<u32>,
}

impl Mesh {
    pub(crate) fn of(scene: &Scene) -> Mesh {
        let positions = scene.vertices.iter().map(|vertex| vertex.position).collect();
        Mesh { positions, indices: scene.indices.clone() }
    }

    /// A sphere of radius 1 about `center`: `rings` × 2 `rings` squares cut in two, the poles triangles. Closed:
    /// neighbours share vertices.
    pub(crate) fn sphere(rings: u32, center: Vec3) -> Mesh {
        let sectors = 2 * rings;
        let mut mesh = Mesh::default();
        for ring in 0..=rings {
            for sector in 0..sectors {
                let (polar, azimuth) = (
                    std::f32::consts::PI * ring as f32 / rings as f32,
                    std::f32::consts::TAU * sector as f32 / sectors as f32,
                );
                let (sin, cos) =
                    if ring == 0 || ring == rings { (0.0, polar.cos()) } else { polar.sin_cos() };
                let place = Vec3::new(sin * azimuth.cos(), cos, sin * azimuth.sin());
                mesh.positions.push((center + place).into());
            }
        }
        for ring in 0..rings {
            for sector in 0..sectors {
                let at = |down: u32, right: u32| (ring + down) * sectors + (sector + right) % sectors;
                mesh.indices.extend([at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)]);
            }
        }
        mesh
    }

    pub(crate) fn map(mut self, place: impl Fn(Vec3) -> Vec3) -> Mesh {
        self.positions.iter_mut().for_each(|position| *position = place(Vec3::from(*position)).into());
        self
    }

    pub(crate) fn bvh(&self) -> Bvh {
        Bvh::build(&self.positions, &self.indices)
    }

    pub(crate) fn triangle(&self, index: u32) -> [Vec3; 3] {
        [0, 1, 2].map(|k| Vec3::from(self.positions[self.indices[3 * index as usize + k] as usize]))
    }

    pub(crate) fn triangles(&self) -> u32 {
        self.indices.len() as u32 / 3
    }

    /// The distance of the closest hit, by testing every triangle in `f64` (Möller and Trumbore 1997). `slack`
    /// widens triangles, in their own coordinates.
    pub(crate) fn brute_force(&self, ray: &Ray, slack: f64) -> Option<f64> {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let hit = |index: u32| {
            let [a, b, c] = self.triangle(index).map(|corner| corner.as_dvec3());
            let (e1, e2) = (b - a, c - a);
            let p = direction.cross(e2);
            let determinant = e1.dot(p);
            if determinant == 0.0 || e1.cross(e2) == DVec3::ZERO {
                return None;
            }
            let s = origin - a;
            let u = s.dot(p) / determinant;
            let q = s.cross(e1);
            let v = direction.dot(q) / determinant;
            let t = e2.dot(q) / determinant;
            let inside = u >= -slack && v >= -slack && u + v <= 1.0 + slack;
            (inside && t > f64::from(ray.nearest) && t < f64::from(ray.farthest)).then_some(t)
        };
        (0..self.triangles()).filter_map(hit).reduce(f64::min)
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: Vec3,
    pub(crate) direction: Vec3,
    pub(crate) nearest: f32,
    pub(crate) farthest: f32,
}

impl Ray {
    pub(crate) fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, direction, nearest: 0.0, farthest: f32::MAX }
    }
}

/// Numbers in [0, 1) (SplitMix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    }

    pub(crate) fn in_cube(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }

    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.in_cube();
            if (1e-3..1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }

    /// From around and inside a box, with directions of many lengths, one in eight along an axis.
    pub(crate) fn rays(&mut self, (low, high): (Vec3, Vec3), count: usize) -> Vec<Ray> {
        (0..count)
            .map(|i| {
                let (center, half) = ((low + high) * 0.5, (high - low) * 0.5);
                let origin = center + self.in_cube() * half * 1.2;
                let direction = if i % 8 == 0 { Vec3::AXES[i / 8 % 3] } else { self.direction() };
                Ray::new(origin, direction * half.length() * 4.0_f32.powf(self.next() * 4.0 - 2.0))
            })
            .collect()
    }
}
