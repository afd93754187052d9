// Whether the light of a source of the scene reaches a point, by a ray.

#import "lights.wgsl"
#import "ray-tracing.wgsl"

/// Whether nothing is between a point [m], off its surface, and a light, which is along the unit way `to_light`.
fn light_reaches(light: Light, origin: vec3<f32>, to_light: vec3<f32>) -> bool {
    if light.kind == LIGHT_DIRECTIONAL {
        return !occluded(origin, to_light, 0.0, FAR);
    }
    // The ray ends just before the light: a light that is attached to a surface shines from it.
    return !occluded(origin, light.position - origin, 0.0, 0.9999);
}
