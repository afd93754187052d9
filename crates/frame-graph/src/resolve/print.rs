//! Writes a flattened pipeline as RON.

use super::{Node, Resolved};
use crate::description::{
    At, Body, Dim, Formula, HistoryPolicy, InputDecl, Link, Off, OutDecl, OutputDecl, SaidFact, Set,
    SetValue, Size, Target,
};
use crate::link::{Taken, taken};
use crate::port::PassTypes;
use data_file::{Name, Place, Value, ValueType};
use std::fmt::Write as _;

struct Printer<'a> {
    resolved: &'a Resolved,
    taken: Vec<Option<Taken>>,
    origins: bool,
    text: String,
}

/// Returns the file as text; with `origins`, comments state the origins of values that the file itself does not hold.
pub(super) fn print(resolved: &Resolved, kinds: &dyn PassTypes, origins: bool) -> String {
    let taken = taken(resolved, kinds);
    let mut printer = Printer { resolved, taken, origins, text: String::from("Pipeline(\n") };
    printer.pipeline();
    printer.text.push_str(")\n");
    printer.text
}

/// RON text; Rust's escapes are RON's.
pub(super) fn quoted(text: &str) -> String {
    format!("{text:?}")
}

pub(super) fn value(value: &Value) -> String {
    match value {
        Value::Text(text) => quoted(&text.replace('$', "$$")),
        other => other.to_string(),
    }
}

pub(super) fn link(link: &Link) -> String {
    let prev = if link.past { "prev " } else { "" };
    quoted(&format!("{prev}{}", link.target))
}

pub(super) fn history(policy: &HistoryPolicy) -> String {
    let reset: Vec<String> = policy.reset.iter().map(|cause| cause.to_string()).collect();
    let rest = policy.rest.map_or_else(String::new, |frames| format!(", rest: {frames}"));
    let catches_up = if policy.catches_up { ", catches_up: true" } else { "" };
    format!("(reset: [{}]{rest}{catches_up})", reset.join(", "))
}

pub(super) fn set(set: &SetValue) -> String {
    set.get().map_or_else(String::new, value)
}

/// What `off:` says, as the sub-graph `scope` knows it.
pub(super) fn off(off: &Off, scope: &str) -> String {
    match off {
        Off::Input(port) => format!("Input({})", quoted(port)),
        Off::Link(other) => local(other, scope),
    }
}

/// Returns the name of a node as the sub-graph `scope` knows it.
fn unprefixed<'n>(name: &'n str, scope: &str) -> &'n str {
    name.strip_prefix(scope).and_then(|rest| rest.strip_prefix('/')).unwrap_or(name)
}

/// Returns a link as the sub-graph `scope` knows it.
fn local(other: &Link, scope: &str) -> String {
    let pass = Name::from(unprefixed(&other.target.pass, scope));
    link(&Link { target: Target { pass, ..other.target.clone() }, ..other.clone() })
}

/// What `when:` says, with parameters as values; `None` where there is no switch.
pub(super) fn when(node: &Node) -> Option<String> {
    let decl = &node.decl;
    let removed = decl.removed.is_some() && !matches!(decl.body, Body::Removed);
    if removed { Some("false".to_owned()) } else { decl.when.as_ref().map(|when| when.expr.text(true)) }
}

fn dim(dim: &Dim) -> String {
    match dim {
        Dim::Number(n) => n.to_string(),
        Dim::Formula(formula) => formula.expr.text(true),
    }
}

pub(super) fn out(out: &OutDecl) -> String {
    let mut fields = Vec::new();
    if let Some(interface) = &out.interface {
        fields.push(format!("interface: {}", quoted(&interface.value)));
    }
    if let Some(At { value: format, .. }) = &out.format {
        fields.push(format!("format: {}", quoted(format.name())));
    }
    if let Some(At { value: size, .. }) = &out.size {
        let times = |num: &Dim, den: &Dim| {
            let part = |sign: &str, d: &Dim| {
                if matches!(d, Dim::Number(1)) { String::new() } else { format!(" {sign} {}", dim(d)) }
            };
            part("*", num) + &part("/", den)
        };
        fields.push(match size {
            Size::Frame(num, den) => format!("size: \"frame{}\"", times(num, den)),
            Size::Like(input, num, den) => format!("size: \"like({input}){}\"", times(num, den)),
            Size::Fixed(w, h) => format!("size: ({}, {})", dim(w), dim(h)),
        });
    }
    if let Some(count) = &out.count {
        fields.push(format!("count: {}", dim(&count.value)));
    }
    if !out.facts.is_empty() {
        let fact = |fact: &SaidFact| {
            let text = fact.value.as_ref().and_then(SetValue::get).map_or("None".to_owned(), value);
            format!("{}: {text}", quoted(&fact.name.value))
        };
        let facts: Vec<String> = out.facts.iter().map(fact).collect();
        fields.push(format!("facts: {{ {} }}", facts.join(", ")));
    }
    format!("Out({})", fields.join(", "))
}

impl Resolved {
    /// Returns the links of a node, each with the name of its input, without those that its pass type does not take or
    /// whose source was removed.
    pub(super) fn links_of(&self, node: usize, taken: Option<&Taken>) -> Vec<(Name, &Link)> {
        let decl = &self.nodes[node].decl;
        let is_taken = |at: usize| taken.is_none_or(|taken| taken.links[at]);
        let links = decl.links.iter().enumerate().filter(|(at, link)| !link.inherited || is_taken(*at));
        let links = links.map(|(_, link)| (link.port.value.clone(), link));
        let feed = decl.feed.as_ref().and_then(|feed| Some((taken?.feed.clone()?, feed)));
        links.chain(feed).filter(|(_, link)| self.removed(link).is_none()).collect()
    }
}

impl Printer<'_> {
    fn line(&mut self, depth: usize, text: &str) {
        let _ = writeln!(self.text, "{:1$}{text}", "", depth * 4);
    }

    /// A line that holds a value from `place`.
    fn value(&mut self, depth: usize, text: &str, place: Place, patched: bool) {
        let mut line = text.to_owned();
        if self.origins && (patched || place.file != 0) {
            let origin = self.resolved.sources.span(place).to_string().replace(char::is_control, " ");
            let _ = write!(line, "  // {origin}");
        }
        self.line(depth, &line);
    }

    /// A line that holds the value of an expression.
    fn computed(&mut self, depth: usize, text: &str, formula: &Formula, origins: &[(Name, Value, Place)]) {
        let mut line = text.to_owned();
        if self.origins {
            let span = |place: Place| self.resolved.sources.span(place).to_string();
            let mut origin = format!("{}: {}", span(formula.text.place), formula.expr.text(false));
            for (name, value, place) in origins {
                let _ = write!(origin, ", {name} = {value} ({})", span(*place));
            }
            let _ = write!(line, "  // {}", origin.replace(char::is_control, " "));
        }
        self.line(depth, &line);
    }

    fn map<T>(&mut self, depth: usize, name: &str, items: &[T], mut item: impl FnMut(&mut Self, &T)) {
        if !items.is_empty() {
            self.line(depth, &format!("{name}: {{"));
            items.iter().for_each(|i| item(self, i));
            self.line(depth, "},");
        }
    }

    fn pipeline(&mut self) {
        let resolved = self.resolved;
        for (name, text) in [("about", &resolved.about), ("paper", &resolved.paper)] {
            if let Some(text) = text {
                self.line(1, &format!("{name}: {},", quoted(text)));
            }
        }
        self.map(1, "parameters", &resolved.parameters, |p, parameter| {
            let setting = &parameter.setting;
            let default = parameter.value.as_ref().map(|v| format!("default: {}", value(v)));
            let mut fields: Vec<String> = default.into_iter().collect();
            // The bounds of integers are written as integers.
            let whole = matches!(setting.ty, ValueType::U32 | ValueType::I32);
            let bound =
                |name: &str, at: f64| if whole { format!("{name}: {at}") } else { format!("{name}: {at:?}") };
            fields.extend(setting.min.map(|min| bound("min", min)));
            fields.extend(setting.max.map(|max| bound("max", max)));
            if !setting.one_of.is_empty() {
                let choices: Vec<String> = setting.one_of.iter().map(value).collect();
                fields.push(format!("one_of: [{}]", choices.join(", ")));
            }
            for (name, text) in [("unit", &setting.unit), ("doc", &setting.doc)] {
                if !text.is_empty() {
                    fields.push(format!("{name}: {}", quoted(text)));
                }
            }
            let line = format!("{}: {}({}),", quoted(&setting.name), setting.ty.form(), fields.join(", "));
            p.value(2, &line, parameter.place, false);
        });
        self.inputs(1, &resolved.inputs.iter().collect::<Vec<_>>());
        self.passes(1, None);
        self.outputs(1, "", &resolved.outputs);
    }

    /// The passes of a sub-graph, or of the pipeline itself; those that were removed are left out.
    fn passes(&mut self, depth: usize, parent: Option<u32>) {
        let nodes = self.resolved.nodes.iter().enumerate();
        let inside =
            nodes.filter(|(_, node)| node.parent == parent && !matches!(node.decl.body, Body::Removed));
        let inside: Vec<usize> = inside.map(|(i, _)| i).collect();
        self.map(depth, "passes", &inside, |p, i| p.node(depth + 1, *i));
    }

    fn inputs(&mut self, depth: usize, inputs: &[&InputDecl]) {
        self.map(depth, "inputs", inputs, |p, input| {
            let line = format!("{}: {},", quoted(&input.name.value), quoted(&input.interface.value));
            p.value(depth + 1, &line, input.name.place, false);
        });
    }

    /// The outputs of the sub-graph of a name; those that are lost with a pass that was removed are left out.
    fn outputs(&mut self, depth: usize, scope: &str, outputs: &[OutputDecl]) {
        let there = outputs.iter().filter(|output| self.resolved.removed(&output.link).is_none());
        let there: Vec<&OutputDecl> = there.collect();
        self.map(depth, "outputs", &there, |p, output| {
            let line = format!("{}: {},", quoted(&output.name.value), local(&output.link, scope));
            p.value(depth + 1, &line, output.link.place, false);
        });
    }

    fn node(&mut self, depth: usize, index: usize) {
        let resolved = self.resolved;
        let node = &resolved.nodes[index];
        let decl = &node.decl;
        let scope = node.parent.map_or("", |parent| resolved.nodes[parent as usize].name.as_str());
        let name = quoted(unprefixed(&node.name, scope));
        let links = resolved.links_of(index, self.taken[index].as_ref());
        match &decl.body {
            Body::Pass { kind, shader } => {
                self.value(depth, &format!("{name}: Pass("), node.place, false);
                self.value(depth + 1, &format!("kind: {},", quoted(&kind.value)), kind.place, false);
                if let Some(shader) = shader {
                    self.value(
                        depth + 1,
                        &format!("shader: {},", quoted(&shader.value)),
                        shader.place,
                        false,
                    );
                }
            }
            Body::Group(group) => {
                self.value(depth, &format!("{name}: Sub("), node.place, false);
                let linked = |input: &&InputDecl| links.iter().any(|(port, _)| *port == input.name.value);
                let inputs: Vec<&InputDecl> = group.inputs.iter().filter(linked).collect();
                self.inputs(depth + 1, &inputs);
            }
            Body::Removed | Body::Sub(_) => return,
        }
        self.map(depth + 1, "in", &links, |p, (port, link)| {
            p.value(depth + 2, &format!("{}: {},", quoted(port), local(link, scope)), link.place, false);
        });
        if let Body::Group(group) = &decl.body {
            self.passes(depth + 1, Some(index as u32));
            self.outputs(depth + 1, &node.name, &group.outputs);
        }
        // What no value is known of is the default of the setting, unless the pipeline's own parameter gives it one.
        let root = |s: &Set| match &s.value {
            SetValue::Parameter(name, None) => resolved.root(index, name),
            _ => None,
        };
        let set_: Vec<&Set> =
            decl.set.iter().filter(|s| s.value.get().is_some() || root(s).is_some()).collect();
        self.map(depth + 1, "set", &set_, |p, s| {
            if let Some(root) = root(s) {
                let line = format!("{}: {},", quoted(&s.name.value), quoted(&format!("${root}")));
                return p.value(depth + 2, &line, s.place, s.patched);
            }
            let line = format!("{}: {},", quoted(&s.name.value), set(&s.value));
            match &s.value {
                SetValue::Parameter(_, Some((_, place))) => p.value(depth + 2, &line, *place, true),
                SetValue::Formula(formula, _) => p.computed(depth + 2, &line, formula, &s.value.origins()),
                _ => p.value(depth + 2, &line, s.place, s.patched),
            }
        });
        self.map(depth + 1, "out", &decl.outs, |p, o| {
            p.value(depth + 2, &format!("{}: {},", quoted(&o.port.value), out(o)), o.port.place, false);
        });
        if let Some(At { value: policy, place }) = &decl.history {
            self.value(depth + 1, &format!("history: {},", history(policy)), *place, false);
        }
        if let Some(text) = when(node) {
            let place = decl.removed.or(decl.when.as_ref().map(|w| w.text.place)).unwrap_or(node.place);
            self.value(depth + 1, &format!("when: {},", quoted(&text)), place, decl.removed.is_some());
        }
        if let Some(o) = &decl.off {
            self.value(depth + 1, &format!("off: {},", off(&o.value, scope)), o.place, false);
        }
        self.line(depth, "),");
    }
}
