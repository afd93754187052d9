// The interface VirtualLights: lights on surfaces that stand for light reflected or emitted there, and lights infinitely far.
//
// A light on a surface carries flux Φ [W] and emits as a Lambertian surface: at a point x far from it, it gives the irradiance
// Φ cosθ cosθ' V / (π d²), and none below the horizon of the normal that a normal map bends there (horizon.wgsl). A light infinitely
// far gives Φ cosθ V, where Φ is the irradiance across its direction [W/m²].

/// Values of `VirtualLight.kind`; all others are bent normals of lights on surfaces (horizon.wgsl).
const ON_SURFACE: u32 = 0u;
const INFINITELY_FAR: u32 = 1u;

/// A light that represents light reflected by a surface, or light from infinitely far.
struct VirtualLight {
    /// Position in world space [m]. Of a light infinitely far: the middle of the plane before the scene in which its map begins.
    position: vec3<f32>,
    /// Area A of the surface that it represents [m²]: 1 / (N p) where N lights were sampled with the density p; where several
    /// lights of the scene see a surface, its share. 0 for a point light.
    area: f32,
    /// Normal of that surface, unit; light leaves on this side. Of a light infinitely far: the direction in which it travels.
    normal: vec3<f32>,
    /// Texel of the reflective shadow map that it was sampled from, counted through rows and layers.
    texel: u32,
    /// Flux Φ [W], of which what is below the horizon does not leave; of a light infinitely far, irradiance [W/m²].
    flux: vec3<f32>,
    /// INFINITELY_FAR; or ON_SURFACE, in place of which stands the bent normal of a light under a normal map, or the mean of several.
    kind: u32,
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
