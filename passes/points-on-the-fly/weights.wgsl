// The weight of a triangle, to which its share of the points is proportional.
//
// The uniform `settings` of a file that imports this one has the members min_factor and max_factor.
//
// DEVIATION(no-tessellator): WebGPU has none; each thread finds its triangle by binary search.

/// Weights are the numbers of points of a tessellator (ACRSM Eq. 5.3-5.4); otherwise areas.
#option TESSELLATION false

#import "triangles.wgsl"

#if TESSELLATION
var<storage, read> bounds: Bounds;

/// The level of a value between two bounds, smoothed. If the bounds are equal, it is the greatest level.
fn level(bounds: vec2<f32>, value: f32) -> u32 {
    var smoothed = 1.0;
    if bounds.y > bounds.x {
        let x = clamp((value - bounds.x) / (bounds.y - bounds.x), 0.0, 1.0);
        smoothed = x * x * (3.0 - 2.0 * x);
    }
    return max(u32(ceil(smoothed * f32(settings.max_factor))), settings.min_factor);
}

/// Number of vertices of a triangle with these levels of its edges and inside, one point each in OpenGL's point mode
/// with equal spacing: those along the edges, and rings with two segments fewer each, down to a triangle or a point.
fn tessellated_points(edges: vec3<u32>, inside: u32) -> u32 {
    let around = edges.x + edges.y + edges.z;
    if inside == 1u && around == 3u {
        return 3u;
    }
    let levels = max(inside, 2u);
    let rings = levels / 2u;
    if levels % 2u == 1u {
        return around + 3u * rings * rings;
    }
    return around + 1u + 3u * rings * (rings - 1u);
}
#endif

fn weight_of_triangle(index: u32) -> f32 {
    let triangle = measured(index);
    if !(triangle.area > 0.0) {
        return 0.0;
    }
#if TESSELLATION
    let edges = vec3(
        level(bounds.edges, triangle.edges.x),
        level(bounds.edges, triangle.edges.y),
        level(bounds.edges, triangle.edges.z),
    );
    return f32(tessellated_points(edges, level(bounds.areas, triangle.area)));
#else
    return triangle.area;
#endif
}
