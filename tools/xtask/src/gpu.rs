//! Sees to it that there is an adapter to render with: a GPU's driver, or one that renders on the CPU.

use crate::packages::{Consent, Need, has_apt, ids_of_linux, os_release};
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::{Command, Stdio};

const DRIVER: Need = Need {
    question: "There is no adapter to render with. Install one that renders on the CPU (mesa-vulkan-drivers, by apt-get)?",
    packages: &["mesa-vulkan-drivers"],
};

/// Returns the adapters, a line each, after having installed a driver where there was none and that was agreed to.
/// Empty where there is none still.
pub fn ensure(lightloom: &Path, consent: Consent) -> Result<Vec<String>> {
    let found = adapters(lightloom)?;
    if !found.is_empty() {
        return Ok(found);
    }
    if !DRIVER.install(consent)? {
        return Ok(found);
    }
    let found = adapters(lightloom)?;
    if found.is_empty() {
        bail!(
            "mesa-vulkan-drivers is installed, but there is no adapter still. Is VK_DRIVER_FILES set to another driver?"
        );
    }
    Ok(found)
}

/// Returns what to do where there is no adapter.
pub fn advice() -> String {
    match Driver::of_this_system() {
        Driver::Apt => "Run this again with -y, or: apt-get install mesa-vulkan-drivers".to_owned(),
        Driver::ByHand(what) => what.to_owned(),
    }
}

/// Returns whether every adapter renders on the CPU.
pub fn on_cpu(adapters: &[String]) -> bool {
    let is_cpu = |line: &String| {
        let line = line.to_lowercase();
        ["llvmpipe", "lavapipe", "swiftshader", "cpu"].iter().any(|name| line.contains(name))
    };
    !adapters.is_empty() && adapters.iter().all(is_cpu)
}

/// Returns the lines of `lightloom adapters`.
fn adapters(lightloom: &Path) -> Result<Vec<String>> {
    let mut command = Command::new(lightloom);
    let output = command
        .arg("adapters")
        .stderr(Stdio::piped())
        .output()
        .with_context(|| format!("cannot run {}", lightloom.display()))?;
    match output.status.code() {
        Some(0) => Ok(String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect()),
        Some(1) => Ok(Vec::new()),
        _ => bail!("{command:?} failed: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr)),
    }
}

/// How a driver that renders on the CPU gets onto a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Driver {
    Apt,
    ByHand(&'static str),
}

impl Driver {
    fn of_this_system() -> Driver {
        if cfg!(target_os = "linux") {
            Driver::of_linux(&os_release())
        } else {
            Driver::ByHand("Install your GPU's driver: Lightloom needs Vulkan, Metal or Direct3D 12.")
        }
    }

    /// Returns the way of a Linux, by the text of /etc/os-release.
    fn of_linux(os_release: &str) -> Driver {
        let ids = ids_of_linux(os_release);
        let is = |names: &[&str]| ids.iter().any(|id| names.contains(id));
        if has_apt(os_release) {
            Driver::Apt
        } else if is(&["fedora", "rhel"]) {
            Driver::ByHand("Install Mesa's driver: dnf install mesa-vulkan-drivers vulkan-loader")
        } else if is(&["arch"]) {
            Driver::ByHand("Install Mesa's driver: pacman -S vulkan-swrast vulkan-icd-loader")
        } else if is(&["suse", "opensuse"]) {
            Driver::ByHand("Install Mesa's driver: zypper install libvulkan_lvp libvulkan1")
        } else if is(&["alpine"]) {
            Driver::ByHand("Install Mesa's driver: apk add mesa-vulkan-swrast vulkan-loader")
        } else {
            Driver::ByHand(
                "Install a Vulkan loader and your GPU's driver, or Mesa's lavapipe, which renders on the CPU.",
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn systems_are_known_by_what_they_derive_from() {
        assert_eq!(Driver::of_linux("NAME=\"Debian GNU/Linux\"\nID=debian\n"), Driver::Apt);
        assert_eq!(Driver::of_linux("ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n"), Driver::Apt);
        let command = |os_release| match Driver::of_linux(os_release) {
            Driver::ByHand(what) => what.split_whitespace().nth(3).unwrap(),
            Driver::Apt => "apt-get",
        };
        assert_eq!(command("ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"\n"), "dnf");
        assert_eq!(command("ID=arch\n"), "pacman");
        assert_eq!(command("ID=\"opensuse-leap\"\nID_LIKE=\"suse opensuse\"\n"), "zypper");
        assert_eq!(command("ID=alpine\n"), "apk");
        assert!(matches!(Driver::of_linux(""), Driver::ByHand(_)));
    }

    #[test]
    fn one_gpu_is_enough_to_count_as_one() {
        let lines = |lines: &[&str]| lines.iter().map(|line| (*line).to_owned()).collect::<Vec<_>>();
        assert!(on_cpu(&lines(&["llvmpipe (LLVM 15.0.6, 256 bits), Vulkan"])));
        assert!(!on_cpu(&lines(&[
            "llvmpipe (LLVM 15.0.6, 256 bits), Vulkan",
            "NVIDIA GeForce RTX 4090, Vulkan"
        ])));
        assert!(!on_cpu(&[]));
    }

    #[cfg(unix)]
    #[test]
    fn the_exit_code_says_whether_there_is_an_adapter() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let listed = |script: &str| {
            let path = folder.path().join(script.len().to_string());
            std::fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
            adapters(&path)
        };
        assert_eq!(listed("echo one; echo two").unwrap(), ["one", "two"]);
        assert!(listed("echo none >&2; exit 1").unwrap().is_empty());
        let error = listed("echo 'no such command' >&2; exit 2").unwrap_err();
        assert!(error.to_string().contains("no such command"), "{error}");
    }
}
