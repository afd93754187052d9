//! `lightloom passes`: the pass types.

use crate::context::{Context, unknown};
use crate::output::{self, stdout};
use anyhow::Result;
use frame_graph::port::PassTypes;
use frame_graph::{FactDecl, Interface, Ports, Setting, Settings, Use};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// List the pass types, or show one.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  lightloom passes gather")]
pub(crate) struct Args {
    /// A pass type
    kind: Option<String>,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let shaders = context.catalog.shaders();
    let Some(name) = &args.kind else {
        let passes = context.catalog.passes().iter();
        let all = passes.map(|pass| (pass.kind(), pass.about(shaders)));
        if context.json {
            let rows: Vec<Value> = all
                .map(|(kind, about)| json!({ "kind": kind, "about": about.about, "paper": about.paper }))
                .collect();
            output::json(&Value::Array(rows));
        } else {
            for (kind, about) in all {
                let paper =
                    if about.paper.is_empty() { String::new() } else { format!(" [{}]", about.paper) };
                stdout!("{kind:<26} {}{paper}", about.about);
            }
        }
        return Ok(());
    };
    let Some(pass) = context.catalog.pass(name) else {
        let names = context.catalog.names();
        return Err(unknown("pass type", name, &names, "passes"));
    };
    let (kind, about) = (pass.kind(), pass.about(shaders));
    let outputs = BTreeMap::new();
    let use_ = Use { kind, shader: None, inputs: &[], outputs: &outputs };
    if pass.takes_shader() {
        stdout!(
            "{}: {}\nports and settings are those of the WGSL file that `shader:` names; an output has the facts of the\n\
             inputs of its interface, unless `Out(facts: …)` states others",
            kind,
            about.about
        );
        return Ok(());
    }
    let settings = context.catalog.settings(use_).map_err(|error| anyhow::anyhow!(error.message))?;
    let ports = context
        .catalog
        .ports(use_, &Settings::defaults(&settings))
        .map_err(|error| anyhow::anyhow!(error.message))?;
    if context.json {
        output::json(&as_json(kind, &about, &settings, &ports, context.catalog.interfaces()));
    } else {
        stdout!("{}", as_text(kind, &about, &settings, &ports, context.catalog.interfaces()));
    }
    Ok(())
}

fn range(setting: &Setting) -> String {
    if !setting.one_of.is_empty() {
        return setting.one_of.iter().map(ToString::to_string).collect::<Vec<_>>().join(" | ");
    }
    match (setting.min, setting.max) {
        (Some(min), Some(max)) => format!("{min} to {max}"),
        (Some(min), None) => format!("at least {min}"),
        (None, Some(max)) => format!("at most {max}"),
        (None, None) => String::new(),
    }
}

/// Returns the facts that an interface declares.
fn facts<'a>(interfaces: &'a [Interface], name: &str) -> &'a [FactDecl] {
    interfaces.iter().find(|interface| interface.name == name).map_or(&[][..], |interface| interface.facts)
}

fn as_text(
    kind: &str,
    about: &pass::About,
    settings: &[Setting],
    ports: &Ports,
    interfaces: &[Interface],
) -> String {
    let mut lines = vec![format!("{}: {}", kind, about.about)];
    if !about.paper.is_empty() {
        lines.push(format!("paper: {}", about.paper));
    }
    lines.push("inputs".to_owned());
    for port in &ports.inputs {
        let optional = if port.optional { " (optional)" } else { "" };
        lines.push(format!("  {:<18} {:<20} {}{optional}", port.name, port.interface, port.doc));
    }
    lines.push("outputs".to_owned());
    for port in &ports.outputs {
        lines.push(format!("  {:<18} {:<20} {}", port.name, port.interface, port.doc));
        for fact in facts(interfaces, &port.interface) {
            let optional = if fact.optional { " (optional)" } else { "" };
            lines.push(format!("  {:<18} fact {:<15} {}{optional}", "", fact.name, fact.doc));
        }
    }
    lines.push("settings".to_owned());
    lines.extend(settings.iter().map(|setting| setting_text(&setting.name, setting, &setting.default)));
    lines.join("\n")
}

/// Returns two lines about a setting: its type, value and range, and what it does.
pub(super) fn setting_text(name: &str, setting: &Setting, value: &frame_graph::Value) -> String {
    let unit = if setting.unit.is_empty() { String::new() } else { format!(" {}", setting.unit) };
    let (ty, range) = (setting.ty, range(setting));
    format!("  {name:<18} {ty} = {value}{unit}  {range}\n  {:<18} {}", "", setting.doc)
}

/// Returns a setting for programs, with the value that it has.
pub(super) fn setting_json(name: &str, setting: &Setting, value: &frame_graph::Value) -> Value {
    json!({
        "name": name,
        "type": setting.ty.to_string(),
        "default": value.to_string(),
        "min": setting.min,
        "max": setting.max,
        "one_of": setting.one_of.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "unit": setting.unit,
        "doc": setting.doc,
    })
}

fn as_json(
    kind: &str,
    about: &pass::About,
    settings: &[Setting],
    ports: &Ports,
    interfaces: &[Interface],
) -> Value {
    let facts_of = |name: &str| -> Vec<Value> {
        let facts = facts(interfaces, name).iter();
        facts.map(|fact| json!({ "name": fact.name, "type": fact.ty.to_string(), "optional": fact.optional, "doc": fact.doc })).collect()
    };
    json!({
        "kind": kind,
        "about": about.about,
        "paper": about.paper,
        "shaders": about.shaders,
        "inputs": ports.inputs.iter().map(|port| json!({ "name": port.name, "interface": port.interface, "optional": port.optional, "doc": port.doc })).collect::<Vec<_>>(),
        "outputs": ports.outputs.iter().map(|port| json!({ "name": port.name, "interface": port.interface, "facts": facts_of(&port.interface), "doc": port.doc })).collect::<Vec<_>>(),
        "settings": settings.iter().map(|setting| setting_json(&setting.name, setting, &setting.default)).collect::<Vec<_>>(),
    })
}
