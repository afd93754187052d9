//! Tests of the executor on a GPU; without an adapter those that need one are skipped, which stderr says.

mod frames;
mod harness;
mod indirect;
mod load;
mod lost;
mod windows;
