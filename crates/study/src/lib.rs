//! Ablation studies: what to vary, the cells that follow, what each of them measured, and the report.
//!
//! ```text
//! RON ─parse─▶ Study ─edit─▶ Study ─Plan::new─▶ Plan ─run─▶ folder ─Results::read─▶ Results ─▶ tables, report
//! ```
//!
//! Nothing here knows a GPU: what there is to study comes through the trait [`Registry`], and what renders a cell
//! through [`Laboratory`].
//!
//! # The files
//!
//! A study is a RON file, read by the reader of `frame-graph`: its text has the same rules, and all errors are told at
//! once. `…?` is optional, `…*` any number of entries.
//!
//! ```text
//! Study(
//!     about: "text"?,  paper: "ISM Fig. 4"?,
//!     scenes: ["name or file" *],
//!     pipelines: ["name or file" or VARIANT *] or All or All(except: ["name" *]),
//!     output: "indirect"?,                  // the output that is judged; each pipeline has it
//!     size: (512, 512)?,                    // of frames [px]
//!     set: { "path": VALUE * }?,            // values for all pipelines
//!     vary: GROUP or [GROUP *]?,            // the cells are the product of the groups
//!     budget: Frames(5)?,                   // how much each cell may spend
//!     warm_up: 1?,                          // frames before those that are measured; a pipeline that says
//!                                           // how far it is has converged before them
//!     first_frame: 0?,                      // number of the first frame that runs, and so the time of animations
//!     jump: 30?,                            // number of the first frame under a new light, for `lag`
//!     seeds: 5 or [1, 2, 3]?,               // 5 is 1 to 5; left out it is [0], the papers' plain sequences
//!     measures: ["rel-mse", "gpu-ms" *],
//!     phases: { "name": ["pass or sub-graph" *] * }?,   // GPU time of passes together: the measure `gpu-ms:name`
//!     reference: REFERENCE?,                // left out it is None
//!     claims: [CLAIM *]?,                   // what the paper says of the measures
//! )
//! ```
//!
//! | form | is |
//! |---|---|
//! | VARIANT | `Variant(name: "as tables name it", pipeline: "name or file", set: { "path": VALUE * }?)` |
//! | path | as [`frame_graph::Overrides`] take it: `parameter`, `part.parameter`, `pass.setting` |
//! | VALUE | `true`, a number or text; `Optional(value)` where pipelines without the path go without it |
//! | GROUP | `Grid({ "path": VALUES * })`, every combination; or `Paired({ … })`, the first values, the second values, and so on |
//! | VALUES | `[value *]`; `Optional([value *])` where pipelines without the path run once, without it. The axis `"size"` takes `[(width, height) *]` and is the size of frames |
//! | budget | `Frames(8)`: equal frames. `Lights(1024)`: equal lights; with names `Lights(count: 1024, by: "lights"?, frames: 5?)`. `Time(ms: 20.0, by: "lights", frames: 5?)`: equal time a frame; the integer `by` is searched so that the median frame meets it within 5 %, once for all seeds. `Time(ms: 500.0, frames: …?)`: frames accumulate until the GPU time is spent |
//! | REFERENCE | `Pipeline(pipeline: "reference", set: { … }?, follow: ["path" *]?, frames: …?)`, `Picture("file.exr")`, `Pictures({ "scene": "file.exr" * })` or `None`; files are looked for from the working folder |
//! | CLAIM | `Order(measure: "tid", rising: [PICK, PICK *], at: AT?, scenes: ["name" *]?, says: "TCAS Fig. 7"?)`: each mean is less than the next; or `Ratio(measure: "gpu-ms:sample", of: PICK, to: PICK, at_most: 0.5?, at_least: 0.1?, …)`, with at least one bound |
//! | PICK | `"name"`, a pipeline as tables name it; or `At("name", AT)`, its cells there |
//! | AT | `{ "axis": value * }`: the cells with these values, and those whose pipelines do not have the axis |
//!
//! **References.** A pipeline with an output `progress` accumulates until it says that it is done, or for `frames`
//! frames; another renders one frame. It takes its own values alone, and those of the axes that it is to `follow`
//! (`"seed"` is one): a reference with the same lights isolates visibility. A reference is made once, kept, and made
//! again only if what it depends on has changed.
//!
//! **What is judged.** Of a scene that stands still, the last measured frame. Of a scene that moves, every measured
//! frame beside a reference of its own; RMSE is then over all of them, other errors are means. Measures are listed by
//! [`Measure::info`]. Where more than one frame of a scene that moves is measured, each cell keeps the value of every
//! frame as well (`frames.csv`, and a figure over the number of the frame): of errors of a picture, `energy`, `mean`,
//! `tid` and `lights-moved` (to the frame before; the first has none), `clamped-energy`, `gpu-ms` and phases.
//!
//! **Phases.** An entry is the name of a pass (`"lights"`), of a sub-graph with all in it (`"shadows"` is `shadows/points`,
//! `shadows/splat`, …), or of a pass in a part. The time of a phase in a frame is the sum of its passes that run there,
//! each once; a pipeline without any of them has no value. Phases may overlap.
//!
//! **Claims.** They are checked for each scene, or each of `scenes`, whenever the report is written, on means over all
//! finished cells of a pick, so its seeds and the values of its axes too. `Ratio` needs a denominator above 0. What has
//! no cells, as after `--quick` or `--set`, is not measured. A claim that does not hold is a result and no failure.
//!
//! **Keys.** The key of a cell is a hash of its plan, shaders, scene, values, size, seed, frames, budget, measures,
//! phases, reference, adapter and version; not of claims. So a study goes on where it stopped, and after an edit only
//! the cells that it touches run again; records of others stay in the folder and are not reported. Failed cells run
//! again.
//!
//! # Failures
//!
//! What is wrong with the file, a name or a value is reported before anything runs. A cell whose pipeline cannot be
//! made, whose device fails, or whose picture has pixels that are NaN or infinite is recorded as failed with what was
//! measured of it, and the others go on. Where a reference fails, its cells do; those of studies with other measures
//! than errors keep them. A full disk ends the run: what is finished stays, and the same call goes on from there.

mod budget;
mod claim;
mod clock;
pub mod description;
mod edit;
mod error;
mod evaluator;
mod folder;
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

pub use claim::Finding;
pub use description::{Study, parse};
pub use edit::Edits;
pub use error::StudyError;
pub use interval::Interval;
pub use laboratory::{
    CellRun, Identity, Laboratory, Observed, Occluded, PipelineFacts, Registry, RunRequest, SceneFacts,
    Values,
};
pub use measure::Measure;
pub use merge::merge;
pub use page::publish;
pub use plan::{Plan, PlannedCell};
pub use record::{
    Axis, AxisValue, Better, Cell, CellImages, ClaimRecord, Difference, FrameSeries, MeasureInfo, Memory,
    Outcome, PassTime, PickRecord, PipelineRecord, ReferenceRecord, RelationRecord, Results, SceneRecord,
    StudyRecord,
};
pub use report::report;
pub use run::{Event, Ran, RunOptions, Shard, name_of, run};
pub use table::{Row, write as write_tables};
