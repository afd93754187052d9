//! Makes one text of a file, its imports and the options' values, with the origin of each byte.

mod declare;

use crate::codes;
use crate::composed::{Composed, Import, Outline, ShaderOption, import_chain};
use crate::directive::{self, Define, Directive, Fault, Placed};
use crate::files::{self, ShaderFiles};
use crate::library::Request;
use crate::line_map::{LineMap, span};
use crate::port;
use crate::scan::Comments;
use data_file::paths::{OUTSIDE, may_name};
use data_file::{Diagnostic, Diagnostics, Label, Source, nearest};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// The greatest number of folders that an error lists.
const SHOWN_FOLDERS: usize = 4;

/// The longest shader with all that it imports, in bytes: fifty times the longest of this tree, and compiled in seconds
/// however it is made.
const MAX_BYTES: usize = 4 << 20;

/// The most errors that are reported of one shader: where all lines are wrong, each would be looked up among all files.
const MAX_ERRORS: usize = 100;

/// The directives that may have several lines.
const DECLARATIONS: [&str; 3] = ["#input", "#output", "#option"];

/// Deeper than any library, and far from the end of the stack.
const MAX_DEPTH: usize = 64;

/// Composes the request's file. Also gives, error or not, each path that was looked for: a change of any of
/// them can change the outcome. With `lenient`, interfaces without a module are left out.
pub(crate) fn compose(
    files: &dyn ShaderFiles,
    roots: &[String],
    request: &Request,
    lenient: bool,
) -> (BTreeSet<String>, Result<Composed, Diagnostics>) {
    let mut composer = Composer {
        files,
        roots,
        request,
        lenient,
        text: String::new(),
        map: LineMap::default(),
        outline: Outline::default(),
        origins: BTreeMap::new(),
        touched: BTreeSet::new(),
        read: BTreeMap::new(),
        errors: Vec::new(),
        enables: Vec::new(),
        depth: 0,
    };
    let main = composer.main();
    let Composer { text, map, outline, origins, touched, errors, .. } = composer;
    let result = match main {
        Some(main) if errors.is_empty() => {
            let values =
                outline.options.iter().map(|o| (o.name.clone(), given(request, o).clone())).collect();
            Ok(Composed { text, map, outline, origins, values, main })
        }
        _ => Err(Diagnostics(errors)),
    };
    (touched, result)
}

/// The value that the request gives to an option, or its default; a value of another type has been reported.
fn given<'a>(request: &'a Request, option: &'a ShaderOption) -> &'a Define {
    request
        .defines
        .get(&option.name)
        .filter(|value| value.same_type(&option.default))
        .unwrap_or(&option.default)
}

struct Composer<'a> {
    files: &'a dyn ShaderFiles,
    roots: &'a [String],
    request: &'a Request,
    lenient: bool,
    text: String,
    map: LineMap,
    outline: Outline,
    origins: BTreeMap<String, Option<Import>>,
    touched: BTreeSet<String>,
    /// The file at each path that was looked for, if there is one: a file can be imported by many lines.
    read: BTreeMap<String, Option<Arc<Source>>>,
    errors: Vec<Diagnostic>,
    /// `enable` lines of all files.
    enables: Vec<(Arc<Source>, Range<usize>)>,
    /// Files that are being read: each imports the next.
    depth: usize,
}

/// An `#if` that has not ended yet.
struct Branch {
    opened: Range<usize>,
    /// The lines around it are part of the text.
    outer: bool,
    /// The lines now are.
    active: bool,
    /// A branch has been chosen already.
    taken: bool,
    has_else: bool,
}

impl Composer<'_> {
    /// Composes the file asked for. Errors are in `self.errors`; `None` only beside one.
    fn main(&mut self) -> Option<Arc<Source>> {
        let request = self.request;
        let Some(main) = self.find("", &request.path) else {
            let mut notes = Vec::new();
            self.suggest_file(&request.path, false, &mut notes);
            let message = format!("there is no shader `{}`", request.path);
            self.errors.push(Diagnostic { notes, ..Diagnostic::new(&codes::MISSING_FILE, message) });
            return None;
        };
        self.include(&main, None);
        self.constants();
        self.enable();
        self.unknown_defines(&main);
        Some(main)
    }

    /// An option that is given and not declared is a slip of the pen. Asked only where all imports were read.
    fn unknown_defines(&mut self, main: &Arc<Source>) {
        let left_out = |interface| !self.request.modules.contains_key(interface);
        if !self.errors.is_empty() || self.outline.interfaces.iter().any(left_out) {
            return;
        }
        for name in self.request.defines.keys() {
            if self.outline.options.iter().any(|option| option.name == *name) {
                continue;
            }
            let known: Vec<&str> = self.outline.options.iter().map(|option| option.name.as_str()).collect();
            let mut notes = Vec::new();
            notes.extend(nearest(name, known.iter().copied()).map(|near| format!("did you mean `{near}`?")));
            notes.push(match known.as_slice() {
                [] => "it declares none; an option is declared by `#option NAME default`".to_owned(),
                known => format!("it declares {}", known.join(", ")),
            });
            let message = format!("`{}` has no option `{name}`", self.request.path);
            let labels = vec![Label { span: span(main, 0..0), message: String::new() }];
            self.errors.push(Diagnostic {
                labels,
                notes,
                ..Diagnostic::new(&codes::UNKNOWN_OPTION, message)
            });
        }
    }

    /// Adds options that are numbers or booleans as WGSL constants. They go to the end, where they cannot come
    /// before a directive such as `enable`.
    fn constants(&mut self) {
        for option in &self.outline.options {
            let value = given(self.request, option);
            if !matches!(value, Define::Text(_)) {
                let place = &option.place;
                self.map.made(self.text.len(), &place.source, place.start as usize..place.end as usize);
                self.text.push_str(&format!("const {} = {value};\n", option.name));
            }
        }
    }

    /// Puts the `enable` lines of all files where WGSL wants them: before all else, each once.
    fn enable(&mut self) {
        let mut head = String::new();
        let mut copies = Vec::new();
        let mut lines = BTreeSet::new();
        for (source, range) in std::mem::take(&mut self.enables) {
            let line = source.text[range.clone()].trim_end();
            if lines.insert(line.to_owned()) {
                head += &format!("{line}\n");
                copies.push((line.len() + 1, source.clone(), range));
            }
        }
        self.map.prepend(&copies);
        self.text.insert_str(0, &head);
    }

    fn fail(&mut self, source: &Arc<Source>, fault: Fault) {
        let labels = vec![Label { span: span(source, fault.range), message: fault.label }];
        let mut notes = fault.notes;
        notes.extend(import_chain(&self.origins, &source.name));
        self.errors.push(Diagnostic { labels, notes, ..Diagnostic::new(fault.code, fault.message) });
    }

    /// Appends a file, once.
    fn include(&mut self, source: &Arc<Source>, import: Option<Import>) {
        if self.origins.contains_key(&source.name) {
            return;
        }
        self.origins.insert(source.name.clone(), import);
        self.outline.files.push(source.name.clone());
        if source.text.len() > MAX_BYTES.saturating_sub(self.text.len()) {
            let message = format!("the shader is longer than {} MiB", MAX_BYTES >> 20);
            return self.fail(source, Fault::new(&codes::EXTENT, 0..0, message));
        }
        if self.depth == MAX_DEPTH {
            let message = format!("imports are nested more than {MAX_DEPTH} deep");
            return self.fail(source, Fault::new(&codes::DIRECTIVE, 0..0, message));
        }
        self.depth += 1;
        let mut branches: Vec<Branch> = Vec::new();
        let mut comments = Comments::default();
        let mut at = 0;
        // A byte order mark is not WGSL.
        let mut copied = if source.text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        while let Some(line) = source.text[at..].split_inclusive('\n').next() {
            if self.errors.len() >= MAX_ERRORS {
                break;
            }
            let start = at;
            let declares = DECLARATIONS.iter().any(|directive| line.trim_start().starts_with(directive));
            let line = if declares && comments.open.is_empty() {
                &source.text[at..at + port::extent(&source.text[at..], line.len())]
            } else {
                line
            };
            at += line.len();
            let active = branches.last().is_none_or(|branch| branch.active);
            let bare = if start == 0 { line.trim_start_matches('\u{feff}') } else { line };
            let enable = comments.open.is_empty() && bare.trim_start().starts_with("enable ");
            if !comments.open.is_empty() || !bare.trim_start().starts_with('#') {
                comments.scan(line, start);
                if enable && active {
                    self.copy(source, copied..start);
                    self.enables.push((source.clone(), at - bare.len()..at));
                    copied = at;
                }
                continue;
            }
            if active {
                self.copy(source, copied..start);
            }
            copied = at;
            let whole = start..start + line.trim_end().len();
            let result = match directive::parse(source, bare, at - bare.len()) {
                Ok(directive) => self.directive(directive, source, whole, &mut branches),
                Err(fault) => {
                    // A condition that cannot be read still has its `#endif`; nothing in it is looked at.
                    if bare.trim_start().starts_with("#if") {
                        branches.push(Branch {
                            opened: whole,
                            outer: false,
                            active: false,
                            taken: true,
                            has_else: false,
                        });
                    }
                    Err(fault)
                }
            };
            if let Err(fault) = result {
                self.fail(source, fault);
            }
        }
        if branches.last().is_none_or(|branch| branch.active) {
            self.copy(source, copied..at);
        }
        self.depth -= 1;
        let open = MAX_ERRORS - self.errors.len().min(MAX_ERRORS);
        for branch in branches.into_iter().take(open) {
            self.fail(source, Fault::new(&codes::UNBALANCED, branch.opened, "this `#if` has no `#endif`"));
        }
        if let Some(&open) = comments.open.first() {
            self.fail(
                source,
                Fault::new(&codes::COMMENT, open..open + 2, "this comment has no end")
                    .note("block comments nest: each `/*` wants its own `*/`"),
            );
        }
    }

    /// Appends a range of a file, and a newline where it ends without.
    fn copy(&mut self, source: &Arc<Source>, range: Range<usize>) {
        let Some(text) = source.text.get(range.clone()).filter(|text| !text.is_empty()) else { return };
        self.map.copied(self.text.len(), source, range.clone());
        self.text.push_str(text);
        if !text.ends_with('\n') {
            self.map.made(self.text.len(), source, range.end..range.end);
            self.text.push('\n');
        }
    }

    fn directive(
        &mut self,
        directive: Directive,
        source: &Arc<Source>,
        line: Range<usize>,
        branches: &mut Vec<Branch>,
    ) -> Result<(), Fault> {
        let active = branches.last().is_none_or(|branch| branch.active);
        let unbalanced =
            |name: &str| Fault::new(&codes::UNBALANCED, line.clone(), format!("`#{name}` without `#if`"));
        match directive {
            Directive::If(condition) => {
                // Pushed even if the condition is wrong: the `#endif` is there all the same.
                let holds = if active { self.condition(&condition) } else { Ok(false) };
                let holding = *holds.as_ref().unwrap_or(&false);
                let opened = line.clone();
                branches.push(Branch {
                    opened,
                    outer: active,
                    active: holding,
                    taken: holding,
                    has_else: false,
                });
                holds.map(|_| ())
            }
            Directive::Elif(condition) => {
                let branch = branches.last().ok_or_else(|| unbalanced("elif"))?;
                if branch.has_else {
                    return Err(Fault::new(&codes::UNBALANCED, line, "`#elif` after `#else`"));
                }
                let (outer, taken) = (branch.outer, branch.taken);
                let holds = if outer { self.condition(&condition) } else { Ok(false) };
                if let Some(branch) = branches.last_mut() {
                    branch.active = outer && !taken && *holds.as_ref().unwrap_or(&false);
                    branch.taken |= branch.active;
                }
                holds.map(|_| ())
            }
            Directive::Else => {
                let branch = branches.last_mut().ok_or_else(|| unbalanced("else"))?;
                if branch.has_else {
                    return Err(Fault::new(&codes::UNBALANCED, line, "a second `#else`"));
                }
                branch.active = branch.outer && !branch.taken;
                branch.has_else = true;
                Ok(())
            }
            Directive::Endif => branches.pop().map(|_| ()).ok_or_else(|| unbalanced("endif")),
            _ if !active => Ok(()),
            Directive::Import(path) => {
                self.inside(source, &path)?;
                let found = self.find(files::folder(&source.name), &path.value).ok_or_else(|| {
                    let mut fault = Fault::new(
                        &codes::MISSING_FILE,
                        path.range.clone(),
                        format!("there is no file `{}`", path.value),
                    );
                    self.suggest_file(&path.value, true, &mut fault.notes);
                    fault
                })?;
                self.include(&found, Some(Import { place: span(source, line), interface: None }));
                Ok(())
            }
            Directive::Interface(name) => self.interface(name, source, line),
            Directive::Option { name, values, internal, doc } => {
                self.option(name, values, (internal, doc), source, line)
            }
            Directive::Port { input, port, name } => self.port(input, port, name, line),
            Directive::Lights => {
                self.outline.lights = Some(span(source, line).to_string());
                Ok(())
            }
            Directive::Exact(declared) => self.exact(declared, line),
        }
    }

    /// Checks that an import leads to a file that the importing one may name.
    fn inside(&self, source: &Arc<Source>, path: &Placed<String>) -> Result<(), Fault> {
        let by = Path::new(&source.name);
        let outside = files::join(files::folder(&source.name), &path.value)
            .is_some_and(|imported| !may_name(by, Path::new(&imported), &self.files.roots()));
        if !outside {
            return Ok(());
        }
        let message = format!("the file `{}` {OUTSIDE}", path.value);
        Err(Fault::new(&codes::MISSING_FILE, path.range.clone(), message).label("outside"))
    }

    fn interface(
        &mut self,
        name: Placed<String>,
        source: &Arc<Source>,
        line: Range<usize>,
    ) -> Result<(), Fault> {
        self.outline.interfaces.insert(name.value.clone());
        let Some(path) = self.request.modules.get(&name.value) else {
            if self.lenient {
                return Ok(());
            }
            let message = format!("no module is given for the interface \"{}\"", name.value);
            let fault = Fault::new(&codes::INTERFACE, name.range, message);
            let given: Vec<&str> = self.request.modules.keys().map(String::as_str).collect();
            return Err(match nearest(&name.value, given.iter().copied()) {
                Some(near) => fault.note(format!("did you mean \"{near}\"?")),
                None if given.is_empty() => {
                    fault.note("modules come from the passes that make the inputs; none is connected")
                }
                None => fault.note(format!("given are \"{}\"", given.join("\", \""))),
            });
        };
        let found = self.find("", path).ok_or_else(|| {
            let message = format!("there is no file `{path}`");
            let mut fault = Fault::new(&codes::MISSING_FILE, name.range.clone(), message)
                .label(format!("the module of the interface \"{}\"", name.value));
            self.suggest_file(path, false, &mut fault.notes);
            fault
        })?;
        self.include(&found, Some(Import { place: span(source, line), interface: Some(name.value) }));
        Ok(())
    }

    /// Reads `path` from `folder`, or else from the first root that has it.
    fn find(&mut self, folder: &str, path: &str) -> Option<Arc<Source>> {
        let folders = std::iter::once(folder).chain(self.roots.iter().map(String::as_str));
        for candidate in folders.filter_map(|folder| files::join(folder, path)) {
            self.touched.insert(candidate.clone());
            let files = self.files;
            let found = self.read.entry(candidate).or_insert_with_key(|path| {
                let source = files.read(path)?;
                // One name for one file, however it was requested; imports are relative to it.
                Some(if source.name == *path { source } else { Source::new(path, source.text.as_str()) })
            });
            if let Some(source) = found {
                return Some(source.clone());
            }
        }
        None
    }

    /// Notes the path nearest to one that is not there, and where it was looked for: in the roots, and also
    /// `beside` the file that imports it.
    fn suggest_file(&self, path: &str, beside: bool, notes: &mut Vec<String>) {
        fn stem(path: &str) -> &str {
            path.strip_suffix(".wgsl").unwrap_or(path)
        }
        fn file_stem(path: &str) -> &str {
            stem(path.rsplit('/').next().unwrap_or_default())
        }
        let all = self.files.list();
        let wgsl = || all.iter().map(String::as_str).filter(|other| other.ends_with(".wgsl"));
        let near = nearest(stem(path), wgsl().map(stem)).map(|near| format!("{near}.wgsl")).or_else(|| {
            let near = nearest(file_stem(path), wgsl().map(file_stem))?;
            wgsl().find(|other| file_stem(other) == near).map(str::to_owned)
        });
        notes.extend(near.map(|near| format!("did you mean `{near}`?")));
        let roots = self.roots.iter().map(|root| if root.is_empty() { "the root" } else { root });
        let folders: Vec<&str> = beside
            .then_some("the file's own folder")
            .into_iter()
            .chain(roots)
            .chain(self.files.elsewhere())
            .collect();
        // The folders of interfaces are many, and no place for files of a user's own.
        let more = match folders.len() {
            0..=SHOWN_FOLDERS => String::new(),
            count => format!(", and in {} more", count - SHOWN_FOLDERS),
        };
        let shown = &folders[..folders.len().min(SHOWN_FOLDERS)];
        notes.push(format!("looked in {}{more}", shown.join(", then ")));
    }
}
