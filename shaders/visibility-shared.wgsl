// The function of a module of the interface Visibility: the visibility of a light by its own map or, where lights share maps,
// by the map of its owner.
//
// The module that imports this file gives
//   fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32
// the part of the light of map `index` that is seen.

#option SHARED false internal // whether lights share maps: the pass share-visibility sets it

#import "virtual-lights.wgsl"

#if SHARED
/// The owner of each light.
var<storage, read> visibility_owners: array<u32>;
/// The owners: the lights of the maps.
var<storage, read> visibility_sources: VirtualLights;
#endif

/// A map, and the light whose it is.
struct OwnMap {
    index: u32,
    light: VirtualLight,
}

/// The map by which a light is looked up.
fn map_of(index: u32, light: VirtualLight) -> OwnMap {
#if SHARED
    let owner = visibility_owners[index];
    return OwnMap(owner, visibility_sources.lights[owner]);
#else
    return OwnMap(index, light);
#endif
}

/// Part of a virtual light that is seen from a point: 0 behind the light's plane and in shadow, 1 in the light.
/// `index` is the light's, `at` [m] and the unit `normal` are the receiver's.
fn visibility(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let own = map_of(index, light);
    return visibility_by_map(own.index, own.light, at, normal);
}
