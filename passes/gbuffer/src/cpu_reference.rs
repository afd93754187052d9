//! The CPU reference of the geometry in shaders/surface.wgsl, motion.wgsl and shaders/camera.wgsl, in `f64`.

/// A vector of the world.
pub type Vec3 = [f64; 3];

/// How position and texture coordinates change from a pixel to its neighbours on the right and below.
#[derive(Clone, Copy, Debug)]
pub struct Change {
    /// To the right \[m\].
    pub position_x: Vec3,
    /// Down \[m\].
    pub position_y: Vec3,
    /// To the right.
    pub uv_x: [f64; 2],
    /// Down.
    pub uv_y: [f64; 2],
}

/// Returns the scalar product.
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the vector product.
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns `a x + b y + c z` for the components of `by`.
pub fn combine(a: Vec3, b: Vec3, c: Vec3, by: Vec3) -> Vec3 {
    std::array::from_fn(|i| a[i] * by[0] + b[i] * by[1] + c[i] * by[2])
}

/// Scales a vector of any length to 1; zero stays zero.
pub fn unit(v: Vec3) -> Vec3 {
    let length = dot(v, v).sqrt();
    if length == 0.0 { v } else { v.map(|x| x / length) }
}

/// Returns the interpolated normal on the seen side, which is that of `towards`. The normal map is [`bent_normal`]'s.
pub fn shading_normal(interpolated: Vec3, towards: Vec3) -> Vec3 {
    let normal = unit(if dot(interpolated, interpolated) < 1e-8 { towards } else { interpolated });
    if dot(normal, towards) < 0.0 { normal.map(|x| -x) } else { normal }
}

/// Returns a tangent-space normal in the frame that the changes span about `normal`.
pub fn bent_normal(normal: Vec3, tangent_space: Vec3, change: &Change) -> Vec3 {
    let across_y = cross(change.position_y, normal);
    let across_x = cross(normal, change.position_x);
    let turn = dot(change.position_x, across_y).signum();
    let along = |i: usize| -> Vec3 {
        std::array::from_fn(|k| (across_y[k] * change.uv_x[i] + across_x[k] * change.uv_y[i]) * turn)
    };
    let (along_u, along_v) = (along(0), along(1));
    let longest = dot(along_u, along_u).max(dot(along_v, along_v)).sqrt();
    if longest == 0.0 {
        return normal;
    }
    unit(combine(along_u.map(|x| x / longest), along_v.map(|x| -x / longest), normal, tangent_space))
}

/// A pinhole, as shaders/camera.wgsl has it.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Right, up, back.
    pub axes: [Vec3; 3],
    /// World space \[m\].
    pub position: Vec3,
    /// Half the width and height of the image plane at distance 1.
    pub half_extent: [f64; 2],
    /// Size of the frame \[px\].
    pub size: [f64; 2],
}

impl Camera {
    /// Returns the world direction through a point of the image \[px, y down\], with length 1 along the viewing axis.
    pub fn view_ray(&self, at_px: [f64; 2]) -> Vec3 {
        let x = (2.0 * at_px[0] / self.size[0] - 1.0) * self.half_extent[0];
        let y = (1.0 - 2.0 * at_px[1] / self.size[1]) * self.half_extent[1];
        combine(self.axes[0], self.axes[1], self.axes[2], [x, y, -1.0])
    }

    /// Returns where a point of the world is in the image \[px, y down\], and its depth \[m\].
    pub fn project(&self, at: Vec3) -> ([f64; 2], f64) {
        let offset = std::array::from_fn(|i| at[i] - self.position[i]);
        let depth = -dot(offset, self.axes[2]);
        let ndc = [0, 1].map(|i| dot(offset, self.axes[i]) / (depth * self.half_extent[i]));
        ([(ndc[0] * 0.5 + 0.5) * self.size[0], (0.5 - ndc[1] * 0.5) * self.size[1]], depth)
    }

    /// Returns the world position \[m\] of what the centre of a pixel sees at that depth.
    pub fn position_from_depth(&self, pixel: [u32; 2], depth: f64) -> Vec3 {
        let ray = self.view_ray(pixel.map(|p| f64::from(p) + 0.5));
        std::array::from_fn(|i| self.position[i] + ray[i] * depth)
    }

    /// Returns where a pixel's surface was in the image of `previous`, minus where it is \[px\].
    pub fn motion(&self, previous: &Camera, pixel: [u32; 2], depth: f64) -> [f64; 2] {
        if depth == 0.0 {
            return [0.0; 2];
        }
        let (before, previous_depth) = previous.project(self.position_from_depth(pixel, depth));
        if previous_depth <= 0.0 {
            return self.size.map(|side| 2.0 * side);
        }
        [0, 1].map(|i| before[i] - (f64::from(pixel[i]) + 0.5))
    }
}
