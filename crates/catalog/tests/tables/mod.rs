//! Tables in documents that repeat what WGSL, Rust and RON declare. With `LIGHTLOOM_BLESS` set, as by
//! `cargo xtask docs`, they are written; without, the test fails where they are out of date.

use super::{assets, passes, use_of};
use catalog::Catalog;
use frame_graph::port::PassTypes;
use frame_graph::{Overrides, Ports, Setting, Settings, Value};
use pass::{FromWgsl, Pass};
use std::collections::BTreeMap;
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
    tables.push(("pipelines/README.md".to_owned(), "pipelines", pipeline_table(&catalog, true)));
    tables.push(("README.md".to_owned(), "pipelines", pipeline_table(&catalog, false)));

    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let bless = std::env::var_os("LIGHTLOOM_BLESS").is_some();
    let mut stale = Vec::new();
    for (path, name, table) in &tables {
        let text = std::fs::read_to_string(root.join(path)).unwrap_or_else(|error| panic!("{path}: {error}"));
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

fn row(cells: &[&str]) -> String {
    // A unit in brackets would be taken for a link to an item by rustdoc, which has these pages too.
    let brackets = |cell: String| {
        if cell.contains("](") { cell } else { cell.replace('[', "\\[").replace(']', "\\]") }
    };
    let cells: Vec<String> =
        cells.iter().map(|cell| brackets(cell.replace('|', "\\|").replace('\n', " "))).collect();
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
    for port in ports(catalog, kind, settings) {
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

/// A port of a pass.
struct Port {
    name: String,
    interface: String,
    doc: String,
    is_output: bool,
    /// `, optional`, or the setting with which there is such a port.
    condition: String,
}

/// Returns the ports that a pass has by default, and those that it has with another value of one setting.
fn ports(catalog: &Catalog, kind: &str, settings: &[Setting]) -> Vec<Port> {
    let with = |changed: Option<(&str, Value)>| {
        let mut values: BTreeMap<String, Value> =
            settings.iter().map(|setting| (setting.name.clone(), setting.default.clone())).collect();
        values.extend(changed.map(|(name, value)| (name.to_owned(), value)));
        let ports = catalog.ports(use_of(kind), &Settings(values));
        ports.unwrap_or_else(|error| panic!("{kind}: {error:?}"))
    };
    let listed = |ports: &Ports, condition: &str| -> Vec<Port> {
        let inputs = ports.inputs.iter().map(|port| Port {
            name: port.name.clone(),
            interface: port.interface.clone(),
            doc: port.doc.clone(),
            is_output: false,
            condition: if port.optional { ", optional".to_owned() } else { condition.to_owned() },
        });
        let outputs = ports.outputs.iter().map(|port| Port {
            name: port.name.clone(),
            interface: port.interface.clone(),
            doc: port.doc.clone(),
            is_output: true,
            condition: condition.to_owned(),
        });
        inputs.chain(outputs).collect()
    };
    let mut all = listed(&with(None), "");
    for setting in settings {
        let values = match &setting.default {
            Value::Bool(on) => vec![Value::Bool(!on)],
            _ => setting.one_of.to_vec(),
        };
        for value in values {
            let condition = format!(", with `{}: {value}`", setting.name);
            let ports = listed(&with(Some((&setting.name, value))), &condition);
            let new = ports.into_iter().filter(|port| {
                !all.iter().any(|known| known.name == port.name && known.is_output == port.is_output)
            });
            let new: Vec<Port> = new.collect();
            all.extend(new);
        }
    }
    all
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
    let ports: Vec<(&str, Vec<Port>)> =
        passes(catalog).map(|(kind, settings)| (kind, ports(catalog, kind, &settings))).collect();
    let mut interfaces: Vec<_> = catalog.interfaces().iter().collect();
    interfaces.sort_by_key(|interface| interface.name);
    let mut text = head(&["interface", "holds", "output of", "input of"]);
    for interface in interfaces {
        let with = |is_output: bool| {
            let is_it = |port: &Port| port.interface == interface.name && port.is_output == is_output;
            let kinds = ports.iter().filter(|(_, ports)| ports.iter().any(is_it)).map(|(kind, _)| *kind);
            kinds.collect::<Vec<_>>().join(", ")
        };
        let (outputs, inputs) = (with(true), with(false));
        text += &row(&[&format!("`{}`", interface.name), interface.doc, &outputs, &inputs]);
    }
    text
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
