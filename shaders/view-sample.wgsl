// A sample of what the camera sees, and what it receives from a virtual light (TCAS Eq. 1-2).
//
// Lengths are in units of the scene's extent: their squares stay in range for scenes of any scale.

#import "algorithms/scaled.wgsl"
#import "color.wgsl"
#import "scene.wgsl"

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

/// The geometry term of Eq. 2 between a virtual light and a sample, cosθ cosθ' / (π d² + guard) [1/extents²].
fn sample_geometry(position: vec3<f32>, normal: vec3<f32>, at: ViewSample, min_distance: f32) -> f32 {
    let way = at.position - position;
    // Single precision distinguishes positions to 1e-7 extents: below that, the sample is at the light, and the cosines
    // are 0 since the vector is.
    let squared = max(dot(way, way), 1e-20);
    let projections = max(dot(normal, way), 0.0) * max(-dot(at.normal, way), 0.0);
    // A light at a sample would take all the importance, so its distance counts as at least `min_distance`.
    return projections / (PI * squared * (squared + min_distance * min_distance));
}

/// The importance of a texel (Eq. 1) that reflects `flux` [W] and to which the view responds by `response` [1/extents²].
fn importance_of(flux: vec3<f32>, response: vec3<f32>, defensive: f32) -> f32 {
    // The response is bounded; multiplied by the flux last, it overflows only where the result does.
    return weight_of(dot(flux, response + defensive * LUMINANCE));
}
