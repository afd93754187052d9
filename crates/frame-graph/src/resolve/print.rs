//! Writes a flattened pipeline as RON.

use super::{Node, Resolved};
use crate::description::{
    At, Body, Dim, Formula, Group, InputDecl, Link, Off, OutDecl, OutputDecl, SaidFact, Set, SetValue, Size,
};
use crate::diagnostic::Place;
use crate::resource::Clear;
use crate::value::{Value, ValueType};
use data_file::Name;
use std::fmt::Write as _;

struct Printer<'a> {
    resolved: &'a Resolved,
    origins: bool,
    text: String,
}

/// The file as text; with `origins`, comments tell where values came from that the file itself does not hold.
pub(super) fn print(resolved: &Resolved, origins: bool) -> String {
    let mut printer = Printer { resolved, origins, text: String::from("Pipeline(\n") };
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
    let port = quoted(&link.target.to_string());
    match &link.past {
        None => port,
        Some(past) => {
            let reset: Vec<String> = past.reset.iter().map(|cause| cause.to_string()).collect();
            let rest = past.rest.map_or_else(String::new, |frames| format!(", rest: {frames}"));
            format!("Prev(port: {port}, init: {}, reset: [{}]{rest})", past.init, reset.join(", "))
        }
    }
}

pub(super) fn set(set: &SetValue) -> String {
    set.get().map_or_else(String::new, value)
}

pub(super) fn off(off: &Off) -> String {
    match off {
        Off::Constant(Clear::Zero) => "Black".to_owned(),
        Off::Constant(color) => color.to_string(),
        Off::Input(port) => format!("Input({})", quoted(port)),
        Off::Link(other) => link(other),
    }
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
    if let Some(format) = out.format {
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

fn input(input: &InputDecl) -> String {
    let interface = quoted(&input.interface.value);
    if input.optional { format!("Optional({interface})") } else { interface }
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
        self.map(1, "inputs", &resolved.inputs, |p, i| {
            p.value(2, &format!("{}: {},", quoted(&i.name.value), input(i)), i.name.place, false);
        });
        let nodes: Vec<usize> = (0..resolved.nodes.len()).collect();
        self.map(1, "passes", &nodes, |p, i| p.node(*i));
        self.outputs(1, &resolved.outputs);
    }

    fn outputs(&mut self, depth: usize, outputs: &[OutputDecl]) {
        self.map(depth, "outputs", outputs, |p, output| {
            let line = format!("{}: {},", quoted(&output.name.value), link(&output.link));
            p.value(depth + 1, &line, output.link.place, false);
        });
    }

    fn links(&mut self, name: &str, links: &[Link], inherited: bool) {
        let links: Vec<&Link> = links.iter().filter(|l| l.inherited == inherited).collect();
        self.map(3, name, &links, |p, l| {
            p.value(4, &format!("{}: {},", quoted(&l.port.value), link(l)), l.place, false);
        });
    }

    fn node(&mut self, index: usize) {
        let resolved = self.resolved;
        let node = &resolved.nodes[index];
        let decl = &node.decl;
        let name = quoted(&node.name);
        match &decl.body {
            Body::Pass { kind, shader } => {
                self.value(2, &format!("{name}: Pass("), node.place, false);
                self.value(3, &format!("kind: {},", quoted(&kind.value)), kind.place, false);
                if let Some(shader) = shader {
                    self.value(3, &format!("shader: {},", quoted(&shader.value)), shader.place, false);
                }
            }
            Body::Group(Group { inputs, .. }) => {
                self.value(2, &format!("{name}: Group("), node.place, false);
                self.map(3, "inputs", inputs, |p, i| {
                    p.value(4, &format!("{}: {},", quoted(&i.name.value), input(i)), i.name.place, false);
                });
            }
            Body::Removed | Body::Sub { .. } => {
                let place = decl.removed.unwrap_or(node.place);
                return self.value(2, &format!("{name}: Removed,"), place, true);
            }
        }
        self.links("in", &decl.links, false);
        self.links("keep", &decl.links, true);
        if let Some(feed) = &decl.feed {
            self.value(3, &format!("feed: {},", link(feed)), feed.place, false);
        }
        if let Body::Group(group) = &decl.body {
            self.outputs(3, &group.outputs);
        }
        // What no value is known of is the default of the setting, unless the pipeline's own parameter gives it one.
        let root = |s: &Set| match &s.value {
            SetValue::Parameter(name, None) => resolved.root(index, name),
            _ => None,
        };
        let set_: Vec<&Set> =
            decl.set.iter().filter(|s| s.value.get().is_some() || root(s).is_some()).collect();
        self.map(3, "set", &set_, |p, s| {
            if let Some(root) = root(s) {
                let line = format!("{}: {},", quoted(&s.name.value), quoted(&format!("${root}")));
                return p.value(4, &line, s.place, s.patched);
            }
            let line = format!("{}: {},", quoted(&s.name.value), set(&s.value));
            match &s.value {
                SetValue::Parameter(_, Some((_, place))) => p.value(4, &line, *place, true),
                SetValue::Formula(formula, _) => p.computed(4, &line, formula, &s.value.origins()),
                _ => p.value(4, &line, s.place, s.patched),
            }
        });
        self.map(3, "out", &decl.outs, |p, o| {
            p.value(4, &format!("{}: {},", quoted(&o.port.value), out(o)), o.port.place, false);
        });
        if let Some(text) = when(node) {
            let place = decl.removed.or(decl.when.as_ref().map(|w| w.text.place)).unwrap_or(node.place);
            self.value(3, &format!("when: {},", quoted(&text)), place, decl.removed.is_some());
        }
        if let Some(o) = &decl.off {
            self.value(3, &format!("off: {},", off(&o.value)), o.place, false);
        }
        self.line(2, "),");
    }
}
