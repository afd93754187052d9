// Unit vectors as two numbers in [-1, 1], or as one half float: the octahedral map. [Cigolle et al. 2014]

/// The point of the square for a unit vector.
fn octahedron_from_direction(direction: vec3<f32>) -> vec2<f32> {
    let at = direction.xy / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    let folded = (1.0 - abs(at.yx)) * select(vec2(-1.0), vec2(1.0), at >= vec2(0.0));
    return select(folded, at, direction.z >= 0.0);
}

/// The unit vector for a point of the square.
fn direction_from_octahedron(at: vec2<f32>) -> vec3<f32> {
    let z = 1.0 - abs(at.x) - abs(at.y);
    let unfolded = at - select(vec2(-1.0), vec2(1.0), at >= vec2(0.0)) * max(-z, 0.0);
    return normalize(vec3(unfolded, z));
}

/// Half the side of the square, in cells that a half float can tell apart.
const HALF_FLOAT_ROWS: u32 = 120u;

/// The bits of a half float that is the least normal number: those below may be read as 0.
const LEAST_NORMAL: u32 = 0x400u;

/// The half float for a unit vector: a normal number, which says the vector to 1°.
fn half_float_from_direction(direction: vec3<f32>) -> f32 {
    let side = 2u * HALF_FLOAT_ROWS;
    let place = (octahedron_from_direction(direction) * 0.5 + 0.5) * f32(side);
    let cell = min(vec2<u32>(max(place, vec2(0.0))), vec2(side - 1u));
    let sign = select(0u, 0x8000u, cell.y >= HALF_FLOAT_ROWS);
    return unpack2x16float((LEAST_NORMAL + cell.y % HALF_FLOAT_ROWS * side + cell.x) | sign).x;
}

/// The unit vector for a half float that is not 0.
fn direction_from_half_float(number: f32) -> vec3<f32> {
    let side = 2u * HALF_FLOAT_ROWS;
    let bits = pack2x16float(vec2(number, 0.0));
    let index = (bits & 0x7fffu) - LEAST_NORMAL;
    let row = index / side + select(0u, HALF_FLOAT_ROWS, (bits & 0x8000u) != 0u);
    return direction_from_octahedron((vec2(f32(index % side), f32(row)) + 0.5) / f32(HALF_FLOAT_ROWS) - 1.0);
}
