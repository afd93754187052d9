//! The time from the start of a process to its first picture.

use super::Bench;
use super::table::{Goal, Row, Section, Spread};
use anyhow::{Context as _, Result, bail};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

/// Processes that are not counted: the first fills the driver's cache.
const WARM_UP: u32 = 1;

pub(super) fn measure(bench: &Bench<'_>) -> Result<Section> {
    // For the table, which says on which adapter it was.
    bench.gpu()?;
    let folder = tempfile::tempdir()?;
    let cache = folder.path().join("cache");
    let mut warm = Vec::new();
    let mut cold = Vec::new();
    for number in 0..bench.args.runs + WARM_UP {
        let empty = folder.path().join(format!("empty-{number}"));
        let times = [process(bench, folder.path(), &cache)?, process(bench, folder.path(), &empty)?];
        if number >= WARM_UP {
            warm.push(times[0]);
            cold.push(times[1]);
        }
    }
    let row = |name, times| Row::new(name, Spread::of(times), "s").goal(Goal::AtMost(1.0), "own");
    let rows = vec![
        row("start to the first picture", warm),
        row("start to the first picture, the driver's cache empty", cold),
    ];
    let note = "A process that renders `ism-invtm` in the Cornell box at 64², from its start to its end, in turns with \
                its driver's cache filled by the one before and with an empty one. The folder of the cache is set for Mesa \
                only: with other drivers the two rows mean the same. `lightloom render --time` prints where the time goes."
        .to_owned();
    Ok(Section { rows, note })
}

/// Returns the seconds that a process takes whose driver keeps what it compiles in the folder `cache`.
fn process(bench: &Bench<'_>, folder: &Path, cache: &Path) -> Result<f64> {
    let program = bench.context.program()?;
    let mut command = Command::new(&program[0]);
    command.args(&program[1..]);
    command.args(["render", "ism-invtm", "cornell-box", "--size", "64x64", "-o"]);
    command.arg(folder.join("picture.png")).env("MESA_SHADER_CACHE_DIR", cache).stdout(Stdio::null());
    let start = Instant::now();
    let done = command.output().context("this program cannot be started")?;
    let seconds = start.elapsed().as_secs_f64();
    if !done.status.success() {
        bail!("`lightloom render` failed: {}", String::from_utf8_lossy(&done.stderr).trim());
    }
    Ok(seconds)
}
