//! `render --log`: a line of JSON for each frame, with its pictures and the memory of the program.

use anyhow::{Context as _, Result};
use metrics::{Glance, Image};
use renderer::Renderer;
use serde_json::{Value, json};
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::xxh3_128;

/// A file with a line for each frame. It grows with each frame, so that whatever ends the program leaves the lines before.
pub(super) struct FrameLog {
    file: File,
    path: PathBuf,
}

impl FrameLog {
    pub(super) fn new(path: &Path) -> Result<FrameLog> {
        let file = File::create(path).with_context(|| format!("{} was not written", path.display()))?;
        Ok(FrameLog { file, path: path.to_owned() })
    }

    /// Adds the line of the frame that was just rendered in `seconds`.
    pub(super) fn add(
        &mut self,
        renderer: &Renderer,
        frame: u32,
        seconds: f64,
        outputs: &[String],
    ) -> Result<()> {
        let mut pictures = serde_json::Map::new();
        for output in outputs {
            pictures.insert(output.clone(), entry(&renderer.picture(output, 0)?));
        }
        let line = json!({
            "frame": frame,
            "seconds": seconds,
            "memory": memory(),
            "objects": renderer.gpu().objects(),
            "outputs": pictures,
        });
        // One write, so that a line is there or is not.
        self.file
            .write_all(format!("{line}\n").as_bytes())
            .with_context(|| format!("{} was not written", self.path.display()))
    }
}

/// Returns the line's entry for a picture: a hash of its bits, and the mean luminance of its finite pixels.
fn entry(picture: &Image) -> Value {
    let bytes: Vec<u8> = picture.pixels().iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    let Glance { mean, not_finite, negative } = picture.glance();
    json!({
        "hash": format!("{:032x}", xxh3_128(&bytes)),
        "mean": mean,
        "not_finite": not_finite,
        "negative": negative,
    })
}

/// Returns the memory that the program holds in RAM \[bytes\]; `None` if the system has no `/proc`.
fn memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}
