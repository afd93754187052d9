// A sample of what the camera sees.
//
// Lengths are in units of the scene's extent: their squares stay in range for scenes of any scale.

struct ViewSample {
    /// Relative to the corner of the scene's bounding box [extents].
    position: vec3<f32>,
    normal: vec3<f32>,
    /// Luminance of the radiance towards the camera, per channel of irradiance [1/sr]: albedo / π, weighted.
    /// Zero where the pixel sees nothing.
    response: vec3<f32>,
}

/// Converts a position in world space [m] to extents. A scene whose bounding box is a point has no distances.
fn to_extents(position: vec3<f32>) -> vec3<f32> {
    return select(vec3(0.0), (position - scene_info.bounds_min) / scene_info.extent, scene_info.extent > 0.0);
}
