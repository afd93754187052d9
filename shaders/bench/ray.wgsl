// A ray to time, as the kernels of `lightloom bench` exchange them: one an element of a buffer.

struct Ray {
    /// World space [m].
    origin: vec3<f32>,
    /// 0 for an element without a ray.
    exists: u32,
    direction: vec3<f32>,
    pad: u32,
}
