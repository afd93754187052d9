//! Moves a camera by mouse and keys: flying, orbiting, going to a point.

use glam::{Mat3, Quat, Vec2, Vec3};
use scene::Camera;

/// The least angle between the direction of a camera and the poles of `up` \[rad\].
const POLE: f32 = 0.02;

/// Turns a camera in place: right and down \[rad\].
pub(crate) fn look(camera: &Camera, right: f32, down: f32) -> Camera {
    let distance = camera.position.distance(camera.target);
    let forward = turned(camera.forward(), camera.up, right, down);
    Camera { target: camera.position + forward * distance, ..*camera }
}

/// Moves a camera around its target: right and down \[rad\].
pub(crate) fn orbit(camera: &Camera, right: f32, down: f32) -> Camera {
    let distance = camera.position.distance(camera.target);
    let forward = turned(camera.forward(), camera.up, right, down);
    Camera { position: camera.target - forward * distance, ..*camera }
}

/// A direction turned about `up`, and towards or away from it, but not across.
fn turned(forward: Vec3, up: Vec3, right: f32, down: f32) -> Vec3 {
    let up = up.normalize_or(Vec3::Y);
    let forward = Quat::from_axis_angle(up, -right) * forward;
    let side = forward.cross(up);
    if side.length_squared() < 1e-12 {
        return forward;
    }
    let from_up = forward.angle_between(up);
    let to = (from_up + down).clamp(POLE, std::f32::consts::PI - POLE);
    (Quat::from_axis_angle(side.normalize(), from_up - to) * forward).normalize()
}

/// Moves a camera with its target: right, up and forward \[m\].
pub(crate) fn fly(camera: &Camera, by: Vec3) -> Camera {
    let step = axes(camera) * by;
    Camera { position: camera.position + step, target: camera.target + step, ..*camera }
}

/// Moves a camera along its axis towards the target by a share of the distance; it never arrives.
pub(crate) fn approach(camera: &Camera, share: f32) -> Camera {
    let away = camera.position - camera.target;
    let position = camera.target + away * (1.0 - share).clamp(0.05, 20.0);
    Camera { position, ..*camera }
}

/// A camera that looks at a point from two thirds of the distance nearer, and orbits around it from now on.
pub(crate) fn go_to(camera: &Camera, point: Vec3) -> Camera {
    let position = camera.position.lerp(point, 2.0 / 3.0);
    if position.distance_squared(point) < 1e-12 {
        return *camera;
    }
    Camera { position, target: point, ..*camera }
}

/// A camera on the way between two, of which one is where it goes to.
pub(crate) fn between(from: &Camera, to: &Camera, share: f32) -> Camera {
    let share = share * share * (3.0 - 2.0 * share);
    Camera {
        position: from.position.lerp(to.position, share),
        target: from.target.lerp(to.target, share),
        ..*to
    }
}

/// Right, up and forward as columns.
pub(crate) fn axes(camera: &Camera) -> Mat3 {
    let forward = camera.forward();
    let right = forward.cross(camera.up).normalize_or(forward.any_orthonormal_vector());
    Mat3::from_cols(right, right.cross(forward), forward)
}

/// Metres that a pixel stands for at the depth of a point, in a frame of this height \[px\].
pub(crate) fn metres_per_pixel(camera: &Camera, point: Vec3, height: f32) -> f32 {
    let depth = (point - camera.position).dot(camera.forward()).max(camera.near);
    2.0 * depth * (camera.vertical_fov * 0.5).tan() / height.max(1.0)
}

/// A point moved across the view by pixels: x to the right, y down.
pub(crate) fn shifted(camera: &Camera, point: Vec3, by: Vec2, height: f32) -> Vec3 {
    let axes = axes(camera);
    let metres = metres_per_pixel(camera, point, height);
    point + (axes.x_axis * by.x - axes.y_axis * by.y) * metres
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            position: Vec3::new(1.0, 2.0, 3.0),
            target: Vec3::new(1.0, 2.0, -1.0),
            up: Vec3::Y,
            vertical_fov: 1.0,
            near: 0.01,
        }
    }

    #[test]
    fn looking_right_turns_to_the_right_and_stays_in_place() {
        let turned = look(&camera(), 0.5, 0.0);
        assert_eq!(turned.position, camera().position);
        assert!(turned.forward().x > 0.4 && turned.forward().y.abs() < 1e-6);
        let down = look(&camera(), 0.0, 0.5);
        assert!(down.forward().y < -0.4);
        // However far it is turned, it never looks along `up`.
        let floor = look(&camera(), 0.0, 100.0);
        assert!(floor.forward().y > -1.0 && floor.forward().y < -0.99);
    }

    #[test]
    fn orbiting_keeps_the_distance_and_the_target() {
        let orbited = orbit(&camera(), 1.0, -0.3);
        assert_eq!(orbited.target, camera().target);
        assert!((orbited.position.distance(orbited.target) - 4.0).abs() < 1e-5);
    }

    #[test]
    fn a_shift_moves_a_point_by_pixels() {
        let (camera, size) = (camera(), [640, 480]);
        let point = Vec3::new(0.3, 2.5, -2.0);
        let moved = shifted(&camera, point, Vec2::new(20.0, -7.0), 480.0);
        let by = camera.project(moved, size).unwrap() - camera.project(point, size).unwrap();
        assert!((by - Vec2::new(20.0, -7.0)).length() < 1e-2, "{by}");
    }

    #[test]
    fn flying_goes_forward_and_never_changes_the_direction() {
        let flown = fly(&camera(), Vec3::new(0.0, 0.0, 2.0));
        assert_eq!(flown.position, Vec3::new(1.0, 2.0, 1.0));
        assert!((flown.forward() - camera().forward()).length() < 1e-6);
        let right = fly(&camera(), Vec3::X);
        assert!((right.position - Vec3::new(2.0, 2.0, 3.0)).length() < 1e-6);
    }
}
