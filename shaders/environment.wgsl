// Light from infinitely far: a map of radiance by longitude and latitude, each texel of one radiance. Its texels are sampled by
// luminance times solid angle, and directions evenly within a texel.
//
// A direction of the scene, turned back by the angle of the environment, has the longitude atan2(x, -z), which grows with the
// column from -π, and the angle to +Y, which grows with the row from 0.

#import "color.wgsl"
#import "random.wgsl"
#import "scene.wgsl"

struct EnvironmentSample {
    /// Towards the environment, unit.
    direction: vec3<f32>,
    /// [1/sr] 0 where there is nothing to sample.
    density: f32,
    /// [W/(m² sr)]
    radiance: vec3<f32>,
}

/// The texel in a direction, of any length but 0.
fn environment_texel(direction: vec3<f32>) -> vec2<u32> {
    let size = textureDimensions(scene_environment);
    let turned = scene_info.environment_cosine * direction.xz + scene_info.environment_sine * vec2(-direction.z, direction.x);
    let longitude = atan2(turned.x, -turned.y);
    let latitude = atan2(length(direction.xz), direction.y);
    let at = vec2(0.5 + longitude / (2.0 * PI), latitude / PI) * vec2<f32>(size);
    return min(vec2<u32>(max(at, vec2(0.0))), size - 1u);
}

/// Radiance that arrives from a direction, of any length but 0 [W/(m² sr)].
fn environment_radiance(direction: vec3<f32>) -> vec3<f32> {
    return textureLoad(scene_environment, environment_texel(direction), 0).rgb;
}
