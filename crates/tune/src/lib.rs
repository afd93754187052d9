//! Searches settings for the least error in a time, or the least time for an error: `lightloom tune`.
//!
//! The points of a grid are tried one by one, each a step away from the best point that is known (best-first search); where no step
//! is better, two axes are changed at once. All have the same random numbers. The best of them are tried again with more seeds, half
//! of them each time (successive halving: Jamieson & Talwalkar 2016), and the last ones are judged by seeds that no choice was made by.

mod front;
mod search;

pub use front::front;
pub use search::{Axis, Candidate, Evaluate, Measured, Options, Outcome, Point, Target, full, search};
