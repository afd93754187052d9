//! The arguments of commands that run cases: `stress`, `precision`, `bench`.

use super::lists::print;
use crate::context::{Context, unknown};
use anyhow::Result;
use std::path::{Path, PathBuf};

// No doc comment: clap would take it for that of the command.
#[derive(clap::Args)]
pub(crate) struct CaseArgs {
    /// Cases by name, or several as far*; all by default
    #[arg(value_name = "CASE")]
    pub(crate) names: Vec<String>,
    /// The folder for cells, tables and the report [default: out/COMMAND]
    #[arg(short, long = "out", value_name = "DIR")]
    out: Option<PathBuf>,
    /// List the cases
    #[arg(long)]
    list: bool,
}

impl CaseArgs {
    /// Returns the folder for the results of a command.
    pub(crate) fn folder(&self, command: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| Path::new("out").join(command))
    }

    /// Returns the indices of the chosen cases of a command, each with its name and a line about it, in their order; all if no
    /// names are given. If the list is asked for, prints it and returns `None`.
    pub(crate) fn chosen(
        &self,
        context: &Context,
        command: &str,
        all: &[(String, String)],
    ) -> Result<Option<Vec<usize>>> {
        let is = |name: &str, case: &str| match name.strip_suffix('*') {
            Some(beginning) => case.starts_with(beginning),
            None => case == name,
        };
        for name in &self.names {
            if !all.iter().any(|(case, _)| is(name, case)) {
                let known: Vec<String> = all.iter().map(|(case, _)| case.clone()).collect();
                return Err(unknown("case", name, &known, &format!("{command} --list")));
            }
        }
        let is_chosen = |case: &str| self.names.is_empty() || self.names.iter().any(|name| is(name, case));
        let chosen: Vec<usize> = (0..all.len()).filter(|&index| is_chosen(&all[index].0)).collect();
        if self.list {
            print(context, &chosen.iter().map(|&index| all[index].clone()).collect::<Vec<_>>());
            return Ok(None);
        }
        Ok(Some(chosen))
    }
}
