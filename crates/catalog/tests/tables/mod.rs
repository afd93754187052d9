//! Tables in documents that repeat what WGSL, Rust and RON declare. With `LIGHTLOOM_BLESS` set, as by
//! `cargo xtask docs`, they are written; without, the test fails where they are out of date.

mod results;

use super::{assets, passes, use_of};
use catalog::Catalog;
use frame_graph::port::PassTypes;
use frame_graph::{Content, Interface, Overrides, Setting, Value};
use pass::{FromWgsl, Pass};
use shader_library::Item;
use std::collections::BTreeSet;
use std::path::Path;

/// A table: the document, the name in its markers, and the text between these.
type Table = (String, &'static str, String);

#[test]
fn tables_of_documents_are_up_to_date() {
    let catalog = Catalog::new(assets());
    let mut tables: Vec<Table> = passes(&catalog)
        .map(|(kind, settings)| {
            (format!("passes/{kind}/README.md"), "declared", pass_table(&catalog, kind, &settings))
        })
        .collect();
    tables.push(("crates/interfaces/README.md".to_owned(), "interfaces", interface_table(&catalog)));
    tables.push(("docs/interfaces.md".to_owned(), "members", interface_page(&catalog)));
    tables.push(("docs/wgsl.md".to_owned(), "functions", library_page(&catalog)));
    tables.push(("pipelines/README.md".to_owned(), "pipelines", pipeline_table(&catalog, true)));
    tables.push(("README.md".to_owned(), "pipelines", pipeline_table(&catalog, false)));

    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let studies = results::studies(&root);
    tables.push(("docs/results.md".to_owned(), "findings", results::table(&root, &studies)));
    tables.push(("studies/README.md".to_owned(), "studies", results::studies_table(&root, &studies)));
    let bless = std::env::var_os("LIGHTLOOM_BLESS").is_some();
    let mut stale = Vec::new();
    for (path, name, table) in &tables {
        let text = results::read(&root.join(path));
        let up_to_date = with_table(&text, name, table)
            .unwrap_or_else(|| panic!("{path}: there are no lines `{}` and `{}`", begin(name), end(name)));
        if text == up_to_date {
            continue;
        }
        if bless {
            std::fs::write(root.join(path), up_to_date).unwrap_or_else(|error| panic!("{path}: {error}"));
        } else {
            stale.push(path.as_str());
        }
    }
    assert!(stale.is_empty(), "`cargo xtask docs` writes the tables of {}", stale.join(", "));
}

fn begin(name: &str) -> String {
    format!("<!-- {name}: written by cargo xtask docs -->\n")
}

fn end(name: &str) -> String {
    format!("<!-- end of {name} -->\n")
}

/// Returns the document with another text between the markers of that name; `None` where it lacks them.
fn with_table(document: &str, name: &str, table: &str) -> Option<String> {
    let (before, rest) = document.split_once(&begin(name))?;
    let (_, after) = rest.split_once(&end(name))?;
    Some([before, &begin(name), table, &end(name), after].concat())
}

/// Returns a text whose units in brackets are not taken for links to items by rustdoc, which has some of these pages too.
fn escaped(text: &str) -> String {
    if text.contains("](") { text.to_owned() } else { text.replace('[', "\\[").replace(']', "\\]") }
}

fn row(cells: &[&str]) -> String {
    let cells: Vec<String> =
        cells.iter().map(|cell| escaped(&cell.replace('|', "\\|").replace('\n', " "))).collect();
    format!("| {} |\n", cells.join(" | ")).replace("|  |", "| |")
}

fn head(columns: &[&str]) -> String {
    row(columns) + &"|---".repeat(columns.len()) + "|\n"
}

/// Returns the summary of a pass, its ports and its settings.
fn pass_table(catalog: &Catalog, kind: &str, settings: &[Setting]) -> String {
    let about = catalog.pass(kind).expect("a pass of the catalog").about(catalog.shaders());
    let paper = if about.paper.is_empty() { String::new() } else { format!(" ({})", about.paper) };
    let mut text = format!("{}{paper}.\n\n", about.about.trim_end_matches('.'));
    text += &head(&["port", "interface", ""]);
    for port in catalog.ports_of(kind).unwrap_or_else(|error| panic!("{kind}: {error:?}")) {
        let direction = if port.is_output { "out" } else { "in" };
        let interface = format!("{}{}", port.interface, port.condition);
        text += &row(&[&format!("{direction} `{}`", port.name), &interface, &port.doc]);
    }
    if !settings.is_empty() {
        text += "\n";
        text += &head(&["setting", "default", "range", ""]);
    }
    for setting in settings {
        let name = format!("`{}`", setting.name);
        text += &row(&[&name, &default(setting), &range(setting), &setting.doc]);
    }
    text
}

/// Returns a value as a table states it: `64`, `runs`, `0.5`.
fn shown(value: &Value) -> String {
    match value {
        Value::Text(word) => format!("`{word}`"),
        Value::F32(number) => number.to_string(),
        other => other.to_string(),
    }
}

fn default(setting: &Setting) -> String {
    format!("{} {}", shown(&setting.default), setting.unit).trim_end().to_owned()
}

fn range(setting: &Setting) -> String {
    match (setting.min, setting.max) {
        _ if !setting.one_of.is_empty() => setting.one_of.iter().map(shown).collect::<Vec<_>>().join(", "),
        (Some(min), Some(max)) => format!("{min} to {max}"),
        (Some(min), None) => format!("at least {min}"),
        (None, Some(max)) => format!("at most {max}"),
        (None, None) => String::new(),
    }
}

/// Returns all interfaces, with the passes that output them and those that read them.
fn interface_table(catalog: &Catalog) -> String {
    let mut text = head(&["interface", "holds", "output of", "input of"]);
    for interface in sorted(catalog) {
        let with = |is_output| {
            let kinds = catalog.passes_with(interface.name, is_output);
            kinds.unwrap_or_else(|error| panic!("{error:?}")).join(", ")
        };
        let name = interface.name;
        let link = format!("[`{name}`](../../docs/interfaces.md#{})", name.to_lowercase());
        text += &row(&[&link, interface.doc, &with(true), &with(false)]);
    }
    text
}

fn sorted(catalog: &Catalog) -> Vec<&Interface> {
    let mut interfaces: Vec<_> = catalog.interfaces().iter().collect();
    interfaces.sort_by_key(|interface| interface.name);
    interfaces
}

/// Returns the members of all interfaces, as a shader declares them.
fn interface_page(catalog: &Catalog) -> String {
    let mut text = String::new();
    for interface in sorted(catalog) {
        text += &format!("## {}\n\n{}\n\n", interface.name, escaped(interface.doc));
        text += &head(&["member", "format", "declaration", "what it holds"]);
        for member in interface.members {
            let name = if member.name.is_empty() { "the only one" } else { &format!("`{}`", member.name) };
            let optional = if member.optional { ", optional" } else { "" };
            let global = pass::declaration::global("PORT", member.name);
            let line = pass::declaration::of_member(&global, member.content);
            let line = line.map_or(String::new(), |line| format!("`{line}`"));
            let format = pass::declaration::format_of(member.content);
            text += &row(&[&format!("{name}{optional}"), &format, &line, member.doc]);
        }
        if !interface.facts.is_empty() {
            text += "\n";
            text += &head(&["fact", "type", ""]);
        }
        for fact in interface.facts {
            let optional = if fact.optional { ", optional" } else { "" };
            text += &row(&[&format!("`{}`{optional}", fact.name), &fact.ty.to_string(), fact.doc]);
        }
        if !interface.outputs.is_empty() {
            let outputs: Vec<String> = interface.outputs.iter().map(|name| format!("`{name}`")).collect();
            text += &format!("\nOutputs of pipelines that hold it: {}.\n", outputs.join(", "));
        }
        for member in interface.members {
            if let Content::Struct(of) = member.content {
                let file = of.file.rsplit('/').next().unwrap_or_default();
                text += &format!("\n`#import \"{file}\"` declares\n\n{}", wgsl(&catalog.structs_of(member)));
            }
        }
        text += "\n";
    }
    text
}

fn wgsl<'i>(items: impl IntoIterator<Item = &'i Item>) -> String {
    let all: Vec<&str> = items.into_iter().map(|item| item.declaration.as_str()).collect();
    format!("```wgsl\n{}\n```\n", all.join("\n\n"))
}

/// Returns the functions and structs of the WGSL that passes share.
fn library_page(catalog: &Catalog) -> String {
    let mut text = String::new();
    for file in catalog.shared_files() {
        let paper = if file.paper.is_empty() { String::new() } else { format!(" ({})", file.paper) };
        text += &format!("## {}\n\n{}{paper}\n\n", file.name, escaped(&file.about));
        let (functions, structs): (Vec<_>, Vec<_>) = file.items.iter().partition(|item| item.keyword == "fn");
        if !functions.is_empty() {
            text += &head(&["function", "what it does"]);
            for item in functions {
                let signature = item.declaration.strip_prefix("fn ").unwrap_or_default();
                text += &row(&[&format!("`{signature}`"), &item.doc]);
            }
            text += "\n";
        }
        if !structs.is_empty() {
            text += &wgsl(structs);
            text += "\n";
        }
    }
    text
}

#[test]
fn every_function_that_passes_share_says_what_it_does() {
    let files = Catalog::new(assets()).shared_files();
    let functions = files.iter().flat_map(|file| file.items.iter().map(move |item| (&file.name, item)));
    let silent = functions.filter(|(_, item)| item.keyword == "fn" && item.doc.is_empty());
    let silent: Vec<String> = silent.map(|(file, item)| format!("{file}: {}", item.name)).collect();
    assert!(silent.is_empty(), "without a doc comment:\n{}", silent.join("\n"));
}

/// Returns all pipelines with their papers; with links to the files, and what each extends, for the folder's own page.
fn pipeline_table(catalog: &Catalog, with_files: bool) -> String {
    let columns = ["pipeline", "paper", "extends", "renders"];
    let columns: Vec<&str> =
        columns.into_iter().filter(|column| with_files || *column != "extends").collect();
    let mut text = head(&columns);
    for pipeline in catalog.list_pipelines() {
        let name = &pipeline.name;
        let resolved = frame_graph::resolve(name, catalog.pipelines(), &Overrides::default())
            .unwrap_or_else(|errors| panic!("{errors}"));
        let paper = resolved.paper().unwrap_or_default();
        let about = pipeline.about.unwrap_or_default();
        let file = assets().text(&format!("pipelines/{name}.ron")).expect("a file of the list");
        let extends = file.split_once("extends: \"").and_then(|(_, rest)| rest.split_once(".ron\""));
        let extends = extends.map(|(base, _)| format!("`{base}`")).unwrap_or_default();
        if with_files {
            text += &row(&[&format!("[{name}]({name}.ron)"), paper, &extends, &about]);
        } else {
            text += &row(&[&format!("`{name}`"), paper, &about]);
        }
    }
    text
}

/// What `cargo xtask new-pass` copies has the tables that it declares, under whatever name.
#[test]
fn the_template_of_passes_has_its_tables() {
    static TEMPLATE: FromWgsl = FromWgsl::new("new-pass", "passes/new-pass/src/lib.rs");
    let text = |file: &str| assets().text(&format!("tools/new-pass/{file}")).expect("a file of the template");
    let shader = text("new-pass.wgsl").leak();
    let assets = assets().with_files([("passes/new-pass/new-pass.wgsl", &*shader)]);
    let catalog = Catalog::with_passes(assets, [&TEMPLATE as &dyn Pass]).expect("a name that no pass has");
    let settings = catalog.settings(use_of("new-pass")).unwrap_or_else(|error| panic!("{error:?}"));
    let (readme, table) = (text("README.md"), pass_table(&catalog, "new-pass", &settings));
    assert_eq!(with_table(&readme, "declared", &table).as_ref(), Some(&readme), "it must be\n{table}");
}

/// The pages say how a shader declares a member as the shaders of the tree do.
#[test]
fn declarations_of_members_are_those_of_the_passes() {
    let catalog = Catalog::new(assets());
    let mut compared = BTreeSet::new();
    for (kind, _) in passes(&catalog) {
        let folder = catalog.shaders().folder(&format!("passes/{kind}"));
        let texts: Vec<String> = folder.iter().filter_map(|file| assets().text(&file.path)).collect();
        for port in catalog.ports_of(kind).unwrap_or_else(|error| panic!("{kind}: {error:?}")) {
            let interface = catalog.interfaces().iter().find(|known| known.name == port.interface);
            for member in interface.into_iter().flat_map(|known| known.members).filter(|_| !port.is_output) {
                let global = pass::declaration::global(&port.name, member.name);
                let Some(line) = pass::declaration::of_member(&global, member.content) else { continue };
                let (head, _) = line.split_once(':').expect("a declaration");
                let declared = texts.iter().flat_map(|text| text.lines());
                for declared in declared.filter(|line| line.starts_with(&format!("{head}:"))) {
                    assert_eq!(declared, line, "{kind}");
                    compared.insert((interface.map(|known| known.name), member.name));
                }
            }
        }
    }
    let all = catalog.interfaces().iter().flat_map(|known| known.members).count();
    assert!(compared.len() > all / 2, "{} of {all} members are read: {compared:?}", compared.len());
}
