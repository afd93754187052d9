// Combines texels of two neighbouring levels, with rejection of outliers. [ISM §3.2, after Marroquim et al. 2007]

#import "paraboloid.wgsl"
#import "scene.wgsl"

/// Pull: the mean of those of four texels that are not holes, if they are close to each other; otherwise NOTHING.
fn pulled(values: vec4<f32>, threshold: f32) -> f32 {
    let valid = values < vec4(NOTHING);
    let kept = select(vec4(0.0), values, valid);
    let nearest = min(min(values.x, values.y), min(values.z, values.w));
    let farthest = max(max(kept.x, kept.y), max(kept.z, kept.w));
    let mean = dot(kept, vec4(1.0)) / dot(select(vec4(0.0), vec4(1.0), valid), vec4(1.0));
    return select(NOTHING, mean, any(valid) && farthest - nearest <= threshold);
}

/// Pull: the median of those of four texels that are not holes: of two or four, the mean of the middle two if these are
/// close to each other, otherwise NOTHING. [ACRSM §5.3.2]
// DEVIATION(middle-two): the paper does not say what the median of an even number is, nor what it does with holes.
fn pulled_median(values: vec4<f32>, threshold: f32) -> f32 {
    let first = min(values.xz, values.yw);
    let second = max(values.xz, values.yw);
    let inner = vec2(max(first.x, first.y), min(second.x, second.y));
    // In ascending order, so that holes are the last.
    let sorted = array(min(first.x, first.y), min(inner.x, inner.y), max(inner.x, inner.y), max(second.x, second.y));
    let valid = values < vec4(NOTHING);
    let count = u32(dot(select(vec4(0.0), vec4(1.0), valid), vec4(1.0)));
    let low = sorted[(max(count, 1u) - 1u) / 2u];
    let high = sorted[count / 2u];
    // Halves, since the sum of two holes is infinite.
    return select(NOTHING, 0.5 * low + 0.5 * high, count > 0u && high - low <= threshold);
}

/// Push: a hole, and a value far from that of the coarser level, are replaced by the latter. It is interpolated
/// bilinearly between those of the four nearest coarse texels that are close to the parent, which is the first. If the
/// parent is a hole, it is interpolated between the others, if these are close to each other.
fn pushed(own: f32, coarse: vec4<f32>, threshold: f32) -> f32 {
    // The values to combine belong to the coarser level, and so does the threshold.
    let apart = 2.0 * threshold;
    let kept = select(vec4(0.0), coarse, coarse < vec4(NOTHING));
    let nearest = min(min(coarse.y, coarse.z), coarse.w);
    let farthest = max(max(kept.y, kept.z), kept.w);
    let others = select(NOTHING, nearest, farthest - nearest <= apart);
    let reference = select(others, coarse.x, coarse.x < NOTHING);
    let close = abs(coarse - reference) <= vec4(apart);
    let weights = select(vec4(0.0), vec4(9.0, 3.0, 3.0, 1.0), close);
    let value = dot(weights, kept) / dot(weights, vec4(1.0));
    return select(own, value, reference < NOTHING && abs(own - value) > threshold);
}

/// Whether pushing leaves a texel as it is, whatever the coarser level has: it is no hole, and no two distances in the scene
/// are farther apart than the threshold. The levels need not be read then.
fn is_final(own: f32, threshold: f32) -> bool {
    return own < NOTHING && threshold >= scene_info.extent;
}

/// The parent of a texel, and its neighbour towards the texel's own side: in x for x, in y for y. Before the
/// first texel this wraps to large numbers.
fn parents(texel: vec2<u32>) -> vec4<u32> {
    let parent = texel / 2u;
    return vec4(parent, parent + (texel % 2u) * 2u - 1u);
}
