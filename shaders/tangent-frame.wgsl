// Frames about a normal. The CPU reference is in crates/gpu-algorithms/src/reference/paraboloid.rs.

/// An orthonormal, right-handed frame whose z is a unit vector (Duff et al. 2017). World from local;
/// `v * frame` goes back.
fn frame_from_normal(n: vec3<f32>) -> mat3x3<f32> {
    let side = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (side + n.z);
    let b = n.x * n.y * a;
    return mat3x3(
        vec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x),
        vec3(b, side + n.y * n.y * a, -n.y),
        n,
    );
}
