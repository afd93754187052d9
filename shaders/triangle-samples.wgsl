// Samples of triangles. The unit square is laid over the surface, area for area: the first number picks the triangle,
// and where it fell in the triangle's interval it is, with the second, the place there. So two numbers do, and the
// evenness of their sequence in the square is evenness on the surface.
//
// Who imports this says where intervals begin: `fn interval_start(triangle: u32) -> u32`, in rising order.

/// The triangle whose interval holds the number, among those from `first` to `last`. Those of no width hold none.
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

/// Barycentric coordinates of the second and third vertex from the unit square: keeps areas, and neighbours near
/// each other (Heitz 2019).
fn triangle_from_square(square: vec2<f32>) -> vec2<f32> {
    if square.y > square.x {
        return vec2(0.5 * square.x, square.y - 0.5 * square.x);
    }
    return vec2(square.x - 0.5 * square.y, 0.5 * square.y);
}
