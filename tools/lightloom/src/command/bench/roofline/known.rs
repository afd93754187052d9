//! Counts that the graph does not know: loads of a shader, barriers, texels that are drawn several times. There is one
//! entry for each pass type of the measured frames, with the reason; other passes are counted by the plan alone.

use super::work::{Quantity, Work, texels_of_layer, threads};
use frame_graph::plan::{Plan, PlannedPass};
use frame_graph::{TextureDesc, Value};
use pass::{LinkedStep, LinkedSteps};
use std::sync::Arc;

/// The counts of a pass type.
struct Known {
    kind: &'static str,
    /// Inputs of which it reads some elements.
    sparse: &'static [&'static str],
    /// Adds the counts that the plan does not give.
    count: fn(&Pass<'_>, &mut Work),
}

const KNOWN: [Known; 9] = [
    // Two entries of the guide table, a step of the search between them, the interval's two ends, three indices and three
    // corners.
    Known {
        kind: "scene-points",
        sparse: &[],
        count: |pass, work| {
            work.add(Quantity::Loads, pass.threads("place") * (2 + 1 + 2 + 3 + 3));
        },
    },
    // A point and a light are two vectors each; of stored points no more are read than there are splats. Atomics are
    // counted in the maps: see `MARKED`.
    Known {
        kind: "splat",
        sparse: &["points"],
        count: |pass, work| {
            let splats = pass.threads("splat");
            work.add(Quantity::Loads, 4 * splats);
            let read = pass.input_bytes("points").min(32 * splats);
            work.add(Quantity::Read, read);
            work.add(Quantity::Bytes, read);
        },
    },
    // Four finer texels for each coarser one; its own for each texel that is pushed or filled, and four coarser ones, but for
    // texels that are no holes where the threshold is the scene's extent: here, for all.
    Known {
        kind: "pull-push",
        sparse: &[],
        count: |pass, work| {
            let (tile, maps) = (pass.input_fact("depth", "tile"), pass.input_fact("depth", "count"));
            let levels = pass.setting("levels");
            let texels = |level: u64| maps * tile.div_ceil(1 << level).pow(2);
            let pulled: u64 = (1..=levels).map(texels).sum();
            let pushed: u64 = (1..levels).map(texels).sum();
            let each = if levels > 0 && pass.setting_f32("push_threshold") < 1.0 { 5 } else { 1 };
            work.add(Quantity::Loads, 4 * pulled + each * (pushed + texels(0)));
        },
    },
    // Each vertex loads three indices and three corners. Of the square of a map, the disc is what a hemisphere covers,
    // at least once where it sees surfaces only; how often triangles lie behind each other is not counted.
    Known {
        kind: "paraboloid-shadow-maps",
        sparse: &[],
        count: |pass, work| {
            work.add(Quantity::Loads, 6 * 3 * work.get(Quantity::Triangles));
            let texels = pass.input_fact("lights", "count") * pass.output_fact("visibility", "tile").pow(2);
            work.set(Quantity::Fragments, (std::f64::consts::FRAC_PI_4 * texels as f64) as u64);
        },
    },
    // A light at a pixel: their offset, three products of it, the bound, the flux (36 operations); and a texel of its map,
    // where both face each other: of directions at random, a quarter.
    Known {
        kind: "gather",
        sparse: &["visibility"],
        count: |pass, work| {
            let pixels = pass.size("view").map_or(0, texels_of_layer);
            let subsets = (pass.setting("interleave_x") * pass.setting("interleave_y")).max(1);
            let pairs = pixels * pass.input_fact("lights", "count") / subsets;
            work.add(Quantity::Operations, 36 * pairs);
            work.add(Quantity::TexelLoads, pairs / 4);
        },
    },
    // Depth and normal of each pixel of the window, which has one more along an even side.
    Known {
        kind: "geometry-aware-blur",
        sparse: &[],
        count: |pass, work| {
            let window = |setting: &str, fact: &str| match pass.setting(setting) {
                0 => pass.input_fact("irradiance", fact).max(1),
                given => given,
            } / 2 * 2 + 1;
            let (width, height) = (window("width", "interleave_x"), window("height", "interleave_y"));
            let separable = pass.planned.settings.0.get("separable").and_then(Value::as_bool);
            let taps = if separable == Some(true) { width + height } else { width * height };
            work.set(Quantity::TexelLoads, 2 * taps * pass.size("view").map_or(0, texels_of_layer));
        },
    },
    // Of the map only its size. A segment waits ten times for its maximum and for each 256 elements.
    Known {
        kind: "sum-importance",
        sparse: &["rsm"],
        count: |pass, work| {
            let Some(map) = pass.size("sums") else { return };
            let (width, height, layers) =
                (u64::from(map.size.0), u64::from(map.size.1), u64::from(map.layers));
            let waits = |length: u64| 10 + 10 * length.div_ceil(256);
            let segments = layers * height * waits(width) + layers * waits(height) + waits(layers);
            work.add(Quantity::Barriers, 256 * segments);
        },
    },
    // Of the map only the texels of lights, and of the sums what a search looks at.
    Known { kind: "sample-inverse-transform", sparse: &["rsm", "sums"], count: |_, _| {} },
    // Of the map only the taps of pixels.
    Known { kind: "direct-light", sparse: &["rsm"], count: |_, _| {} },
];

/// A word that a pass leaves in a buffer where it has done no atomic: the number of others is the least number of atomics.
pub(super) struct Marked {
    /// The output port.
    pub(super) port: &'static str,
    /// The word.
    pub(super) empty: u32,
}

/// Pass types whose atomics are counted in what they leave.
const MARKED: [(&str, Marked); 1] = [("splat", Marked { port: "depth", empty: f32::INFINITY.to_bits() })];

/// Returns where the atomics of a pass are counted.
pub(super) fn marked(kind: &str) -> Option<&'static Marked> {
    MARKED.iter().find(|(known, _)| *known == kind).map(|(_, marked)| marked)
}

/// Returns the least that a pass must move and do. `triangles` are the scene's.
pub(super) fn work(plan: &Plan, planned: &PlannedPass, steps: &LinkedSteps, triangles: u64) -> Work {
    let known = KNOWN.iter().find(|known| *known.kind == *planned.kind);
    let mut work = Work::of(plan, planned, steps, triangles, known.map_or(&[], |known| known.sparse));
    if let Some(known) = known {
        (known.count)(&Pass { plan, planned, steps }, &mut work);
    }
    work
}

/// A pass as counts see it.
struct Pass<'a> {
    plan: &'a Plan,
    planned: &'a PlannedPass,
    steps: &'a LinkedSteps,
}

impl Pass<'_> {
    /// Returns the threads of all dispatches of an entry point.
    fn threads(&self, entry: &str) -> u64 {
        let of_entry = |step: &&Arc<LinkedStep>| step.shader.interface.entries[step.entries[0]].name == entry;
        self.steps.iter().filter(of_entry).map(|step| threads(step)).sum()
    }

    fn setting(&self, name: &str) -> u64 {
        number(self.planned.settings.0.get(name))
    }

    fn setting_f32(&self, name: &str) -> f32 {
        match self.planned.settings.0.get(name) {
            Some(Value::F32(value)) => *value,
            _ => 0.0,
        }
    }

    fn input_fact(&self, port: &str, name: &str) -> u64 {
        let input = self.planned.inputs.iter().find(|input| *input.port == *port);
        number(input.and_then(|input| input.facts.get(name)))
    }

    fn output_fact(&self, port: &str, name: &str) -> u64 {
        let output = self.planned.outputs.iter().find(|output| *output.port == *port);
        number(output.and_then(|output| output.facts.get(name)))
    }

    /// Returns the bytes of all resources of an input.
    fn input_bytes(&self, port: &str) -> u64 {
        let input = self.planned.inputs.iter().find(|input| *input.port == *port);
        let members = input.into_iter().flat_map(|input| &input.members);
        members.map(|(_, id)| self.plan.resources[id.0 as usize].desc.bytes()).sum()
    }

    /// Returns the first texture of an input, an output or scratch.
    fn size(&self, port: &str) -> Option<&TextureDesc<(u32, u32)>> {
        let inputs = self.planned.inputs.iter().map(|input| (&input.port, &input.members));
        let outputs = self.planned.outputs.iter().map(|output| (&output.port, &output.members));
        let (_, members) = inputs.chain(outputs).find(|(name, _)| ***name == *port)?;
        members.iter().find_map(|(_, id)| self.plan.resources[id.0 as usize].desc.texture())
    }
}

fn number(value: Option<&Value>) -> u64 {
    value.and_then(Value::as_u32).map_or(0, u64::from)
}
