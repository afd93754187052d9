// The closest hit of each ray, one thread per ray. If there is no ray, the result stays zero.

#import "dispatch.wgsl"
#import "ray-tracing.wgsl"
#import "ray.wgsl"

var<storage, read> rays: array<Ray>;
var<storage, read_write> hits: array<Hit>;

@compute @workgroup_size(64)
fn closest_hit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let i = row_index(group, groups, local, 64u);
    if i >= arrayLength(&rays) || rays[i].exists == 0u {
        return;
    }
    hits[i] = trace(rays[i].origin, rays[i].direction, 0.0, FAR);
}
