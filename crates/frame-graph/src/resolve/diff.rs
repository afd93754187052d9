//! What two pipelines differ in.

use super::{Node, Parameter, Resolved, print};
use crate::description::{Body, Link, OutputDecl};
use crate::link::{Taken, taken};
use crate::port::PassTypes;
use data_file::{Name, Value};
use serde_json::json;
use std::fmt;

/// One difference between two flattened pipelines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// What differs: `pass`, `link`, `setting`, `output format`, `history`, `switch`, `off`, `parameter`, `input`, `output` or `samples`.
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

impl Difference {
    /// Returns it for programs: its kind, the path, and what was before and is after; `null` for nothing.
    pub fn to_json(&self) -> serde_json::Value {
        json!({ "kind": self.what, "path": self.path, "before": self.from, "after": self.to })
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

/// Returns all that `b` does otherwise than `a`: parameters, passes, links, settings, switches, outputs, samples. A setting that
/// a file leaves out has the default of its pass type; a link or an output whose source was removed is not there.
pub fn diff(a: &Resolved, b: &Resolved, kinds: &dyn PassTypes) -> Vec<Difference> {
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
    let (of_a, of_b) = (taken(a, kinds), taken(b, kinds));
    for (i, node) in a.nodes.iter().enumerate() {
        match b.index.get(&node.name).map(|other| *other as usize) {
            Some(other) => {
                let (x, y) = (
                    Side { resolved: a, taken: &of_a, at: i },
                    Side { resolved: b, taken: &of_b, at: other },
                );
                nodes(&mut all, (&x, &y), kinds);
            }
            None if matches!(node.decl.body, Body::Removed) => {}
            None => all.value("pass", node.name.to_string(), Some(kind(node)), None),
        }
    }
    let is_new = |node: &&Node| {
        !matches!(node.decl.body, Body::Removed) && a.nodes.iter().all(|other| other.name != node.name)
    };
    for node in b.nodes.iter().filter(is_new) {
        all.value("pass", node.name.to_string(), None, Some(kind(node)));
        // The settings of a new pass are as much a difference as the pass.
        all.lists("setting", &format!("{}.", node.name), Vec::new(), given(node, kinds));
    }
    all.lists("output", "", outputs(a, &a.outputs), outputs(b, &b.outputs));
    all.value("samples", "picture".to_owned(), sampled(a, &of_a), sampled(b, &of_b));
    all.0
}

fn kind(node: &Node) -> String {
    match &node.decl.body {
        Body::Pass { kind, shader: None } => kind.value.to_string(),
        Body::Pass { kind, shader: Some(shader) } => format!("{} {}", kind.value, shader.value),
        Body::Group(_) | Body::Sub(_) => "a sub-graph".to_owned(),
        Body::Removed => "removed".to_owned(),
    }
}

/// Returns what is said of a pipeline each frame of which is another sample of the picture: the passes for which it is.
fn sampled(resolved: &Resolved, taken: &[Option<Taken>]) -> Option<String> {
    let passes = resolved.nodes.iter().zip(taken);
    let passes = passes.filter(|(_, taken)| taken.as_ref().is_some_and(|taken| taken.sampled));
    let names: Vec<&str> = passes.map(|(node, _)| &*node.name).collect();
    (!names.is_empty()).then(|| format!("another in each frame, for {}", names.join(", ")))
}

fn outputs(resolved: &Resolved, outputs: &[OutputDecl]) -> Vec<(String, String)> {
    let there = outputs.iter().filter(|output| resolved.removed(&output.link).is_none());
    there.map(|output| (output.name.value.to_string(), print::link(&output.link))).collect()
}

/// A setting of a pass: its name, its value, and whether that is the default.
struct Valued {
    name: String,
    value: String,
    default: bool,
}

/// Returns all settings of a pass; those that the file gives alone where the pass type cannot say which it has.
fn settings(node: &Node, kinds: &dyn PassTypes) -> Vec<Valued> {
    let set = &node.decl.set;
    let schema = node.decl.use_of(&node.decl.link_names).and_then(|use_| kinds.settings(use_).ok());
    let schema = schema.unwrap_or_default();
    let known = schema.iter().map(|setting| {
        let given = set.iter().find(|set| set.name.value == *setting.name).and_then(|set| set.value.get());
        let given = given.and_then(|value| value.clone().convert(setting.ty));
        let value = given.as_ref().unwrap_or(&setting.default);
        Valued { name: setting.name.clone(), value: print::value(value), default: *value == setting.default }
    });
    let unknown = set.iter().filter(|set| schema.iter().all(|setting| set.name.value != *setting.name));
    let unknown = unknown.filter(|set| set.value.get().is_some()).map(|set| Valued {
        name: set.name.value.to_string(),
        value: print::set(&set.value),
        default: false,
    });
    known.chain(unknown).collect()
}

/// Returns the settings of a pass that are no defaults.
fn given(node: &Node, kinds: &dyn PassTypes) -> Vec<(String, String)> {
    let settings = settings(node, kinds).into_iter().filter(|setting| !setting.default);
    settings.map(|setting| (setting.name, setting.value)).collect()
}

/// One of two nodes that are compared.
struct Side<'a> {
    resolved: &'a Resolved,
    taken: &'a [Option<Taken>],
    at: usize,
}

impl<'a> Side<'a> {
    fn node(&self) -> &'a Node {
        &self.resolved.nodes[self.at]
    }

    fn links(&self) -> Vec<(Name, &'a Link)> {
        self.resolved.links_of(self.at, self.taken[self.at].as_ref())
    }
}

fn nodes(all: &mut Differences, (x, y): (&Side<'_>, &Side<'_>), kinds: &dyn PassTypes) {
    let (a, b) = (x.node(), y.node());
    let prefix = format!("{}.", a.name);
    all.value("pass", a.name.to_string(), Some(kind(a)), Some(kind(b)));
    let links = |links: Vec<(Name, &Link)>| {
        links.into_iter().map(|(port, link)| (port.to_string(), print::link(link))).collect()
    };
    all.lists("link", &prefix, links(x.links()), links(y.links()));
    let (x, y) = (x.resolved, y.resolved);
    let every = |node| settings(node, kinds).into_iter().map(|s| (s.name, s.value)).collect();
    let (before, after) = match kind(a) == kind(b) {
        true => (every(a), every(b)),
        false => (given(a, kinds), given(b, kinds)),
    };
    all.lists("setting", &prefix, before, after);
    let outs =
        |node: &Node| node.decl.outs.iter().map(|o| (o.port.value.to_string(), print::out(o))).collect();
    all.lists("output format", &prefix, outs(a), outs(b));
    if let (Body::Group(of_a), Body::Group(of_b)) = (&a.decl.body, &b.decl.body) {
        all.lists("output", &prefix, outputs(x, &of_a.outputs), outputs(y, &of_b.outputs));
    }
    let history = |node: &Node| node.decl.history.as_ref().map(|policy| print::history(&policy.value));
    all.value("history", a.name.to_string(), history(a), history(b));
    all.value("switch", a.name.to_string(), print::when(a), print::when(b));
    let off = |node: &Node| node.decl.off.as_ref().map(|off| print::off(&off.value, ""));
    all.value("off", a.name.to_string(), off(a), off(b));
}
