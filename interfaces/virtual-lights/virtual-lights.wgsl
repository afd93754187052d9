// The interface VirtualLights: lights on surfaces that stand for light reflected there.
//
// A virtual light carries flux Φ [W] and emits as a Lambertian surface: at a point x far from it, it gives the irradiance
// Φ cosθ cosθ' V / (π d²).

struct VirtualLight {
    /// World space [m].
    position: vec3<f32>,
    /// Area A of the surface that it represents [m²]; 0 for a point.
    area: f32,
    /// Unit; light leaves on this side.
    normal: vec3<f32>,
    /// What it was made from: texel of the reflective shadow map, counted through rows and layers.
    texel: u32,
    /// Φ [W].
    flux: vec3<f32>,
    pad: f32,
}

struct VirtualLights {
    /// How many there are; those beyond have no meaning.
    count: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
    lights: array<VirtualLight>,
}
