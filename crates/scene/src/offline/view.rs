//! Where cameras and lights look.

use glam::{DMat4, DVec3};

/// Returns the transform to the world from what is at `eye` and looks at `at`: +z into the scene, +y up, and +x such that
/// y × z = x. Without `up`, any direction that is perpendicular is; `None` where it looks at its own position, or along its `up`.
pub(super) fn look_at(eye: DVec3, at: DVec3, up: Option<DVec3>) -> Option<DMat4> {
    let z = (at - eye).try_normalize()?;
    let up = up.unwrap_or_else(|| z.any_orthonormal_vector());
    let x = up.normalize_or_zero().cross(z).try_normalize()?;
    Some(DMat4::from_cols(x.extend(0.0), z.cross(x).extend(0.0), z.extend(0.0), eye.extend(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_looks_along_z_with_x_to_the_right_of_a_left_handed_world() {
        let eye = DVec3::new(1.0, 2.0, 3.0);
        let camera = look_at(eye, DVec3::new(1.0, 2.0, 8.0), Some(DVec3::Y)).expect("a view");
        assert_eq!(camera, DMat4::from_translation(eye));
        assert!(look_at(eye, eye, Some(DVec3::Y)).is_none());
        assert!(look_at(eye, eye + DVec3::Y, Some(DVec3::Y)).is_none());
    }
}
