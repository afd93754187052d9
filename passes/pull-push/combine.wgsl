// How texels of two neighbouring levels are combined, with rejection of outliers. [ISM §3.2, after Marroquim et al. 2007]

#import "paraboloid.wgsl"

/// Pull: the mean of those of four texels that are close to the nearest of them; NOTHING where all are holes.
fn pulled(values: vec4<f32>, threshold: f32) -> f32 {
    let nearest = min(min(values.x, values.y), min(values.z, values.w));
    let close = values - nearest <= vec4(threshold);
    let sum = dot(select(vec4(0.0), values, close), vec4(1.0));
    return select(sum / dot(select(vec4(0.0), vec4(1.0), close), vec4(1.0)), NOTHING, nearest >= NOTHING);
}

/// Push: a hole, and a value far from what the coarser level says there, give way to it. It is interpolated
/// bilinearly between those of the four nearest coarse texels that are close to the parent, which is the first,
/// or where that is a hole, to the nearest of the others.
fn pushed(own: f32, coarse: vec4<f32>, threshold: f32) -> f32 {
    let others = min(min(coarse.y, coarse.z), coarse.w);
    let reference = select(coarse.x, others, coarse.x >= NOTHING);
    let close = abs(coarse - reference) <= vec4(2.0 * threshold);
    let weights = select(vec4(0.0), vec4(9.0, 3.0, 3.0, 1.0), close);
    let value = dot(weights, select(vec4(0.0), coarse, close)) / dot(weights, vec4(1.0));
    return select(own, value, abs(own - value) > threshold && reference < NOTHING);
}

/// The parent of a texel, and its neighbour towards the texel's own side: in x for x, in y for y. Before the
/// first texel this wraps to large numbers.
fn parents(texel: vec2<u32>) -> vec4<u32> {
    let parent = texel / 2u;
    return vec4(parent, parent + (texel % 2u) * 2u - 1u);
}
