//! Ablation studies: the axes that vary, the cells that result, the measurements of each cell, and the
//! report.
//!
//! ```text
//! RON ─parse─▶ Study ─edit─▶ Study ─Plan::new─▶ Plan ─run─▶ folder ─Results::read─▶ Results ─▶ tables, report
//! ```
//!
//! Nothing here depends on the GPU: the scenes and pipelines come through the trait [`Registry`], and cells
//! are rendered through [`Laboratory`].
//!
//! # The files
//!
//! A study is a RON file, read by the reader of `frame-graph`: the same rules hold for its text, and all
//! errors are reported at once. `…?` is optional, `…*` is any number of entries.
//!
//! ```text
//! Study(
//!     about: "text"?,  paper: "ISM Fig. 4"?,
//!     scenes: ["name or file" *],
//!     pipelines: ["name or file" or VARIANT *] or All or All(except: ["name" *]),
//!     output: "indirect"?,                  // the output that is measured, or a pass or `pass.port`; each pipeline has it
//!     size: (512, 512)?,                    // of frames [px]
//!     set: { "path": VALUE * }?,            // values for all pipelines
//!     vary: GROUP or [GROUP *]?,            // the cells are the product of the groups
//!     budget: Frames(5)?,                   // the budget of each cell
//!     warm_up: 1?,                          // frames before those that are measured; a pipeline with an
//!                                           // output `progress` has converged before them
//!     first_frame: 0?,                      // number of the first frame that runs, and so the time of animations
//!     jump: 30?,                            // number of the first frame under a new light, for `lag`
//!     seeds: 5 or [1, 2, 3]?,               // 5 stands for 1 to 5; the default is [0], the plain sequences
//!     measures: ["rel-mse", "gpu-ms" *],
//!     phases: { "name": ["pass or sub-graph" *] * }?,   // sum of the GPU times of passes: the measure `gpu-ms:name`
//!     figures: { "name": "pass.port.figure" * }?,   // numbers that passes report: the measure `figure:name`
//!     reference: REFERENCE?,                // the default is None
//!     claims: [CLAIM *]?,                   // the claims of the paper about the measures
//!     crops: [(0.4, 0.1, 0.2, 0.2) *]?,     // parts of pictures that the report enlarges: left, top, width and height in
//!                                           // shares of the sides; also as figures/*.png
//! )
//! ```
//!
//! | form | meaning |
//! |---|---|
//! | VARIANT | `Variant(name: "as tables name it", pipeline: "name or file", set: { "path": VALUE * }?)` |
//! | path | as in [`frame_graph::Overrides`]: `parameter`, `sub-graph.parameter`, `pass.setting` |
//! | VALUE | `true`, a number or text; `Optional(value)` leaves the value out for pipelines that have no such path |
//! | GROUP | `Grid({ "path": VALUES * })`, every combination; or `Paired({ … })`, the first values, the second values, and so on |
//! | VALUES | `[value *]`; with `Optional([value *])`, pipelines that have no such path run once, without it. The axis `"size"` takes `[(width, height) *]` and is the size of frames |
//! | budget | `Frames(8)`: equal number of frames. `Lights(1024)`: equal number of lights; with names `Lights(count: 1024, by: "lights"?, frames: 5?)`. `Time(ms: 20.0, by: "lights", frames: 5?)`: equal time per frame; the integer `by` is searched so that the median frame meets it within 5 %, once for all seeds. `Time(ms: 500.0, frames: …?)`: frames accumulate until the GPU time is spent |
//! | REFERENCE | `Pipeline(pipeline: "reference", set: { … }?, follow: ["path" *]?, frames: …?)`, `Picture("file.exr")`, `Pictures({ "scene": "file.exr" * })` or `None`; paths of files are relative to the working folder |
//! | CLAIM | `Order(measure: "tid", rising: [PICK, PICK *], at: AT?, scenes: ["name" *]?, says: "TCAS Fig. 7"?)`: each mean is less than the next; or `Ratio(measure: "gpu-ms:sample", of: PICK, to: PICK, at_most: 0.5?, at_least: 0.1?, …)`, with at least one bound; or `Growth(measure: "gpu-ms:gather", of: PICK, over: "axis", at_most: 1.0?, at_least: 0.5?, …)`: the exponent with which the measure grows over an axis of numbers. `over: "size"` is over pixels, `over: "triangles"` over those of the scenes |
//! | PICK | `"name"`, all cells of a pipeline by its name in tables; or `At("name", AT)`, those with these values |
//! | AT | `{ "axis": value * }`: the cells with these values, and those whose pipelines do not have the axis |
//!
//! **References.** A pipeline with an output `progress` accumulates until it has converged, or for `frames`
//! frames; another pipeline renders one frame. The reference takes only its own values and those of the axes
//! that it is to `follow` (`"seed"` is one of them): a reference with the same lights isolates the error of
//! visibility. A reference is rendered once, stored, and rendered again only if what it depends on has
//! changed.
//!
//! **Measured frames.** For a scene that stands still, it is the last measured frame that is compared with
//! the reference. For a scene that moves, every measured frame is compared with its own reference; RMSE is
//! then taken over all of them, and other errors are means. [`Measure::info`] describes each measure. If more
//! than one frame of a scene that moves is measured, each cell also stores the value of every frame (in
//! `frames.csv`, and as a chart over the frame number) for errors of a picture, `energy`, `mean`, `e` and
//! `tone-error`, `tid`, `e-prime`, `tone-change` and `lights-moved` (each compared with the frame before; the
//! first frame has no value), `clamped-energy`, `gpu-ms` and phases.
//!
//! **Phases.** An entry is the name of a pass (`"lights"`), of a sub-graph with all its passes (`"shadows"`
//! stands for `shadows/points`, `shadows/splat`, …), or of a pass in a sub-graph. The time of a phase in a
//! frame is the sum over its passes that run in it, each counted once; a pipeline without any of them has no
//! value. Phases may overlap.
//!
//! **Figures.** A figure is a number that a pass reports about a frame, such as `lights/average.averaged.alive`:
//! `render` prints them. Its value is the mean over the measured frames; a pipeline without the pass has none.
//!
//! **Claims.** They are checked for each scene, or for each of `scenes`, whenever the report is written. Each
//! mean is over all finished cells of a pick, and so over its seeds and over the values of all other axes. A
//! claim is decided by the differences of these means, seed by seed: it holds, or does not, where their 95 %
//! interval lies on one side, and is not decided where that has both; a single seed is taken at its word.
//! `Ratio` needs a denominator above 0. `Growth` is of the exponent p of a power law, measure ∝ axisᵖ: the slope
//! of a straight line (least squares) through the logarithms of axis and measure, for each seed. The line goes
//! through the upper half of the axis (by its logarithm, and through three values at least), since fixed costs
//! flatten growth at the lower end; the exponent over all values is reported beside it. Where the two are
//! alike, nothing flattens; where the upper one is the greater, growth beyond the axis may be greater still: of
//! a fixed cost that is a tenth of the time there, the exponent is a tenth below that of the rest. Over
//! triangles a claim is about all its scenes at once. Cells run seed by seed, so that a machine that is slow for
//! minutes is slow for one seed and not for one end of an axis. A claim without cells, as after `--quick` or `--set`, is not
//! measured. A claim that does not hold is a result, not a failure.
//!
//! **Keys.** The key of a cell is a hash of its plan, shaders, scene, values, size, seed, frames, budget,
//! measures, phases, reference, adapter and version, but not of claims and crops. So a study continues where it
//! stopped, and after a change of the file only the affected cells run again; the records of the others stay
//! in the folder and are not reported. Failed cells run again.
//!
//! # Failures
//!
//! Errors of the file, a name or a value are reported before anything runs. A cell whose pipeline is
//! broken, whose device fails, or whose picture has pixels that are NaN or infinite is recorded as failed,
//! together with its measurements so far, and the other cells still run. If a reference fails, its cells
//! fail; but cells that also have measures other than errors keep those. A full disk ends the run: what is
//! finished stays, and the same call continues from there.

mod budget;
mod claim;
pub mod codes;
pub mod description;
mod edit;
mod error;
mod evaluator;
mod figure;
mod folder;
mod growth;
mod interval;
mod key;
mod laboratory;
mod measure;
mod merge;
mod page;
mod phase;
mod plan;
mod record;
mod reference;
mod remaining;
mod report;
mod run;
mod seeds;
mod table;

pub use claim::{Finding, Verdict};
pub use description::{Claim, Pick, Relation, Study, parse};
pub use edit::Edits;
pub use error::{Failure, StudyError};
pub use interval::Interval;
pub use laboratory::{
    CellRun, Laboratory, Observed, Occluded, PipelineFacts, Registry, RunRequest, SceneFacts, Step, Values,
};
pub use measure::Measure;
pub use merge::merge;
pub use page::publish;
pub use plan::{Plan, PlannedCell};
pub use record::{
    Axis, AxisValue, Better, Cell, CellImages, Difference, FrameSeries, MeasureInfo, Memory, Outcome,
    PassTime, PipelineRecord, ReferenceRecord, Results, SceneRecord, StudyRecord,
};
pub use report::report;
pub use run::{Event, Ran, RunOptions, Shard, ShardError, name_of, run};
pub use table::{Row, write as write_tables};
