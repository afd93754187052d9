// Threads in a row. A dispatch of more workgroups than one dimension allows is folded into two.

/// Index of this thread, for dispatches made with `Threads::Row`.
fn row_index(group: vec3<u32>, groups: vec3<u32>, local: u32, group_size: u32) -> u32 {
    return (group.y * groups.x + group.x) * group_size + local;
}
