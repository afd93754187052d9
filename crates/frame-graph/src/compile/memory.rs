//! Assigns objects to resources.
//!
//! wgpu cannot place two resources in one piece of memory, so whole objects are shared: a resource takes over
//! an object of the same shape whose resource is no longer alive. Resources are assigned in the order in
//! which they are written; for resources of the same shape, that needs no more objects than are alive at
//! once.

use crate::plan::{Allocation, AllocationId, Plan, ResourceId};
use crate::resource::{BufferDesc, Format, ResourceDesc};
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// The properties that textures must have in common to share an object.
type Shape = (Format, (u32, u32), u32, bool);

fn shape(desc: &ResourceDesc) -> Option<Shape> {
    desc.texture().map(|t| (t.format, t.size, t.layers, t.array))
}

/// Objects whose resources are no longer alive.
#[derive(Default)]
struct Free {
    textures: FxHashMap<Shape, Vec<u32>>,
    /// By size in bytes.
    buffers: BTreeMap<u64, Vec<u32>>,
}

impl Free {
    fn put(&mut self, object: u32, desc: &ResourceDesc) {
        match shape(desc) {
            Some(shape) => self.textures.entry(shape).or_default().push(object),
            None => self.buffers.entry(desc.bytes()).or_default().push(object),
        }
    }

    /// Returns an object for a resource. A buffer may take one that is up to a quarter larger, or one that
    /// becomes large enough if it grows by at most that much.
    fn take(&mut self, desc: &ResourceDesc) -> Option<u32> {
        if let Some(shape) = shape(desc) {
            return self.textures.get_mut(&shape)?.pop();
        }
        let need = desc.bytes();
        let larger = self.buffers.range(need..=need.saturating_add(need / 4)).next().map(|(bytes, _)| *bytes);
        let smaller = || self.buffers.range(need - need / 5..need).next_back().map(|(bytes, _)| *bytes);
        let bytes = larger.or_else(smaller)?;
        let list = self.buffers.get_mut(&bytes)?;
        let object = list.pop();
        if list.is_empty() {
            self.buffers.remove(&bytes);
        }
        object
    }
}

/// Assigns an object to every resource, and adds up the memory.
pub(super) fn share(plan: &mut Plan, sharing: bool) {
    let mut free = Free::default();
    // Objects in use: the end of the lifetime of the resource in them, and the object.
    let mut used: BinaryHeap<Reverse<(u32, u32)>> = BinaryHeap::new();
    let allocations = &mut plan.allocations;
    let memory = &mut plan.memory;
    // Bytes whose lifetime begins and ends, by position.
    let mut begins = vec![0u64; plan.passes.len() + 1];
    let mut ends = vec![0u64; plan.passes.len() + 1];
    let mut transient: Vec<u32> = Vec::new();
    for (i, resource) in plan.resources.iter_mut().enumerate() {
        let id = ResourceId(i as u32);
        let mut object = |desc: &ResourceDesc| {
            allocations.push(Allocation { desc: desc.clone(), resources: vec![id] });
            AllocationId(allocations.len() as u32 - 1)
        };
        let bytes = resource.desc.bytes();
        if resource.persistent {
            resource.allocation = object(&resource.desc);
            memory.persistent += bytes;
            if let Some(history) = resource.history {
                let history = &mut plan.histories[history.0 as usize];
                history.copies = [resource.allocation; 2];
                if !history.in_place {
                    history.copies[1] = object(&resource.desc);
                    memory.persistent += bytes;
                }
            }
            continue;
        }
        let (start, end) = resource.lifetime;
        memory.unshared += bytes;
        begins[start as usize] += bytes;
        ends[end as usize + 1] += bytes;
        while let Some(Reverse((last, at))) = used.peek().copied()
            && last < start
        {
            used.pop();
            free.put(at, &allocations[at as usize].desc);
        }
        let taken = if sharing { free.take(&resource.desc) } else { None };
        let at = match taken {
            Some(at) => {
                let allocation = &mut allocations[at as usize];
                if allocation.desc.bytes() < bytes {
                    allocation.desc = ResourceDesc::Buffer(BufferDesc { bytes });
                }
                allocation.resources.push(id);
                at
            }
            None => {
                allocations.push(Allocation { desc: resource.desc.clone(), resources: vec![id] });
                transient.push(allocations.len() as u32 - 1);
                allocations.len() as u32 - 1
            }
        };
        resource.allocation = AllocationId(at);
        used.push(Reverse((end, at)));
    }
    let mut alive = 0;
    for (begin, end) in begins.into_iter().zip(ends) {
        alive = alive + begin - end;
        memory.bound = memory.bound.max(alive);
    }
    memory.objects = transient.len() as u32;
    memory.shared = transient.iter().map(|at| allocations[*at as usize].desc.bytes()).sum();
}
