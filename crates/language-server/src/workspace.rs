//! The open files, and which file a URI, a path and a name mean.

use catalog::{Assets, Catalog, Sort};
use data_file::{Source, Span};
use lsp_types::{Location, Uri};
use percent_encoding::{AsciiSet, CONTROLS, percent_decode_str, utf8_percent_encode};
use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr as _;
use std::sync::Arc;

/// What stands in paths of URIs as it is.
const ESCAPED: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'[')
    .add(b'\\')
    .add(b']')
    .add(b'^')
    .add(b'`')
    .add(b'{')
    .add(b'|')
    .add(b'}');

/// A file that is open in the editor.
#[derive(Debug)]
pub(crate) struct Document {
    pub(crate) uri: Uri,
    pub(crate) version: i32,
    pub(crate) text: String,
}

/// The files that an editor works on.
pub(crate) struct Workspace {
    pub(crate) catalog: Arc<Catalog>,
    /// The folders that the editor has opened.
    folders: Vec<PathBuf>,
    /// By path.
    pub(crate) open: BTreeMap<PathBuf, Document>,
    /// Where files are written that are built into the program, for the editor to show.
    built_in: OnceCell<Option<tempfile::TempDir>>,
    pub(crate) pass_types: RefCell<crate::wgsl::PassTypes>,
}

/// What the text of a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// A pipeline, a scene or a study in RON; `None` where its first word says none of them.
    Ron(Option<Sort>),
    /// WGSL.
    Wgsl,
}

impl Language {
    pub(crate) fn of(path: &str, text: &str) -> Option<Language> {
        match path.rsplit_once('.')?.1 {
            "ron" => Some(Language::Ron(Sort::of_text(text))),
            "wgsl" => Some(Language::Wgsl),
            _ => None,
        }
    }
}

/// Returns the path of a URI; `None` where it is of no file.
pub(crate) fn path_of_uri(uri: &Uri) -> Option<PathBuf> {
    let rest = uri.as_str().strip_prefix("file://")?;
    let path = &rest[rest.find('/')?..];
    let path = percent_decode_str(path).decode_utf8().ok()?;
    // `/c:/folder` of Windows.
    let drive = path.as_bytes().get(2) == Some(&b':');
    Some(PathBuf::from(if drive { &path[1..] } else { &path }))
}

pub(crate) fn uri_of_path(path: &Path) -> Option<Uri> {
    let path = path.to_string_lossy().replace('\\', "/");
    let slash = if path.starts_with('/') { "" } else { "/" };
    Uri::from_str(&format!("file://{slash}{}", utf8_percent_encode(&path, ESCAPED))).ok()
}

impl Workspace {
    pub(crate) fn new(catalog: Arc<Catalog>, folders: Vec<PathBuf>) -> Workspace {
        let (built_in, pass_types) = (OnceCell::new(), RefCell::default());
        Workspace { catalog, folders, open: BTreeMap::new(), built_in, pass_types }
    }

    pub(crate) fn assets(&self) -> &Assets {
        self.catalog.assets()
    }

    /// Returns the name by which the front end knows the file at a path: from the root of the tree, from the working folder
    /// as on a command line, or the path, where such a name would mean another file.
    pub(crate) fn name(&self, path: &Path) -> String {
        let built_in = self.built_in.get().and_then(Option::as_ref).map(tempfile::TempDir::path);
        let within = [built_in, self.assets().root()].into_iter().flatten();
        let relative = within.filter_map(|folder| {
            path.strip_prefix(folder).map(Path::to_owned).ok().or_else(|| {
                Some(path.canonicalize().ok()?.strip_prefix(folder.canonicalize().ok()?).ok()?.to_owned())
            })
        });
        let shown = |path: &Path| path.to_string_lossy().replace('\\', "/");
        if let Some(path) = relative.into_iter().next() {
            return shown(&path);
        }
        let working = std::env::current_dir().ok().and_then(|folder| folder.canonicalize().ok());
        let from_there = working.and_then(|folder| path.strip_prefix(folder).map(shown).ok());
        let is_other = |name: &String| {
            ["", "pipelines/", "studies/", "scenes/"].iter().any(|folder| {
                let name = format!("{folder}{name}");
                self.assets().root().is_some_and(|root| root.join(&name).is_file())
                    || self.assets().embedded(&name).is_some()
            })
        };
        from_there.filter(|name| !is_other(name)).unwrap_or_else(|| shown(path))
    }

    /// Returns the path of a file, by its name; one that is only in the program is written to a folder for the editor.
    pub(crate) fn path(&self, name: &str) -> Option<PathBuf> {
        if Path::new(name).is_absolute() {
            return Some(PathBuf::from(name));
        }
        if let Some(path) = self.assets().root().map(|root| root.join(name))
            && (path.is_file() || self.open.contains_key(&path))
        {
            return Some(path);
        }
        let Some(text) = self.assets().embedded(name) else {
            let path = std::env::current_dir().ok()?.canonicalize().ok()?.join(name);
            return Some(path).filter(|path| path.is_file() || self.open.contains_key(path));
        };
        let folder =
            self.built_in.get_or_init(|| tempfile::Builder::new().prefix("lightloom-").tempdir().ok());
        let path = folder.as_ref()?.path().join(name);
        if !path.is_file() {
            std::fs::create_dir_all(path.parent()?).ok()?;
            std::fs::write(&path, text).ok()?;
        }
        Some(path)
    }

    /// Returns whether a file is one that a user can change: on disk, and not built in.
    pub(crate) fn is_own(&self, name: &str) -> bool {
        let built_in = self.built_in.get().and_then(Option::as_ref).map(tempfile::TempDir::path);
        self.path(name).is_some_and(|path| built_in.is_none_or(|folder| !path.starts_with(folder)))
    }

    pub(crate) fn uri(&self, name: &str) -> Option<Uri> {
        let path = self.path(name)?;
        self.open.get(&path).map(|open| open.uri.clone()).or_else(|| uri_of_path(&path))
    }

    pub(crate) fn location(&self, span: &Span) -> Option<Location> {
        let range = crate::text::range(&span.source.text, span.start as usize..span.end as usize);
        Some(Location { uri: self.uri(&span.source.name)?, range })
    }

    /// Returns the place at which a file begins.
    pub(crate) fn start(&self, name: &str) -> Option<Location> {
        Some(Location { uri: self.uri(name)?, range: lsp_types::Range::default() })
    }

    /// Returns a file by the name that [`Workspace::name`] gives it, as the editor has it.
    pub(crate) fn source(&self, name: &str) -> Option<Arc<Source>> {
        let text = self.assets().text(name)?;
        Some(Source::new(name, text))
    }

    /// Returns the names of all RON files of the tree and of the folders of the editor: also of folders of the tree in which
    /// no one looks for pipelines.
    pub(crate) fn all_ron(&self) -> Vec<String> {
        let on_disk = self.folders.iter().flat_map(|folder| files_near(folder));
        let is_ron = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "ron");
        let mut names = self.names("ron");
        names.extend(on_disk.filter(is_ron).map(|path| self.name(&path)));
        names.sort();
        names.dedup();
        names
    }

    /// Returns the names of the RON or WGSL files of the tree, of the folders of the editor, and of those that are open.
    pub(crate) fn names(&self, extension: &str) -> Vec<String> {
        let folders: &[&str] = if extension == "ron" {
            &["pipelines", "scenes", "studies", "docs"]
        } else {
            &["shaders", "crates/interfaces", "passes", "pipelines"]
        };
        let mut names: Vec<String> =
            folders.iter().flat_map(|folder| self.assets().list(folder, extension)).collect();
        let is_wanted = |path: &PathBuf| path.extension().is_some_and(|found| found == extension);
        let around = self.folders.iter().filter(|folder| self.assets().root() != Some(folder));
        let on_disk = around.flat_map(|folder| files_near(folder)).filter(is_wanted);
        names.extend(on_disk.map(|path| self.name(&path)));
        names.extend(self.open.keys().filter(|path| is_wanted(path)).map(|path| self.name(path)));
        names.sort();
        names.dedup();
        names
    }
}

/// The most files that a folder of an editor is searched for.
const MOST_FILES: usize = 20_000;

/// Returns the files of a folder, as many as are looked at, without hidden folders and `target`.
fn files_near(folder: &Path) -> Vec<PathBuf> {
    let (mut files, mut open) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let name = entry.file_name();
            let skipped =
                name.to_string_lossy().starts_with('.') || name == "target" || name == "node_modules";
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && !skipped => open.push(entry.path()),
                Ok(kind) if kind.is_file() => files.push(entry.path()),
                _ => {}
            }
        }
        if files.len() + open.len() > MOST_FILES {
            break;
        }
    }
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_and_its_uri_are_one() {
        for path in ["/a b/ä#%/x.ron", "/😀/[y].wgsl"] {
            let uri = uri_of_path(Path::new(path)).unwrap();
            assert_eq!(path_of_uri(&uri).unwrap(), Path::new(path), "{}", uri.as_str());
        }
        assert_eq!(path_of_uri(&Uri::from_str("untitled:Untitled-1").unwrap()), None);
        assert_eq!(
            path_of_uri(&Uri::from_str("file:///c%3A/x.ron").unwrap()).unwrap(),
            Path::new("c:/x.ron")
        );
    }
}
