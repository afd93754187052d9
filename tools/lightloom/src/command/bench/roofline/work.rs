//! The least that a pass must move and do, and the time that it takes at the adapter's ceilings.

use super::ceiling::{Ceiling, Ceilings};
use frame_graph::plan::{Plan, PlannedPass, ResourceId};
use frame_graph::{ResourceDesc, TextureDesc};
use pass::{Draw, LinkedStep, LinkedSteps, Source, Step, Threads};
use shader_library::{Access, GlobalKind};
use std::collections::BTreeSet;

/// Defines the quantities: name, and the ceilings of which the fastest bounds it, since what a
/// pass moves may be in caches or not.
macro_rules! quantities {
    ($($(#[$doc:meta])* $name:ident $label:literal [$($ceiling:ident)*])*) => {
        /// A quantity that is counted of a pass.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Quantity {
            $($(#[$doc])* $name,)*
        }

        impl Quantity {
            pub(super) const ALL: [Quantity; [$($label),*].len()] = [$(Quantity::$name),*];

            pub(super) fn name(self) -> &'static str {
                match self {
                    $(Quantity::$name => $label,)*
                }
            }

            fn ceilings(self) -> &'static [Ceiling] {
                match self {
                    $(Quantity::$name => &[$(Ceiling::$ceiling),*],)*
                }
            }
        }
    };
}

quantities! {
    /// Bytes of all that it reads and writes, each once.
    Bytes "bytes moved" [Copy Load LoadNear Store StoreNear]
    /// Bytes of buffers that it reads.
    Read "bytes read from buffers" [Load LoadNear]
    /// Bytes of buffers that it writes.
    Written "bytes written to buffers" [Store StoreNear]
    /// Loads from buffers, of any size.
    Loads "loads" [LoadWordsInOrder LoadWords LoadWordsNear LoadVectors LoadVectorsNear]
    /// Texels that it loads.
    TexelLoads "texels loaded" [LoadTexels]
    /// Texels that it stores.
    TexelStores "texels stored" [StoreTexels]
    Atomics "atomics" [Atomics AtomicsNear]
    /// Threads of its dispatches, of whole workgroups.
    Threads "threads" [Threads]
    /// Threads at a barrier, for each of its barriers.
    Barriers "threads at barriers" [Barriers]
    /// Operations of floating point.
    Operations "operations" [Multiplications]
    Dispatches "dispatches" [Dispatches]
    /// Texels that it draws.
    Fragments "fragments" [Fragments FragmentsOfFour]
    /// Triangles that it draws.
    Triangles "triangles" [Triangles TrianglesOutOfView]
}

/// The amount of each quantity of a pass.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Work([u64; Quantity::ALL.len()]);

impl Work {
    /// Counts what the plan and the steps of a pass declare: sizes of what is bound, each resource once however many steps
    /// bind it; threads, dispatches and draws. Inputs whose ports are `sparse` are read here and there, and not counted. A
    /// draw counts as one that covers its target once. The scene's own buffers and textures are not counted, nor draws
    /// and dispatches whose size is on the GPU.
    pub(super) fn of(
        plan: &Plan,
        pass: &PlannedPass,
        steps: &LinkedSteps,
        triangles: u64,
        sparse: &[&str],
    ) -> Work {
        let mut work = Work::default();
        let skipped: BTreeSet<ResourceId> = pass
            .inputs
            .iter()
            .filter(|input| sparse.contains(&input.port.as_str()))
            .flat_map(|input| input.members.iter().map(|(_, id)| *id))
            .collect();
        let mut moved = BTreeSet::new();
        for step in steps {
            work.add_step(plan, step, triangles);
            for (id, how) in moves(plan, step) {
                if !skipped.contains(&id) && moved.insert((id, how)) {
                    work.add_moved(&plan.resources[id.0 as usize].desc, how);
                }
            }
        }
        work
    }

    fn add_step(&mut self, plan: &Plan, step: &LinkedStep, triangles: u64) {
        let raster = match &step.step {
            Step::Compute(_) => {
                self.add(Quantity::Dispatches, 1);
                self.add(Quantity::Threads, threads(step));
                return;
            }
            Step::Raster(raster) => raster,
        };
        self.add(
            Quantity::Triangles,
            match &raster.draw {
                Draw::Fullscreen => 1,
                Draw::Scene => triangles,
                Draw::Vertices { vertices, instances } => u64::from(vertices / 3) * u64::from(*instances),
                Draw::Indirect { .. } => 0,
            },
        );
        let target = step.targets.first().or(step.depth.as_ref());
        let desc = target.and_then(|id| plan.resources[id.0 as usize].desc.texture());
        self.add(Quantity::Fragments, desc.map_or(0, texels_of_layer));
    }

    fn add_moved(&mut self, desc: &ResourceDesc, how: Move) {
        let texels = desc.texture().map_or(0, |t| texels_of_layer(t) * u64::from(t.layers));
        match how {
            Move::Read => self.add(Quantity::Read, desc.bytes()),
            Move::Written => self.add(Quantity::Written, desc.bytes()),
            Move::Loaded => self.add(Quantity::TexelLoads, texels),
            Move::Stored => self.add(Quantity::TexelStores, texels),
            Move::Drawn => {}
        }
        self.add(Quantity::Bytes, desc.bytes());
    }

    pub(super) fn add(&mut self, quantity: Quantity, more: u64) {
        self.0[quantity as usize] += more;
    }

    pub(super) fn set(&mut self, quantity: Quantity, count: u64) {
        self.0[quantity as usize] = count;
    }

    pub(super) fn get(&self, quantity: Quantity) -> u64 {
        self.0[quantity as usize]
    }

    /// Returns the least milliseconds that each quantity takes.
    pub(super) fn least(&self, ceilings: &Ceilings) -> impl Iterator<Item = (Quantity, f64)> {
        Quantity::ALL.into_iter().filter_map(|quantity| {
            let count = self.get(quantity);
            let rate = ceilings.fastest(quantity.ceilings()).filter(|_| count > 0)?;
            Some((quantity, 1e3 * count as f64 / rate))
        })
    }

    /// Returns the least milliseconds that all of it takes, where everything overlaps: those of the quantity that takes longest.
    pub(super) fn bound(&self, ceilings: &Ceilings) -> Option<(Quantity, f64)> {
        self.least(ceilings).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Returns the counts that are not zero.
    pub(super) fn counts(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let all = Quantity::ALL.into_iter().map(|quantity| (quantity.name(), self.get(quantity)));
        all.filter(|(_, count)| *count > 0)
    }
}

/// Returns the threads of a dispatch, of whole workgroups; 0 where its size is on the GPU.
pub(super) fn threads(step: &LinkedStep) -> u64 {
    let Step::Compute(compute) = &step.step else { return 0 };
    let size = step.shader.interface.entries[step.entries[0]].workgroup_size.map(|side| side.max(1));
    let whole = |threads: u32, axis: usize| u64::from(threads.next_multiple_of(size[axis]));
    let rest = |axis: usize| u64::from(size[axis]);
    match &compute.threads {
        Threads::Grid(threads) => (0..3).map(|axis| whole(threads[axis], axis)).product(),
        Threads::Row(threads) => whole(*threads, 0) * rest(1) * rest(2),
        Threads::Indirect { .. } => 0,
    }
}

/// How a step moves a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Move {
    /// From a buffer.
    Read,
    /// Into a buffer.
    Written,
    /// From a texture.
    Loaded,
    /// Into a storage texture.
    Stored,
    /// As a target.
    Drawn,
}

/// Returns what a step moves, and how. A buffer that a shader may write counts as written alone: whether it reads it, too, is not
/// declared.
fn moves(plan: &Plan, step: &LinkedStep) -> impl Iterator<Item = (ResourceId, Move)> {
    let globals = &step.shader.interface.globals;
    let bound = step.bindings.iter().filter_map(move |bound| {
        let id = match &bound.source {
            Source::Resource(id) => *id,
            Source::Past(history) => plan.histories[history.0 as usize].resource,
            Source::SceneBinding(_) | Source::ChosenLights { .. } | Source::Uniform(_) => return None,
        };
        let how = match &globals[bound.global].kind {
            GlobalKind::Storage { writable: true, .. } => Move::Written,
            GlobalKind::Storage { .. } => Move::Read,
            GlobalKind::Texture { .. } => Move::Loaded,
            GlobalKind::StorageTexture { access: Access::Read, .. } => Move::Loaded,
            GlobalKind::StorageTexture { .. } => Move::Stored,
            _ => return None,
        };
        Some((id, how))
    });
    bound.chain(step.targets.iter().chain(&step.depth).map(|id| (*id, Move::Drawn)))
}

/// Returns the number of texels of one layer of a texture.
pub(super) fn texels_of_layer(texture: &TextureDesc<(u32, u32)>) -> u64 {
    u64::from(texture.size.0) * u64::from(texture.size.1)
}

#[cfg(test)]
mod tests {
    use super::super::super::table::Spread;
    use super::super::ceiling::Measured;
    use super::*;

    #[test]
    fn the_longest_quantity_binds_at_its_fastest_ceiling() {
        let measured = |ceiling, rate| Measured { ceiling, rate: Spread::exact(rate) };
        let ceilings = Ceilings(vec![
            measured(Ceiling::Copy, 4e9),
            measured(Ceiling::Load, 1e9),
            measured(Ceiling::LoadNear, 2e9),
            measured(Ceiling::Threads, 1e6),
        ]);
        let mut work = Work::default();
        assert_eq!(work.bound(&ceilings), None);
        work.add(Quantity::Read, 8_000_000);
        work.add(Quantity::Bytes, 8_000_000);
        work.add(Quantity::Threads, 1000);
        // Nothing has measured atomics.
        work.add(Quantity::Atomics, 1000);
        let least: Vec<(Quantity, f64)> = work.least(&ceilings).collect();
        assert_eq!(least, [(Quantity::Bytes, 2.0), (Quantity::Read, 4.0), (Quantity::Threads, 1.0)]);
        assert_eq!(work.bound(&ceilings), Some((Quantity::Read, 4.0)));
    }
}
