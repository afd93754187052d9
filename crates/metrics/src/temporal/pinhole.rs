/// A camera, as in `shaders/camera.wgsl`: maps pixels to the world and back.
///
/// View space is right-handed and the camera looks along −`back`; the three axes are unit vectors at
/// right angles. A point of the image is in pixels from its top left corner, y down, so that the
/// centre of the first pixel is (0.5, 0.5); sizes are (width, height) in pixels.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct Pinhole {
    /// Position in world space \[m\].
    pub position: [f64; 3],
    /// World direction of the image's x axis.
    pub right: [f64; 3],
    /// World direction opposite to the image's y axis.
    pub up: [f64; 3],
    /// World direction opposite to the viewing direction.
    pub back: [f64; 3],
    /// Half the width and height of the image plane at distance 1.
    pub half_extent: [f64; 2],
}

impl Pinhole {
    /// Returns the world position \[m\] of what is seen at the point (`x`, `y`) of the image \[px\], at
    /// `depth` \[m\] along the viewing axis.
    pub fn world(&self, x: f64, y: f64, depth: f64, size: (usize, usize)) -> [f64; 3] {
        let across = (2.0 * x / size.0 as f64 - 1.0) * self.half_extent[0];
        let upwards = (1.0 - 2.0 * y / size.1 as f64) * self.half_extent[1];
        std::array::from_fn(|axis| {
            let ray = across * self.right[axis] + upwards * self.up[axis] - self.back[axis];
            self.position[axis] + ray * depth
        })
    }

    /// Returns the position in the image of a world position \[m\]: x and y \[px\], which may be outside the
    /// frame, and its depth \[m\] along the viewing axis. `None` if it is not in front of the camera.
    pub fn project(&self, point: [f64; 3], size: (usize, usize)) -> Option<(f64, f64, f64)> {
        let offset: [f64; 3] = std::array::from_fn(|axis| point[axis] - self.position[axis]);
        let along = |axis: [f64; 3]| offset.iter().zip(axis).map(|(a, b)| a * b).sum::<f64>();
        let depth = -along(self.back);
        if depth.is_nan() || depth <= 0.0 {
            return None;
        }
        let across = along(self.right) / (depth * self.half_extent[0]);
        let upwards = along(self.up) / (depth * self.half_extent[1]);
        Some(((across + 1.0) * 0.5 * size.0 as f64, (1.0 - upwards) * 0.5 * size.1 as f64, depth))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At (1, 2, 3), looking along +x: right is +z.
    const CAMERA: Pinhole = Pinhole {
        position: [1.0, 2.0, 3.0],
        right: [0.0, 0.0, 1.0],
        up: [0.0, 1.0, 0.0],
        back: [-1.0, 0.0, 0.0],
        half_extent: [2.0, 1.0],
    };

    #[test]
    fn by_hand() {
        // The middle of 8x4 looks straight ahead; the top left corner is 2 to the left of that and 1 up, a
        // metre ahead.
        assert_eq!(CAMERA.world(4.0, 2.0, 5.0, (8, 4)), [6.0, 2.0, 3.0]);
        assert_eq!(CAMERA.world(0.0, 0.0, 5.0, (8, 4)), [6.0, 7.0, -7.0]);
        assert_eq!(CAMERA.project([6.0, 7.0, -7.0], (8, 4)), Some((0.0, 0.0, 5.0)));
        // Beyond the right edge: z is 20 to the right, and the frame ends at 10.
        assert_eq!(CAMERA.project([6.0, 2.0, 23.0], (8, 4)), Some((12.0, 2.0, 5.0)));
        assert_eq!(CAMERA.project([1.0, 2.0, 4.0], (8, 4)), None, "beside the camera");
        assert_eq!(CAMERA.project([f64::NAN, 2.0, 4.0], (8, 4)), None);
    }
}
