//! The origin of a scene: the place in the world of its file that is (0, 0, 0) in the scene.
//!
//! A position in `f32` is rounded by up to 2⁻²⁴ of its distance from (0, 0, 0): at 10⁶ m by 3 cm, whatever the size of
//! the scene. A scene that lies far out is therefore placed around an origin near its geometry, which is subtracted
//! in `f64` from what its files have, before that becomes `f32`. What has a parent is placed in the space of that, and
//! moves with it.

use data_file::grammar::Number;
use glam::{Affine3A, DVec3, Mat3, Vec3};

use crate::assemble::Flattened;
use crate::error::SceneError;
use crate::model::{Node, NodeAnimation};

/// The farthest that the centre of a scene may lie from (0, 0, 0), in its extents. There, positions are rounded by up to 2⁻²⁰
/// extents; farther out it would be by more than the 10⁻⁶ extents nearer than which shaders let rays hit nothing. Rays
/// that begin 2⁻¹⁶ of a position off its surface begin up to 2⁻¹² extents off.
const FARTHEST: f64 = 16.0;

/// The number of times that an origin is replaced by a better one. The first is as precise as `f32` is at the geometry; where the
/// geometry lies farther out than about 10⁶ extents, the second is found with what the first one shows of it.
const REPLACEMENTS: u32 = 2;

/// Places a scene around the origin that suits it: that of the world, unless the geometry lies far from there.
pub(crate) fn settle(
    around: impl Fn(DVec3) -> Result<Flattened, SceneError>,
) -> Result<Flattened, SceneError> {
    let mut scene = around(DVec3::ZERO)?;
    for _ in 0..REPLACEMENTS {
        let (origin, bounds) = scene.still_bounds();
        match better(origin, bounds) {
            Some(better) => scene = around(better)?,
            None => break,
        }
    }
    Ok(scene)
}

/// Returns a better origin than `origin`, if the box, which is relative to it, lies far from it: the centre, rounded to
/// multiples of the power of two above the extent, from which positions of the scene differ exactly in `f64`, and which
/// stay where they are while the geometry changes little.
fn better(origin: DVec3, (min, max): (Vec3, Vec3)) -> Option<DVec3> {
    let (min, max) = (min.as_dvec3(), max.as_dvec3());
    let centre = (min + max) * 0.5;
    let distance = centre.length();
    // Rounding may have changed smaller sizes.
    let extent = (max - min).length().max(distance * f64::from(f32::EPSILON));
    if distance <= FARTHEST * extent {
        return None;
    }
    // Without the fraction, a number is the power of two below: by bits, the same on every machine.
    let unit = 2.0 * f64::from_bits(extent.to_bits() & f64::INFINITY.to_bits());
    let found = ((origin + centre) / unit).round() * unit;
    (found != origin).then_some(found)
}

/// Returns a coordinate of a file, relative to that of the origin.
pub(crate) fn local(number: Number, origin: f64) -> f32 {
    match number {
        // Rounded once.
        Number::Integer(n) if origin == 0.0 => n as f32,
        _ => (number.as_f64() - origin) as f32,
    }
}

/// Returns a coordinate as it is after it was written to a file and read again: `f64` has no room for a distance from
/// the origin that is less than 2⁻⁵³ of the distance to that of the world.
pub(crate) fn kept(coordinate: f32, origin: f64) -> f32 {
    local(Number::Float(origin + f64::from(coordinate)), origin)
}

/// Returns a coordinate relative to an origin as a file has it, with no more digits than make it the same again.
pub(crate) fn written(coordinate: f32, origin: f64) -> String {
    if origin == 0.0 {
        return format!("{coordinate:?}");
    }
    let (world, same) = (origin + f64::from(coordinate), kept(coordinate, origin));
    let reads = |text: &String| text.parse().is_ok_and(|x| local(Number::Float(x), origin) == same);
    (1..=20).map(|digits| format!("{world:.digits$}")).find(reads).unwrap_or_else(|| format!("{world:?}"))
}

/// Returns the transform of a node to the space of a far scene, given that of its parent. Where both lie far out and
/// all but cancel, nothing of their difference is lost.
pub(crate) fn below(parent: &Affine3A, local: &Affine3A) -> Affine3A {
    let [from, to] = [parent.translation, local.translation].map(|at| Vec3::from(at).as_dvec3());
    let translation = from + Mat3::from(parent.matrix3).as_dmat3() * to;
    Affine3A { matrix3: parent.matrix3 * local.matrix3, translation: translation.as_vec3().into() }
}

impl Node {
    /// Moves a node without a parent from the space of the world to that of a scene around `origin`.
    pub(crate) fn move_to(&mut self, origin: DVec3) {
        if origin == DVec3::ZERO {
            return;
        }
        let moved = |at: Vec3| (at.as_dvec3() - origin).as_vec3();
        self.rest.translation = moved(self.rest.translation.into()).into();
        if let Some(NodeAnimation { base, translation, .. }) = &mut self.animation {
            base.translation = moved(base.translation);
            // Slopes are differences.
            translation.iter_mut().flat_map(|track| &mut track.keys).for_each(|(_, at)| *at = moved(*at));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(centre: Vec3) -> (Vec3, Vec3) {
        (centre - 0.5, centre + 0.5)
    }

    #[test]
    fn only_geometry_far_out_gets_an_origin_of_its_own() {
        for near in [Vec3::ZERO, Vec3::ONE, Vec3::new(0.0, -27.0, 0.0)] {
            assert_eq!(better(DVec3::ZERO, cube(near)), None, "{near}");
        }
        let far = better(DVec3::ZERO, cube(Vec3::new(28.3, 0.4, -0.9)));
        assert_eq!(far, Some(DVec3::new(28.0, 0.0, 0.0)), "multiples of 2 m for an extent of √3 m");
        assert_eq!(better(DVec3::ZERO, (Vec3::ZERO, Vec3::ZERO)), None, "nothing lies nowhere");
    }

    #[test]
    fn two_replacements_are_enough_as_far_as_f64_separates_places() {
        for exponent in -30..44 {
            let far = 2f64.powi(exponent) * DVec3::new(1.3, -0.7, 1.1);
            let around = |origin: DVec3| ((far - 0.5 - origin).as_vec3(), (far + 0.5 - origin).as_vec3());
            let mut origin = DVec3::ZERO;
            for _ in 0..REPLACEMENTS {
                origin = better(origin, around(origin)).unwrap_or(origin);
            }
            assert_eq!(better(origin, around(origin)), None, "{far} from {origin}");
            let (min, max) = around(origin);
            assert!(min.abs().max(max.abs()).max_element() < 50.0, "{far} from {origin}: {min} to {max}");
            assert!((max - min - 1.0).abs().max_element() < 4e-6, "{far} from {origin}: {min} to {max}");
        }
    }

    #[test]
    fn written_coordinates_are_short_and_read_the_same() {
        assert_eq!(written(0.278, 0.0), "0.278");
        assert_eq!(written(0.278, 1e6), "1000000.278");
        assert_eq!(written(-0.5, -4096.0), "-4096.5");
        assert_eq!(written(0.0, 1e6), "1000000.0");
        for origin in [1e3, -7e6, 3e9, 0.5] {
            for value in [0.1f32, -3.33e-4, 1.0 / 3.0, 7e-20, f32::MIN_POSITIVE, 123_456.79] {
                let read: f64 = written(value, origin).parse().expect("a number");
                assert_eq!(local(Number::Float(read), origin), kept(value, origin), "{value} from {origin}");
            }
        }
        assert_eq!(kept(0.1, 1e6), 0.1, "f64 holds both");
    }
}
