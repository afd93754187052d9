//! Tests of studies over a laboratory that needs no GPU.

mod report;
mod studies;
