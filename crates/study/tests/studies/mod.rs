//! Descriptions, plans, runs, and what is left behind.

mod broken;
mod budgets;
mod failures;
mod fake;
mod plans;
mod runs;
mod tables;
