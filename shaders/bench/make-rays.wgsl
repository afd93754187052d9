// Makes the rays: from the camera through the centres of pixels, or one from each surface that these see, spread over
// the cosine as a diffuse surface spreads light. [Aila, Laine 2009, "Understanding the Efficiency of Ray Traversal on
// GPUs": primary and diffuse rays]

#import "camera.wgsl"
#import "dispatch.wgsl"
#import "path-vertex.wgsl"
#import "random.wgsl"
#import "ray.wgsl"
#import "tangent-frame.wgsl"

struct Settings {
    seed: u32,
    /// 0 for those of the camera, 1 for those of surfaces. [default: 0, max: 1]
    from_surfaces: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> rays: array<Ray>;

@compute @workgroup_size(64)
fn make(row: Row) {
    let i = index_in(row, 64u);
    if i >= arrayLength(&rays) {
        return;
    }
    let width = u32(camera.size.x);
    let direction = view_ray(vec2<f32>(vec2(i % width, i / width)) + 0.5);
    if settings.from_surfaces == 0u {
        rays[i] = Ray(camera.position, 1u, direction, 0u);
        return;
    }
    let hit = trace(camera.position, direction, camera.near, FAR);
    if hit.triangle == NO_HIT {
        return;
    }
    let vertex = path_vertex(hit, direction);
    let first = unit_float(hash2(settings.seed, 2u * i));
    let turn = 6.2831853 * unit_float(hash2(settings.seed, 2u * i + 1u));
    let side = sqrt(first);
    let spread = vec3(side * cos(turn), side * sin(turn), sqrt(1.0 - first));
    let origin = offset_origin(vertex.position, vertex.geometric);
    rays[i] = Ray(origin, 1u, frame_from_normal(vertex.geometric) * spread, 0u);
}
