//! How densely points lie on surfaces, by the distances to their nearest neighbours.

pub mod cpu_reference;

use gpu_algorithms::{Grid, LOOP_ITERATIONS, reduce};
use interfaces::{density, owners, surface_points};
use pass::{
    Compute, Define, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Struct, Threads, UseContext, Value, input, optional,
    output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &NearestNeighbours;

/// See the crate.
#[derive(Debug)]
pub struct NearestNeighbours;

const SUMMARIZE: &str = "passes/nearest-neighbours/summary.wgsl";
const SORT: &str = "passes/nearest-neighbours/cells.wgsl";
const SEARCH: &str = "passes/nearest-neighbours/search.wgsl";

const SUMMARY: Struct = Struct::new("passes/nearest-neighbours/neighbourhood.wgsl", "Summary");

/// Pairs of points above which they are sorted into cells. With fewer, a GPU takes longer for the steps of the sort.
const MOST_PAIRS: u64 = 2048 * 2048;

/// The most cells in a direction: a search of all of their rows, in steps that at least double, stays far below the loop
/// iterations that lavapipe allows.
const MOST_CELLS: u32 = 64;

pass::choice! {
    /// How neighbours are found.
    pub enum Structure {
        /// The faster of both for the numbers of points.
        Auto = "auto",
        /// All pairs are compared.
        Pairs = "pairs",
        /// Points are sorted into cells, of which the nearest are searched.
        Grid = "grid",
    }
}

pass::settings! {
    /// The settings of the pass type `nearest-neighbours`.
    pub struct NearestNeighboursSettings {
        /// Which neighbour's distance is measured, k. Higher: the estimate has less variance, but is blurred. 0: max(1, ⌊√I /
        /// 32⌋) of I points, with which it is consistent (SMC-IR Eq. 8), up to 32.
        k: u32 = 0, min: 0, max: 32;
        /// How neighbours are found; the result is the same. pairs: all pairs are compared. grid: points are sorted into
        /// cells. auto: the faster of both for the numbers of points.
        structure: Structure = Structure::Auto;
        /// Whether only neighbours whose normals are within 90° of the point's own count. Otherwise the two sides of a thin
        /// wall are neighbours, and lights on either side are as weak as if they were on one.
        sides: bool = false;
        /// Whether the nearest neighbour of each point is told too: its owner.
        owners: bool = false;
    }
}

/// The numbers of points, and what follows from them and the settings.
struct Search {
    points: u32,
    among: u32,
    settings: NearestNeighboursSettings,
}

impl Search {
    fn is_grid(&self) -> bool {
        match self.settings.structure {
            Structure::Auto => u64::from(self.points) * u64::from(self.among) > MOST_PAIRS,
            Structure::Pairs => false,
            Structure::Grid => true,
        }
    }

    /// Returns how many vectors of four distances a point has: a power of two.
    fn vectors(&self) -> u32 {
        let k = match self.settings.k {
            0 => cpu_reference::consistent_k(self.among),
            k => k,
        };
        k.div_ceil(4).next_power_of_two()
    }

    /// Returns how many dispatches search. Comparing all may insert all, with an iteration for each vector; cells hold few
    /// points, unless all are in one place.
    fn parts(&self) -> u32 {
        let most = if self.is_grid() { LOOP_ITERATIONS } else { LOOP_ITERATIONS / (1 + self.vectors()) };
        self.among.div_ceil(most).max(1)
    }

    /// Returns the most cells in a direction. Points lie on surfaces, so there are few of them in a cell.
    fn resolution(&self) -> u32 {
        (f64::from(self.among) / 4.0).sqrt().clamp(1.0, f64::from(MOST_CELLS)) as u32
    }

    fn grid(&self) -> Grid<'static> {
        Grid {
            length: self.among,
            cells: self.resolution().pow(3),
            starts: "starts",
            indices: "order",
            scratch: "sort",
        }
    }
}

impl Pass for NearestNeighbours {
    fn info(&self) -> Info {
        Info {
            kind: "nearest-neighbours",
            about: "Estimates how densely points lie on surfaces, by the distance to the k-th nearest neighbour.",
            paper: "SMC-IR §3.2.4, Eq. 7-8",
            shaders: &[SUMMARIZE, SORT, SEARCH],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(NearestNeighboursSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, settings: &Settings) -> Result<Ports, PassTypeError> {
        let mut outputs =
            vec![output("density", "Density", "Estimate at each point; 0 where that is empty.")];
        if NearestNeighboursSettings::read(settings).owners {
            outputs.push(output("owners", "Owners", "The neighbour that is nearest to each point."));
        }
        Ok(Ports {
            inputs: vec![
                input("points", "SurfacePoints", "The points that have a density."),
                optional(
                    "among",
                    "SurfacePoints",
                    "The points whose density it is, and which are neighbours. Without it, the points themselves.",
                ),
            ],
            outputs,
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let points = cx.fact("points", surface_points::COUNT)?;
        let among = match cx.input("among") {
            Some(_) => cx.fact("among", surface_points::COUNT)?,
            None => points,
        };
        let search = Search { points, among, settings: NearestNeighboursSettings::read(cx.settings) };
        // One dispatch alone leaves nothing to another.
        let points_between = if search.parts() > 1 { u64::from(points) } else { 1 };
        let distances = points_between * u64::from(search.vectors());
        let mut outputs = vec![density::output("density", points)];
        if search.settings.owners {
            outputs.push(owners::output("owners", points));
        }
        outputs.extend([
            OutputDesc::scratch("summary", use_cx.buffer(SUMMARY, 1)?),
            reduce::scratch(use_cx, "summaries", among, use_cx.size_of(SUMMARY)?)?,
            OutputDesc::scratch("distances", ResourceDesc::buffer(16 * distances)),
        ]);
        if search.is_grid() {
            let grid = search.grid();
            outputs.extend(grid.scratch(use_cx)?);
            outputs.extend([
                OutputDesc::scratch("starts", ResourceDesc::buffer(grid.starts_bytes())),
                OutputDesc::scratch("order", ResourceDesc::buffer(grid.indices_bytes())),
                OutputDesc::scratch("arranged", ResourceDesc::buffer(16 * u64::from(among.max(1)))),
            ]);
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let points = cx.fact("points", surface_points::COUNT)?;
        let own = !cx.connected("among");
        let among = if own { points } else { cx.fact("among", surface_points::COUNT)? };
        let search = Search { points, among, settings: NearestNeighboursSettings::read(cx.settings) };
        let use_cx = cx.use_context();

        let mut steps = reduce::steps(&use_cx, &cx.shader(SUMMARIZE, &[]), among, "summaries")?;
        if search.is_grid() {
            let sort = cx.shader(SORT, &[]);
            steps.extend(search.grid().steps(&use_cx, &sort)?);
            steps.push(Compute::new(sort, "arrange", Threads::Row(among)));
        }
        let defines = [
            ("GRID", Define::Bool(search.is_grid())),
            ("SELF", Define::Bool(own)),
            ("SIDES", Define::Bool(search.settings.sides)),
            ("OWNERS", Define::Bool(search.settings.owners)),
            ("VECTORS", Define::from(search.vectors())),
        ];
        let shader = cx.shader(SEARCH, &defines);
        steps.extend((0..search.parts()).map(|part| {
            Compute::new(shader.clone(), "search", Threads::Row(points))
                .value("part", Value::U32(part))
                .value("parts", Value::U32(search.parts()))
        }));
        let of_neighbours = |step: Compute| {
            let step = step
                .value("among_count", Value::U32(among))
                .value("resolution", Value::U32(search.resolution()));
            if own { step.bind("among", "points") } else { step }
        };
        Ok(Recording::of(steps.into_iter().map(of_neighbours)))
    }
}
