// The interface Stands: where virtual lights stood when their shadow maps were rendered. [SMC-IR §4, Laine et al. 2007]

/// The pose of a virtual light when its shadow map was rendered.
struct Stand {
    /// Position in world space [m].
    position: vec3<f32>,
    /// 1 where there is a map; 0 before, and where the light is dark.
    is_rendered: u32,
    /// Normal, unit.
    normal: vec3<f32>,
    pad: u32,
}

struct Stands {
    stands: array<Stand>,
}
