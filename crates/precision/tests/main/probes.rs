//! The probes of the shaders.

use crate::library;
use precision::{Interpreted, Kernel, Options, Probe, measure, paths};

#[test]
fn every_probe_meets_its_bound() {
    let library = library();
    let options = Options { magnitudes: 13, samples: 100, seed: 1 };
    // One at a time, while a shader is worked on.
    let only = std::env::var("PROBE").unwrap_or_default();
    let mut exceeding = Vec::new();
    let paths = paths(&library);
    assert!(paths.len() > 20, "{paths:?}");
    for path in paths.iter().filter(|path| path.contains(&only)) {
        let probe = Probe::load(&library, path).unwrap_or_else(|error| panic!("{error}"));
        let start = std::time::Instant::now();
        let measured =
            measure(&probe, &Interpreted, &options).unwrap_or_else(|fault| panic!("{path}: {fault}"));
        let worst = measured.worst().unwrap();
        println!(
            "{:<24} worst at {:<8.1e} error {:<8.1e} unavoidable {:<8.1e} ratio {:<8.2} greatest {:<8.1e} lost {}, {:.2} s",
            probe.name,
            worst.magnitude,
            worst.errors.most,
            worst.unavoidable.most,
            worst.ratio(),
            measured.points.iter().map(|point| point.errors.most).fold(0.0, f64::max),
            measured.points.iter().map(|point| point.lost).fold(0.0, f64::max),
            start.elapsed().as_secs_f64(),
        );
        if !only.is_empty() {
            for point in &measured.points {
                println!(
                    "    {:<8.1e} {:<8.1e} unavoidable {:<8.1e}",
                    point.magnitude, point.errors.most, point.unavoidable.most
                );
            }
        }
        if !measured.holds() {
            exceeding.push(probe.name.clone());
        }
    }
    assert!(exceeding.is_empty(), "these exceed their bound: {exceeding:?}");
}

#[test]
fn every_probe_is_a_compute_shader() {
    let library = library();
    for path in paths(&library) {
        let probe = Probe::load(&library, &path).unwrap_or_else(|error| panic!("{error}"));
        let kernel = Kernel::new(&probe).unwrap_or_else(|fault| panic!("{path}: {fault}"));
        let given = probe.given(probe.range.0, [0.2, 0.4, 0.6, 0.8]).unwrap();
        let bytes = kernel.bytes(&[given.clone(), given]).unwrap();
        let (first, second) = bytes.split_at(bytes.len() / 2);
        assert_eq!(first, second);
        assert!(first.iter().any(|byte| *byte != 0), "{path}");
        // What no thread of it uses, it does not ask for.
        let bound =
            kernel.module.global_variables.iter().filter(|(_, global)| global.binding.is_some()).count();
        assert_eq!(bound, 2, "{path}");
    }
}
