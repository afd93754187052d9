//! `lightloom interfaces`: the types of ports.

use super::lists;
use crate::context::{Context, unknown};
use crate::output::{self, stdout};
use anyhow::{Result, anyhow};
use frame_graph::{Interface, PassTypeError};
use pass::declaration::{format_of, global, of_member};
use serde_json::{Value, json};

/// List the interfaces, or show one.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  lightloom interfaces GBuffer")]
pub(crate) struct Args {
    /// An interface
    name: Option<String>,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let all = context.catalog.interfaces();
    let Some(name) = &args.name else {
        let rows = all.iter().map(|interface| (interface.name.to_owned(), interface.doc.to_owned()));
        lists::print(context, &rows.collect::<Vec<_>>());
        return Ok(());
    };
    let Some(interface) = all.iter().find(|interface| interface.name == name) else {
        let names: Vec<String> = all.iter().map(|interface| interface.name.to_owned()).collect();
        return Err(unknown("interface", name, &names, "interfaces"));
    };
    let failed = |error: PassTypeError| anyhow!(error.message);
    let output_of = context.catalog.passes_with(name, true).map_err(failed)?;
    let input_of = context.catalog.passes_with(name, false).map_err(failed)?;
    if context.json {
        let mut value = as_json(interface);
        value["output_of"] = json!(output_of);
        value["input_of"] = json!(input_of);
        output::json(&value);
        return Ok(());
    }
    stdout!("{}", as_text(context, interface));
    stdout!("output of {}", output_of.join(", "));
    stdout!("input of {}", input_of.join(", "));
    Ok(())
}

fn as_text(context: &Context, interface: &Interface) -> String {
    let mut lines =
        vec![format!("{}: {}", interface.name, interface.doc), "members, of a port PORT".to_owned()];
    let optional = |is_optional: bool| if is_optional { " (optional)" } else { "" };
    for member in interface.members {
        let global = global("PORT", member.name);
        let format = format_of(member.content);
        lines.push(format!("  {global:<22} {format:<20} {}{}", member.doc, optional(member.optional)));
        lines.extend(of_member(&global, member.content).map(|line| format!("  {:<22} {line}", "")));
    }
    if !interface.facts.is_empty() {
        lines.push("facts".to_owned());
    }
    for fact in interface.facts {
        let (name, ty) = (fact.name, fact.ty.to_string());
        lines.push(format!("  {name:<22} {ty:<20} {}{}", fact.doc, optional(fact.optional)));
    }
    if !interface.outputs.is_empty() {
        lines.push(format!("outputs of pipelines that hold it: {}", interface.outputs.join(", ")));
    }
    let structs = interface.members.iter().flat_map(|member| context.catalog.structs_of(member));
    lines.extend(structs.map(|item| item.declaration));
    lines.join("\n")
}

fn as_json(interface: &Interface) -> Value {
    let members = interface.members.iter().map(|member| {
        json!({
            "name": member.name,
            "optional": member.optional,
            "format": format_of(member.content),
            "declaration": of_member(&global("PORT", member.name), member.content),
            "doc": member.doc,
        })
    });
    let facts = interface.facts.iter().map(|fact| {
        json!({ "name": fact.name, "type": fact.ty.to_string(), "optional": fact.optional, "doc": fact.doc })
    });
    json!({
        "name": interface.name,
        "about": interface.doc,
        "members": members.collect::<Vec<_>>(),
        "facts": facts.collect::<Vec<_>>(),
        "outputs": interface.outputs,
    })
}
