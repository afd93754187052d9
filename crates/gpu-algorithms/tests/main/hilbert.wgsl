// Places along Hilbert's curve of the cells of a cube of 16³ at a corner of the box, x first.

#import "algorithms/hilbert.wgsl"
#import "dispatch.wgsl"

var<storage, read_write> places: array<u32>;

@compute @workgroup_size(64)
fn find(row: Row) {
    let i = index_in(row, 64u);
    let cell = vec3(i & 15u, (i >> 4u) & 15u, i >> 8u);
    let box = Summary(vec3(0.0), 0u, vec3(1023.0), 0u);
    places[i] = hilbert_of(vec3<f32>(cell) + 0.25, box);
}
