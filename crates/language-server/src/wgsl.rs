//! WGSL of passes and of users: errors, names, documentation.

use crate::info::interface;
use crate::offer::{Offer, takes};
use crate::workspace::Workspace;
use catalog::Catalog;
use data_file::{Diagnostic, Diagnostics, Source, Span};
use frame_graph::port::PassTypes as _;
use frame_graph::{Interface, Member};
use lsp_types::{CompletionItem, CompletionItemKind, Location};
use shader_library::{DeclaredPort, Outline, Request, codes};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// The most names that are offered of the files that one imports.
const MOST_NAMES: usize = 2000;
const DIRECTIVES: [&str; 10] = [
    "import \"\"",
    "import interface \"\"",
    "option ",
    "lights",
    "input ",
    "output ",
    "if ",
    "elif ",
    "else",
    "endif",
];
/// The words of the declaration of a setting.
const OF_SETTINGS: [&str; 6] = ["default", "min", "max", "unit", "one_of", "bool"];

/// Returns the main file of the pass that a file belongs to; the file itself outside of passes.
fn main_of(catalog: &Catalog, name: &str) -> String {
    let folder = name.strip_prefix("passes/").and_then(|rest| rest.split('/').next());
    let main = folder.map(|kind| format!("passes/{kind}/{kind}.wgsl"));
    main.filter(|main| catalog.assets().has(main)).unwrap_or_else(|| name.to_owned())
}

/// The ports and the comment of the main file of each pass type, as long as no shader changes.
#[derive(Default)]
pub(crate) struct PassTypes {
    generation: u64,
    declared: BTreeMap<String, (Outline, String)>,
}

/// Returns the ports that the main file of a pass type declares, whatever its options are, and the comment with which it
/// begins: quicker than to ask the pass type.
pub(crate) fn declared_by<T>(workspace: &Workspace, kind: &str, read: impl FnOnce(&Outline, &str) -> T) -> T {
    let mut known = workspace.pass_types.borrow_mut();
    let generation = workspace.catalog.shaders().generation();
    if known.generation != generation {
        *known = PassTypes { generation, ..PassTypes::default() };
    }
    let (outline, about) = known.declared.entry(kind.to_owned()).or_insert_with(|| {
        let source = workspace.source(&format!("passes/{kind}/{kind}.wgsl"));
        let outline = source.as_ref().map(Outline::of_broken).unwrap_or_default();
        (outline, source.map(|source| comment_at_start(&source.text)).unwrap_or_default())
    });
    read(outline, about)
}

/// Returns whether a file is of a pass type that takes its ports from a user's shader.
fn is_frame(catalog: &Catalog, name: &str) -> bool {
    let kind = name.strip_prefix("passes/").and_then(|rest| rest.split('/').next());
    kind.is_some_and(|kind| catalog.takes_shader(kind) == Some(true))
}

/// Returns what the main file declares; of one that is broken, what its lines do.
fn outline(workspace: &Workspace, name: &str) -> Option<Arc<Outline>> {
    let main = main_of(&workspace.catalog, name);
    let whole = workspace.catalog.shaders().outline(&Request::new(&*main)).ok();
    whole.or_else(|| Some(Arc::new(Outline::of_broken(&workspace.source(&main)?))))
}

/// Returns what is wrong with a file by itself, with its options at their defaults: composed with stand-ins for the
/// modules of interfaces, and validated by naga.
pub fn check(catalog: &Catalog, name: &str) -> Vec<Diagnostic> {
    let shaders = catalog.shaders();
    let outline = match shaders.outline(&Request::new(name)) {
        Ok(outline) => outline,
        Err(Diagnostics(errors)) => return within_others(catalog, name).unwrap_or(errors),
    };
    let mut found = Vec::new();
    for port in outline.inputs.iter().chain(&outline.outputs) {
        let known = catalog.interfaces().iter().map(|known| known.name).chain(["Texture", "Buffer", "Any"]);
        if port.place.source.name == name && !known.clone().any(|known| known == port.interface) {
            let message = format!("there is no interface `{}`", port.interface);
            let error = Diagnostic::new(&codes::DIRECTIVE, message).label(of_interface(port), "");
            found.push(error.suggest("interfaces", &port.interface, known));
        }
    }
    if !found.is_empty() {
        return found;
    }
    let main = main_of(catalog, name);
    let request = match pass::reflected::by_itself(shaders, catalog.interfaces(), name, &main) {
        Ok(request) => request,
        // Imports the shader of a user.
        Err(_) if is_frame(catalog, name) => return Vec::new(),
        Err(error) => {
            let text = catalog.assets().text(name).unwrap_or_default();
            let at = text.find("#import interface").unwrap_or(0);
            let end = text[at..].find('\n').map_or(text.len(), |end| at + end);
            let span = Span { source: Source::new(name, text), start: at as u32, end: end as u32 };
            let found = Diagnostic::new(&codes::INTERFACE, error.message).label(span, "");
            return vec![error.help.into_iter().fold(found, Diagnostic::note)];
        }
    };
    let shader = match shaders.load(&request) {
        Ok(shader) => shader,
        Err(Diagnostics(errors)) => return within_others(catalog, name).unwrap_or(errors),
    };
    let attributes = shader.attributes().err();
    let settings = shader.settings().err();
    [attributes, settings].into_iter().flatten().flat_map(|Diagnostics(errors)| errors).collect()
}

/// Returns the errors of a file where another one imports it: some name functions and options that their importers
/// declare.
/// `None` where there is no such file.
fn within_others(catalog: &Catalog, name: &str) -> Option<Vec<Diagnostic>> {
    let shaders = catalog.shaders();
    let mut errors = None;
    for path in importers(catalog, name) {
        let main = main_of(catalog, &path);
        let Ok(request) = pass::reflected::by_itself(shaders, catalog.interfaces(), &path, &main) else {
            continue;
        };
        // The import may stand within `#if`.
        let variants = shaders.variants(&request).unwrap_or_default().into_iter();
        let takes_part = |request: &Request| {
            shaders.outline(request).is_ok_and(|outline| outline.files.iter().any(|file| file == name))
        };
        let Some(request) = variants.into_iter().find(takes_part) else { continue };
        let Err(Diagnostics(found)) = shaders.load(&request) else { return Some(Vec::new()) };
        if found.iter().any(|error| error.labels.iter().any(|label| label.span.source.name == name)) {
            errors = Some(found);
        }
    }
    errors
}

/// The most files that import one that are looked at.
const MOST_IMPORTERS: usize = 24;

/// Returns files that import a file, directly or by others; the nearest first.
fn importers(catalog: &Catalog, name: &str) -> Vec<String> {
    let files = catalog.shaders().files();
    let texts: Vec<Arc<Source>> = files.list().iter().filter_map(|path| files.read(path)).collect();
    let mut found = vec![name.to_owned()];
    let mut next = 0;
    while let Some(written) =
        found.get(next).and_then(|path| path.rsplit('/').next()).map(|name| format!("{name}\""))
    {
        let is_import = |line: &str| line.starts_with("#import") && line.ends_with(&written);
        let imports = texts.iter().filter(|source| source.text.lines().any(is_import));
        let new: Vec<String> =
            imports.map(|source| source.name.clone()).filter(|path| !found.contains(path)).collect();
        found.extend(new);
        next += 1;
        if found.len() > MOST_IMPORTERS {
            break;
        }
    }
    found.into_iter().skip(1).take(MOST_IMPORTERS).collect()
}

/// Returns the place of the interface of a port, which stands behind the port's name.
fn of_interface(port: &DeclaredPort) -> Span {
    let text = &port.place.source.text;
    let start = text[port.place.end as usize..]
        .find(&port.interface)
        .map_or(port.place.start, |at| port.place.end + at as u32);
    Span { start, end: start + port.interface.len() as u32, ..port.place.clone() }
}

/// Returns the word that a byte is in, or at the end of.
fn word_at(text: &str, at: usize) -> Range<usize> {
    let part = |c: char| c == '_' || c.is_alphanumeric();
    let at = text.floor_char_boundary(at);
    let start = text[..at].trim_end_matches(part).len();
    start..text.len() - text[at..].trim_start_matches(part).len()
}

fn line_at(text: &str, at: usize) -> Range<usize> {
    let start = text[..at].rfind('\n').map_or(0, |start| start + 1);
    start..text[at..].find('\n').map_or(text.len(), |end| at + end)
}

/// Returns the file that an import of a file means.
fn imported(workspace: &Workspace, name: &str, path: &str) -> Option<String> {
    let beside = data_file::paths::beside(name, path);
    if let Some(beside) = beside.filter(|beside| workspace.assets().has(beside)) {
        return Some(beside);
    }
    let folders = workspace.catalog.interfaces().iter().filter_map(|known| known.folder);
    let mut all = ["shaders"].into_iter().chain(folders).map(|folder| format!("{folder}/{path}"));
    all.find(|name| workspace.assets().has(name))
        .or_else(|| workspace.assets().has(path).then(|| path.to_owned()))
}

/// Returns the quoted path of the import on the line of a byte.
fn import_at(text: &str, at: usize) -> Option<&str> {
    let line = &text[line_at(text, at)];
    line.trim_start().strip_prefix("#import")?.trim_start().strip_prefix('"')?.split('"').next()
}

/// Returns where a name is declared, in a file or in those that it imports.
pub(crate) fn declaration(workspace: &Workspace, file: &str, name: &str) -> Option<Location> {
    workspace.location(&declared(workspace, file, name)?)
}

fn declared(workspace: &Workspace, file: &str, name: &str) -> Option<Span> {
    let outline = workspace.catalog.shaders().outline(&Request::new(file)).ok();
    let imports = outline.iter().flat_map(|outline| outline.files.iter().map(String::as_str));
    let upper = name.to_uppercase();
    // A setting may be an option of the same name in capitals.
    [name, &upper].into_iter().find_map(|name| {
        std::iter::once(file).chain(imports.clone()).find_map(|file| {
            let source = workspace.source(file)?;
            let range = shader_library::declaration(&source.text, name)?;
            Some(Span { source, start: range.start as u32, end: range.end as u32 })
        })
    })
}

pub(crate) fn definition(workspace: &Workspace, (name, text): (&str, &str), at: usize) -> Option<Location> {
    if let Some(path) = import_at(text, at) {
        return workspace.start(&imported(workspace, name, path)?);
    }
    let word = &text[word_at(text, at)];
    if let Some(found) =
        Some(word).filter(|word| !word.is_empty()).and_then(|word| declaration(workspace, name, word))
    {
        return Some(found);
    }
    // The port whose member a global is.
    let outline = outline(workspace, name)?;
    let (port, ..) = bound(&workspace.catalog, &outline, word)?;
    workspace.location(&port.place)
}

/// Returns the port, its interface and the member that a global reads or writes.
fn bound<'o>(
    catalog: &'o Catalog,
    outline: &'o Outline,
    global: &str,
) -> Option<(&'o DeclaredPort, &'o Interface, Option<&'static Member>)> {
    let ports = outline.inputs.iter().chain(&outline.outputs);
    ports
        .filter_map(|port| {
            let member = match global.strip_prefix(&*port.name)? {
                "" => "",
                rest => rest.strip_prefix('_')?,
            };
            let known = catalog.interfaces().iter().find(|known| known.name == port.interface)?;
            Some((port, known, known.member(member)))
        })
        .max_by_key(|(port, ..)| port.name.len())
}

pub(crate) fn hover(
    workspace: &Workspace,
    (name, text): (&str, &str),
    at: usize,
) -> Option<(String, Range<usize>)> {
    let catalog = &workspace.catalog;
    if let Some(path) = import_at(text, at) {
        let file = imported(workspace, name, path)?;
        let about = comment_at_start(&workspace.source(&file)?.text);
        return Some((format!("`{file}`\n\n{about}"), line_at(text, at)));
    }
    let range = word_at(text, at);
    let word = Some(&text[range.clone()]).filter(|word| !word.is_empty())?;
    if let Some(known) = catalog.interfaces().iter().find(|known| known.name == word) {
        return Some((interface(known), range));
    }
    let request = Request::new(name);
    let outline = outline(workspace, name);
    if let Some(option) =
        outline.iter().flat_map(|outline| &outline.options).find(|option| option.name == word)
    {
        return Some((format!("`#option {} {}` {}", option.name, option.default, option.doc), range));
    }
    let settings = catalog.shaders().settings(&request).unwrap_or_default();
    let is_setting = |name: &str| shader_library::setting_name(word) == name;
    if let Some(setting) = settings.iter().find(|setting| is_setting(&setting.name)) {
        return Some((format!("**{}** {}\n\n{}", setting.name, takes(setting), setting.doc), range));
    }
    if let Some((port, known, member)) = outline.as_ref().and_then(|outline| bound(catalog, outline, word)) {
        let line = |member: &Member| pass::declaration::of_member(word, member.content).unwrap_or_default();
        let member = member.map_or(String::new(), |member| format!("\n\n`{}` {}", line(member), member.doc));
        return Some((format!("`{}: {}` {}{member}", port.name, known.name, port.doc), range));
    }
    let found = declared(workspace, name, word)?;
    let whole = &found.source.text;
    let line = line_at(whole, found.start as usize);
    let doc = comment_before(whole, line.start);
    Some((format!("```wgsl\n{}\n```\n{doc}\n\n{found}", whole[line].trim_end().trim_end_matches('{')), range))
}

fn comment(line: &str) -> Option<&str> {
    let line = line.trim();
    line.starts_with("//").then(|| line.trim_start_matches('/').trim())
}

/// Returns the first paragraph of the comment with which a text begins.
fn comment_at_start(text: &str) -> String {
    text.lines().map_while(comment).take_while(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
}

/// Returns the comment above a byte.
fn comment_before(text: &str, at: usize) -> String {
    let mut lines: Vec<&str> = text[..at].lines().rev().map_while(comment).collect();
    lines.reverse();
    lines.join("\n")
}

/// Returns what may be typed at a byte of a WGSL file.
pub(crate) fn completion(
    workspace: &Workspace,
    (name, text): (&str, &str),
    at: usize,
) -> Vec<CompletionItem> {
    let catalog = &workspace.catalog;
    let at = text.floor_char_boundary(at);
    let line = line_at(text, at);
    let before = &text[line.start..at];
    let trimmed = before.trim_start();
    let word = word_at(text, at);
    let word = word.start..at;
    let quoted = || before.rfind('"').map_or(word.clone(), |quote| line.start + quote + 1..at);
    let interfaces = || -> Vec<Offer> {
        let all = catalog.interfaces().iter();
        all.map(|known| Offer::new(known.name, CompletionItemKind::INTERFACE).doc(known.doc)).collect()
    };
    let outline = outline(workspace, name);
    let (range, offers) = if trimmed.starts_with("#import interface") {
        let ports = outline.iter().flat_map(|outline| &outline.inputs);
        let has_module = |port: &&DeclaredPort| {
            catalog.interfaces().iter().any(|known| known.name == port.interface && known.stand_in.is_some())
        };
        let offer = |port: &DeclaredPort| Offer::new(&*port.name, CompletionItemKind::FIELD).doc(&*port.doc);
        (quoted(), ports.filter(has_module).map(offer).collect())
    } else if trimmed.starts_with("#import") {
        (quoted(), importable(workspace, name))
    } else if let Some(typed) = trimmed.strip_prefix('#').filter(|typed| !typed.contains(' ')) {
        let all = DIRECTIVES.iter().map(|word| Offer::new(*word, CompletionItemKind::KEYWORD));
        (at - typed.len()..at, all.collect())
    } else if (trimmed.starts_with("#input") || trimmed.starts_with("#output")) && before.contains(':') {
        (word, interfaces())
    } else if trimmed.starts_with("///") {
        let inside = before.rfind('[').is_some_and(|open| !before[open..].contains(']'));
        let words = shader_library::ATTRIBUTES.iter().chain(&OF_SETTINGS).filter(|_| inside);
        (word, words.map(|word| Offer::new(*word, CompletionItemKind::KEYWORD)).collect())
    } else if trimmed.starts_with("//") {
        return Vec::new();
    } else if text[..word.start].ends_with("settings.") {
        let settings = catalog.shaders().settings(&Request::new(name)).unwrap_or_default();
        let offer = |setting: &data_file::Setting| {
            Offer::new(&*setting.name, CompletionItemKind::PROPERTY).detail(takes(setting)).doc(&*setting.doc)
        };
        (word, settings.iter().map(offer).collect())
    } else {
        (word, names(workspace, name, outline.as_deref()))
    };
    let items = offers.into_iter().enumerate();
    items
        .map(|(order, offer)| {
            let name = offer.name.clone();
            offer.item(text, range.clone(), name, order)
        })
        .collect()
}

/// Returns the files that a file may import, as it names them.
fn importable(workspace: &Workspace, name: &str) -> Vec<Offer> {
    let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder);
    let of_interfaces = workspace.catalog.interfaces().iter().filter_map(|known| known.folder);
    let folders: Vec<&str> = [folder, "shaders"].into_iter().chain(of_interfaces).collect();
    let names = workspace.names("wgsl").into_iter().filter(|other| other != name);
    let short = |path: String| {
        let rest = folders.iter().find_map(|folder| path.strip_prefix(folder)?.strip_prefix('/'));
        rest.map(str::to_owned).filter(|rest| !rest.starts_with("tests/"))
    };
    names.filter_map(short).map(|path| Offer::new(path, CompletionItemKind::FILE)).collect()
}

/// Returns the globals that ports give, those of the scene, and what a file and its imports declare.
fn names(workspace: &Workspace, name: &str, outline: Option<&Outline>) -> Vec<Offer> {
    let catalog = &workspace.catalog;
    let mut found = Vec::new();
    let ports = outline.iter().flat_map(|outline| outline.inputs.iter().chain(&outline.outputs));
    for port in ports {
        let known = catalog.interfaces().iter().find(|known| known.name == port.interface);
        for member in known.into_iter().flat_map(|known| known.members) {
            let global = pass::declaration::global(&port.name, member.name);
            let line = pass::declaration::of_member(&global, member.content);
            let detail = format!("{}: {}", port.interface, line.unwrap_or_default());
            let offer = Offer::new(global, CompletionItemKind::VARIABLE);
            found.push(offer.detail(detail).doc(member.doc));
        }
    }
    let scene = pass::scene_bindings::GLOBALS.iter();
    found.extend(
        scene.map(|(name, _)| Offer::new(*name, CompletionItemKind::VARIABLE).detail("scene binding")),
    );
    let imports = outline.iter().flat_map(|outline| outline.files.iter().map(String::as_str));
    let mut files: Vec<&str> = std::iter::once(name).chain(imports).collect();
    files.dedup();
    for file in files {
        let Some(source) = workspace.source(file) else { continue };
        let short = Path::new(file).file_name().map(|name| name.to_string_lossy().into_owned());
        for (keyword, name) in shader_library::declared(&source.text) {
            let kind = match keyword {
                "fn" => CompletionItemKind::FUNCTION,
                "struct" | "alias" => CompletionItemKind::STRUCT,
                "var" => CompletionItemKind::VARIABLE,
                _ => CompletionItemKind::CONSTANT,
            };
            found.push(Offer::new(name, kind).detail(short.clone().unwrap_or_default()));
        }
    }
    found.truncate(MOST_NAMES);
    found
}
