// The screen value of a radiance by the curve of Reinhard with a white point, and its luminance.

#import "inputs/radiance.wgsl"

/// [magnitude: 1e-10 to 1e20, radiance [W/(m² sr)]]
/// [option: TONEMAP reinhard]
fn probe(given: Given) -> vec4<f32> {
    return on_screen(given);
}
