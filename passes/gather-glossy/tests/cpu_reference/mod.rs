//! The CPU reference in `f64`, with the names of lobe.wgsl. All directions leave the surface, unit.

use glam::DVec3;
use std::f64::consts::PI;

/// How surfaces reflect specularly.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Model {
    /// Of a roughness.
    Ggx(f64),
    /// Of an exponent.
    Phong(f64),
    /// Of an exponent.
    Blinn(f64),
}

impl Model {
    /// The value of the setting `model`.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Model::Ggx(_) => "ggx",
            Model::Phong(_) => "phong",
            Model::Blinn(_) => "blinn",
        }
    }

    /// Returns the lobe of the reflectance 1 \[1/sr\].
    pub(crate) fn lobe(self, normal: DVec3, from: DVec3, to: DVec3) -> f64 {
        let (nl, nv, half_way) = (normal.dot(from), normal.dot(to), (from + to).normalize());
        if nl <= 0.0 || nv <= 0.0 {
            return 0.0;
        }
        let nh = normal.dot(half_way).clamp(0.0, 1.0);
        match self {
            Model::Ggx(roughness) => {
                let a2 = roughness.powi(4).max(1e-6);
                let nv = nv.max(1e-3);
                let distribution = a2 / (PI * (nh * nh * (a2 - 1.0) + 1.0).powi(2));
                let shadowing = |x: f64, y: f64| x * (a2 + (1.0 - a2) * y * y).sqrt();
                distribution * 0.5 / (shadowing(nl, nv) + shadowing(nv, nl))
            }
            Model::Phong(n) => {
                let mirrored = 2.0 * nl * normal - from;
                (n + 2.0) / (2.0 * PI) * mirrored.dot(to).max(0.0).powf(n)
            }
            Model::Blinn(n) => {
                let whole = 8.0 * PI * (2f64.powf(-0.5 * n) + n) / ((n + 2.0) * (n + 4.0));
                nh.powf(n) / whole
            }
        }
    }
}

/// Directions over the hemisphere above a normal, each for the same solid angle, 2π / their number.
pub(crate) fn hemisphere(normal: DVec3, rings: u32, sides: u32) -> impl Iterator<Item = DVec3> {
    let (u, v) = normal.any_orthonormal_pair();
    (0..rings * sides).map(move |i| {
        let cosine = (f64::from(i / sides) + 0.5) / f64::from(rings);
        let (sin, cos) = (2.0 * PI * (f64::from(i % sides) + 0.5) / f64::from(sides)).sin_cos();
        normal * cosine + (1.0 - cosine * cosine).sqrt() * (cos * u + sin * v)
    })
}
