// The interface Points: samples of the scene's surfaces.

struct Point {
    /// World space [m].
    position: vec3<f32>,
    triangle: u32,
    /// Geometric normal, unit; its sign means nothing. Zero where the surface is cut out.
    normal: vec3<f32>,
    /// Barycentric coordinates of the triangle's second and third vertex, 16 bits each.
    barycentric: u32,
}
