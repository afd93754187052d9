// Directions for the inputs of probes.

/// A unit direction, uniformly distributed.
fn unit_direction(square: vec2<f32>) -> vec3<f32> {
    let z = 1.0 - 2.0 * square.x;
    let radius = sqrt(max(1.0 - z * z, 0.0));
    let angle = 6.283185307 * square.y;
    return vec3(radius * cos(angle), radius * sin(angle), z);
}

/// A unit direction at an angle [rad] to another, turned about it by a number of turns.
fn direction_beside(axis: vec3<f32>, angle: f32, turns: f32) -> vec3<f32> {
    let least = select(select(vec3(0.0, 0.0, 1.0), vec3(0.0, 1.0, 0.0), abs(axis.y) < abs(axis.z)), vec3(1.0, 0.0, 0.0),
        abs(axis.x) < min(abs(axis.y), abs(axis.z)));
    let right = normalize(cross(axis, least));
    let up = cross(right, axis);
    let around = 6.283185307 * turns;
    return normalize(cos(angle) * axis + sin(angle) * (cos(around) * right + sin(around) * up));
}
