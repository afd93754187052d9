// Tests of the whole program: the command line as a user types it, reload under a running loop, and pictures.
// tools/lightloom/tests/whole-program.rs includes this file.
//
// Without a graphics adapter, tests that need one print that and do nothing.

mod accumulated;
mod adapter;
mod application;
mod batch;
mod bench;
mod blame;
mod bounces;
mod cli;
mod clusters;
mod direct;
mod errors;
#[cfg(unix)]
mod external;
mod faults;
mod filling;
mod flux;
mod frames;
mod glossy;
#[cfg(unix)]
mod guides;
mod incremental;
mod judge;
mod lamps;
mod linking;
mod lsp;
mod many_lights;
mod mixed;
mod normal_maps;
#[cfg(unix)]
mod offline;
mod pairs;
mod partition;
mod pictures;
mod points;
mod precision;
mod program;
mod rays;
mod reference;
mod reflective;
mod reload;
mod rendered;
mod reports;
mod reproduce;
mod reprojected;
mod rerun;
mod reservoirs;
mod sequential;
mod skies;
mod sources;
mod still;
mod stress;
mod study;
mod supersampling;
mod surface_lights;
mod trace;
mod truth;
mod tune;
mod warnings;
mod window;
