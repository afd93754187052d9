// Solid angle of a texel of a light's map, by the number of texels.

#import "beam.wgsl"

struct Given {
    half_extent: vec2<f32>,
    size: u32,
    texel: vec2<u32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let size = u32(magnitude);
    return Given(0.1 + 3.6 * u.zw, size, min(vec2<u32>(u.xy * magnitude), vec2(size - 1u)));
}

/// [magnitude: 1 to 16384, side of the map [texels]]
fn probe(given: Given) -> vec4<f32> {
    let size = vec2(given.size);
    let middle = texel_middle(given.texel, size, given.half_extent);
    return vec4(rectangle_solid_angle(middle, texel_sides(size, given.half_extent)), 0.0, 0.0, 0.0);
}
