// The interface Stands: where virtual lights stood when their shadow maps were rendered. [SMC-IR §4, Laine et al. 2007]

#import "virtual-lights.wgsl"

/// The pose of a virtual light when its shadow map was rendered.
struct Stand {
    /// Position in world space [m].
    position: vec3<f32>,
    /// 1 where there is a map; 0 before, and where the light is dark.
    is_rendered: u32,
    /// Normal, unit.
    normal: vec3<f32>,
    /// Frames in which points fell into the map; 0 where it is rendered whole.
    frames: u32,
}

struct Stands {
    stands: array<Stand>,
}

/// Returns where a light stands. A dark light has no map, until it shines.
fn stand_of(light: VirtualLight) -> Stand {
    if all(light.flux == vec3(0.0)) {
        return Stand(vec3(0.0), 0u, vec3(0.0, 0.0, 1.0), 0u);
    }
    return Stand(light.position, 1u, light.normal, 0u);
}

/// Whether a light stands where it did: to the bit, since any difference moves edges of shadows.
fn is_same_stand(a: Stand, b: Stand) -> bool {
    return a.is_rendered == b.is_rendered
        && all(bitcast<vec3<u32>>(a.position) == bitcast<vec3<u32>>(b.position))
        && all(bitcast<vec3<u32>>(a.normal) == bitcast<vec3<u32>>(b.normal));
}
