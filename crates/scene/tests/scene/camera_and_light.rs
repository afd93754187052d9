//! Projection, cones, flux: closed forms.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};
use proptest::prelude::*;
use scene::{Camera, Light, LightKind};

fn camera() -> Camera {
    Camera {
        position: Vec3::new(0.0, 0.0, 5.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        vertical_fov: 90f32.to_radians(),
        near: 0.01,
    }
}

#[test]
fn a_known_point_falls_on_a_known_pixel() {
    // At 90° the frame's upper edge is as far from the axis as the point is from the camera: 5 m at z = 0.
    // So 1 m is a tenth of the height: 10 pixels of 100, also along x.
    let size = [200, 100];
    let at = |x, y, z| camera().project(Vec3::new(x, y, z), size);
    assert_eq!(at(0.0, 0.0, 0.0), Some(Vec2::new(100.0, 50.0)), "the target is in the middle");
    let right = at(1.0, 0.0, 0.0).expect("in front");
    assert!(right.abs_diff_eq(Vec2::new(110.0, 50.0), 1e-4), "+x is to the right: {right}");
    let up = at(0.0, 5.0, 0.0).expect("in front");
    assert!(up.abs_diff_eq(Vec2::new(100.0, 0.0), 1e-4), "row 0 is on top: {up}");
    assert_eq!(at(0.0, 0.0, 6.0), None, "behind the camera");
}

#[test]
fn a_ray_goes_through_what_is_seen_there() {
    // At 90° the picture is as high as it is far; twice as wide as high here. Up in the picture is +y.
    let (origin, right_and_up) = camera().ray(Vec2::new(0.5, 1.0), 2.0);
    assert_eq!(origin, camera().position);
    assert!(right_and_up.abs_diff_eq(Vec3::new(1.0, 1.0, -1.0).normalize(), 1e-6), "{right_and_up}");
    let corner = camera().project_to_ndc(Vec3::new(-10.0, 5.0, 0.0), 2.0).expect("in front");
    assert!(corner.abs_diff_eq(Vec2::new(-1.0, 1.0), 1e-5), "the upper left corner: {corner}");
    assert_eq!(camera().project_to_ndc(Vec3::new(0.0, 0.0, 5.1), 2.0), None, "behind the camera");
}

fn point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-10.0f32..10.0).prop_map(Vec3::from)
}

proptest! {
    #[test]
    fn rays_are_those_of_the_shaders_and_the_inverse_of_projection(
        (position, target, up) in (point(), point(), point()),
        fov in 5.0f32..150.0,
        at in prop::array::uniform2(0.0f32..1.0),
        distance in 1.0f32..50.0,
    ) {
        prop_assume!((target - position).length() > 0.1 && up.length() > 0.1);
        let vertical_fov = fov.to_radians();
        let camera = Camera { position, target, up, vertical_fov, near: 0.01 };
        let size = Vec2::new(320.0, 200.0);
        let (at_px, aspect) = (Vec2::from(at) * size, 320.0 / 200.0);
        let ndc = Vec2::new(2.0, -2.0) * at_px / size + Vec2::new(-1.0, 1.0);
        let (origin, direction) = camera.ray(ndc, aspect);
        // `view_ray` of shaders/camera.wgsl, with the `half_extent` that is uploaded for it.
        let tan = (vertical_fov * 0.5).tan();
        let plane = ndc * Vec2::new(tan * aspect, tan);
        let shader = (camera.view().inverse() * plane.extend(-1.0).extend(0.0)).truncate();
        prop_assert!(direction.abs_diff_eq(shader.normalize(), 1e-5), "{direction} and {shader}");
        let point = origin + direction * distance;
        let back = camera.project(point, [320, 200]).expect("in front");
        prop_assert!(back.abs_diff_eq(at_px, 0.05), "{at_px} px comes back at {back} px");
        let back = camera.project_to_ndc(point, aspect).expect("in front");
        prop_assert!(back.abs_diff_eq(ndc, 1e-3), "{ndc} comes back as {back}");
    }
}

#[test]
fn depth_is_one_at_the_near_plane_and_falls_to_zero() {
    let camera = camera();
    let depth = |distance: f32| {
        let clip = camera.projection(1.0) * Vec3::new(0.0, 0.0, -distance).extend(1.0);
        clip.z / clip.w
    };
    assert!((depth(0.01) - 1.0).abs() < 1e-6, "near");
    assert!((depth(1.0) - 0.01).abs() < 1e-7, "near / distance");
    assert!(depth(1e9) > 0.0 && depth(1e9) < 1e-9, "far");
}

#[test]
fn an_offset_moves_the_picture_by_as_many_pixels() {
    let (camera, size) = (camera(), [64u32, 48]);
    let point = camera.view() * Vec3::new(0.7, -0.4, 1.0).extend(1.0);
    let pixel = |offset| {
        let clip = camera.projection_offset(size, offset) * point;
        let ndc = clip.truncate() / clip.w;
        (Vec2::new(ndc.x, -ndc.y) * 0.5 + 0.5) * Vec2::new(64.0, 48.0)
    };
    let moved = pixel(Vec2::new(0.25, -0.5)) - pixel(Vec2::ZERO);
    assert!(moved.abs_diff_eq(Vec2::new(0.25, -0.5), 1e-4), "moved by {moved}");
}

#[test]
fn looking_along_up_still_gives_a_view() {
    let camera = Camera { target: Vec3::new(0.0, 5.0, 5.0), ..camera() };
    assert!(camera.view().is_finite(), "{:?}", camera.view());
    assert!((camera.view().determinant() - 1.0).abs() < 1e-5, "a rotation and a move");
}

#[test]
fn flux_is_the_integral_of_the_falloff() {
    let spot = |inner: f32, outer: f32| Light {
        name: "spot".into(),
        kind: LightKind::Spot { inner: inner.to_radians(), outer: outer.to_radians() },
        position: Vec3::ZERO,
        direction: Vec3::NEG_Z,
        intensity: Vec3::new(1.0, 2.0, 3.0),
    };
    for (inner, outer) in [(30.0, 30.0), (10.0, 40.0), (0.0, 90.0)] {
        let light = spot(inner, outer);
        // Midpoint rule over z = cos θ, for which dω = 2π dz.
        let n = 100_000;
        let sum: f64 = (0..n).map(|i| f64::from(light.falloff((i as f32 + 0.5) / n as f32))).sum();
        let numeric = 2.0 * std::f64::consts::PI * sum / f64::from(n);
        let flux = light.flux().expect("finite");
        let error = (f64::from(flux.x) / numeric - 1.0).abs();
        assert!(error < 1e-4, "cone {inner}°..{outer}°: {} by formula, {numeric} by sum", flux.x);
        assert!((flux.z / flux.x - 3.0).abs() < 1e-5, "per channel");
    }
    let hard = spot(30.0, 30.0).flux().expect("finite").x;
    assert!((hard - 2.0 * PI * (1.0 - 30f32.to_radians().cos())).abs() < 1e-6, "2π (1 − cos)");
    let point = Light { kind: LightKind::Point, ..spot(0.0, 0.0) };
    assert_eq!(point.flux().expect("finite").x, 4.0 * PI, "4π I");
    assert_eq!((point.layers(), spot(1.0, 2.0).layers()), (6, 1), "a cube's faces, one layer");
    assert_eq!((spot(10.0, 74.9).layers(), spot(10.0, 90.0).layers()), (1, 6), "no plane shows a half space");
    assert_eq!(Light { kind: LightKind::Directional, ..point }.flux(), None, "no end");
}
