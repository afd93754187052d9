// The guide table of a search for triangles: where searches begin and end (Chen & Asau 1974). `gpu_algorithms::guide`
// dispatches it.
//
// The shader that imports this file gives, beside what `triangle-samples.wgsl` asks for,
//   fn guide_bits() -> u32                       binary logarithm of the number of entries without the last
//   fn number_bits() -> u32                      intervals divide the numbers of so many bits; more than `guide_bits`
//   fn guide_store(i: u32, triangle: u32)        takes the triangle of the first number of entry i, and for the last the last
//
// A number n is then sought between the triangles of entries n >> (number_bits - guide_bits) and the next: mostly one or two.

#import "dispatch.wgsl"
#import "scene.wgsl"
#import "triangle-samples.wgsl"

@compute @workgroup_size(256)
fn guide(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 256u);
    let entries = 1u << guide_bits();
    if index > entries || scene_info.triangles == 0u {
        return;
    }
    let last = scene_info.triangles - 1u;
    var triangle = last;
    if index < entries {
        triangle = triangle_at(index << (number_bits() - guide_bits()), 0u, last);
    }
    guide_store(index, triangle);
}
