//! The report, from made-up results to what a reader sees in a browser.

mod browser;
mod files;
mod frames;
mod odd;
mod page;
mod sample;
