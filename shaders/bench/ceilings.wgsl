// The limits of an adapter: one kernel for each sort of work that passes do, and little else in it. `lightloom
// bench --only roofline` times them.
//
// Lengths of buffers and sides of textures are powers of two, so that an index is kept inside by a mask. No kernel can be
// left out by a compiler: what is loaded decides whether something is stored.

#import "fullscreen.wgsl"

var<storage, read> vectors: array<vec4<u32>>;
var<storage, read> words: array<u32>;
var<storage, read_write> stored: array<vec4<u32>>;
var<storage, read_write> minima: array<atomic<u32>>;
var<storage, read_write> kept: array<u32>;
var texels: texture_2d<f32>;
var image: texture_storage_2d<r32float, write>;

/// Loads, stores or atomics of a thread.
const PER_THREAD: u32 = 8u;
/// Threads of a workgroup, where nothing is shared.
const GROUP_SIZE: u32 = 64u;
/// Threads of a workgroup that wait for each other, as in algorithms/workgroup.wgsl.
const WAITING: u32 = 256u;
/// Times that each of them waits.
const WAITS: u32 = 64u;
/// Multiplications with additions of a thread, of vectors of four.
const MULTIPLICATIONS: u32 = 1024u;
/// Side of the target of tiny triangles [px].
const TARGET_SIDE: u32 = 512u;

/// Bits without a visible order, in as few operations as give them.
fn scattered(index: u32) -> u32 {
    let mixed = index * 0x9e3779b1u;
    return (mixed ^ (mixed >> 15u)) * 0x85ebca77u;
}

/// Stores what no test foresees: loads before it have to be done.
fn keep(value: u32) {
    if value == 0x9e3779b9u {
        kept[0] = value;
    }
}

/// Nothing: threads that start and end.
@compute @workgroup_size(GROUP_SIZE)
fn start() {}

/// Neighbouring threads load neighbouring vectors.
@compute @workgroup_size(GROUP_SIZE)
fn load_in_order(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let mask = arrayLength(&vectors) - 1u;
    var all = vec4(0u);
    for (var k = 0u; k < PER_THREAD; k++) {
        all ^= vectors[(id.x + k * groups.x * GROUP_SIZE) & mask];
    }
    keep(all.x ^ all.y ^ all.z ^ all.w);
}

/// Neighbouring threads load neighbouring words.
@compute @workgroup_size(GROUP_SIZE)
fn load_words_in_order(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let mask = arrayLength(&words) - 1u;
    var all = 0u;
    for (var k = 0u; k < PER_THREAD; k++) {
        all ^= words[(id.x + k * groups.x * GROUP_SIZE) & mask];
    }
    keep(all);
}

/// Each load is of a word anywhere.
@compute @workgroup_size(GROUP_SIZE)
fn load_words(@builtin(global_invocation_id) id: vec3<u32>) {
    let mask = arrayLength(&words) - 1u;
    var all = 0u;
    for (var k = 0u; k < PER_THREAD; k++) {
        all ^= words[scattered(id.x * PER_THREAD + k) & mask];
    }
    keep(all);
}

/// Each load is of a vector anywhere.
@compute @workgroup_size(GROUP_SIZE)
fn load_vectors(@builtin(global_invocation_id) id: vec3<u32>) {
    let mask = arrayLength(&vectors) - 1u;
    var all = vec4(0u);
    for (var k = 0u; k < PER_THREAD; k++) {
        all ^= vectors[scattered(id.x * PER_THREAD + k) & mask];
    }
    keep(all.x ^ all.y ^ all.z ^ all.w);
}

/// Neighbouring threads store neighbouring vectors.
@compute @workgroup_size(GROUP_SIZE)
fn store_in_order(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let mask = arrayLength(&stored) - 1u;
    for (var k = 0u; k < PER_THREAD; k++) {
        let at = (id.x + k * groups.x * GROUP_SIZE) & mask;
        stored[at] = vec4(at) * vec4(1u, 3u, 5u, 7u);
    }
}

/// Minima of words anywhere, as splats are.
@compute @workgroup_size(GROUP_SIZE)
fn minimum_anywhere(@builtin(global_invocation_id) id: vec3<u32>) {
    let mask = arrayLength(&minima) - 1u;
    for (var k = 0u; k < PER_THREAD; k++) {
        let bits = scattered(id.x * PER_THREAD + k);
        atomicMin(&minima[bits & mask], bits);
    }
}

/// Minima of one word, for which all threads wait.
@compute @workgroup_size(GROUP_SIZE)
fn minimum_of_one(@builtin(global_invocation_id) id: vec3<u32>) {
    for (var k = 0u; k < PER_THREAD; k++) {
        atomicMin(&minima[0], scattered(id.x * PER_THREAD + k));
    }
}

var<workgroup> passed: array<u32, WAITING>;

/// Each thread takes what its neighbour had, and waits before and after.
@compute @workgroup_size(WAITING)
fn wait(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    passed[thread] = id.x;
    for (var k = 0u; k < WAITS; k += 2u) {
        workgroupBarrier();
        let next = passed[(thread + 1u) % WAITING];
        workgroupBarrier();
        passed[thread] = next;
    }
    keep(passed[thread]);
}

/// Two chains of vectors of four, which do not wait for each other: eight sums are on their way at once.
@compute @workgroup_size(GROUP_SIZE)
fn multiply(@builtin(global_invocation_id) id: vec3<u32>) {
    let factor = vec4(1.0 + 1e-7 * f32(id.x & 15u));
    let summand = vec4(f32(id.x)) + vec4(0.0, 1.0, 2.0, 3.0);
    var a = summand;
    var b = summand + 4.0;
    for (var k = 0u; k < MULTIPLICATIONS; k += 16u) {
        // So many at a time that the loop itself counts for little.
        a = fma(a, factor, summand);
        b = fma(b, factor, summand);
        a = fma(a, factor, summand);
        b = fma(b, factor, summand);
        a = fma(a, factor, summand);
        b = fma(b, factor, summand);
        a = fma(a, factor, summand);
        b = fma(b, factor, summand);
        a = fma(a, factor, summand);
        b = fma(b, factor, summand);
        a = fma(a, factor, summand);
        b = fma(b, factor, summand);
        a = fma(a, factor, summand);
        b = fma(b, factor, summand);
        a = fma(a, factor, summand);
        b = fma(b, factor, summand);
    }
    let both = bitcast<vec4<u32>>(a + b);
    keep(both.x ^ both.y ^ both.z ^ both.w);
}

/// Neighbouring threads load neighbouring texels.
@compute @workgroup_size(8, 8)
fn load_texels(@builtin(global_invocation_id) id: vec3<u32>) {
    let mask = textureDimensions(texels) - 1u;
    var sum = 0.0;
    for (var k = 0u; k < PER_THREAD; k++) {
        sum += textureLoad(texels, (id.xy + vec2(0u, k)) & mask, 0).x;
    }
    keep(bitcast<u32>(sum));
}

/// One texel a thread.
@compute @workgroup_size(8, 8)
fn store_texels(@builtin(global_invocation_id) id: vec3<u32>) {
    let mask = textureDimensions(image) - 1u;
    textureStore(image, id.xy & mask, vec4(f32(id.x)));
}

/// A corner of a triangle of a third of a pixel anywhere, between the centres of pixels.
fn tiny_triangle(index: u32) -> vec4<f32> {
    let bits = scattered(index / 3u);
    let corner = vec2<f32>(vec2(index % 3u) == vec2(1u, 2u)) * 0.3 + 0.1;
    let at = vec2<f32>(vec2(bits, bits >> 9u) % TARGET_SIDE) + corner;
    return vec4(at / f32(TARGET_SIDE) * 2.0 - 1.0, 0.5, 1.0);
}

/// It is set up, and covers no pixel's centre.
@vertex
fn tiny(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return tiny_triangle(index);
}

/// The same beside the target: it is left out before it is set up, as whatever is out of view.
@vertex
fn out_of_view(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return tiny_triangle(index) + vec4(2.0, 0.0, 0.0, 0.0);
}

/// A color that differs from pixel to pixel.
@fragment
fn paint(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return position;
}
