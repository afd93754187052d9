#![doc = include_str!("../README.md")]

pass::from_wgsl!();
