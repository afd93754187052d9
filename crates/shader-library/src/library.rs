//! Requests for shaders, and the library that loads and keeps shaders.

use crate::codes;
use crate::compose::compose;
use crate::composed::Outline;
use crate::directive::Define;
use crate::files::ShaderFiles;
use crate::interface::TypeLayout;
use crate::settings;
use crate::shader::Shader;
use data_file::{Diagnostic, Diagnostics, Setting, Severity, Value};
use naga::valid::Capabilities;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// One variant of one shader.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Request {
    /// The path of the file.
    pub path: String,
    /// Values of the options that the file and its imports declare; the others have their defaults.
    pub defines: BTreeMap<String, Define>,
    /// For each name in `#import interface "name"`, the path of the module. Names that the shader does not import are
    /// ignored, so that a caller may give all modules it has.
    pub modules: BTreeMap<String, String>,
}

impl Request {
    /// Creates a request for the file at `path` with all options at their defaults.
    pub fn new(path: impl Into<String>) -> Self {
        Request { path: path.into(), ..Request::default() }
    }

    /// Adds a define: a value for an option.
    pub fn define(mut self, name: impl Into<String>, value: impl Into<Define>) -> Self {
        self.defines.insert(name.into(), value.into());
        self
    }

    /// Adds the module of an interface.
    pub fn module(mut self, interface: impl Into<String>, path: impl Into<String>) -> Self {
        self.modules.insert(interface.into(), path.into());
        self
    }
}

/// The greatest number of variants that [`Library::variants`] lists.
pub const MAX_VARIANTS: usize = 128;

/// Shaders by request, each loaded once and kept until one of its files changes.
pub struct Library {
    files: Arc<dyn ShaderFiles>,
    roots: Vec<String>,
    thread_order: Option<u32>,
    made: Mutex<BTreeMap<Request, Made>>,
    outlines: Mutex<BTreeMap<Request, MadeOutline>>,
    /// The WGSL below folders, and the header of each file.
    folders: Mutex<BTreeMap<String, Arc<[FileInfo]>>>,
    generation: AtomicU64,
}

#[derive(Clone)]
struct MadeOutline {
    outline: Result<Arc<Outline>, Diagnostics>,
    /// What the doc comments of `struct Settings` declare.
    settings: Result<Arc<[Setting]>, Diagnostics>,
    touched: BTreeSet<String>,
}

/// A WGSL file of a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileInfo {
    /// The path.
    pub path: String,
    /// The first paragraph of the comment with which it begins, without what stands in brackets at its end.
    pub about: String,
    /// The paper and its section, which stand there in brackets; empty without these.
    pub paper: String,
    /// Whether it has an entry point of its own.
    pub has_entries: bool,
}

impl FileInfo {
    fn new(path: String, text: &str) -> FileInfo {
        let lines = text.trim_start_matches('\u{feff}').lines();
        let comment = lines.map_while(|line| line.strip_prefix("//")).map(str::trim);
        let paragraph: Vec<&str> = comment.take_while(|line| !line.is_empty()).collect();
        let paragraph = paragraph.join(" ");
        let tag = paragraph.strip_suffix(']').and_then(|text| text.rsplit_once('['));
        let (about, paper) = tag.unwrap_or((&paragraph, ""));
        let has_entries = ["@compute", "@fragment", "@vertex"].iter().any(|stage| text.contains(stage));
        FileInfo { path, about: about.trim().to_owned(), paper: paper.to_owned(), has_entries }
    }
}

struct Made {
    shader: Result<Arc<Shader>, Diagnostics>,
    /// The paths that were looked for, found or not.
    touched: BTreeSet<String>,
}

impl Library {
    /// The capabilities that WebGPU itself allows and every adapter has: no 64-bit types, no `f16`, no subgroups, no
    /// texture atomics, no immediates. Also ray queries, which a shader must `enable` and
    /// [`GlobalKind::AccelerationStructure`](crate::GlobalKind::AccelerationStructure) shows: who runs it sees whether
    /// the adapter has them.
    pub const PORTABLE: Capabilities = Capabilities::MULTISAMPLED_SHADING
        .union(Capabilities::CUBE_ARRAY_TEXTURES)
        .union(Capabilities::SHADER_FLOAT16_IN_FLOAT32)
        .union(Capabilities::RAY_QUERY);

    /// Creates a library of `files`, whose imports are looked for beside the importing file and then at the root of all
    /// files, validated for [`Library::PORTABLE`].
    pub fn new(files: Arc<dyn ShaderFiles>) -> Self {
        Library {
            files,
            roots: vec![String::new()],
            thread_order: None,
            made: Mutex::default(),
            outlines: Mutex::default(),
            folders: Mutex::default(),
            generation: AtomicU64::new(0),
        }
    }

    /// Sets the folders in which imports are looked for, in this order, after the folder of the importing file.
    /// The empty path is the root of all files.
    pub fn with_roots<P: Into<String>>(mut self, roots: impl IntoIterator<Item = P>) -> Self {
        self.roots = roots.into_iter().map(Into::into).collect();
        self
    }

    /// Runs the workgroups of every compute entry point, and the threads in them, in another order, which `seed`
    /// chooses. A shader that is correct gives the same bits: this is for tests that show it.
    pub fn with_thread_order(mut self, seed: u32) -> Self {
        self.thread_order = Some(seed);
        self
    }

    /// Returns the files.
    pub fn files(&self) -> &Arc<dyn ShaderFiles> {
        &self.files
    }

    /// Returns the requested shader: composes, validates and reflects it, or returns the one that is kept.
    ///
    /// # Errors
    /// Everything that is wrong in the file or its imports, at the user's own lines. Errors are kept as shaders are.
    pub fn load(&self, request: &Request) -> Result<Arc<Shader>, Diagnostics> {
        if let Some(made) = lock(&self.made).get(request) {
            return made.shader.clone();
        }
        let generation = self.generation();
        let composing = tracing::info_span!(target: "phase", "shaders read and composed").entered();
        let (touched, composed) = compose(&*self.files, &self.roots, request, false);
        drop(composing);
        let shader = composed.and_then(|composed| Shader::new(composed, self.thread_order)).map(Arc::new);
        if let Err(errors) = &shader {
            tracing::debug!(path = request.path, errors = errors.0.len(), "shader refused");
        }
        let mut made = lock(&self.made);
        // What was read before a file changed is not kept for those who load it afterwards.
        if generation == self.generation() {
            made.insert(request.clone(), Made { shader: shader.clone(), touched });
        }
        shader
    }

    /// Returns what the request's file and its imports declare and ask for, or the outline that is kept. Needs no module
    /// for any interface.
    ///
    /// # Errors
    /// As [`Library::load`], but for what only WGSL's own grammar and types show.
    pub fn outline(&self, request: &Request) -> Result<Arc<Outline>, Diagnostics> {
        self.made_outline(request).outline
    }

    /// Returns what the doc comments of `struct Settings` declare in the request's file and its imports, in the order
    /// of its members. Reads comments alone: it needs no module for any interface, and is quick.
    ///
    /// # Errors
    /// As [`Library::outline`], and each declaration that cannot be read, at its place.
    pub fn settings(&self, request: &Request) -> Result<Arc<[Setting]>, Diagnostics> {
        self.made_outline(request).settings
    }

    fn made_outline(&self, request: &Request) -> MadeOutline {
        if let Some(made) = lock(&self.outlines).get(request) {
            return made.clone();
        }
        let generation = self.generation();
        let (touched, composed) = compose(&*self.files, &self.roots, request, true);
        let settings = composed.as_ref().map_err(Clone::clone);
        let settings = settings.and_then(|composed| settings::read(composed, None)).map(Arc::from);
        let outline = composed.map(|composed| Arc::new(composed.outline));
        let made = MadeOutline { outline, settings, touched };
        let mut outlines = lock(&self.outlines);
        if generation == self.generation() {
            outlines.insert(request.clone(), made.clone());
        }
        made
    }

    /// Returns the WGSL below a folder, sorted by path; files of tests apart.
    pub fn folder(&self, folder: &str) -> Arc<[FileInfo]> {
        if let Some(known) = lock(&self.folders).get(folder) {
            return Arc::clone(known);
        }
        let in_folder = |path: &String| {
            let below = path.strip_prefix(folder).and_then(|rest| rest.strip_prefix('/'));
            below.is_some_and(|rest| rest.ends_with(".wgsl") && !rest.starts_with("tests/"))
        };
        let mut paths: Vec<String> = self.files.list().into_iter().filter(in_folder).collect();
        paths.sort();
        let info = |path: String| Some(FileInfo::new(path.clone(), &self.files.read(&path)?.text));
        let files: Arc<[FileInfo]> = paths.into_iter().filter_map(info).collect();
        lock(&self.folders).insert(folder.to_owned(), Arc::clone(&files));
        files
    }

    /// Returns how often files have changed: what follows from WGSL stays right as long as this number stays.
    pub fn generation(&self) -> u64 {
        self.generation.load(Ordering::Relaxed)
    }

    /// Returns the content of a buffer of a struct that a file declares or imports, from which the size of the buffer
    /// follows. Options of the file have their defaults.
    ///
    /// # Errors
    /// As [`Library::load`]; and where there is no such struct.
    pub fn content(&self, file: &str, name: &str) -> Result<TypeLayout, Diagnostics> {
        let shader = self.load(&Request::new(file))?;
        let found = shader.interface.contents.iter().find(|content| content.ty == name).cloned();
        found.ok_or_else(|| {
            let names = shader.interface.contents.iter().map(|content| content.ty.as_str());
            absent(&shader, "struct", name, names)
        })
    }

    /// Returns a constant that a file declares or imports, from which sizes of dispatches and buffers follow. Options
    /// of the file have their defaults.
    ///
    /// # Errors
    /// As [`Library::load`]; and where there is no such constant, or it is no whole number.
    pub fn constant(&self, file: &str, name: &str) -> Result<u32, Diagnostics> {
        let shader = self.load(&Request::new(file))?;
        let found = shader.interface.constant(name).and_then(Value::as_u32);
        found.ok_or_else(|| {
            let constants = shader.interface.constants.iter();
            let whole = constants.filter(|(_, value)| value.as_u32().is_some());
            absent(&shader, "u32 constant", name, whole.map(|(name, _)| name.as_str()))
        })
    }

    /// Returns all variants of a request: each combination of the values that make a difference
    /// ([`ShaderOption::values`](crate::ShaderOption::values)) of the options it leaves open. Loading each of them
    /// validates the file completely.
    ///
    /// # Errors
    /// As [`Library::outline`]; and where there are more than [`MAX_VARIANTS`].
    pub fn variants(&self, request: &Request) -> Result<Vec<Request>, Diagnostics> {
        let mut variants = Vec::new();
        let mut open = vec![request.clone()];
        while let Some(request) = open.pop() {
            let outline = self.outline(&request)?;
            // Options are declared before they are requested: fixing the first open one never hides another
            // that is fixed already.
            let Some(option) =
                outline.options.iter().find(|option| !request.defines.contains_key(&option.name))
            else {
                variants.push(request);
                continue;
            };
            let values = option.values();
            if variants.len() + open.len() + values.len() > MAX_VARIANTS {
                let names: Vec<&str> = outline.options.iter().map(|option| option.name.as_str()).collect();
                return Err(Diagnostics(vec![Diagnostic {
                    code: codes::VARIANTS.code,
                    severity: Severity::Error,
                    message: format!("`{}` has more than {MAX_VARIANTS} variants", request.path),
                    labels: vec![data_file::Label { span: option.place.clone(), message: String::new() }],
                    notes: vec![
                        format!("its options are {}", names.join(", ")),
                        "choices that need no other code are cheaper as `override` or as settings".to_owned(),
                    ],
                }]));
            }
            open.extend(
                values.into_iter().rev().map(|value| request.clone().define(option.name.clone(), value)),
            );
        }
        Ok(variants)
    }

    /// Drops the shaders that were loaded from any of these paths, or that looked for one of them in vain, and returns
    /// their requests; the next [`Library::load`] loads them again.
    pub fn invalidate<P: AsRef<str>>(&self, paths: &[P]) -> Vec<Request> {
        self.generation.fetch_add(1, Ordering::Relaxed);
        lock(&self.folders).clear();
        lock(&self.outlines).retain(|_, made| !paths.iter().any(|path| made.touched.contains(path.as_ref())));
        let mut made = lock(&self.made);
        let stale: Vec<Request> = made
            .iter()
            .filter(|(_, made)| paths.iter().any(|path| made.touched.contains(path.as_ref())))
            .map(|(request, _)| request.clone())
            .collect();
        for request in &stale {
            made.remove(request);
        }
        stale
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The error that a shader declares no such thing.
fn absent<'a>(
    shader: &Shader,
    what: &str,
    name: &str,
    known: impl Iterator<Item = &'a str> + Clone,
) -> Diagnostics {
    let mut notes = Vec::new();
    if let Some(near) = data_file::nearest(name, known) {
        notes.push(format!("did you mean `{near}`?"));
    }
    Diagnostics(vec![Diagnostic {
        code: codes::NO_DECLARATION.code,
        severity: Severity::Error,
        message: format!("there is no {what} `{name}`"),
        labels: vec![data_file::Label {
            span: shader.start(),
            message: "in this file and its imports".to_owned(),
        }],
        notes,
    }])
}
