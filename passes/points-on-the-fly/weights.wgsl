// The weight of a triangle, to which its share of the points is proportional.
//
// DEVIATION(no-tessellator): WebGPU has none; each thread finds its triangle by binary search.

#option RULE area one_of [area, tessellation] // The number of points of a triangle. area: in proportion to its area; the total is as
    // many as are requested. tessellation: as many as the vertices of a tessellator whose levels rise with edges and area (ACRSM
    // Eq. 5.3-5.4), so that small triangles get more than in proportion to their area; the total follows from the scene, and is
    // cut to the points that fit.

#import "tessellation.wgsl"

#if RULE == tessellation
var<storage, read> bounds: Bounds;

/// Number of vertices of a triangle with these levels of its edges and inside, one point each in OpenGL's point mode
/// with equal spacing: those along the edges, and rings with two segments fewer each, down to a triangle or a point.
fn tessellated_points(levels: TessellationLevels) -> u32 {
    let around = levels.edges.x + levels.edges.y + levels.edges.z;
    if levels.inside == 1u && around == 3u {
        return 3u;
    }
    let inside = max(levels.inside, 2u);
    let rings = inside / 2u;
    if inside % 2u == 1u {
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
    return f32(tessellated_points(tessellation_levels(bounds, triangle, factors)));
#else
    return triangle.area;
#endif
}
