//! Splats of what rays find.

use super::{STORED, on_the_floor};
use glam::{DVec3, uvec2};
use gpu_algorithms::reference::paraboloid::texel_centre;
use pass_test::{Harness, elements, light_at};

/// No light sees a point: what the maps have, rays found.
#[test]
fn what_rays_meet_is_splatted() {
    // No light sees it: it lies in the plane of one or behind it.
    let unseen = [[0.5, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0_f32]];
    let maps = |height: f64, texels: u32| {
        let outputs = Harness::new(splat::PASS)
            .scene("plane")
            .set("map", 32)
            .set("points_per_map", 1)
            .set("traced", true)
            .set("texels_per_ray", texels)
            .input("points", "Points", &[("count", 1)], elements(&unseen))
            .module(STORED)
            .lights(&[light_at(DVec3::Y, DVec3::Y), light_at(height * DVec3::Y, DVec3::NEG_Y)])
            .run()?;
        let depth: Vec<f32> = outputs.read::<u32>("depth").into_iter().map(f32::from_bits).collect();
        Some(depth)
    };
    // From 1 cm, the plane is nearly all that a light sees.
    for (height, texels) in [(1.0, 1), (1.0, 4), (0.01, 1), (0.01, 4)] {
        let Some(depth) = maps(height, texels) else { return };
        let (behind, depth) = depth.split_at(32 * 32);
        assert!(behind.iter().all(|depth| *depth == f32::INFINITY), "the first light sees nothing");
        let (mut seen, mut met) = (0_usize, 0_usize);
        for (i, depth) in depth.iter().map(|depth| f64::from(*depth)).enumerate() {
            // The map of a light that is lower sees the same, nearer.
            let at = on_the_floor(i);
            let is_below = texel_centre(uvec2(i as u32 % 32, i as u32 / 32), 32).length_squared() < 1.0;
            let (side, wanted) = (height * at.x.abs().max(at.z.abs()), height * at.distance(DVec3::Y));
            if is_below && side < 0.98 {
                seen += 1;
                met += usize::from(depth.is_finite());
                let is_right = depth.is_infinite() || (depth - wanted).abs() < 1e-4 * wanted;
                assert!(
                    is_right,
                    "a ray for {texels}² texels, {height} m: texel {i} has {depth} for {wanted}"
                );
            } else if !is_below || side > 1.02 {
                assert!(depth.is_infinite(), "a ray for {texels}² texels, {height} m: texel {i} has {depth}");
            }
        }
        // Measured: 0.88 to 0.99.
        assert!(20 * met >= 17 * seen, "a ray for {texels}² texels, {height} m: {met} of {seen}");
    }
}
