//! The CPU reference of the geometry in shaders/surface.wgsl, gbuffer.wgsl and shaders/camera.wgsl, in `f64`.

use glam::{DMat3, DVec2, DVec3, UVec2};

/// The change of position and texture coordinates from a pixel to its neighbours on the right and below.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Change {
    /// To the right \[m\].
    pub(crate) position_x: DVec3,
    /// Down \[m\].
    pub(crate) position_y: DVec3,
    /// To the right.
    pub(crate) uv_x: DVec2,
    /// Down.
    pub(crate) uv_y: DVec2,
}

/// Returns the interpolated normal on the seen side, which is that of `towards`. The normal map is [`bent_normal`]'s.
pub(crate) fn shading_normal(interpolated: DVec3, towards: DVec3) -> DVec3 {
    let normal = if interpolated.length_squared() < 1e-8 { towards } else { interpolated };
    let normal = normal.normalize_or_zero();
    if normal.dot(towards) < 0.0 { -normal } else { normal }
}

/// Returns a tangent-space normal in the frame that the changes span about `normal`.
pub(crate) fn bent_normal(normal: DVec3, tangent_space: DVec3, change: &Change) -> DVec3 {
    let across_y = change.position_y.cross(normal);
    let across_x = normal.cross(change.position_x);
    let turn = change.position_x.dot(across_y).signum();
    let along_u = (across_y * change.uv_x.x + across_x * change.uv_y.x) * turn;
    let along_v = (across_y * change.uv_x.y + across_x * change.uv_y.y) * turn;
    let longest = along_u.length().max(along_v.length());
    if longest == 0.0 {
        return normal;
    }
    let frame = DMat3::from_cols(along_u / longest, -along_v / longest, normal);
    (frame * tangent_space).normalize_or_zero()
}

/// A pinhole, as shaders/camera.wgsl has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    /// Right, up, back.
    pub(crate) axes: DMat3,
    /// World space \[m\].
    pub(crate) position: DVec3,
    /// Half the width and height of the image plane at distance 1.
    pub(crate) half_extent: DVec2,
    /// Size of the frame \[px\].
    pub(crate) size: DVec2,
}

/// From y up to y down, and back.
const FLIP: DVec2 = DVec2::new(1.0, -1.0);

impl Camera {
    /// Returns the world direction through a point of the image \[px, y down\], with length 1 along the viewing axis.
    pub(crate) fn view_ray(&self, at_px: DVec2) -> DVec3 {
        let ndc = (2.0 * at_px / self.size - 1.0) * FLIP;
        self.axes * (ndc * self.half_extent).extend(-1.0)
    }

    /// Returns where a point of the world is in the image \[px, y down\], and its depth \[m\].
    pub(crate) fn project(&self, at: DVec3) -> (DVec2, f64) {
        let offset = self.axes.transpose_mul_vec3(at - self.position);
        let depth = -offset.z;
        let ndc = offset.truncate() / (depth * self.half_extent);
        ((ndc * FLIP * 0.5 + 0.5) * self.size, depth)
    }

    /// Returns the world position \[m\] of what the centre of a pixel sees at that depth.
    pub(crate) fn position_from_depth(&self, pixel: UVec2, depth: f64) -> DVec3 {
        self.position + self.view_ray(pixel.as_dvec2() + 0.5) * depth
    }

    /// Returns where a pixel's surface was in the image of `previous`, minus where it is \[px\].
    pub(crate) fn motion(&self, previous: &Camera, pixel: UVec2, depth: f64) -> DVec2 {
        if depth == 0.0 {
            return DVec2::ZERO;
        }
        let (before, previous_depth) = previous.project(self.position_from_depth(pixel, depth));
        if previous_depth <= 0.0 {
            return 2.0 * self.size;
        }
        before - (pixel.as_dvec2() + 0.5)
    }
}
