// The screen value of a radiance by the curve filmic.

#import "inputs/radiance.wgsl"

/// [magnitude: 1e-10 to 1e20, radiance [W/(m² sr)]]
/// [option: TONEMAP filmic]
fn probe(given: Given) -> vec4<f32> {
    return on_screen(given);
}
