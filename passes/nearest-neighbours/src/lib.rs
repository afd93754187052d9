#![doc = include_str!("../README.md")]

use gpu_algorithms::{Grid, reduce};
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

/// Scratch of the reduction that makes the summary.
const SUMMARIES: &str = "summaries";

/// Pairs of points above which they are sorted into cells. With fewer, a GPU takes longer for the steps of the sort.
const MOST_PAIRS: u64 = 2048 * 2048;

/// The most cells in a direction: a search of all of their rows, in steps that at least double, takes few loop iterations.
const MOST_CELLS: u32 = 64;

/// The way in which neighbours are searched: it follows from the numbers of points and the settings.
struct Search {
    points: u32,
    among: u32,
    is_grid: bool,
    /// Vectors of four distances of a point: a power of two.
    vectors: u32,
}

impl Search {
    fn new(settings: &Settings, points: u32, among: u32) -> Result<Search, PassTypeError> {
        let is_grid = match settings.text("structure")? {
            "auto" => u64::from(points) * u64::from(among) > MOST_PAIRS,
            structure => structure == "grid",
        };
        let k = match settings.u32("k")? {
            0 => (among.isqrt() / 32).clamp(1, 32),
            k => k,
        };
        Ok(Search { points, among, is_grid, vectors: k.div_ceil(4).next_power_of_two() })
    }

    /// Returns how many dispatches search. Comparing all may insert all, with an iteration for each vector; cells hold few
    /// points, unless all are in one place.
    fn parts(&self) -> u32 {
        split_count(self.among, if self.is_grid { 1 } else { 1 + self.vectors })
    }

    /// Returns the most cells in a direction. Points lie on surfaces, so there are few of them in a cell.
    fn resolution(&self) -> u32 {
        (f64::from(self.among) / 4.0).sqrt().clamp(1.0, f64::from(MOST_CELLS)) as u32
    }

    fn grid(&self) -> Grid<'static> {
        let cells = self.resolution().pow(3);
        Grid { length: self.among, cells, starts: "starts", indices: "order", scratch: "sort" }
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
        if search.is_grid {
            let grid = search.grid();
            outputs.extend(grid.scratch(use_cx)?);
            outputs.extend([
                scratch("starts", grid.starts_bytes()),
                scratch("order", grid.indices_bytes()),
                scratch("arranged", 16 * u64::from(among.max(1))),
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
        if search.is_grid {
            let sort = cx.file("cells.wgsl");
            steps.extend(search.grid().steps(&use_cx, &sort)?);
            steps.push(Compute::new(sort, "arrange", Threads::Row(among)));
        }
        let shader = cx.file("nearest-neighbours.wgsl");
        let shader =
            shader.define("GRID", search.is_grid).define("SELF", own).define("VECTORS", search.vectors);
        steps.extend((0..search.parts()).map(|part| {
            Compute::new(shader.clone(), "search", Threads::Row(search.points))
                .value("part", part)
                .value("parts", search.parts())
        }));
        let of_neighbours = |step: Compute| {
            let step = step.value("among_count", among).value("resolution", search.resolution());
            if own { step.bind("among", "points") } else { step }
        };
        Ok(Recording::of(steps.into_iter().map(of_neighbours)))
    }
}
