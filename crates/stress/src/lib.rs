//! Stress tests: every pipeline at extremes of scenes, frames and settings.
//!
//! A [`Case`] is one extreme: a scene file, a size of frames, values of settings, and the expected picture. A [`Subject`] is a
//! pipeline with its settings. [`run`] renders each case by each pipeline, in a process of its own, so that a crash or a hang
//! affects no other; [`evaluate`] compares the picture with the expectation. If the energy differs from the path tracer's, the
//! mean over further [`Seeds`] decides. The scene files stay in the folder, and each [`Cell`] has the command that renders it
//! again.
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
pub use cell::{Cell, Known, Picture, Verdict, evaluate};
pub use child::{Child, Ended, Guard, Program, Ran};
pub use long::{Line, Long, Outputs, SHORTEST, Seen, Steady, long};
pub use report::{html, json};
pub use run::{Event, Options, REFERENCE, StressError, Subject, run};
pub use seeds::Seeds;
pub use settings::{of_pairs, of_settings};
pub use shown::Shown;
pub use table::cases;
