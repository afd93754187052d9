//! Descriptions, plans, runs, and what is left behind.

mod adapters;
mod broken;
mod budgets;
mod cases;
mod claims;
mod failures;
mod fake;
mod growth;
mod phases;
mod plans;
mod runs;
mod series;
mod tables;
