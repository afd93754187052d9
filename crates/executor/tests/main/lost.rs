//! A device that is gone: every call says so, and none waits for it.

use crate::harness::{TestPass, Workshop, every_frame, shader, words};
use executor::{ExecutorError, FrameOptions, Gpu};
use frame_graph::Change;
use pass::{Compute, OutputDesc, Step, Threads};

const COUNT: &str = "var<storage, read_write> sum: array<u32>;
     @compute @workgroup_size(1) fn main() { sum[0] = 7u; }";

#[test]
fn a_device_that_is_gone_is_an_error_of_every_call() {
    // Of its own: the other tests need theirs.
    let Ok(gpu) = Gpu::open() else { return };
    let grid = Threads::Grid([1; 3]);
    let count = every_frame(TestPass::new("count").output(OutputDesc::one("sum", words(4))))
        .steps(move |_| vec![Step::Compute(Compute::new(shader("count.wgsl"), "main", grid.clone()))]);
    let workshop = Workshop::new(vec![count], &[("count.wgsl", COUNT)]);
    let (passes, outputs) = (r#""count": Pass(kind: "count")"#, r#""sum": "count""#);
    let mut running = workshop.start_on(gpu.clone(), passes, outputs);
    running.frame();
    assert_eq!(running.read("count.sum")[0], 7);

    gpu.device.destroy();
    // It is known once it was waited for.
    let _ = running.0.frame(&Change::default(), FrameOptions::default());
    let sum = running.id("count.sum");
    let timed = FrameOptions { timed: true, ..FrameOptions::default() };
    let monitored = FrameOptions { monitored: true, ..FrameOptions::default() };
    for _ in 0..2 {
        let read = running.0.read(sum).map(|_| ());
        let frames = [FrameOptions::default(), timed, monitored]
            .map(|options| running.0.frame(&Change::default(), options).map(|_| ()));
        let loaded = running.load(workshop.link(passes, outputs).unwrap()).map(|_| ());
        for done in [read, loaded, gpu.wait()].into_iter().chain(frames) {
            let error = done.unwrap_err();
            assert!(matches!(error, ExecutorError::Lost { .. }), "{error}");
            assert!(error.to_string().contains("the graphics device is gone"), "{error}");
        }
        assert!(gpu.take_fault().is_some_and(|fault| fault.contains("gone")), "it is reported again");
    }
}
