//! Extremes times pipelines: what becomes of each pipeline where a scene, a frame or a setting is extreme.
//!
//! A [`Case`] is one extreme: a scene file, a size of frames, values of settings, and what is expected of the picture. A
//! [`Subject`] is a pipeline with what can be set in it. [`run`] renders each case by each pipeline, in a process of its
//! own, so that one that hangs or ends takes no other with it; [`judge`] says what became of it. Where the energy is off
//! from the truth, the mean over further [`Seeds`] is judged. The scene files stay in
//! the folder, and each [`Cell`] has the command that renders it again.
//!
//! This crate does not use the GPU: a [`Program`] renders.

mod case;
mod cell;
mod child;
mod long;
mod report;
mod room;
mod run;
mod seeds;
mod settings;
mod shown;
mod table;
mod triangles;

pub use case::{Case, Expect};
pub use cell::{Cell, Known, Picture, Verdict, judge};
pub use child::{Child, Ended, Guard, Program, Ran};
pub use long::{Line, Long, Outputs, SHORTEST, Seen, Steady, long};
pub use report::{html, json};
pub use run::{Event, Options, REFERENCE, StressError, Subject, run};
pub use seeds::Seeds;
pub use settings::{of_pairs, of_settings};
pub use shown::Shown;
pub use table::cases;
