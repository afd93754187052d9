// The interface VirtualLights: lights on surfaces that stand for light reflected there.
//
// A virtual light carries flux Φ [W] and emits as a Lambertian surface: at a point x far from it, it gives the irradiance
// Φ cosθ cosθ' V / (π d²).

/// A light that represents light reflected by a surface.
struct VirtualLight {
    /// Position in world space [m].
    position: vec3<f32>,
    /// Area A of the surface that it represents [m²]: 1 / (N p) where N lights were sampled with the density p; where several
    /// lights of the scene see a surface, its share. 0 for a point light.
    area: f32,
    /// Normal of that surface, unit; light leaves on this side.
    normal: vec3<f32>,
    /// Texel of the reflective shadow map that it was sampled from, counted through rows and layers.
    texel: u32,
    /// Reflected flux Φ [W].
    flux: vec3<f32>,
    pad: f32,
}

/// A number of virtual lights.
struct VirtualLights {
    /// How many lights there are; those beyond have no meaning.
    count: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
    lights: array<VirtualLight>,
}
