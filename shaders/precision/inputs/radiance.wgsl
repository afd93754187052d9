// Radiance on a screen, for the probes of curves.

#import "tonemap.wgsl"

struct Given {
    radiance: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    return Given(magnitude * (0.1 + 0.9 * u.xyz));
}

/// Returns the screen value, and the luminance of the radiance.
fn on_screen(given: Given) -> vec4<f32> {
    return vec4(displayed(given.radiance, 0.0, 4.0), luminance(given.radiance));
}
