//! Packages of the system: what it derives from, whether something may be installed, and how.

use anyhow::{Context, Result};
use std::io::{IsTerminal, Write};
use std::process::Command;

/// Whether something may be installed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Consent {
    /// Without asking: `-y`, or on a machine of continuous integration.
    Given,
    /// There is someone to ask.
    Ask,
    /// There is no one to ask.
    Withheld,
}

impl Consent {
    /// Decides from `-y`, the variable `CI`, and whether there is a terminal.
    pub fn new(yes: bool) -> Consent {
        let ci = std::env::var("CI").is_ok_and(|ci| !ci.is_empty() && ci != "false");
        if yes || ci {
            Consent::Given
        } else if std::io::stdin().is_terminal() && std::io::stdout().is_terminal() {
            Consent::Ask
        } else {
            Consent::Withheld
        }
    }

    /// Whether the answer is yes.
    pub(crate) fn to(self, question: &str) -> Result<bool> {
        if self != Consent::Ask {
            return Ok(self == Consent::Given);
        }
        print!("{question} [Y/n] ");
        std::io::stdout().flush()?;
        let mut answer = String::new();
        let read = std::io::stdin().read_line(&mut answer)?;
        Ok(read > 0 && matches!(answer.trim().to_lowercase().as_str(), "" | "y" | "yes"))
    }
}

/// What the text of /etc/os-release names as the distribution and those it derives from.
pub(crate) fn ids_of_linux(os_release: &str) -> Vec<&str> {
    os_release
        .lines()
        .filter_map(|line| line.strip_prefix("ID=").or_else(|| line.strip_prefix("ID_LIKE=")))
        .flat_map(|value| value.trim_matches(['"', '\'']).split_whitespace())
        .collect()
}

/// The text of /etc/os-release; empty where there is none.
pub(crate) fn os_release() -> String {
    std::fs::read_to_string("/etc/os-release").unwrap_or_default()
}

/// Whether packages come by apt-get, by the text of /etc/os-release.
pub(crate) fn has_apt(os_release: &str) -> bool {
    ids_of_linux(os_release).iter().any(|id| ["debian", "ubuntu"].contains(id))
}

/// Installs a package of Debian or Ubuntu.
pub(crate) fn install(package: &str) -> Result<()> {
    // A source that cannot be reached need not be the one that has the package.
    if let Err(error) = apt_get(&["update"]) {
        eprintln!("warning: {error:#}");
    }
    apt_get(&["install", "--yes", "--no-install-recommends", package])
}

fn apt_get(args: &[&str]) -> Result<()> {
    let id = Command::new("id").arg("-u").output().context("cannot run `id`")?;
    let mut command = if id.stdout.trim_ascii() == b"0" { Command::new("env") } else { Command::new("sudo") };
    command.args(["DEBIAN_FRONTEND=noninteractive", "apt-get"]).args(args);
    println!("{command:?}");
    crate::cargo::run(&mut command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_given_consent_installs_unasked() {
        assert!(Consent::Given.to("?").unwrap());
        assert!(!Consent::Withheld.to("?").unwrap());
        assert_eq!(Consent::new(true), Consent::Given);
    }
}
