// What the module of an interface Points answers with.
//
// The uniform `settings` of the consumer, whose port is `points`, has these members, which `pass::SurfaceSamples` fills:
//   points_count: u32     fact of the port
//   points_maps: u32      maps that samples are wanted for
//   points_per_map: u32   samples wanted for each
//   points_block_bits: u32      binary logarithm of how many maps take turns, at most the fact `block` of the port
//   points_step_whole: u32      2³¹ over the product of both, rounded down
//   points_step_fraction: u32   and the rest of it, in units of 2⁻³²
//   seed: u32             of the pass

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

/// Answer of `samples_asked()` where any number will do.
const ANY_NUMBER: u32 = 0xffffffffu;
