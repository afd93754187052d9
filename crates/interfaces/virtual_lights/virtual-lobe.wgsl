// What the surface of a virtual light reflects specularly: the member `lobes` of the interface VirtualLights.
//
// A light with a lobe f has the radiant intensity (Φ/π + Ψ f(ψ, ω)) cosθ' towards ω, where the flux Ψ arrived from ψ.

/// The specular reflection of a virtual light on a surface.
struct VirtualLobe {
    /// The way to the source of what it reflects, unit, ψ.
    incoming: vec3<f32>,
    /// Of the surface.
    roughness: f32,
    /// Flux Ψ [W] that arrives at what the light stands for; 0 where nothing is reflected specularly.
    flux: vec3<f32>,
    pad0: u32,
    /// Reflectance of the surface at normal incidence.
    f0: vec3<f32>,
    pad1: u32,
}

/// What reflects nothing specularly.
fn no_lobe() -> VirtualLobe {
    return VirtualLobe(vec3(0.0, 0.0, 1.0), 1.0, vec3(0.0), 0u, vec3(0.0), 0u);
}
