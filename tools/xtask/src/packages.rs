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

/// Returns the names of the distribution and of those that it derives from, by the text of /etc/os-release.
pub(crate) fn ids_of_linux(os_release: &str) -> Vec<&str> {
    os_release
        .lines()
        .filter_map(|line| line.strip_prefix("ID=").or_else(|| line.strip_prefix("ID_LIKE=")))
        .flat_map(|value| value.trim_matches(['"', '\'']).split_whitespace())
        .collect()
}

/// Returns the text of /etc/os-release; empty where there is none.
pub(crate) fn os_release() -> String {
    std::fs::read_to_string("/etc/os-release").unwrap_or_default()
}

/// Whether packages come by apt-get, by the text of /etc/os-release.
pub(crate) fn has_apt(os_release: &str) -> bool {
    ids_of_linux(os_release).iter().any(|id| ["debian", "ubuntu"].contains(id))
}

/// Packages of Debian and Ubuntu that something needs, and how it is asked whether they may be installed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Need {
    pub(crate) question: &'static str,
    pub(crate) packages: &'static [&'static str],
}

impl Need {
    /// Installs the packages where they come by apt-get and that is agreed to, and returns whether it did.
    pub(crate) fn install(&self, consent: Consent) -> Result<bool> {
        if !has_apt(&os_release()) || !consent.to(self.question)? {
            return Ok(false);
        }
        // A source that cannot be reached need not be the one that has the package.
        if let Err(error) = apt_get(&["update"]) {
            eprintln!("warning: {error:#}");
        }
        apt_get(&[&["install", "--yes", "--no-install-recommends"], self.packages].concat())?;
        Ok(true)
    }
}

/// Returns those of `packages` that are not installed; none where there is no dpkg to ask.
pub(crate) fn missing<'a>(packages: &[&'a str]) -> Vec<&'a str> {
    let mut query = Command::new("dpkg-query");
    // It fails if one is unknown, and still lists the others.
    match query.args(["--show", "--showformat", "${db:Status-Abbrev} ${Package}\n"]).args(packages).output() {
        Ok(listed) => not_listed(packages, &String::from_utf8_lossy(&listed.stdout)),
        Err(_) => Vec::new(),
    }
}

/// Returns those of `packages` that no line of dpkg's list calls installed, with or without "wanted".
fn not_listed<'a>(packages: &[&'a str], list: &str) -> Vec<&'a str> {
    let installed: Vec<&str> = list
        .lines()
        .filter_map(|line| line.split_once(char::is_whitespace))
        .filter(|(status, _)| status.get(1..2) == Some("i"))
        .map(|(_, package)| package.trim())
        .collect();
    packages.iter().copied().filter(|package| !installed.contains(package)).collect()
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

    #[test]
    fn a_package_that_was_removed_or_is_unknown_is_missing() {
        let list = "ii  libxi6\nrc  xvfb\nhi  libxcursor1\nun  libx11-xcb1\n";
        let packages = ["xvfb", "libxi6", "libxcursor1", "libx11-xcb1", "libxkbcommon-x11-0"];
        assert_eq!(not_listed(&packages, list), ["xvfb", "libx11-xcb1", "libxkbcommon-x11-0"]);
    }
}
