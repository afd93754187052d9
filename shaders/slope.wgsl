// The slope of a surface against a direction.

/// Tangent of the angle between a unit normal and a unit direction, of which the cosine counts as at least `least`. By the cross
/// product: 1 less the square of a cosine has lost digits where the surface faces the direction.
fn slope_against(normal: vec3<f32>, direction: vec3<f32>, least: f32) -> f32 {
    return length(cross(normal, direction)) / max(dot(normal, direction), least);
}
