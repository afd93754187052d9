//! Steps that bind a part of a buffer.

use crate::harness::{TestPass, Workshop, gpu, shader, words};
use executor::{ExecutorError, FrameOptions};
use pass::{Compute, OutputDesc, Step, Threads, Value};
use std::ops::Range;

/// Writes a number into the first word of what it sees, and how many words that are into the second.
const SIGN: &str = "
    struct Settings { number: u32 }
    var<uniform> settings: Settings;
    var<storage, read_write> out: array<u32>;
    @compute @workgroup_size(1) fn sign() {
        out[0] = settings.number;
        out[1] = arrayLength(&out);
    }";

fn sign(number: u32, bytes: Option<Range<u64>>) -> Step {
    let step = Compute::new(shader("sign.wgsl"), "sign", Threads::Grid([1; 3]));
    let step = step.value("number", Value::U32(number));
    Step::Compute(match bytes {
        Some(bytes) => step.window("out", bytes),
        None => step,
    })
}

/// A pass that signs each of these parts of a buffer of this many words, with 1, 2, ….
fn workshop(count: u64, parts: Vec<Option<Range<u64>>>) -> Workshop {
    let kind = TestPass::new("kind").output(OutputDesc::one("out", words(count)));
    let kind = kind.steps(move |_| (1..).zip(&parts).map(|(n, part)| sign(n, part.clone())).collect());
    Workshop::new(vec![kind], &[("sign.wgsl", SIGN)])
}

const PASS: &str = r#""use": Pass(kind: "kind")"#;
const OUTPUT: &str = r#""out": "use.out""#;

#[test]
fn a_step_sees_its_window_alone() {
    // All words, 64 to 127, and 128 to 131.
    let workshop = workshop(132, vec![None, Some(256..512), Some(512..528)]);
    let Some(mut running) = workshop.start(PASS, OUTPUT) else { return };
    running.frame_of_all(FrameOptions { poison: Some(FrameOptions::NAN), ..FrameOptions::default() });
    let found = running.read("use.out");
    let signed = [(0, 1), (1, 132), (64, 2), (65, 64), (128, 3), (129, 4)];
    for (i, word) in found.into_iter().enumerate() {
        let wanted = signed.iter().find(|(at, _)| *at == i).map_or(u32::MAX, |(_, wanted)| *wanted);
        assert_eq!(word, wanted, "word {i}");
    }
}

#[test]
fn windows_reach_what_no_step_can_bind_whole() {
    let Some(gpu) = gpu() else { return };
    let most = gpu.limits().max_storage_buffer_binding_size;
    if gpu.limits().max_buffer_size < most + 256 || most > 1 << 30 {
        eprintln!("skipped: the adapter binds every buffer that it can hold, or a gigabyte");
        return;
    }
    let first = most.next_multiple_of(256);
    let count = first / 4 + 4;
    let windows = vec![Some(0..256), Some(first..first + 16)];
    let Some(mut running) = workshop(count, windows).start(PASS, OUTPUT) else { return };
    running.frame();
    let found = running.read("use.out");
    let last = first as usize / 4;
    assert_eq!((&found[..2], &found[last..last + 2]), (&[1, 64][..], &[2, 4][..]));

    let linked = workshop(count, vec![None]).link(PASS, OUTPUT).expect("links without an adapter");
    let refused = running.load(linked).expect_err("more than a step can bind");
    assert!(
        matches!(refused, ExecutorError::Limit { limit: "max_storage_buffer_binding_size", .. }),
        "{refused}"
    );
}

#[test]
fn a_window_that_is_not_in_its_buffer_or_not_aligned_is_refused() {
    for (bytes, why) in [
        (256..544, "cannot see the bytes 256 to 544: it has 528 bytes"),
        (0..0, "cannot see the bytes 0 to 0: it has 528 bytes"),
        (4..12, "cannot see the bytes 4 to 12: the first is no multiple of 256"),
    ] {
        let linked = workshop(132, vec![Some(bytes)]).link(PASS, OUTPUT);
        let refused = linked.expect_err("a window that does not fit");
        assert!(refused.contains(why) && refused.contains("sign.wgsl:4"), "{refused}");
    }
}
