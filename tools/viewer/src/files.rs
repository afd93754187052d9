//! Pipelines and scenes in files: those of a folder, and those that were opened lately.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A pipeline.
    Pipeline,
    /// A scene: a scene file, or one of glTF, pbrt or Mitsuba.
    Scene,
}

/// The part of a file in which its first word is looked for.
const HEAD: u64 = 16 * 1024;

/// The most files of a folder that are looked into.
const MOST: usize = 300;

/// The number of names that are remembered.
const RECENT: usize = 8;

/// The time after which a folder is read again.
const FRESH: Duration = Duration::from_secs(2);

/// Returns what a file holds, by its ending and its first word; `None` where it is neither a pipeline nor a scene.
pub(crate) fn kind_of(path: &Path) -> Option<Kind> {
    let ending = path.extension()?.to_str()?;
    // A pipe or a device would be waited for.
    if !path.is_file() {
        return None;
    }
    match ending {
        _ if is_geometry(path) => Some(Kind::Scene),
        "ron" => {
            let mut head = Vec::new();
            std::fs::File::open(path).ok()?.take(HEAD).read_to_end(&mut head).ok()?;
            match first_word(&String::from_utf8_lossy(&head)) {
                "Pipeline" => Some(Kind::Pipeline),
                "Scene" => Some(Kind::Scene),
                _ => None,
            }
        }
        _ => None,
    }
}

/// Returns whether a file is one of geometry, with materials and lights.
fn is_geometry(path: &Path) -> bool {
    path.file_name().is_some_and(|name| scene::is_geometry(&name.to_string_lossy()))
}

/// Returns the first word of a RON file behind comments and attributes.
fn first_word(text: &str) -> &str {
    let mut rest = text.trim_start_matches(['\u{feff}', ' ', '\t', '\r', '\n']);
    loop {
        let after = if rest.starts_with("//") || rest.starts_with("#!") {
            rest.split_once('\n').map_or("", |(_, after)| after)
        } else if rest.starts_with("/*") {
            rest.split_once("*/").map_or("", |(_, after)| after)
        } else {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            return &rest[..end];
        };
        rest = after.trim_start();
    }
}

/// Something in a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Entry {
    /// A folder.
    Folder(PathBuf),
    /// A file of this kind.
    File(PathBuf, Kind),
}

/// Returns the folders, and then the pipelines and scenes of a folder, each sorted by name; nothing where it cannot be read.
pub(crate) fn entries(folder: &Path) -> Vec<Entry> {
    let found = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let hidden = |path: &PathBuf| path.file_name().is_none_or(|name| name.to_string_lossy().starts_with('.'));
    let mut paths: Vec<PathBuf> = found.filter(|path| !hidden(path)).collect();
    paths.sort();
    let (folders, files): (Vec<PathBuf>, Vec<PathBuf>) = paths.into_iter().partition(|path| path.is_dir());
    let may_fit =
        |path: &PathBuf| path.extension().is_some_and(|ending| ending == "ron") || is_geometry(path);
    let files = files.into_iter().filter(may_fit).take(MOST);
    let files = files.filter_map(|path| kind_of(&path).map(|kind| Entry::File(path, kind)));
    folders.into_iter().map(Entry::Folder).chain(files).collect()
}

/// The files of the working folder, read again now and then.
#[derive(Debug, Default)]
pub(crate) struct Beside {
    names: Vec<(String, Kind)>,
    read: Option<Instant>,
}

impl Beside {
    /// Returns the names of the files of a kind.
    pub(crate) fn of(&mut self, kind: Kind) -> Vec<String> {
        if self.read.is_none_or(|read| read.elapsed() > FRESH) {
            let file = |entry: Entry| match entry {
                Entry::File(path, kind) => Some((path.file_name()?.to_str()?.to_owned(), kind)),
                Entry::Folder(_) => None,
            };
            self.names = entries(Path::new(".")).into_iter().filter_map(file).collect();
            self.read = Some(Instant::now());
        }
        self.names.iter().filter(|(_, of)| *of == kind).map(|(name, _)| name.clone()).collect()
    }
}

/// Puts a file in front of those that were opened lately: by its whole path, since the next start may be in another folder.
pub(crate) fn remember(recent: &mut Vec<String>, name: &str) {
    let whole =
        Path::new(name).canonicalize().map_or_else(|_| name.to_owned(), |path| path.display().to_string());
    recent.retain(|known| *known != whole);
    recent.insert(0, whole);
    recent.truncate(RECENT);
}

/// Returns the path as it is shortest: from the working folder, where the file is in it.
pub(crate) fn shortest(path: &Path) -> String {
    let here = Path::new(".").canonicalize().ok();
    let within = here.and_then(|here| path.strip_prefix(here).ok().map(Path::to_owned));
    within.unwrap_or_else(|| path.to_owned()).display().to_string()
}

/// Returns names as they are listed.
pub(crate) fn listed(names: &[String]) -> Vec<String> {
    names.iter().map(|name| shortest(Path::new(name))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_word_says_what_a_file_holds() {
        let text = "\u{feff}#![enable(implicit_some)]\n// Scene(\n/* Study( */ Pipeline (passes: {})";
        assert_eq!(first_word(text), "Pipeline");
        assert_eq!((first_word("Scene("), first_word(""), first_word("// only this")), ("Scene", "", ""));
    }

    #[test]
    fn a_folder_lists_its_folders_pipelines_and_scenes() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("z")).unwrap();
        std::fs::create_dir(at(".git")).unwrap();
        for (name, text) in [("b.ron", "Scene("), ("a.ron", "Pipeline("), ("c.ron", "Study("), ("d.glb", "")]
        {
            std::fs::write(at(name), text).unwrap();
        }
        let expected = [
            Entry::Folder(at("z")),
            Entry::File(at("a.ron"), Kind::Pipeline),
            Entry::File(at("b.ron"), Kind::Scene),
            Entry::File(at("d.glb"), Kind::Scene),
        ];
        assert_eq!(entries(folder.path()), expected);
        assert!(entries(&at("nothing")).is_empty());
    }

    #[test]
    fn what_was_opened_last_comes_first_and_once() {
        let mut recent = Vec::new();
        for name in ["a", "b", "a", "c"] {
            remember(&mut recent, name);
        }
        assert_eq!(recent, ["c", "a", "b"]);
        (0..20).for_each(|number| remember(&mut recent, &number.to_string()));
        assert_eq!((recent.len(), recent[0].as_str()), (RECENT, "19"));
        // A file is kept by its whole path, and listed by the shortest.
        remember(&mut recent, "Cargo.toml");
        assert!(Path::new(&recent[0]).is_absolute(), "{}", recent[0]);
        assert_eq!(listed(&recent[..1]), ["Cargo.toml"]);
    }
}
