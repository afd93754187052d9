// Threads in a row. A dispatch of more workgroups than one dimension allows is folded into two.

/// Place of a thread in a row, for dispatches made with `Threads::Row`: the parameter of an entry point.
struct Row {
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
}

/// Index of this thread among those of workgroups of this size.
fn index_in(row: Row, group_size: u32) -> u32 {
    return group_in(row) * group_size + row.local;
}

/// Index of the workgroup of this thread.
fn group_in(row: Row) -> u32 {
    return row.group.y * row.groups.x + row.group.x;
}

/// The most workgroups that WebGPU promises along one dimension.
const WIDEST: u32 = 65535u;

/// Returns this number of workgroups, folded into two dimensions: for a dispatch whose size a shader writes.
fn folded(groups: u32) -> vec2<u32> {
    let rows = (groups + WIDEST - 1u) / WIDEST;
    return vec2((groups + max(rows, 1u) - 1u) / max(rows, 1u), rows);
}
