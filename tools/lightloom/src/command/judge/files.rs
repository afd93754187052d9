//! The files of frames: numbered, of one engine and one run.

use anyhow::{Context as _, Result, bail};
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// The endings of pictures of radiance.
const ENDINGS: [&str; 3] = ["exr", "pfm", "hdr"];

/// The frames of one run, in order, without a gap.
#[derive(Debug)]
pub(super) struct Sequence {
    /// The folder, or the file.
    pub(super) path: PathBuf,
    /// Its last part, without the ending.
    pub(super) name: String,
    pub(super) files: Vec<PathBuf>,
    first: u32,
}

impl Sequence {
    /// Reads which frames are in a folder, or takes a single picture.
    pub(super) fn of(path: &Path) -> Result<Sequence> {
        let files = if path.is_dir() { pictures(path)? } else { vec![path.to_owned()] };
        Sequence::of_files(path, files)
    }

    /// Sorts files by their numbers.
    fn of_files(path: &Path, files: Vec<PathBuf>) -> Result<Sequence> {
        if let Some(missing) = files.iter().find(|file| !file.exists()) {
            bail!("{}: there is no such file or folder", missing.display());
        }
        let name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let mut numbered = Vec::new();
        for file in files {
            numbered.push((number(&file), file));
        }
        numbered.sort();
        match &numbered[..] {
            [] => bail!(
                "{}: expected pictures, files that end in .exr, .pfm or .hdr; found none",
                path.display()
            ),
            [_] => {}
            [(None, file), ..] => bail!("{}: expected a number in the name of each frame", file.display()),
            _ => {}
        }
        for pair in numbered.windows(2) {
            let [(Some(one), before), (Some(other), file)] = pair else { continue };
            if one == other {
                bail!("frame {one} is twice: {} and {}", before.display(), file.display());
            }
            if one + 1 != *other {
                bail!("frame {} is missing between {} and {}", one + 1, before.display(), file.display());
            }
        }
        let first = numbered[0].0.unwrap_or(0);
        Ok(Sequence {
            path: path.to_owned(),
            name,
            files: numbered.into_iter().map(|(_, file)| file).collect(),
            first,
        })
    }

    /// Returns the number of the first frame.
    pub(super) fn first(&self) -> u32 {
        self.first
    }

    /// Returns the number of the last frame.
    pub(super) fn last(&self) -> u32 {
        self.first + self.files.len() as u32 - 1
    }
}

/// Returns the last number in the name of a file.
fn number(file: &Path) -> Option<u32> {
    let stem = file.file_stem()?.to_string_lossy();
    let end = stem.rfind(|c: char| c.is_ascii_digit())? + 1;
    let start = stem[..end]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |at| at + stem[at..].chars().next().map_or(1, char::len_utf8));
    stem[start..end].parse().ok()
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries =
        std::fs::read_dir(folder).with_context(|| format!("{}: cannot be read", folder.display()))?;
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<PathBuf>>>()?;
    paths.sort();
    Ok(paths)
}

fn pictures(folder: &Path) -> Result<Vec<PathBuf>> {
    let is_picture = |path: &PathBuf| {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        ending.is_some_and(|ending| ENDINGS.contains(&&*ending)) && path.is_file()
    };
    Ok(entries(folder)?.into_iter().filter(is_picture).collect())
}

/// Returns the runs of each engine, by a name: a folder holds the frames of one run, or folders of runs. Files alone are the
/// frames of one engine.
pub(super) fn rows_of(paths: &[PathBuf]) -> Result<Vec<(String, Vec<Sequence>)>> {
    if paths.iter().all(|path| !path.is_dir()) {
        let path = match paths {
            [one] => one.as_path(),
            _ => paths[0].parent().unwrap_or(Path::new("")),
        };
        let sequence = Sequence::of_files(path, paths.to_vec())?;
        let name = if sequence.name.is_empty() { "frames".to_owned() } else { sequence.name.clone() };
        return Ok(vec![(name, vec![sequence])]);
    }
    let mut rows: Vec<(String, Vec<Sequence>)> = Vec::new();
    for path in paths {
        let folders: Vec<PathBuf> = match path.is_dir() && pictures(path)?.is_empty() {
            true => entries(path)?.into_iter().filter(|entry| entry.is_dir()).collect(),
            false => Vec::new(),
        };
        let runs = match &folders[..] {
            [] => vec![Sequence::of(path)?],
            _ => folders.iter().map(|folder| Sequence::of(folder)).collect::<Result<_>>()?,
        };
        // Folders of one name are told apart by their paths.
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let is_taken = rows.iter().any(|(other, _)| *other == name);
        rows.push((if is_taken { path.display().to_string() } else { name }, runs));
    }
    Ok(rows)
}

/// The times of frames, as `--ms` gives them.
#[derive(Clone, Debug)]
pub(crate) enum Times {
    /// Of each frame \[ms\].
    Each(f64),
    /// In a CSV file.
    File(PathBuf),
}

impl FromStr for Times {
    type Err = String;

    fn from_str(text: &str) -> Result<Times, String> {
        match text.parse() {
            Ok(ms) if ms > 0.0 && f64::is_finite(ms) => Ok(Times::Each(ms)),
            Ok(_) => Err("expected a number above 0, or a CSV file".to_owned()),
            Err(_) => Ok(Times::File(PathBuf::from(text))),
        }
    }
}

impl fmt::Display for Times {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Times::Each(ms) => write!(f, "{ms}"),
            Times::File(path) => write!(f, "{}", path.display()),
        }
    }
}

impl Times {
    /// Returns the time of each frame \[ms\]: of a CSV file, the last number of each line that has one.
    pub(super) fn of(&self, frames: &Sequence) -> Result<Vec<f64>> {
        let count = frames.files.len();
        let path = match self {
            Times::Each(ms) => return Ok(vec![*ms; count]),
            Times::File(path) => path,
        };
        let text = std::fs::read_to_string(path).with_context(|| {
            format!("--ms {}: expected a number, or a CSV file that can be read", path.display())
        })?;
        let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let mut times = Vec::new();
        for (index, line) in lines {
            let field = line.rsplit([',', ';', '\t']).next().unwrap_or_default().trim();
            match field.parse() {
                Ok(ms) if ms >= 0.0 && f64::is_finite(ms) => times.push(ms),
                // The first line may name the columns.
                _ if index == 0 => {}
                _ => bail!(
                    "{}:{}: expected milliseconds in the last column, found `{field}`",
                    path.display(),
                    index + 1
                ),
            }
        }
        if times.len() != count {
            bail!("{}: expected a line for each of {count} frames, found {}", path.display(), times.len());
        }
        Ok(times)
    }
}

#[cfg(test)]
mod tests {
    use super::number;
    use std::path::Path;

    #[test]
    fn the_last_number_of_a_name_is_that_of_the_frame() {
        for (name, expected) in [
            ("frame-0012.exr", Some(12)),
            ("shot2.beauty.0007.exr", Some(7)),
            ("12.pfm", Some(12)),
            ("take3-final.hdr", Some(3)),
            ("bild-Ü4.exr", Some(4)),
            ("beauty.exr", None),
            ("99999999999.exr", None),
        ] {
            assert_eq!(number(Path::new(name)), expected, "{name}");
        }
    }
}
