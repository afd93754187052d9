// The plane of what a pixel sees. Its normal is not the one that a normal map bends, which lights the surface: shadow tests,
// the origins of rays and distances from the surface take the plane's.

#option VIEW_GEOMETRIC false // whether the G-buffer has the member `geometric`

#if VIEW_GEOMETRIC
#import "octahedron.wgsl"

var view_geometric: texture_2d<f32>;
#endif

/// The unit normal of the plane at a pixel; `shading` is its shading normal, unit.
fn plane_normal(pixel: vec2<u32>, shading: vec3<f32>) -> vec3<f32> {
#if VIEW_GEOMETRIC
    return direction_from_octahedron(textureLoad(view_geometric, pixel, 0).xy);
#else
    return shading;
#endif
}
