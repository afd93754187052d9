//! The plan for Graphviz.

use super::{Fate, Plan};
use petgraph::dot::{Config, Dot, RankDir};
use petgraph::graph::DiGraph;

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}

/// Returns the attributes of a box: `id` is its name in an SVG that Graphviz writes.
fn node(name: &str, label: &str, shape: &str, color: &str, tooltip: &str) -> String {
    let [name, label, tooltip] = [name, label, tooltip].map(quoted);
    format!("id={name}, label={label}, shape={shape}, style=filled, fillcolor=\"{color}\", tooltip={tooltip}")
}

pub(super) fn dot(plan: &Plan) -> String {
    // The weights are attributes.
    let mut graph = DiGraph::<String, String>::new();
    let passes = plan.passes.iter().map(|pass| {
        let label = format!("{}\n{}", pass.name, pass.kind);
        graph.add_node(node(&pass.name, &label, "box", "#dcecf7", &pass.name))
    });
    let passes: Vec<_> = passes.collect();
    for (name, fate) in &plan.fates {
        let color = match fate {
            Fate::Kept { .. } => continue,
            Fate::Culled { .. } => "#e4e4e4",
            Fate::Off { .. } => "#f7e3c0",
        };
        graph.add_node(node(name, name, "box", color, &fate.to_string()));
    }
    for (pass, reader) in plan.passes.iter().zip(&passes) {
        for link in plan.links(pass) {
            let style = if link.past { ", style=dashed, constraint=false" } else { "" };
            let label = quoted(&format!("{} → {}", link.port, link.input));
            graph.add_edge(passes[link.producer.0 as usize], *reader, format!("label={label}{style}"));
        }
    }
    for output in &plan.outputs {
        let name = format!("out.{}", output.name);
        let shown = graph.add_node(node(&name, &name, "ellipse", "#d9f0d3", &output.from));
        if let Some(pass) = plan.shown_by(output) {
            graph.add_edge(passes[pass.0 as usize], shown, String::new());
        }
    }
    let config = [Config::NodeNoLabel, Config::EdgeNoLabel, Config::RankDir(RankDir::LR)];
    let dot = Dot::with_attr_getters(&graph, &config, &|_, link| link.weight().clone(), &|_, (_, node)| {
        node.clone()
    });
    format!("{dot:?}")
}
