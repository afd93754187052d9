//! The CPU reference of direct-light.wgsl in `f64`: one light, one receiver.

/// A vector, here in the space of a layer: x right, y up, the light looks along −z.
pub type Vec3 = [f64; 3];

/// How steep a plane may rise from texel to texel, in sides of a texel.
pub const STEEPEST: f64 = 8.0;

/// A shadow map: distances along the axis \[m\], 0 where empty, row by row from the top.
#[derive(Clone, Debug)]
pub struct Map {
    /// Side \[px\].
    pub size: u32,
    /// Half the width and height at distance 1; in metres where parallel.
    pub half_extent: [f64; 2],
    /// Of a spot or point light.
    pub perspective: bool,
    /// `size`² distances.
    pub distances: Vec<f64>,
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

impl Map {
    /// Returns the map of one plane through `at` across `normal`.
    pub fn of_plane(size: u32, half_extent: [f64; 2], perspective: bool, at: Vec3, normal: Vec3) -> Map {
        let mut map = Map { size, half_extent, perspective, distances: Vec::new() };
        map.distances = (0..size * size)
            .map(|i| plane_distance(at, normal, map.on_image_plane([i % size, i / size]), perspective))
            .collect();
        map
    }

    /// Returns the centre of a texel on the image plane, y up.
    pub fn on_image_plane(&self, texel: [u32; 2]) -> [f64; 2] {
        let ndc = texel.map(|t| (f64::from(t) + 0.5) / f64::from(self.size) * 2.0 - 1.0);
        [ndc[0] * self.half_extent[0], -ndc[1] * self.half_extent[1]]
    }

    /// Returns the share of the light that reaches `receiver`, whose surface is across `n`. `pcf` is odd, `bias` in
    /// texels.
    pub fn visibility(&self, receiver: Vec3, n: Vec3, pcf: u32, bias: f64) -> f64 {
        let distance = -receiver[2];
        if self.perspective && distance <= 0.0 {
            return 0.0;
        }
        let size = f64::from(self.size);
        let half_extent = self.half_extent.map(|h| if self.perspective { h * distance } else { h });
        let texel = 2.0 * (half_extent[0] / size).max(half_extent[1] / size);
        let cosine = if self.perspective { -dot(n, receiver) / length(receiver) } else { n[2] };
        let slope = ((1.0 - cosine * cosine).max(0.0).sqrt() / cosine.max(1.0 / STEEPEST)).min(STEEPEST);
        let bias = bias * texel * (1.0 + slope);

        let centre = [
            (receiver[0] / half_extent[0] * 0.5 + 0.5) * size - 0.5,
            (receiver[1] / half_extent[1] * -0.5 + 0.5) * size - 0.5,
        ];
        let reach = STEEPEST * texel * f64::from(pcf / 2 + 1);
        let weight = |i: u32, part: f64| match i {
            0 => 1.0 - part,
            i if i == pcf => part,
            _ => 1.0,
        };
        let mut lit = 0.0;
        for (y, x) in (0..=pcf).flat_map(|y| (0..=pcf).map(move |x| (y, x))) {
            let tap = [x, y].map(f64::from);
            let tap = [0, 1]
                .map(|i| (centre[i].floor() - f64::from(pcf / 2) + tap[i]).clamp(0.0, size - 1.0) as u32);
            let expected = plane_distance(receiver, n, self.on_image_plane(tap), self.perspective)
                .clamp(distance - reach, distance + reach);
            let seen = self.distances[(tap[1] * self.size + tap[0]) as usize];
            if seen == 0.0 || seen >= expected - bias {
                lit += weight(x, centre[0] - centre[0].floor()) * weight(y, centre[1] - centre[1].floor());
            }
        }
        lit / f64::from(pcf * pcf)
    }
}

/// Returns the distance along the axis \[m\] at which the plane through `receiver` across `n` is met by the ray through
/// `tap`, a point of the image plane.
pub fn plane_distance(receiver: Vec3, n: Vec3, tap: [f64; 2], perspective: bool) -> f64 {
    if perspective {
        let facing = dot(n, [tap[0], tap[1], -1.0]);
        if facing < 0.0 { dot(n, receiver) / facing } else { -receiver[2] }
    } else if n[2] > 0.0 {
        (n[0] * (tap[0] - receiver[0]) + n[1] * (tap[1] - receiver[1])) / n[2] - receiver[2]
    } else {
        -receiver[2]
    }
}

/// Computes the microfacet reflection \[1/sr\] of one channel: GGX, height-correlated Smith, Schlick. All directions
/// leave the surface, unit.
pub fn ggx(normal: Vec3, to_light: Vec3, to_camera: Vec3, f0: f64, roughness: f64) -> f64 {
    let nl = dot(normal, to_light);
    let nv = dot(normal, to_camera).max(1e-3);
    let a2 = (roughness * roughness).max(1e-3).powi(2);
    let sum: Vec3 = std::array::from_fn(|i| to_light[i] + to_camera[i]);
    let half_way = sum.map(|x| x / length(sum));
    let nh = dot(normal, half_way).clamp(0.0, 1.0);
    let spread = a2 * nh * nh + (1.0 - nh * nh);
    let distribution = a2 / (std::f64::consts::PI * spread * spread);
    let smith = |a: f64, b: f64| a * (a2 + (1.0 - a2) * b * b).sqrt();
    let fresnel = f0 + (1.0 - f0) * (1.0 - dot(to_light, half_way).clamp(0.0, 1.0)).powi(5);
    distribution * 0.5 / (smith(nl, nv) + smith(nv, nl)) * fresnel
}
