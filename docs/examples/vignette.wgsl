// The picture, darker towards the corners.

struct Settings {
    /// Darkening of the corners. [default: 0.5, min: 0.0, max: 1.0]
    strength: f32,
    picture_size: vec2<u32>,
}
var<uniform> settings: Settings;
var picture: texture_2d<f32>;

@fragment
fn vignette(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let from_centre = at.xy / vec2<f32>(settings.picture_size) - 0.5;
    let light = 1.0 - settings.strength * 2.0 * dot(from_centre, from_centre);
    return vec4(textureLoad(picture, vec2<u32>(at.xy), 0).rgb * light, 1.0);
}
