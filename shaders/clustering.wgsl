// The conventions of the passes that cluster the texels of a reflective shadow map: which texels there are to cluster, what
// they hold, and the window in which a cluster looks for them. The CPU reference is in
// crates/gpu-algorithms/src/reference/clustering.rs.

#import "algorithms/scaled.wgsl"
#import "clusters.wgsl"

/// The entry of the map of clusters for a texel that belongs to none.
const NO_CLUSTER: u32 = 0xffffffffu;

/// Whether every component is a number: neither NaN nor infinite.
fn is_finite(v: vec3<f32>) -> bool {
    return all((bitcast<vec3<u32>>(v) & vec3(0x7fffffffu)) < vec3(0x7f800000u));
}

/// Whether a texel saw a surface: `position` is its texel of `rsm_position`.
fn is_lit(position: vec4<f32>) -> bool {
    return is_finite(position.xyz) && weight_of(position.w) > 0.0;
}

/// Flux whose channels can be summed: NaN and negative ones count as 0.
fn flux_of(flux: vec3<f32>) -> vec3<f32> {
    return vec3(weight_of(flux.r), weight_of(flux.g), weight_of(flux.b));
}

/// The unit vector in this direction; 0 where there is none.
fn direction_of(v: vec3<f32>) -> vec3<f32> {
    let length2 = dot(v, v);
    // Beyond these, the squares in it overflow or have lost digits.
    if is_finite(v) && length2 > 1e-30 && length2 < 1e30 {
        return v * inverseSqrt(length2);
    }
    return vec3(0.0);
}

/// Texels from `low` to before `high`, in one layer.
struct Window {
    low: vec2<u32>,
    high: vec2<u32>,
}

/// The window of a cluster at `uv` [texels]: a square of `side` texels around it, as far as the map has them; the whole
/// layer for a `side` of 0. [ACRSM §4.6]
fn window_of(uv: vec2<f32>, side: u32, size: vec2<u32>) -> Window {
    if side == 0u {
        return Window(vec2(0u), size);
    }
    let first = vec2<i32>(floor(uv)) - i32(side / 2u);
    let end = vec2<i32>(size);
    let low = clamp(first, vec2(0), end);
    let high = clamp(first + i32(side), vec2(0), end);
    return Window(vec2<u32>(low), vec2<u32>(high));
}
