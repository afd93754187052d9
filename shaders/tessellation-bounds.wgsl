// The bounds of all areas and edges, between which the levels of a tessellator rise (ACRSM Eq. 5.3-5.4).

#import "algorithms/reduce.wgsl"
#import "tessellation.wgsl"

alias Reduced = Bounds;

var<storage, read_write> bounds: Bounds;

/// The number of triangles.
fn reduce_length() -> u32 {
    return scene_info.triangles;
}

/// The bounds of one triangle: its area, and its shortest and longest edge.
fn reduce_element(i: u32) -> Bounds {
    let triangle = measured(i);
    if !(triangle.area > 0.0) {
        return reduce_identity();
    }
    let edges = triangle.edges;
    let least = min(edges.x, min(edges.y, edges.z));
    let greatest = max(edges.x, max(edges.y, edges.z));
    return Bounds(vec2(triangle.area), vec2(least, greatest));
}

/// The bounds of no triangle.
fn reduce_identity() -> Bounds {
    return Bounds(vec2(3.0e38, 0.0), vec2(3.0e38, 0.0));
}

/// The bounds of what two have.
fn reduce_both(a: Bounds, b: Bounds) -> Bounds {
    return Bounds(united(a.areas, b.areas), united(a.edges, b.edges));
}

/// The least of the one and the greatest of the other component.
fn united(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2(min(a.x, b.x), max(a.y, b.y));
}

/// The bounds of what the threads of a workgroup have.
fn reduce_workgroup(thread: u32, own: Bounds) -> Bounds {
    let areas = vec2(-workgroup_max(thread, -own.areas.x), workgroup_max(thread, own.areas.y));
    let edges = vec2(-workgroup_max(thread, -own.edges.x), workgroup_max(thread, own.edges.y));
    return Bounds(areas, edges);
}

/// Stores the bounds of all.
fn reduce_store(result: Bounds) {
    bounds = result;
}
