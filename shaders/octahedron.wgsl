// Unit vectors as two numbers in [-1, 1]: the octahedral map. [Cigolle et al. 2014]

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
