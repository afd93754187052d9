// What the module of an interface Points answers with: `samples_requested() -> u32`, how many samples there are to be of all
// maps together, or ANY_NUMBER; and `surface_sample(wanted: SamplesWanted, index: u32) -> SurfaceSample`.

/// The samples that a consumer wants. `pass::SurfaceSamples` works it out.
struct SamplesWanted {
    /// Maps that samples are wanted for.
    maps: u32,
    /// Samples wanted for each.
    per_map: u32,
    /// Binary logarithm of how many maps take turns, at most the fact `block` of the port.
    block_bits: u32,
    /// 2³¹ over the product of `maps` and `per_map`, rounded down.
    step_whole: u32,
    /// The rest of it, in units of 2⁻³².
    step_fraction: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

/// A sample of the scene's surfaces, for one map.
struct SurfaceSample {
    /// World space [m].
    position: vec3<f32>,
    /// The map that it is for.
    map: u32,
    /// Geometric normal, unit; its sign means nothing.
    normal: vec3<f32>,
    /// What it stands for among the samples of its map [m²]; 0: there is no such sample.
    area: f32,
}

/// Answer of `samples_requested()` where any number will do.
const ANY_NUMBER: u32 = 0xffffffffu;
