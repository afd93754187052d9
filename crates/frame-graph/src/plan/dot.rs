//! The plan for Graphviz.

use super::{Fate, Plan};
use std::fmt::Write as _;

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}

pub(super) fn dot(plan: &Plan) -> String {
    let mut out = String::from(
        "digraph plan {\n  rankdir=LR;\n  node [shape=box, style=filled, fillcolor=\"#dcecf7\"];\n",
    );
    for pass in &plan.passes {
        let _ = writeln!(
            out,
            "  {} [label={}];",
            quoted(&pass.name),
            quoted(&format!("{}\n{}", pass.name, pass.kind))
        );
    }
    for (_, resource) in plan.constants() {
        let label = quoted(&format!(
            "{}\n{}",
            resource.name,
            resource.constant.unwrap_or(crate::resource::Clear::Zero)
        ));
        let _ = writeln!(out, "  {} [label={label}, fillcolor=\"#f7e3c0\"];", quoted(&resource.name));
    }
    for (name, fate) in &plan.fates {
        let colour = match fate {
            Fate::Kept { .. } => continue,
            Fate::Culled { .. } => "#e4e4e4",
            Fate::Off { .. } => "#f7e3c0",
        };
        let _ = writeln!(
            out,
            "  {} [fillcolor=\"{colour}\", tooltip={}];",
            quoted(name),
            quoted(&fate.to_string())
        );
    }
    for pass in &plan.passes {
        for link in plan.links(pass) {
            let from = match link.producer {
                Some(producer) => &plan.passes[producer.0 as usize].name,
                None => &plan.resources[link.constant.0 as usize].name,
            };
            let style = if link.past { ", style=dashed, constraint=false" } else { "" };
            let label = quoted(&format!("{} → {}", link.port, link.input));
            let _ = writeln!(out, "  {} -> {} [label={label}{style}];", quoted(from), quoted(&pass.name));
        }
    }
    for output in &plan.outputs {
        let name = quoted(&format!("out.{}", output.name));
        let from = output.members.first().map(|(_, id)| &plan.resources[id.0 as usize]);
        let Some(from) = from else { continue };
        let from = plan.shown_by(output).map_or(&from.name, |p| &plan.passes[p.0 as usize].name);
        let _ =
            writeln!(out, "  {name} [shape=ellipse, fillcolor=\"#d9f0d3\"];\n  {} -> {name};", quoted(from));
    }
    out.push_str("}\n");
    out
}
