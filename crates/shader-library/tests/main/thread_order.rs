//! Compute entry points in another order of threads: valid, and the same shader but for the order. That each thread's
//! work is done once is shown on a GPU, in `pass-test`.

use shader_library::{Library, MemoryFiles, Request, Shader};
use std::sync::Arc;

fn load(text: &str, seed: Option<u32>) -> Arc<Shader> {
    let library = Library::new(Arc::new(MemoryFiles::new([("main.wgsl", text)])));
    let library = match seed {
        Some(seed) => library.with_thread_order(seed),
        None => library,
    };
    library.load(&Request::new("main.wgsl")).unwrap_or_else(|errors| panic!("{errors}"))
}

const EVERY_BUILT_IN: &str = "
    const WIDTH = 4;
    struct Given {
        @builtin(workgroup_id) group: vec3<u32>,
        @builtin(local_invocation_index) thread: u32,
        @builtin(global_invocation_id) id: vec3<u32>,
    }
    var<storage, read_write> seen: array<u32>;
    @compute @workgroup_size(WIDTH, 2) fn by_struct(
        given: Given, // a comment (with a parenthesis
        @builtin(num_workgroups) groups: vec3<u32>, /* fn by_struct() { */
        @builtin(local_invocation_id) local: vec3<u32>,
    ) {
        seen[given.group.x * groups.y + given.thread] = given.id.x + local.y;
    }
    @compute @workgroup_size(64) fn without_any() { seen[0] = 1u; }
    fn helper(group: vec3<u32>) -> u32 { return group.x; }
    @compute @workgroup_size(8, 8, 1)
    fn one(@builtin(global_invocation_id) id: vec3<u32>) { seen[helper(id)] = id.y; }
    @vertex fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
        return vec4<f32>(f32(index));
    }
";

#[test]
fn what_a_shader_binds_and_takes_stays() {
    let plain = load(EVERY_BUILT_IN, None);
    let permuted = load(EVERY_BUILT_IN, Some(3));
    assert_eq!(format!("{:?}", plain.interface), format!("{:?}", permuted.interface));
    assert_eq!(plain.text(), permuted.text());
}

#[test]
fn orders_are_other_shaders() {
    let hashes: Vec<u128> =
        [None, Some(0), Some(1)].map(|seed| load(EVERY_BUILT_IN, seed).hash).into_iter().collect();
    assert!(hashes[0] != hashes[1] && hashes[0] != hashes[2] && hashes[1] != hashes[2]);
    assert_eq!(hashes[2], load(EVERY_BUILT_IN, Some(1)).hash);
}

#[test]
fn an_early_return_before_a_barrier_is_taken() {
    let text = "var<workgroup> part: u32;
        @compute @workgroup_size(64) fn main(
            @builtin(workgroup_id) group: vec3<u32>,
            @builtin(num_workgroups) groups: vec3<u32>,
            @builtin(local_invocation_index) local: u32,
        ) {
            if group.x + 1 == groups.x { return; }
            part = local;
            workgroupBarrier();
        }";
    load(text, Some(0));
}

#[test]
fn a_workgroup_of_an_override_keeps_the_order_inside() {
    let text = "override WIDTH: u32 = 64;
        var<storage, read_write> seen: array<u32>;
        @compute @workgroup_size(WIDTH) fn main(@builtin(local_invocation_index) local: u32) { seen[0] = local; }";
    load(text, Some(0));
}
