// The part of the light that shadows take away: 0 where nothing is in the way, and where there is no light. [ACRSM Fig. 6.2]

#import "color.wgsl"

var shadowed: texture_2d<f32>;
var unshadowed: texture_2d<f32>;

@fragment
fn shadow(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let all = luminance(textureLoad(unshadowed, vec2<u32>(at.xy), 0).rgb);
    let arrives = luminance(textureLoad(shadowed, vec2<u32>(at.xy), 0).rgb);
    return vec4(vec3(select(0.0, clamp(1.0 - arrives / all, 0.0, 1.0), all > 0.0)), 1.0);
}
