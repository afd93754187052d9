// Directions towards the environment, sampled by luminance times solid angle.

#import "environment.wgsl"

/// Heights of the caps about +Y that the upper and the lower edge of a row cut from the unit sphere: 1 - cos, without its
/// cancellation at the pole.
fn caps_of_row(row: u32) -> vec2<f32> {
    let rows = f32(textureDimensions(scene_environment).y);
    let half = sin(0.5 * PI * vec2(f32(row), f32(row + 1u)) / rows);
    return 2.0 * half * half;
}

/// Whether any direction is sampled.
fn environment_is_sampled() -> bool {
    let size = textureDimensions(scene_environment);
    return scene_environment_table[size.x * size.y] > 0u;
}

/// Density [1/sr] with which the directions of a texel are sampled.
fn density_of_texel(texel: vec2<u32>) -> f32 {
    let size = textureDimensions(scene_environment);
    let index = texel.y * size.x + texel.x;
    let numbers = scene_environment_table[index + 1u] - scene_environment_table[index];
    // The difference of the cosines of the edges, without its cancellation.
    let middle = PI * (f32(texel.y) + 0.5) / f32(size.y);
    let solid_angle = 4.0 * PI / f32(size.x) * sin(middle) * sin(0.5 * PI / f32(size.y));
    return f32(numbers) * 0x1p-32f / solid_angle;
}

/// Density [1/sr] with which a direction is sampled.
fn density_of_environment(direction: vec3<f32>) -> f32 {
    return density_of_texel(environment_texel(direction));
}

/// A direction by a place in the unit square in fixed point, where `environment_is_sampled`.
fn sample_environment(place: vec2<u32>) -> EnvironmentSample {
    let size = textureDimensions(scene_environment);
    // Tables end at 2^32 - 1, which is in no interval.
    let number = min(place.x, 0xfffffffeu);
    var low = 0u;
    var high = size.x * size.y - 1u;
    while low < high {
        let middle = (low + high + 1u) / 2u;
        if scene_environment_table[middle] <= number {
            low = middle;
        } else {
            high = middle - 1u;
        }
    }
    let start = scene_environment_table[low];
    let width = max(scene_environment_table[low + 1u] - start, 1u);
    let texel = vec2(low % size.x, low / size.x);
    let within = vec2(min((f32(number - start) + 0.5) / f32(width), 1.0), unit_float(place.y));
    let caps = caps_of_row(texel.y);
    let cap = mix(caps.x, caps.y, within.y);
    let level = sqrt(max(cap * (2.0 - cap), 0.0));
    let longitude = 2.0 * PI * ((f32(texel.x) + within.x) / f32(size.x) - 0.5);
    let along = level * vec2(sin(longitude), -cos(longitude));
    // Turned by the angle, against environment_texel.
    let turned = scene_info.environment_cosine * along + scene_info.environment_sine * vec2(along.y, -along.x);
    let direction = vec3(turned.x, 1.0 - cap, turned.y);
    return EnvironmentSample(direction, density_of_texel(texel), textureLoad(scene_environment, texel, 0).rgb);
}
