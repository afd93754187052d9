// Samples of triangles. The unit square is mapped to the surface, preserving areas: the first number picks the
// triangle, and its position within the triangle's interval gives, with the second number, the position on it. So two
// numbers suffice, and a sequence that is stratified in the square is stratified on the surface.
//
// A file that imports this one defines where intervals begin: `fn interval_start(triangle: u32) -> u32`, in rising
// order.

/// The triangle whose interval holds the number, among those from `first` to `last`. Intervals of no width hold none.
fn triangle_at(number: u32, first: u32, last: u32) -> u32 {
    var low = first;
    var high = last;
    while low < high {
        let middle = (low + high + 1u) / 2u;
        if interval_start(middle) <= number {
            low = middle;
        } else {
            high = middle - 1u;
        }
    }
    return low;
}

/// Barycentric coordinates of the second and third vertex from the unit square: preserves areas, and keeps neighbours
/// near each other (Heitz 2019).
fn triangle_from_square(square: vec2<f32>) -> vec2<f32> {
    if square.y > square.x {
        return vec2(0.5 * square.x, square.y - 0.5 * square.x);
    }
    return vec2(square.x - 0.5 * square.y, 0.5 * square.y);
}
