// The lattice of points on a triangle. [ACRSM Alg. 5.2]

#import "tessellation.wgsl"

/// A place on the lattice of a triangle.
struct Lattice {
    /// Barycentric coordinates of the first, second and third vertex.
    at: vec3<f32>,
    /// Steps along the edges opposite to the vertices.
    steps: vec3<f32>,
    /// The row, which has the same third coordinate throughout.
    row: u32,
    rows: u32,
}

/// The first point of a triangle with these levels.
fn first_of_lattice(levels: TessellationLevels) -> Lattice {
    let segments = levels.edges.zyx + levels.inside;
    return Lattice(vec3(1.0, 0.0, 0.0), 1.0 / vec3<f32>(segments), 0u, segments.z);
}

/// The point after one; where there is none, its row is `rows`. Every step along a row is at least 2 / 128.
fn next_of_lattice(lattice: Lattice) -> Lattice {
    var next = lattice;
    let first = lattice.at.x - dot(1.0 - lattice.at, lattice.steps);
    // What rounding leaves of a row that ends on the edge is no point.
    if first > 1e-5 {
        next.at = vec3(first, 1.0 - first - lattice.at.z, lattice.at.z);
        return next;
    }
    next.row++;
    let third = f32(next.row) / f32(next.rows);
    next.at = vec3(1.0 - third, 0.0, third);
    return next;
}
