//! Measures of virtual lights: how many reach the image, how many move from frame to frame, how much of their
//! energy a clamp removes.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::Image;
use crate::image::{is_finite, luminance};

/// A virtual light: a light on a surface that represents the light reflected there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualLight {
    /// Position in world space \[m\].
    pub position: [f32; 3],
    /// Unit normal; light leaves on this side.
    pub normal: [f32; 3],
    /// Flux Φ \[W\], RGB.
    pub flux: [f32; 3],
    /// Area \[m²\]; 0 for a point light.
    pub area: f32,
}

/// A point of a visible surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    /// Position in world space \[m\].
    pub position: [f32; 3],
    /// Unit normal, on the viewer's side.
    pub normal: [f32; 3],
}

/// Counts the lights that moved by more than `tolerance_m` \[m\] between two frames. Lights are matched by
/// their index in the buffer; if the counts differ, each light without a counterpart counts as moved, and so
/// does one whose position is NaN.
pub fn lights_moved(previous: &[VirtualLight], current: &[VirtualLight], tolerance_m: f32) -> usize {
    let stays = |(a, b): &(&VirtualLight, &VirtualLight)| {
        precise(a.position).distance(precise(b.position)) <= f64::from(tolerance_m)
    };
    previous.len().max(current.len()) - previous.iter().zip(current).filter(stays).count()
}

/// Returns [`lights_moved`] divided by the greater of the two counts; `None` if neither frame has lights.
pub fn share_of_lights_moved(
    previous: &[VirtualLight],
    current: &[VirtualLight],
    tolerance_m: f32,
) -> Option<f64> {
    let all = previous.len().max(current.len());
    (all > 0).then(|| lights_moved(previous, current, tolerance_m) as f64 / all as f64)
}

/// Counts the lights that illuminate at least one of the `receivers`: their flux is positive in some channel,
/// the two face each other, and nothing is between them. `occluded(light, receiver)` returns whether
/// something is between two positions \[m\]; it must ignore the surfaces themselves. The lights are
/// distributed over all threads; each is tested until the first receiver that it reaches. O(lights ·
/// receivers) at worst.
///
/// Receivers are a sample of the pixels, so the count is a lower bound that grows with their number.
pub fn lights_that_reach(
    lights: &[VirtualLight],
    receivers: &[Receiver],
    occluded: &(dyn Fn([f32; 3], [f32; 3]) -> bool + Sync),
) -> usize {
    let reaches = |light: &&VirtualLight| {
        light.flux.iter().any(|&channel| channel > 0.0)
            && receivers.iter().any(|receiver| {
                let towards = precise(receiver.position) - precise(light.position);
                towards.dot(precise(light.normal)) > 0.0
                    && towards.dot(precise(receiver.normal)) < 0.0
                    && !occluded(light.position, receiver.position)
            })
    };
    lights.par_iter().filter(reaches).count()
}

/// Returns the share of the irradiance that clamping removed: `irradiance` has the remaining irradiance in
/// RGB and the luminance of the removed one in alpha, less what rays returned of it. These are estimates: where they return more, the share is
/// 0. Pixels with a NaN or infinite channel are left out; `None` if there is no light at all.
pub fn clamped_share(irradiance: &Image) -> Option<f64> {
    let (mut kept, mut removed) = (0.0, 0.0);
    let pixels = irradiance.pixels().iter();
    for &[r, g, b, clamped] in pixels.filter(|&&pixel| is_finite(pixel) && pixel[3].is_finite()) {
        kept += f64::from(luminance([r, g, b]));
        removed += f64::from(clamped);
    }
    (kept + removed > 0.0).then(|| (removed / (kept + removed)).max(0.0))
}

fn precise(v: [f32; 3]) -> DVec3 {
    Vec3::from(v).as_dvec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: [f32; 3] = [0.0, 1.0, 0.0];
    const DOWN: [f32; 3] = [0.0, -1.0, 0.0];

    fn light(x: f32, normal: [f32; 3]) -> VirtualLight {
        VirtualLight { position: [x, 0.0, 0.0], normal, flux: [1.0; 3], area: 0.0 }
    }

    #[test]
    fn moved_lights_by_hand() {
        let before = [0.0, 1.0, 2.0].map(|x| light(x, UP));
        // The first moves by 0.5, the second stays, the third is gone.
        let now = [0.5, 1.0].map(|x| light(x, UP));
        assert_eq!(lights_moved(&before, &now, 0.1), 2);
        assert_eq!(lights_moved(&before, &now, 0.5), 1);
        assert_eq!(lights_moved(&now, &before, 0.1), 2, "one that comes counts as one that goes");
        assert_eq!(lights_moved(&before, &[f32::NAN, 1.0, 2.0].map(|x| light(x, UP)), 1e9), 1);
        assert_eq!(share_of_lights_moved(&before, &now, 0.1), Some(2.0 / 3.0));
        assert_eq!(share_of_lights_moved(&[], &[], 0.1), None);
    }

    #[test]
    fn reaching_lights_by_hand() {
        // The receiver looks down at the lights from a metre above.
        let receivers = [Receiver { position: [0.0, 1.0, 0.0], normal: DOWN }];
        let mut dark = light(0.0, UP);
        dark.flux = [0.0; 3];
        let lights = [light(0.0, UP), light(5.0, UP), light(0.0, DOWN), dark];
        let free = |_: [f32; 3], _: [f32; 3]| false;
        assert_eq!(lights_that_reach(&lights, &receivers, &free), 2);
        // An occluder is at about x = 5; it is called with the light first, then the receiver.
        let wall = |from: [f32; 3], to: [f32; 3]| from[0] > 4.0 && to[1] == 1.0;
        assert_eq!(lights_that_reach(&lights, &receivers, &wall), 1);
        let turned = [Receiver { normal: UP, ..receivers[0] }];
        assert_eq!(lights_that_reach(&lights, &turned, &free), 0);
        assert_eq!(lights_that_reach(&lights, &[turned, receivers].concat(), &free), 2, "any of them");
        assert_eq!(lights_that_reach(&lights, &[], &free), 0);
    }

    #[test]
    fn clamped_share_by_hand() {
        // Kept: luminances 3 and 0; removed: 0.5 and 0.5. The broken pixels would add 9 and NaN.
        let pixels = vec![
            [3.0, 3.0, 3.0, 0.5],
            [0.0, 0.0, 0.0, 0.5],
            [f32::NAN, 0.0, 0.0, 9.0],
            [1.0, 1.0, 1.0, f32::NAN],
        ];
        let share = clamped_share(&Image::new(4, 1, pixels).unwrap()).unwrap();
        assert!((share - 0.25).abs() < 1e-6, "{share}");
        assert_eq!(clamped_share(&Image::new(1, 1, vec![[0.0; 4]]).unwrap()), None);
        assert_eq!(clamped_share(&Image::new(1, 1, vec![[1.0, 1.0, 1.0, -0.1]]).unwrap()), Some(0.0));
    }
}
