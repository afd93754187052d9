//! Shares the error of a picture out between what its pipeline approximates: `lightloom blame`.
//!
//! Passes declare what they approximate, and what is exact in its place (`#exact` in their WGSL). Each approximation is a
//! [`Player`] of a cooperative game: a subset of them is exact, and the value of the subset is the error that is left. The share
//! of an approximation is its Shapley value, the mean over all orders in which approximations can be made exact of what the error
//! falls by when its turn comes; shares add up to the error of the pipeline less that of the picture in which all are exact.
//!
//! Error is relative squared error, as bias² and variance over seeds; energy and time are shared out in the same way.

mod estimate;
mod game;
mod map;
mod page;
mod player;
mod shares;

pub use estimate::{Pictures, References, Weights};
pub use game::{Game, Subset};
pub use map::Map;
pub use page::{Heading, page, rows};
pub use player::{Declared, FRAMES, Player, players};
pub use shares::{Cell, Change, Estimate, Owing, Row, Shares, Stage, blamed, table};
