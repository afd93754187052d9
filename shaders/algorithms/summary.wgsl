// How many points there are, and the box around them: algorithms/summarize.wgsl finds both.

/// All points together.
struct Summary {
    /// The box around them, in the unit of their positions.
    low: vec3<f32>,
    /// The number of those that count.
    count: u32,
    high: vec3<f32>,
    pad: u32,
}
