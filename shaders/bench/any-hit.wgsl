// Whether each ray hits anything, one thread per ray: 2 if it does, 1 if not, and 0 if there is no ray.

#import "dispatch.wgsl"
#import "ray-tracing.wgsl"
#import "ray.wgsl"

var<storage, read> rays: array<Ray>;
var<storage, read_write> hits: array<u32>;

@compute @workgroup_size(64)
fn any_hit(row: Row) {
    let i = index_in(row, 64u);
    if i >= arrayLength(&rays) || rays[i].exists == 0u {
        return;
    }
    hits[i] = select(1u, 2u, occluded(rays[i].origin, rays[i].direction, 0.0, FAR));
}
