//! Broken versions of good files, for tests of what reads files.
//!
//! Noise is refused at its first byte; a good file with a few edits gets far into a program. [`texts`] and [`bytes`] are
//! strategies of proptest that make such edits, [`within`] bounds the time of a case, and [`config`] says how many cases
//! there are: few in a test run, which are the same in every run; as many others as `PROPTEST_CASES` says where it is
//! set. The seeds of cases that failed are kept beside the test, in a file `….regressions`, and are run first.

mod edit;
mod structure;

pub use structure::{json, taken, wgsl};

use edit::{Edit, Seeds};
use proptest::prelude::*;
use proptest::test_runner::{Config, FileFailurePersistence, RngSeed};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::Builder;
use std::time::Duration;

/// The stack of the thread that runs a case: that of any thread which Rust starts.
const STACK: usize = 2 << 20;

/// The number of limits that pass at most where a case waits and does not run.
const MOST_LIMITS: u32 = 30;

/// Returns a configuration of so many cases, the same in every run; of as many as `PROPTEST_CASES` says, and others in each run,
/// where that is set.
pub fn config(cases: u32) -> Config {
    let given = std::env::var_os("PROPTEST_CASES").is_some();
    let config = if given { Config::default() } else { Config::with_cases(cases) };
    Config {
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        // A case that takes its whole time would be shrunk for hours.
        max_shrink_iters: 200,
        // The verdict on a change must not depend on chance.
        rng_seed: if given { config.rng_seed } else { RngSeed::Fixed(0) },
        ..config
    }
}

/// Returns one of the good texts with a few edits: parts cut, repeated, exchanged with those of another, nested; numbers
/// made extreme; rows of one character.
///
/// # Panics
/// If there are no texts.
pub fn texts<T: Into<String>>(good: impl IntoIterator<Item = T>) -> impl Strategy<Value = String> {
    let good = good.into_iter().map(|text| text.into().into_bytes());
    edited(good).prop_map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
}

/// Returns one of the good files with a few edits, as [`texts`] does, and with changed bytes.
///
/// # Panics
/// If there are no files.
pub fn bytes(good: impl IntoIterator<Item = Vec<u8>>) -> impl Strategy<Value = Vec<u8>> {
    (edited(good), prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4)).prop_map(
        |(mut bytes, changes)| {
            if !bytes.is_empty() {
                let count = bytes.len();
                changes.into_iter().for_each(|(place, byte)| bytes[place.index(count)] = byte);
            }
            bytes
        },
    )
}

fn edited(good: impl IntoIterator<Item = Vec<u8>>) -> impl Strategy<Value = Vec<u8>> {
    let good: Seeds = good.into_iter().collect();
    assert!(!good.is_empty(), "there are no good files to edit");
    let which = 0..good.len();
    let edits = prop::collection::vec(Edit::strategy(), 1..4);
    (which, edits).prop_map(move |(which, edits)| {
        edits.iter().fold(good[which].clone(), |bytes, edit| edit.apply(bytes, &good))
    })
}

/// Runs a case on a thread of its own, of the stack that threads have, and returns what it returns.
///
/// # Panics
/// If the case panics, or takes longer than `limit`: on Linux of the time that its thread runs, so that other programs do
/// not count, elsewhere of any time.
pub fn within<T: Send + 'static>(limit: Duration, case: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = channel();
    let (starting, started) = channel();
    let case = move || {
        // Neither receiver waits any longer where sending fails.
        let _ = starting.send(std::fs::read_link("/proc/thread-self"));
        let _ = sender.send(case());
    };
    let thread = Builder::new().name("case".into()).stack_size(STACK).spawn(case).expect("a thread");
    let statistics = started.recv().ok().and_then(Result::ok);
    let statistics = statistics.map(|thread| Path::new("/proc").join(thread).join("schedstat"));
    let is_over = || statistics.as_deref().and_then(ran).is_none_or(|ran| ran >= limit);
    let mut result = receiver.recv_timeout(limit);
    for _ in 0..MOST_LIMITS {
        if result.is_ok() || is_over() {
            break;
        }
        result = receiver.recv_timeout(limit);
    }
    match result {
        Ok(result) => result,
        Err(RecvTimeoutError::Timeout) => panic!("it takes longer than {limit:?}"),
        Err(RecvTimeoutError::Disconnected) => match thread.join() {
            Err(panic) => std::panic::resume_unwind(panic),
            Ok(()) => unreachable!("a thread that ends without a panic has sent its result"),
        },
    }
}

/// Returns how long a thread has run, by the file that Linux keeps of it.
fn ran(statistics: &Path) -> Option<Duration> {
    let text = std::fs::read_to_string(statistics).ok()?;
    Some(Duration::from_nanos(text.split_whitespace().next()?.parse().ok()?))
}

/// Returns texts that are large and simple: rows of one character, brackets, one long line, each of about `len` bytes.
/// Whatever reads text must refuse them fast.
pub fn large(len: usize) -> Vec<(&'static str, Arc<str>)> {
    let of = |piece: &str| piece.repeat(len / piece.len()).into();
    [
        "\0", "(", ")", "[", "{", "}", "<", " ", "\n", "a", "1", "\"", "'", "#", "#!\n", "/*", "//", "\\",
        "é", "-", ",", ":", "a(", "a: (", "A(a: ", "a,", "a: 1,", "\"a\": ", "\0\u{1}", "1e9999 ", "r#",
        "b\"", "'a", "&", "a+", "a.",
    ]
    .into_iter()
    .map(|piece| (piece, of(piece)))
    .collect()
}
