// The screen value of a radiance by the curve aces.

#import "tonemap.wgsl"

struct Given {
    radiance: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(magnitude * (0.1 + 0.9 * u.xyz));
}

/// [magnitude: 1e-10 to 1e20, radiance [W/(m² sr)]]
/// [option: TONEMAP aces]
fn probe(given: Given) -> vec4<f32> {
    return vec4(displayed(given.radiance, 0.0, 4.0), luminance(given.radiance));
}
