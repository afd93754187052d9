//! Shares against definitions and closed forms, and error against pictures whose error is known.

mod measured;
mod shapley;
