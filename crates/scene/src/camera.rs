//! The pinhole camera.

use glam::camera::rh::{proj::directx, view};
use glam::{Mat3, Mat4, Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// A pinhole camera: square pixels, the centre of the image on the optical axis, x to the right, row 0 at the
/// top.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Position of the pinhole \[m\].
    pub position: Vec3,
    /// A point on the optical axis, in front of the camera \[m\].
    pub target: Vec3,
    /// The direction that points up in the image; neither zero nor along the axis.
    pub up: Vec3,
    /// The whole vertical field of view \[rad\], in (0, π).
    pub vertical_fov: f32,
    /// Distance of the near plane along the axis \[m\], > 0.
    pub near: f32,
}

impl Camera {
    /// Returns the unit vector along the optical axis, into the scene.
    pub fn forward(&self) -> Vec3 {
        (self.target - self.position).normalize_or(Vec3::NEG_Z)
    }

    /// Returns the matrix from world to view space: x right, y up, the camera looks along −z.
    pub fn view(&self) -> Mat4 {
        let forward = self.forward();
        let up = if forward.cross(self.up).length_squared() > 1e-12 * self.up.length_squared() {
            self.up.normalize_or(Vec3::Y)
        } else {
            // If `up` is along the axis, any perpendicular direction will do, as long as it is always the
            // same.
            forward.any_orthonormal_vector()
        };
        view::look_to_mat4(self.position, forward, up)
    }

    /// Returns the matrix from view space to clip space for a frame with `width`/`height` = `aspect`. Depth
    /// is 1 at `near` and approaches 0 at infinity.
    pub fn projection(&self, aspect: f32) -> Mat4 {
        directx::perspective_infinite_reverse(self.vertical_fov, aspect, self.near)
    }

    /// Returns [`Camera::projection`] with the picture displaced by `offset_px` pixels (x to the right, y
    /// down) in a frame of `size_px`: for samples at other positions in the pixel than its centre.
    pub fn projection_offset(&self, size_px: [u32; 2], offset_px: Vec2) -> Mat4 {
        let size = Vec2::new(size_px[0].max(1) as f32, size_px[1].max(1) as f32);
        let mut projection = self.projection(size.x / size.y);
        // w of clip space is −z of view space, so what is subtracted from the column of z is added to x/w and
        // y/w.
        projection.z_axis.x -= 2.0 * offset_px.x / size.x;
        projection.z_axis.y += 2.0 * offset_px.y / size.y;
        projection
    }

    /// Returns the position of `point` \[m, world\] in a frame of `size_px`, in pixels from the upper left
    /// corner (the centre of the first pixel is (0.5, 0.5)); `None` behind the near plane.
    pub fn project(&self, point: Vec3, size_px: [u32; 2]) -> Option<Vec2> {
        let size = Vec2::new(size_px[0].max(1) as f32, size_px[1].max(1) as f32);
        let ndc = self.project_to_ndc(point, size.x / size.y)?;
        Some((Vec2::new(ndc.x, -ndc.y) * 0.5 + 0.5) * size)
    }

    /// Returns the position of `point` \[m, world\] in normalised device coordinates: from −1 at the left and at
    /// the bottom of the frame to 1 at the right and at the top (y up), beyond that outside of it. `aspect` is the
    /// frame's width divided by its height. `None` behind the near plane.
    pub fn project_to_ndc(&self, point: Vec3, aspect: f32) -> Option<Vec2> {
        let clip = self.projection(aspect) * self.view() * point.extend(1.0);
        (clip.w >= self.near).then(|| (clip.truncate() / clip.w).truncate())
    }

    /// Returns the ray on which everything lies that is seen at `ndc`, as in [`Camera::project_to_ndc`]: its origin,
    /// the pinhole \[m\], and its direction, of length 1. What lies before the near plane is on it too, but not seen.
    pub fn ray(&self, ndc: Vec2, aspect: f32) -> (Vec3, Vec3) {
        let half_height = (self.vertical_fov * 0.5).tan();
        let plane = ndc * half_height * Vec2::new(aspect, 1.0);
        let world_from_view = Mat3::from_mat4(self.view()).transpose();
        (self.position, (world_from_view * plane.extend(-1.0)).normalize_or(self.forward()))
    }

    /// Returns a camera that sees the whole box from `min` to `max` from the front, slightly from above.
    pub(crate) fn framing(min: Vec3, max: Vec3) -> Camera {
        let vertical_fov = 45.0f32.to_radians();
        let target = (min + max) * 0.5;
        let radius = ((max - min).length() * 0.5).max(f32::MIN_POSITIVE.sqrt());
        let distance = radius / (vertical_fov * 0.5).sin();
        let position = target + Vec3::new(0.35, 0.3, 1.0).normalize() * distance;
        Camera { position, target, up: Vec3::Y, vertical_fov, near: distance * 1e-3 }
    }
}
