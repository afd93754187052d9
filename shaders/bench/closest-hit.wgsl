// The closest hit of each ray, one thread per ray. If there is no ray, the result stays zero.

#import "dispatch.wgsl"
#import "ray-tracing.wgsl"
#import "ray.wgsl"

var<storage, read> rays: array<Ray>;
var<storage, read_write> hits: array<Hit>;

@compute @workgroup_size(64)
fn closest_hit(row: Row) {
    let i = index_in(row, 64u);
    if i >= arrayLength(&rays) || rays[i].exists == 0u {
        return;
    }
    hits[i] = trace(rays[i].origin, rays[i].direction, 0.0, FAR);
}
