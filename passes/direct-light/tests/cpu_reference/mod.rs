//! The CPU reference of direct-light.wgsl in `f64`: one light, one receiver. Vectors are in the
//! space of a layer: x right, y up, the light looks along −z.

use glam::{DVec2, DVec3, UVec2};

/// The greatest slope of a plane from texel to texel, in sides of a texel.
pub(crate) const STEEPEST: f64 = 8.0;

/// A shadow map: distances along the axis \[m\], 0 where empty, row by row from the top.
#[derive(Clone, Debug)]
pub(crate) struct Map {
    /// Side \[px\].
    pub(crate) size: u32,
    /// Half the width and height at distance 1; in metres if the projection is parallel.
    pub(crate) half_extent: DVec2,
    /// Whether the map belongs to a spot or point light, and so is a perspective projection.
    pub(crate) perspective: bool,
    /// `size`² distances.
    pub(crate) distances: Vec<f64>,
}

impl Map {
    /// Returns the map of one plane through `at` with the normal `normal`.
    pub(crate) fn of_plane(
        size: u32,
        half_extent: DVec2,
        perspective: bool,
        at: DVec3,
        normal: DVec3,
    ) -> Map {
        let mut map = Map { size, half_extent, perspective, distances: Vec::new() };
        map.distances = (0..size * size)
            .map(|i| {
                plane_distance(at, normal, map.on_image_plane(UVec2::new(i % size, i / size)), perspective)
            })
            .collect();
        map
    }

    /// Returns the centre of a texel on the image plane, y up.
    pub(crate) fn on_image_plane(&self, texel: UVec2) -> DVec2 {
        let ndc = (texel.as_dvec2() + 0.5) / f64::from(self.size) * 2.0 - 1.0;
        ndc * self.half_extent * DVec2::new(1.0, -1.0)
    }

    /// Returns the share of the light that reaches `receiver`, whose normal is `n`. `pcf` is odd, `bias` in
    /// texels.
    pub(crate) fn visibility(&self, receiver: DVec3, n: DVec3, pcf: u32, bias: f64) -> f64 {
        let distance = -receiver.z;
        if self.perspective && distance <= 0.0 {
            return 0.0;
        }
        let size = f64::from(self.size);
        let half_extent = self.half_extent * if self.perspective { distance } else { 1.0 };
        let texel = 2.0 * (half_extent / size).max_element();
        let cosine = if self.perspective { -n.dot(receiver) / receiver.length() } else { n.z };
        let slope = ((1.0 - cosine * cosine).max(0.0).sqrt() / cosine.max(1.0 / STEEPEST)).min(STEEPEST);
        let bias = bias * texel * (1.0 + slope);

        let centre = (receiver.truncate() / half_extent * DVec2::new(0.5, -0.5) + 0.5) * size - 0.5;
        let (low, part) = (centre.floor() - f64::from(pcf / 2), centre.fract_gl());
        let reach = STEEPEST * texel * f64::from(pcf / 2 + 1);
        let weight = |i: u32, part: f64| match i {
            0 => 1.0 - part,
            i if i == pcf => part,
            _ => 1.0,
        };
        let (mut lit, mut weights) = (0.0, 0.0);
        for (y, x) in (0..=pcf).flat_map(|y| (0..=pcf).map(move |x| (y, x))) {
            let tap = low + UVec2::new(x, y).as_dvec2();
            let tap = tap.clamp(DVec2::ZERO, DVec2::splat(size - 1.0)).as_uvec2();
            let expected = plane_distance(receiver, n, self.on_image_plane(tap), self.perspective)
                .clamp(distance - reach, distance + reach);
            let seen = self.distances[(tap.y * self.size + tap.x) as usize];
            if seen != 0.0 {
                let weight = weight(x, part.x) * weight(y, part.y);
                lit += if seen >= expected - bias { weight } else { 0.0 };
                weights += weight;
            }
        }
        if weights > 0.0 { lit / weights } else { 1.0 }
    }
}

/// Returns the distance along the axis \[m\] at which the ray through `tap`, a point of the image plane,
/// meets the plane through `receiver` with the normal `n`.
pub(crate) fn plane_distance(receiver: DVec3, n: DVec3, tap: DVec2, perspective: bool) -> f64 {
    if perspective {
        let facing = n.dot(tap.extend(-1.0));
        if facing < 0.0 { n.dot(receiver) / facing } else { -receiver.z }
    } else if n.z > 0.0 {
        n.truncate().dot(tap - receiver.truncate()) / n.z - receiver.z
    } else {
        -receiver.z
    }
}

/// Computes the microfacet reflection \[1/sr\] of one channel: GGX, height-correlated Smith, Schlick. All directions
/// leave the surface, unit.
pub(crate) fn ggx(normal: DVec3, to_light: DVec3, to_camera: DVec3, f0: f64, roughness: f64) -> f64 {
    let nl = normal.dot(to_light);
    let nv = normal.dot(to_camera).max(1e-3);
    let a2 = (roughness * roughness).max(1e-3).powi(2);
    let half_way = (to_light + to_camera).normalize();
    let nh = normal.dot(half_way).clamp(0.0, 1.0);
    let spread = a2 * nh * nh + (1.0 - nh * nh);
    let distribution = a2 / (std::f64::consts::PI * spread * spread);
    let smith = |a: f64, b: f64| a * (a2 + (1.0 - a2) * b * b).sqrt();
    let fresnel = f0 + (1.0 - f0) * (1.0 - to_light.dot(half_way).clamp(0.0, 1.0)).powi(5);
    distribution * 0.5 / (smith(nl, nv) + smith(nv, nl)) * fresnel
}
