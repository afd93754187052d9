//! The CPU reference against brute force in `f64`, and the GPU against the CPU reference.

#[path = "main/closed.rs"]
mod closed;
#[path = "main/gpu.rs"]
mod gpu;
#[path = "main/hits.rs"]
mod hits;
#[path = "main/moving.rs"]
mod moving;
#[path = "main/shared.rs"]
mod shared;
