// The screen value of a radiance by the curve aces.

#import "inputs/radiance.wgsl"

/// [magnitude: 1e-10 to 1e20, radiance [W/(m² sr)]]
/// [option: TONEMAP aces]
fn probe(given: Given) -> vec4<f32> {
    return on_screen(given);
}
