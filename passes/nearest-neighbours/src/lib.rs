#![doc = include_str!("../README.md")]

use gpu_algorithms::{RadixSort, reduce};
use interfaces::surface_points;
use pass::{
    Compute, OutputContext, OutputDesc, Pass, PassTypeError, ReadSettings, RecordContext, Recording,
    ResourceDesc, Settings, Struct, Threads, UseContext, reflected, split_count,
};

/// The pass type `nearest-neighbours`.
pub const PASS: &dyn Pass = &NearestNeighbours;

struct NearestNeighbours;

/// The points among which neighbours are searched, all together.
const SUMMARY: Struct = Struct::new("shaders/algorithms/summary.wgsl", "Summary");

const NEIGHBOURHOOD: &str = "passes/nearest-neighbours/neighbourhood.wgsl";

/// A node of the tree over them.
const NODE: Struct = Struct::new(NEIGHBOURHOOD, "Neighbourhood");

/// Scratch of the reduction that makes the summary.
const SUMMARIES: &str = "summaries";

/// Pairs of points above which a tree is built. With fewer, a GPU takes longer for the steps of its sort.
const MOST_PAIRS: u64 = 2048 * 2048;

/// The way in which neighbours are searched: it follows from the numbers of points and the settings.
struct Search {
    points: u32,
    among: u32,
    is_tree: bool,
    /// Vectors of four distances of a point: a power of two.
    vectors: u32,
}

impl Search {
    fn new(settings: &Settings, points: u32, among: u32) -> Result<Search, PassTypeError> {
        let is_tree = match settings.text("structure")? {
            "auto" => u64::from(points) * u64::from(among) > MOST_PAIRS,
            structure => structure == "tree",
        };
        let k = match settings.u32("k")? {
            0 => (among.isqrt() / 32).clamp(1, 32),
            k => k,
        };
        Ok(Search { points, among, is_tree, vectors: k.div_ceil(4).next_power_of_two() })
    }

    /// Returns how many dispatches search. Comparing all may insert all, with an iteration for each vector.
    fn parts(&self) -> u32 {
        if self.is_tree { 1 } else { split_count(self.among, 1 + self.vectors) }
    }

    /// Returns the number of leaves that hold all neighbours.
    fn leaves(&self, cx: &UseContext<'_>) -> Result<u32, PassTypeError> {
        Ok(self.among.div_ceil(cx.constant(NEIGHBOURHOOD, "LEAF")?).next_power_of_two())
    }

    /// Returns the sort of the neighbours along the curve, and that of the points, where they are others; each with its port.
    fn sorts(
        &self,
        cx: &UseContext<'_>,
        own: bool,
    ) -> Result<Vec<(&'static str, RadixSort<'static>)>, PassTypeError> {
        let along = |port, length, left_out, keys, order, scratch| RadixSort {
            length,
            count: Some(port),
            bits: 32 - left_out,
            keys,
            values: None,
            sorted_keys: keys,
            sorted_values: order,
            scratch,
        };
        let neighbours = |port| (port, along(port, self.among, 0, "keys", "order", "sort"));
        if own {
            return Ok(vec![neighbours("points")]);
        }
        let left_out = cx.constant(NEIGHBOURHOOD, "LEFT_OUT")?;
        let points = along("points", self.points, left_out, "keys_of_points", "turns", "sort_of_points");
        Ok(vec![neighbours("among"), ("points", points)])
    }
}

impl Pass for NearestNeighbours {
    fn kind(&self) -> &'static str {
        "nearest-neighbours"
    }

    fn files(&self) -> pass::Files {
        pass::files!()
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let points = cx.fact("points", surface_points::COUNT)?;
        let among = cx.input("among").map_or(Ok(points), |_| cx.fact("among", surface_points::COUNT))?;
        let search = Search::new(cx.settings, points, among)?;
        let scratch = |name, bytes| OutputDesc::scratch(name, ResourceDesc::buffer(bytes));
        // One dispatch alone leaves nothing to another.
        let points_between = if search.parts() > 1 { u64::from(points) } else { 1 };
        let mut outputs = reflected::outputs(use_cx, &self.main_shader(&cx.use_)?, cx)?;
        outputs.extend([
            reduce::scratch(use_cx, SUMMARIES, among, use_cx.size_of(SUMMARY)?)?,
            scratch("distances", 16 * points_between * u64::from(search.vectors)),
        ]);
        if search.is_tree {
            for (_, sort) in search.sorts(use_cx, cx.input("among").is_none())? {
                let words = 4 * u64::from(sort.length.max(1));
                outputs.extend(sort.scratch(use_cx)?);
                outputs.extend([scratch(sort.keys, words), scratch(sort.sorted_values, words)]);
            }
            outputs.extend([
                scratch("arranged", 16 * u64::from(among.max(1))),
                scratch("nodes", 2 * u64::from(search.leaves(use_cx)?) * use_cx.size_of(NODE)?),
            ]);
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let points = cx.fact("points", surface_points::COUNT)?;
        let own = !cx.connected("among");
        let among = if own { points } else { cx.fact("among", surface_points::COUNT)? };
        let search = Search::new(cx.settings, points, among)?;
        let use_cx = cx.use_context();

        let mut steps = reduce::steps(&use_cx, &cx.file("summary.wgsl"), among, SUMMARIES)?;
        let leaves = search.leaves(&use_cx)?;
        if search.is_tree {
            let tree = cx.file("tree.wgsl");
            // A step for points, whose keys may lack low bits, or for the leaves, or for the nodes of a level.
            let step = |entry, count: u32, left_out: u32| {
                Compute::new(tree.clone(), entry, Threads::Row(count.max(1)))
                    .value("count", count)
                    .value("left_out", left_out)
            };
            for (port, sort) in search.sorts(&use_cx, own)? {
                let place = step("place", sort.length, 32 - sort.bits);
                steps.push(place.bind("keys", sort.keys).bind("among", port));
                steps.extend(sort.steps(&use_cx)?);
            }
            steps.push(step("make_leaves", leaves, 0));
            let levels = std::iter::successors(Some(leaves / 2), |level| Some(level / 2));
            let levels = levels.take_while(|level| *level > 0);
            steps.extend(levels.map(|level| step("make_level", level, 0)));
        }
        let shader = cx.file("nearest-neighbours.wgsl");
        let shader =
            shader.define("TREE", search.is_tree).define("SELF", own).define("VECTORS", search.vectors);
        steps.extend((0..search.parts()).map(|part| {
            let step = Compute::new(shader.clone(), "search", Threads::Row(search.points))
                .value("part", part)
                .value("parts", search.parts());
            if search.is_tree && own { step.bind("turns", "order") } else { step }
        }));
        let of_neighbours = |step: Compute| {
            let step = step.value("among_count", among).value("leaves", leaves);
            if own { step.bind("among", "points") } else { step }
        };
        Ok(Recording::of(steps.into_iter().map(of_neighbours)))
    }
}
