// Rays by the adapter's ray queries: what ray-tracing.wgsl promises, where the adapter has them. Whether an end of
// the interval counts, and which of two triangles at one distance is hit, is the adapter's own.

enable wgpu_ray_query;

/// Over all triangles, in the order of scene_indices.
var scene_acceleration: acceleration_structure;

/// The closest hit in (nearest, farthest).
fn trace(origin: vec3<f32>, direction: vec3<f32>, nearest: f32, farthest: f32) -> Hit {
    let found = query_rays(origin, direction, nearest, farthest, RAY_FLAG_NONE);
    if found.kind == RAY_QUERY_INTERSECTION_NONE {
        return Hit(farthest, NO_HIT, vec2(0.0));
    }
    return Hit(found.t, found.primitive_index, found.barycentrics);
}

/// Whether anything is hit in (nearest, farthest).
fn occluded(origin: vec3<f32>, direction: vec3<f32>, nearest: f32, farthest: f32) -> bool {
    let found = query_rays(origin, direction, nearest, farthest, RAY_FLAG_TERMINATE_ON_FIRST_HIT);
    return found.kind != RAY_QUERY_INTERSECTION_NONE;
}

/// Returns the intersection of a ray that the adapter finds within (nearest, farthest), in lengths of the direction; `flags`
/// are those of a ray query.
fn query_rays(
    origin: vec3<f32>, direction: vec3<f32>, nearest: f32, farthest: f32, flags: u32,
) -> RayIntersection {
    var query: ray_query;
#if MASKED
    // Each triangle is a candidate until the shader confirms it.
    rayQueryInitialize(
        &query, scene_acceleration,
        RayDesc(flags | RAY_FLAG_FORCE_NO_OPAQUE, 0xffu, nearest, farthest, origin, direction),
    );
    while rayQueryProceed(&query) {
        let candidate = rayQueryGetCandidateIntersection(&query);
        if triangle_exists(candidate.primitive_index, candidate.barycentrics) {
            rayQueryConfirmIntersection(&query);
        }
    }
#else
    rayQueryInitialize(
        &query, scene_acceleration,
        RayDesc(flags | RAY_FLAG_FORCE_OPAQUE, 0xffu, nearest, farthest, origin, direction),
    );
    while rayQueryProceed(&query) {}
#endif
    return rayQueryGetCommittedIntersection(&query);
}
