// Rays against the scene's triangles: the closest hit, and whether there is any.
//
// Distances along a ray are in units of the length of its direction, which need not be 1; hits lie in (nearest,
// farthest), without both ends. Triangles have two sides, and those without area are never hit. A pass that imports
// this file declares the scene bindings SCENE; where vertices move, the acceleration structures follow before the
// frame.
//
//     fn trace(origin: vec3<f32>, direction: vec3<f32>, nearest: f32, farthest: f32) -> Hit
//     fn occluded(origin: vec3<f32>, direction: vec3<f32>, nearest: f32, farthest: f32) -> bool

#option RAYS bvh one_of [bvh, query] auto query where RAY_QUERIES // How rays are traced. bvh: by traversal in WGSL. query: by
    // the adapter's ray queries. auto: by ray queries where the adapter has them and the scene fits, else by traversal.

#import "mask.wgsl"
#import "scene.wgsl"
#if RAYS == query
#import "ray-query.wgsl"
#else
#import "bvh.wgsl"
#endif

const NO_HIT: u32 = 0xffffffffu;

/// Beyond every scene, and finite.
const FAR: f32 = 3.0e38;

struct Hit {
    /// Along the ray, in lengths of its direction.
    distance: f32,
    /// Index into scene_indices over three; NO_HIT for none.
    triangle: u32,
    /// Weights of its second and third vertex.
    barycentrics: vec2<f32>,
}

/// A point moved off its surface along the unit normal of the wanted side, farther than its rounding: by about
/// 200 times the spacing of floats there, but no less than near the scene's own extent where a coordinate is near
/// zero. [Wächter, Binder 2019, "A fast and robust method for avoiding self-intersection"]
fn offset_origin(position: vec3<f32>, geometric_normal: vec3<f32>) -> vec3<f32> {
    let least = vec3(scene_info.extent * 0x1p-18f);
    return position + geometric_normal * max(abs(position) * 0x1p-16f, least);
}
