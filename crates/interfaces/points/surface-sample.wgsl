// The functions of the module of an interface Points: `samples_requested() -> u32`, the number of samples of all maps
// together, or ANY_NUMBER; and `surface_sample(wanted: SamplesWanted, index: u32) -> SurfaceSample`.

/// The samples that a consumer requests; `interfaces::points::SurfaceSamples` computes it.
struct SamplesWanted {
    /// Number of maps.
    maps: u32,
    /// Samples of each map.
    per_map: u32,
    /// Binary logarithm of how many maps take turns, at most the fact `block` of the port.
    block_bits: u32,
    /// 2³¹ over the product of `maps` and `per_map`, rounded down.
    step_whole: u32,
    /// The rest of it, in units of 2⁻³².
    step_fraction: u32,
    /// Which of many sets of as many samples: 0 for the first.
    turn: u32,
    pad1: u32,
    pad2: u32,
}

/// A sample of the scene's surfaces, for one map.
struct SurfaceSample {
    /// Position in world space [m].
    position: vec3<f32>,
    /// The map that it is for.
    map: u32,
    /// Geometric normal, unit; its sign has no meaning.
    normal: vec3<f32>,
    /// Area that it represents among the samples of its map [m²]; 0 where there is no such sample.
    area: f32,
    /// The triangle on which it lies.
    triangle: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

/// Result of `samples_requested()` where any number will do.
const ANY_NUMBER: u32 = 0xffffffffu;
