#![doc = include_str!("../README.md")]

mod budget;
mod cases;
mod claim;
pub mod codes;
mod cost;
pub mod description;
mod edit;
mod error;
mod evaluator;
mod external;
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
mod report;
mod run;
mod seeds;
mod shard;
mod spread;
mod table;

pub use cases::{MeasureCase, keep, measure_cases};
pub use claim::{Finding, Verdict};
pub use cost::{Costs, SHARD_MINUTES, UNKNOWN_SECONDS};
pub use description::{Claim, Pick, Relation, Study, parse, parse_with};
pub use edit::Edits;
pub use error::{Failure, StudyError};
pub use external::{Ended, External, ExternalRun, PLACEHOLDERS, kill_running, run_program};
pub use folder::source;
pub use interval::Interval;
pub use laboratory::{
    CellRun, Laboratory, Observed, Occluded, PipelineFacts, Registry, RunRequest, SceneFacts, Step, Values,
};
pub use measure::Measure;
pub use merge::{Merged, merge};
pub use page::publish;
pub use plan::{Plan, PlannedCell, Run};
pub use record::{
    Axis, AxisValue, Better, Cell, CellImages, Difference, End, FrameSeries, MeasureInfo, Memory, Node,
    Outcome, PassTime, PipelineRecord, ReferenceRecord, Results, SceneRecord, StudyRecord, Words,
};
pub use report::{claims, gallery, report, report_with, tables};
pub use run::{Event, Ran, RunOptions, name_of, run};
pub use shard::{Shard, ShardError};
pub use spread::costs;
pub use table::write as write_tables;
