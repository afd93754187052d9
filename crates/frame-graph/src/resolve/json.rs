//! A flattened pipeline as JSON, each value with its origin.

use super::{Node, Resolved, print};
use crate::description::{At, Body, InputDecl, Link, OutputDecl, Set};
use crate::plan::json::value;
use crate::port::PassTypes;
use data_file::Place;
use serde_json::{Value as Json, json};

impl Resolved {
    /// Returns the flattened pipeline for programs: what [`Resolved::to_ron`] writes as text. Every value has its
    /// `origin`: file, line and column. `ron` is that text.
    pub fn to_json(&self, kinds: &dyn PassTypes) -> Json {
        let parameters = self.parameters.iter().map(|parameter| {
            let setting = &parameter.setting;
            json!({
                "name": setting.name,
                "type": setting.ty.to_string(),
                "value": parameter.value.as_ref().map(value),
                "min": setting.min,
                "max": setting.max,
                "one_of": setting.one_of.iter().map(value).collect::<Vec<_>>(),
                "unit": setting.unit,
                "doc": setting.doc,
                "origin": self.origin(parameter.place),
            })
        });
        json!({
            "about": self.about,
            "paper": self.paper,
            "parameters": parameters.collect::<Vec<_>>(),
            "inputs": self.inputs_json(&self.inputs),
            "passes": self.nodes.iter().map(|node| self.node_json(node)).collect::<Vec<_>>(),
            "outputs": self.outputs_json(&self.outputs),
            "ron": self.to_ron(kinds, true),
        })
    }

    fn origin(&self, place: Place) -> Json {
        let span = self.sources.span(place);
        let (line, column) = span.line_column();
        json!({ "file": span.source.name, "line": line, "column": column })
    }

    fn inputs_json(&self, inputs: &[InputDecl]) -> Json {
        let input = |input: &InputDecl| {
            json!({
                "name": input.name.value.as_str(),
                "interface": input.interface.value.as_str(),
                "origin": self.origin(input.name.place),
            })
        };
        inputs.iter().map(input).collect()
    }

    fn outputs_json(&self, outputs: &[OutputDecl]) -> Json {
        let output = |output: &OutputDecl| {
            json!({
                "name": output.name.value.as_str(),
                "from": output.link.target.to_string(),
                "lost": self.removed(&output.link).is_some(),
                "origin": self.origin(output.link.place),
            })
        };
        outputs.iter().map(output).collect()
    }

    fn link_json(&self, link: &Link) -> Json {
        json!({
            "input": link.port.value.as_str(),
            "from": link.target.to_string(),
            "previous": link.past,
            "lost": self.removed(link).is_some(),
            "origin": self.origin(link.place),
        })
    }

    fn node_json(&self, node: &Node) -> Json {
        let decl = &node.decl;
        let (form, kind, shader) = match &decl.body {
            Body::Pass { kind, shader } => {
                ("pass", Some(kind.value.as_str()), shader.as_ref().map(|shader| shader.value.as_str()))
            }
            Body::Group(_) | Body::Sub(_) => ("sub-graph", None, None),
            Body::Removed => ("removed", None, None),
        };
        let set = |set: &Set| {
            let origin = set.value.origins().last().map_or(set.place, |(_, _, place)| *place);
            json!({
                "name": set.name.value.as_str(),
                "value": set.value.get().map(value),
                "expression": set.value.explained(),
                "origin": self.origin(origin),
            })
        };
        let (inputs, outputs) = match &decl.body {
            Body::Group(group) => (self.inputs_json(&group.inputs), self.outputs_json(&group.outputs)),
            _ => (json!([]), json!([])),
        };
        json!({
            "name": node.name.as_str(),
            "form": form,
            "kind": kind,
            "shader": shader,
            "inputs": inputs,
            "links": decl.links.iter().chain(&decl.feed).map(|link| self.link_json(link)).collect::<Vec<_>>(),
            "settings": decl.set.iter().map(set).collect::<Vec<_>>(),
            "out": decl.outs.iter().map(|out| json!({
                "output": out.port.value.as_str(), "is": print::out(out), "origin": self.origin(out.port.place),
            })).collect::<Vec<_>>(),
            "outputs": outputs,
            "history": decl.history.as_ref().map(|policy| print::history(&policy.value)),
            "when": print::when(node),
            "off": decl.off.as_ref().map(|At { value, .. }| print::off(value, "")),
            "origin": self.origin(decl.removed.unwrap_or(node.place)),
        })
    }
}
