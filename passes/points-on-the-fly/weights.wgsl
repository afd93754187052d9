// The weight of a triangle, to which its share of the points is proportional.
//
// DEVIATION(no-tessellator): WebGPU has none; each thread finds its triangle by binary search.

#option RULE area one_of [area, tessellation] // The number of points of a triangle. area: in proportion to its area; the total is as
    // many as are requested. tessellation: as many as the vertices of a tessellator whose levels rise with edges and area (ACRSM
    // Eq. 5.3-5.4), so that small triangles get more than in proportion to their area; the total follows from the scene, and is
    // cut to the points that fit.

#import "triangles.wgsl"

#if RULE == tessellation
var<storage, read> bounds: Bounds;

/// The level of a value between two bounds, smoothed. If the bounds are equal, it is the greatest level.
fn level(bounds: vec2<f32>, value: f32, factors: vec2<u32>) -> u32 {
    var smoothed = 1.0;
    if bounds.y > bounds.x {
        let x = clamp((value - bounds.x) / (bounds.y - bounds.x), 0.0, 1.0);
        smoothed = x * x * (3.0 - 2.0 * x);
    }
    return max(u32(ceil(smoothed * f32(factors.y))), factors.x);
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

/// The weight of a triangle. `factors` are the least and the greatest tessellation level.
fn weight_of_triangle(index: u32, factors: vec2<u32>) -> f32 {
    let triangle = measured(index);
    if !(triangle.area > 0.0) {
        return 0.0;
    }
#if RULE == tessellation
    let edges = vec3(
        level(bounds.edges, triangle.edges.x, factors),
        level(bounds.edges, triangle.edges.y, factors),
        level(bounds.edges, triangle.edges.z, factors),
    );
    return f32(tessellated_points(edges, level(bounds.areas, triangle.area, factors)));
#else
    return triangle.area;
#endif
}
