//! Stress tests: every pipeline at extremes of scenes, frames and settings.
//!
//! A [`Case`] is one extreme: a scene file, a size of frames, values of settings, and the expected picture. A [`Subject`] is a
//! pipeline with its settings. [`run`] makes each case by each pipeline a cell of a study, which a
//! laboratory renders in a process of its own, so that a crash or a hang affects no other. If the energy differs from the path tracer's,
//! the mean over further seeds decides. The scene files stay in the folder, and each [`Cell`] has the command that renders
//! it again.
//!
//! This crate does not use the GPU: a [`Program`] renders.

mod case;
mod cell;
mod child;
mod isolated;
mod long;
mod report;
mod room;
mod run;
mod seeds;
mod settings;
mod table;
mod triangles;

pub use case::{Case, Expect};
pub use cell::{Cell, Verdict};
pub use child::{Child, Ended, Program, Ran};
pub use isolated::Details;
pub use long::{Line, Long, Outputs, SHORTEST, Seen, Steady, long};
pub use report::{add, tables};
pub use run::{Options, REFERENCE, Subject, run};
pub use settings::{of_pairs, of_settings};
pub use table::cases;
