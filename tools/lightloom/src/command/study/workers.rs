//! A study on all adapters of a machine: one process for each, which runs shard after shard.

use crate::output::stderr;
use anyhow::{Context as _, Result, anyhow, bail};
use std::io::{BufRead as _, BufReader};
use std::ops::Range;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};
use study::{Costs, Plan};

/// Shards for each worker: adapters need not be alike, and costs not be as expected.
const SHARDS: u32 = 4;

/// Runs the cells of a plan in processes, each on an adapter of its own, into the folder `out`. `program` is the command of a
/// process but for folder, adapter and shard.
pub(super) fn run(program: &[String], out: &Path, workers: u32, plan: &Plan, costs: &Costs) -> Result<()> {
    let mut shards = plan.parts(costs, workers.saturating_mul(SHARDS));
    shards.retain(|shard| !shard.is_empty());
    // The first is the last to be taken.
    shards.reverse();
    let shards = Mutex::new(shards);
    let next = || shards.lock().unwrap_or_else(PoisonError::into_inner).pop();
    let worker = |adapter: u32| -> Result<()> {
        while let Some(shard) = next() {
            one(program, out, adapter, &shard, plan.cells.len())?;
        }
        Ok(())
    };
    let ends: Vec<Result<()>> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..workers).map(|adapter| scope.spawn(move || worker(adapter))).collect();
        let join = |worker: std::thread::ScopedJoinHandle<'_, Result<()>>| {
            worker.join().unwrap_or_else(|_| Err(anyhow!("a worker panicked")))
        };
        workers.into_iter().map(join).collect()
    });
    ends.into_iter().collect()
}

/// Runs one shard in a process, and prints what that reports.
fn one(program: &[String], out: &Path, adapter: u32, shard: &Range<usize>, of: usize) -> Result<()> {
    let shard = format!("cells:{}-{}/{of}", shard.start + 1, shard.end);
    let [path, arguments @ ..] = program else { bail!("the command of a worker is empty") };
    let mut child = Command::new(path)
        .args(arguments)
        .arg("-o")
        .arg(out)
        .args(["--adapter", &adapter.to_string(), "--shard", &shard])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start {path}"))?;
    for line in child.stderr.take().into_iter().flat_map(|stderr| BufReader::new(stderr).lines()) {
        stderr!("adapter {adapter}: {}", line.unwrap_or_default());
    }
    let status = child.wait().context("cannot wait for a worker")?;
    if !status.success() {
        bail!("the worker of adapter {adapter} ended with {status} in the shard {shard}");
    }
    Ok(())
}
