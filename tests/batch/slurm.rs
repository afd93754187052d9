//! A real Slurm: a controller and two node daemons on this machine.

use super::{assert_alike, folder, snakefile, snakemake, study};
use crate::adapter::root;
use crate::program::{Done, Folder};
use serde_json::Value;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// There is one configuration for all of the machine.
static ONE: Mutex<()> = Mutex::new(());

/// A cluster that runs.
struct Cluster {
    folder: tempfile::TempDir,
    _one: MutexGuard<'static, ()>,
}

impl Cluster {
    /// Starts a cluster; `None`, with the reason on standard error, where it cannot be.
    fn up() -> Option<Cluster> {
        super::install();
        let is_there = |program: &str| {
            let version = Command::new(program).arg("-V").output();
            version.is_ok_and(|output| output.status.success())
        };
        if !is_there("slurmctld") || !is_there("slurmd") {
            eprintln!("skipped: there is no Slurm; tests/cluster/install.sh installs it");
            return None;
        }
        let one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = tempfile::tempdir().unwrap();
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o755)).unwrap();
        let cluster = Cluster { folder, _one: one };
        // Daemons keep what they inherit open.
        let up = cluster.script(&["up"]).stdout(Stdio::null()).stderr(Stdio::null()).status();
        if !up.is_ok_and(|status| status.success()) {
            eprintln!(
                "skipped: Slurm does not start here: it takes root, and a machine that has no Slurm of its own"
            );
            return None;
        }
        cluster.until("two idle nodes", || {
            cluster.slurm("sinfo", &["-h", "-N", "-o", "%t"]).out.split_whitespace().eq(["idle", "idle"])
        });
        Some(cluster)
    }

    fn script(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(root().join("tests/cluster/slurm.sh"));
        command.arg(arguments[0]).arg(self.folder.path()).args(&arguments[1..]);
        command
    }

    /// Runs a command of Slurm.
    fn slurm(&self, program: &str, arguments: &[&str]) -> Done {
        Done::of(Command::new(program).args(arguments))
    }

    #[track_caller]
    fn until(&self, what: &str, ready: impl Fn() -> bool) {
        let start = Instant::now();
        while !ready() {
            let queue = || self.slurm("squeue", &[]);
            assert!(start.elapsed() < Duration::from_secs(300), "no {what} in five minutes: {}", queue());
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    /// Submits a script, and returns the job.
    fn submit(&self, folder: &Folder, arguments: &[&str]) -> String {
        let done = Done::of(Command::new("sbatch").arg("--parsable").args(arguments).current_dir(&**folder));
        done.success().out.trim().to_owned()
    }

    fn job(&self, job: &str) -> String {
        self.slurm("scontrol", &["show", "job", job]).out
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        let _ = Command::new("scancel").args(["--partition", "all", "--signal", "KILL"]).output();
        let _ = self.script(&["down"]).output();
    }
}

/// Returns the nodes that ran the cells in a folder.
fn nodes(folder: &Path) -> Vec<String> {
    let mut nodes: Vec<String> =
        rows(folder).iter().map(|row| row["node"]["host"].as_str().unwrap().to_owned()).collect();
    nodes.sort();
    nodes.dedup();
    nodes
}

/// Returns the processes of Slurm that watch a job.
fn watchers(job: &str) -> Vec<String> {
    let of = |process: &str| fs::read_to_string(format!("/proc/{process}/cmdline")).unwrap_or_default();
    let all = fs::read_dir("/proc").unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    all.filter(|process| of(process).starts_with(&format!("slurmstepd: [{job}."))).collect()
}

/// Reads the records of the cells in a folder.
fn rows(folder: &Path) -> Vec<Value> {
    let entries = fs::read_dir(folder.join("cells")).into_iter().flatten();
    let paths = entries.map(|entry| entry.unwrap().path());
    let rows = paths.filter(|path| path.extension().is_some_and(|extension| extension == "json"));
    rows.map(|path| serde_json::from_slice(&fs::read(path).unwrap()).unwrap()).collect()
}

/// The command of the program, as a job has it.
fn program() -> String {
    format!("{} --root {}", env!("CARGO_BIN_EXE_lightloom"), root().display())
}

/// The same Snakefile as on one machine, by the executor for Slurm.
#[test]
fn snakemake_on_slurm_gives_the_report_of_one_process() {
    let Some(snakemake) = snakemake() else { return };
    let Some(_cluster) = Cluster::up() else { return };
    let Some(folder) = folder() else { return };
    let (path, _) = snakefile(&folder, &["--shard-minutes", "1.5"]);
    let mut command = Command::new(snakemake);
    command.args(["--executor", "slurm", "--jobs", "4", "--snakefile", &path, "--config", "out=out/slurm"]);
    command.args(["--seconds-between-status-checks", "1", "--slurm-init-seconds-before-status-checks", "1"]);
    command.args(["--slurm-status-command", "squeue"]);
    command.args(["--default-resources", "slurm_partition='all'", "slurm_account='tests'", "mem_mb=100"]);
    Done::of(command.current_dir(&*folder)).success();
    assert_eq!(nodes(&folder.at("out/slurm")), ["n1", "n2"]);
    study(&folder, &["small.ron", "-o", "one"]).success();
    assert_alike(&folder, "one", "out/slurm");
    eprintln!("ran: Snakemake on Slurm, two nodes");
}

/// A bare array of jobs: a node dies, a job is put back into the queue, and each cell has one row in the end.
#[test]
fn a_killed_node_and_a_requeued_job_leave_one_row_each() {
    let Some(cluster) = Cluster::up() else { return };
    let Some(folder) = folder() else { return };
    let program = program();
    folder
        .write("references.sh", &format!("#!/bin/sh\n{program} study small.ron -o out --shard references\n"));
    let cells = format!(
        "#!/bin/sh\n#SBATCH --array=1-4 --requeue --time=30 --open-mode=append --output=%a.log\n\
         {program} study small.ron -o out --shard $SLURM_ARRAY_TASK_ID/4\n"
    );
    folder.write("cells.sh", &cells);
    let first = cluster.submit(&folder, &["references.sh"]);
    let array = cluster.submit(&folder, &["--dependency", &format!("afterok:{first}"), "cells.sh"]);
    let out = folder.at("out");
    cluster.until("first cells of both nodes", || nodes(&out).len() == 2);
    let running = |node: &str| {
        cluster.slurm("squeue", &["-h", "-w", node, "-t", "R", "-o", "%A"]).out.trim().to_owned()
    };
    // One job is taken from its node in the middle, and its node's daemon dies in that of the other.
    let (killed, requeued) = (running("n1"), running("n2"));
    let daemon = fs::read_to_string(cluster.folder.path().join("n1.pid")).unwrap();
    // With the daemon dies what watches the job and would report its end. The job itself goes on beside the one that takes
    // its place, as on a node that lost its network.
    for process in std::iter::once(daemon.trim().to_owned()).chain(watchers(&killed)) {
        Done::of(Command::new("kill").args(["-9", &process])).success();
    }
    cluster.slurm("scontrol", &["requeue", &requeued]).success();
    for job in [&killed, &requeued] {
        cluster.until("a second start", || cluster.job(job).contains("Restarts=1"));
    }
    Done::of(&mut cluster.script(&["node", "n1"])).success();
    cluster.until("an empty queue", || cluster.slurm("squeue", &["-h"]).out.trim().is_empty());
    assert!(cluster.job(&array).contains("JobState=COMPLETED"), "{}", cluster.job(&array));
    assert_eq!(rows(&out).len(), 40);
    study(&folder, &["small.ron", "-o", "one"]).success();
    study(&folder, &["merge", "out", "-o", "out"]).success();
    assert_alike(&folder, "one", "out");
    eprintln!("ran: an array of jobs on Slurm, a node that died, a job put back into the queue");
}

/// Errors of nodes with the same adapter may be mixed, since their pictures are equal.
#[test]
fn nodes_of_one_adapter_give_equal_pictures() {
    let Some(cluster) = Cluster::up() else { return };
    let Some(folder) = folder() else { return };
    for node in ["n1", "n2"] {
        let line = format!("{} study small.ron -o {node} --shard 1/4", program());
        let mut command = Command::new("srun");
        command.args(["-w", node, "sh", "-c", &line]).current_dir(&*folder);
        Done::of(&mut command).success();
        assert_eq!(nodes(&folder.at(node)), [node]);
    }
    let pictures = |node: &str| {
        let entries = fs::read_dir(folder.at(node).join("images")).unwrap().map(|entry| entry.unwrap());
        let mut pictures: Vec<_> =
            entries.map(|entry| (entry.file_name(), fs::read(entry.path()).unwrap())).collect();
        pictures.sort();
        pictures
    };
    let (one, other) = (pictures("n1"), pictures("n2"));
    assert_eq!(one.len(), 20, "a picture and a map of errors of each of ten cells");
    assert!(one == other, "pictures differ");
    drop(cluster);
    eprintln!("ran: ten cells on each of two nodes");
}
