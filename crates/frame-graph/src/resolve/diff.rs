//! What two pipelines differ in.

use super::{Node, Parameter, Resolved, print};
use crate::description::{Body, Link};
use crate::value::Value;
use std::fmt;

/// One difference between two flattened pipelines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// What differs: `pass`, `link`, `setting`, `output format`, `switch`, `off`, `parameter`, `input` or `output`.
    pub what: &'static str,
    /// Which one: `lights`, `gather.view`, `blur.radius`.
    pub path: String,
    /// In the first pipeline; `None` where it has none.
    pub from: Option<String>,
    /// In the second; `None` where it has none.
    pub to: Option<String>,
}

impl fmt::Display for Difference {
    /// One line: `- pass x: kind`, `+ …` or `~ setting x.y: 1 → 2`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Difference { what, path, from, to } = self;
        match (from, to) {
            (None, Some(to)) => write!(f, "+ {what} {path}: {to}"),
            (Some(from), None) => write!(f, "- {what} {path}: {from}"),
            (Some(from), Some(to)) => write!(f, "~ {what} {path}: {from} → {to}"),
            (None, None) => write!(f, "= {what} {path}"),
        }
    }
}

#[derive(Default)]
struct Differences(Vec<Difference>);

impl Differences {
    /// Compares two lists of named values by name, in the order of the first, then of the second.
    fn lists(
        &mut self,
        what: &'static str,
        prefix: &str,
        a: Vec<(String, String)>,
        b: Vec<(String, String)>,
    ) {
        let find = |list: &[(String, String)], name: &str| {
            list.iter().find(|(n, _)| n == name).map(|(_, v)| v.clone())
        };
        for (name, from) in &a {
            self.value(what, format!("{prefix}{name}"), Some(from.clone()), find(&b, name));
        }
        for (name, to) in &b {
            if find(&a, name).is_none() {
                self.value(what, format!("{prefix}{name}"), None, Some(to.clone()));
            }
        }
    }

    fn value(&mut self, what: &'static str, path: String, from: Option<String>, to: Option<String>) {
        if from != to {
            self.0.push(Difference { what, path, from, to });
        }
    }
}

/// Returns all that `b` does otherwise than `a`: parameters, passes, links, settings, switches, outputs.
pub fn diff(a: &Resolved, b: &Resolved) -> Vec<Difference> {
    let mut all = Differences::default();
    let parameters = |r: &Resolved| {
        let value = |p: &Parameter| p.value.as_ref().map_or("inherited".to_owned(), Value::to_string);
        r.parameters.iter().map(|p| (p.setting.name.clone(), value(p))).collect()
    };
    all.lists("parameter", "", parameters(a), parameters(b));
    let inputs = |r: &Resolved| {
        r.inputs.iter().map(|i| (i.name.value.to_string(), i.interface.value.to_string())).collect()
    };
    all.lists("input", "", inputs(a), inputs(b));
    for node in &a.nodes {
        match b.nodes.iter().find(|other| other.name == node.name) {
            Some(other) => nodes(&mut all, node, other),
            None => all.value("pass", node.name.to_string(), Some(kind(node)), None),
        }
    }
    for node in b.nodes.iter().filter(|node| a.nodes.iter().all(|other| other.name != node.name)) {
        all.value("pass", node.name.to_string(), None, Some(kind(node)));
        // The settings of a new pass are as much a difference as the pass.
        all.lists("setting", &format!("{}.", node.name), Vec::new(), settings(node));
    }
    let outputs =
        |r: &Resolved| r.outputs.iter().map(|o| (o.name.value.to_string(), print::link(&o.link))).collect();
    all.lists("output", "", outputs(a), outputs(b));
    all.0
}

fn kind(node: &Node) -> String {
    match &node.decl.body {
        Body::Pass { kind, shader: None } => kind.value.to_string(),
        Body::Pass { kind, shader: Some(shader) } => format!("{} {}", kind.value, shader.value),
        Body::Group(_) | Body::Sub { .. } => "a sub-graph".to_owned(),
        Body::Removed => "removed".to_owned(),
    }
}

fn settings(node: &Node) -> Vec<(String, String)> {
    node.decl.set.iter().map(|s| (s.name.value.to_string(), print::set(&s.value))).collect()
}

fn nodes(all: &mut Differences, a: &Node, b: &Node) {
    let prefix = format!("{}.", a.name);
    all.value("pass", a.name.to_string(), Some(kind(a)), Some(kind(b)));
    let links = |node: &Node| {
        let named = |l: &Link| {
            let port = if l.port.value.is_empty() { "the input that fits" } else { l.port.value.as_str() };
            (port.to_owned(), print::link(l))
        };
        node.decl.links.iter().chain(&node.decl.feed).map(named).collect()
    };
    all.lists("link", &prefix, links(a), links(b));
    all.lists("setting", &prefix, settings(a), settings(b));
    let outs =
        |node: &Node| node.decl.outs.iter().map(|o| (o.port.value.to_string(), print::out(o))).collect();
    all.lists("output format", &prefix, outs(a), outs(b));
    if let (Body::Group(x), Body::Group(y)) = (&a.decl.body, &b.decl.body) {
        let inner = |g: &crate::description::Group| {
            g.outputs.iter().map(|o| (o.name.value.to_string(), print::link(&o.link))).collect()
        };
        all.lists("output", &prefix, inner(x), inner(y));
    }
    all.value("switch", a.name.to_string(), print::when(a), print::when(b));
    let off = |node: &Node| node.decl.off.as_ref().map(|off| print::off(&off.value));
    all.value("off", a.name.to_string(), off(a), off(b));
}
