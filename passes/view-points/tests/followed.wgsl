// Points where their triangles are now.

#import "dispatch.wgsl"
#import "surface-point.wgsl"

var<storage, read> before: array<SurfacePoint>;
var<storage, read_write> after: array<SurfacePoint>;

@compute @workgroup_size(64)
fn follow(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let i = row_index(group, groups, local, 64u);
    if i < arrayLength(&before) {
        after[i] = followed(before[i]);
    }
}
