//! A Snakefile for a study: Snakemake runs it on one machine, on Slurm and elsewhere.

use serde_json::to_string;
use std::fmt::Write as _;
use std::ops::Range;
use study::{Costs, Plan};

/// A job may take this times the expected time, and [`MORE_MINUTES`], before a batch system ends it.
const TIMES_EXPECTED: f64 = 3.0;
const MORE_MINUTES: f64 = 15.0;

/// The times that a job is tried again, as after the failure of a node.
const RETRIES: u32 = 2;

/// What a Snakefile is written for.
pub(super) struct Workflow<'a> {
    /// Name of the study.
    pub(super) name: &'a str,
    /// Path of the Snakefile.
    pub(super) file: &'a str,
    /// The program and its arguments up to the subcommand.
    pub(super) program: &'a [String],
    /// The arguments after `study`, without those that the rules add.
    pub(super) study: &'a [String],
}

/// Returns the text of the Snakefile: a rule for references, one for shards, one for the report.
pub(super) fn text(plan: &Plan, costs: &Costs, shard_minutes: f64, workflow: &Workflow<'_>) -> String {
    let Workflow { name, file, program, study } = workflow;
    let cells = plan.shards(costs, shard_minutes);
    let references = plan.reference_shards(costs, shard_minutes);
    let (cell_costs, reference_costs) = (costs.of_cells(plan), costs.of_references(plan));
    let minutes = cell_costs.iter().chain(&reference_costs).sum::<f64>() / 60.0;
    let program: Vec<String> = program.iter().map(python).collect();
    let study: Vec<String> = study.iter().map(python).collect();
    let mut out = format!(
        "# The study {name}: {minutes:.0} minutes in all, if costs are as expected; cells: {}, references: {}.\n\
         #\n\
         #     snakemake -c1 --snakefile {file} --config out=out/{name}\n\
         #     snakemake --executor slurm --jobs 64 --default-resources gpu=1 --snakefile {file} --config out=out/{name}\n\
         #\n\
         # On one machine, the number of `-c` is that of jobs at once; two on one adapter make each other's times longer.\n\
         # Written by `lightloom study --snakefile`, and to be written again if the study changes.\n\
         import shlex\n\n\
         OUT = config.get(\"out\", {})\n\
         PROGRAM = [config.get(\"lightloom\", {}), {}]\n\
         STUDY = shlex.join([*PROGRAM, \"study\", {}, \"-o\", OUT])\n\
         MERGE = shlex.join([*PROGRAM, \"study\", \"merge\", OUT, \"-o\", OUT])\n\n\
         # The jobs: places in the study, with the minutes that they are expected to take.\n",
        plan.cells.len(),
        reference_costs.len(),
        python(&format!("out/{name}")),
        program.first().map_or("", String::as_str),
        program.get(1..).unwrap_or_default().join(", "),
        study.join(", "),
    );
    jobs(&mut out, "REFERENCES", &references, &reference_costs);
    jobs(&mut out, "CELLS", &cells, &cell_costs);
    let _ = write!(
        out,
        r#"

def minutes(jobs):
    return lambda wildcards: int({TIMES_EXPECTED} * jobs[wildcards.places] + {MORE_MINUTES})


rule report:
    input:
        [OUT + "/shards/cells-" + places for places in CELLS],
    output:
        OUT + "/report.html",
    params:
        merge=MERGE,
    resources:
        runtime=60,
    shell:
        "{{params.merge}}"


rule references:
    output:
        touch(OUT + "/shards/references-{{places}}"),
    wildcard_constraints:
        places=r"\d+-\d+",
    params:
        study=STUDY,
    resources:
        runtime=minutes(REFERENCES),
    retries: {RETRIES}
    shell:
        "{{params.study}} --shard references:{{wildcards.places}}/{references}"


rule shard:
    input:
        [OUT + "/shards/references-" + places for places in REFERENCES],
    output:
        touch(OUT + "/shards/cells-{{places}}"),
    wildcard_constraints:
        places=r"\d+-\d+",
    params:
        study=STUDY,
    resources:
        runtime=minutes(CELLS),
    retries: {RETRIES}
    shell:
        "{{params.study}} --shard cells:{{wildcards.places}}/{cells}"
"#,
        references = reference_costs.len(),
        cells = cell_costs.len(),
    );
    out
}

/// Writes a table of jobs, without those that have nothing to do.
fn jobs(out: &mut String, name: &str, ranges: &[Range<usize>], seconds: &[f64]) {
    let _ = writeln!(out, "{name} = {{");
    for range in ranges.iter().filter(|range| !range.is_empty()) {
        let minutes = seconds[range.clone()].iter().sum::<f64>() / 60.0;
        let _ = writeln!(out, "    \"{}-{}\": {minutes:.1},", range.start + 1, range.end);
    }
    out.push_str("}\n");
}

/// Formats a text as Python does: its escapes are those of JSON.
fn python(text: &String) -> String {
    to_string(text).unwrap_or_default()
}
