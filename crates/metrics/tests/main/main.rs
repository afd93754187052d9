//! Measures against other implementations and by their properties, and files.

mod extremes;
mod files;
mod flip;
mod patterns;
mod seeds;
mod ssim;
mod temporal;
mod tev;
