//! The cones of spot lights.

/// Returns the inner cone \[rad\] of a spot whose flux is `2π · share` times its intensity, and whose intensity falls to 0 at
/// `cos_outer`: between the cones of a scene's light, the mean over the cosine is a third.
pub(super) fn inner_cone(share: f64, cos_outer: f64) -> f64 {
    // share = 1 − cos inner + (cos inner − cos outer)/3
    (1.5 * (1.0 - share - cos_outer / 3.0)).clamp(cos_outer.min(1.0), 1.0).acos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{Light, LightKind};
    use glam::Vec3;
    use std::f64::consts::TAU;

    #[test]
    fn the_flux_is_that_of_the_other_falloff() {
        for (start, end) in [(20.0_f64, 30.0_f64), (0.0, 60.0), (44.9, 45.0), (80.0, 90.0)] {
            let [cos_start, cos_end] = [start, end].map(|degrees| degrees.to_radians().cos());
            let share = (1.0 - cos_start) + 0.5 * (cos_start - cos_end);
            let inner = inner_cone(share, cos_end) as f32;
            let light = Light {
                name: String::new(),
                kind: LightKind::Spot { inner, outer: end.to_radians() as f32 },
                position: Vec3::ZERO,
                direction: Vec3::Z,
                intensity: Vec3::ONE,
            };
            let flux = f64::from(light.flux().expect("a spot").x);
            assert!((flux / (TAU * share) - 1.0).abs() < 1e-4, "{start} to {end}: {flux}");
        }
    }
}
