// Traces given rays: what the CPU reference on the CPU must give too.

#import "dispatch.wgsl"
#import "ray-tracing.wgsl"

struct GivenRay {
    origin: vec3<f32>,
    nearest: f32,
    direction: vec3<f32>,
    farthest: f32,
}

struct FoundHit {
    barycentrics: vec2<f32>,
    distance: f32,
    triangle: u32,
    /// Whether the same ray is occluded.
    occluded: u32,
    /// Whether a ray from the hit, moved off its surface to either side, does not meet the same triangle.
    leaves: u32,
}

var<storage, read> rays: array<GivenRay>;
var<storage, read_write> hits: array<FoundHit>;

@compute @workgroup_size(64)
fn follow(row: Row) {
    let i = index_in(row, 64u);
    if i >= arrayLength(&rays) {
        return;
    }
    let ray = rays[i];
    let hit = trace(ray.origin, ray.direction, ray.nearest, ray.farthest);
    let shadow = occluded(ray.origin, ray.direction, ray.nearest, ray.farthest);
    hits[i] = FoundHit(hit.barycentrics, hit.distance, hit.triangle, u32(shadow), u32(leaves(hit, ray.direction)));
}

/// From the hit's point in the triangle, mirrored and passing on.
fn leaves(hit: Hit, direction: vec3<f32>) -> bool {
    if hit.triangle == NO_HIT {
        return true;
    }
    let a = scene_vertices[scene_indices[3u * hit.triangle]].position;
    let b = scene_vertices[scene_indices[3u * hit.triangle + 1u]].position;
    let c = scene_vertices[scene_indices[3u * hit.triangle + 2u]].position;
    let position = a + (b - a) * hit.barycentrics.x + (c - a) * hit.barycentrics.y;
    let across = cross(b - a, c - a);
    let normal = normalize(across / max(max(abs(across.x), abs(across.y)), abs(across.z)));
    let behind = normal * sign(dot(normal, direction));
    let reflected = direction - behind * (2.0 * dot(behind, direction));
    let back = trace(offset_origin(position, -behind), reflected, 0.0, 3e38);
    let on = trace(offset_origin(position, behind), direction, 0.0, 3e38);
    return back.triangle != hit.triangle && on.triangle != hit.triangle;
}
