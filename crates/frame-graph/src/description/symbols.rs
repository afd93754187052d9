//! The names in a pipeline file, each with what it names: for editors.

use super::Description;
use super::form::{
    At, Body, Dim, Entry, Formula, InputDecl, Link, Off, OutputDecl, PassDecl, Patch, SetValue, Size, Sub,
    Target,
};
use data_file::{Name, Place};

/// What a name in a pipeline file names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SymbolKind {
    /// A parameter of the file or of one that it extends.
    Parameter,
    /// A pass or a sub-graph; the name may be a path, `sub-graph/pass`.
    Pass,
    /// An input of the file, which is a sub-graph.
    Input,
    /// An output of the file.
    Output,
    /// An input of the pass [`Symbol::of`].
    InputPort,
    /// An output of the pass [`Symbol::of`].
    OutputPort,
    /// A setting of the pass [`Symbol::of`], or a parameter of that sub-graph.
    Setting,
    /// A pass type.
    PassType,
    /// An interface.
    Interface,
    /// The path of a pipeline file.
    File,
    /// The path of a WGSL file.
    Shader,
}

/// A name in a pipeline file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// What it names.
    pub kind: SymbolKind,
    /// The name.
    pub name: Name,
    /// The pass whose port or setting it is, as the scope knows it.
    pub of: Name,
    /// The written out sub-graph that it is in, `outer/inner`; empty outside of these.
    pub scope: Name,
    /// Its bytes, without quotes.
    pub place: Place,
    /// Whether the file declares here what it names.
    pub declares: bool,
}

impl Description {
    /// Returns the names that the file holds, in no order. Names with escapes are left out.
    pub fn symbols(&self) -> Vec<Symbol> {
        let mut symbols = Symbols { text: &self.source.text, scope: String::new(), found: Vec::new() };
        if let Some(file) = &self.extends {
            symbols.add(SymbolKind::File, &file.value, file.place);
        }
        for parameter in &self.parameters {
            symbols.declare(SymbolKind::Parameter, &parameter.name);
        }
        symbols.inputs(&self.inputs);
        symbols.passes(&self.passes);
        symbols.outputs(&self.outputs);
        self.patch.iter().for_each(|patch| symbols.patch(patch));
        symbols.found
    }

    /// Returns the file of a sub-graph, by the name of its pass, where this file says which.
    pub fn sub_file(&self, pass: &str) -> Option<&str> {
        match &self.decl(pass)?.body {
            Body::Sub(Sub::File(file)) => Some(&file.value),
            _ => None,
        }
    }

    /// Returns the pass type and the shader of a pass, where this file says which.
    pub fn pass_type(&self, pass: &str) -> Option<(&str, Option<&str>)> {
        match &self.decl(pass)?.body {
            Body::Pass { kind, shader } => Some((&kind.value, shader.as_ref().map(|shader| &*shader.value))),
            _ => None,
        }
    }

    /// Returns what the file last says of a pass.
    fn decl(&self, pass: &str) -> Option<&PassDecl> {
        let patched = self.patch.iter().rev().find_map(|patch| match patch {
            Patch::Replace { name, decl } | Patch::Insert { name, decl, .. } if name.value == pass => {
                Some(decl)
            }
            _ => None,
        });
        let own = || self.passes.iter().find(|entry| entry.name.value == pass).map(|entry| &entry.decl);
        patched.or_else(own).map(|decl| &**decl)
    }
}

struct Symbols<'d> {
    text: &'d str,
    scope: String,
    found: Vec<Symbol>,
}

impl Symbols<'_> {
    /// Adds a name that is all of the text at a place, in quotes or without.
    fn add(&mut self, kind: SymbolKind, name: &str, place: Place) -> Option<&mut Symbol> {
        let written = self.text.get(place.start as usize..place.end as usize)?;
        let at = written.find(name).filter(|at| written.len() - name.len() <= 2 && *at <= 1)?;
        self.put(kind, name, place.part(at, name.len()))
    }

    fn put(&mut self, kind: SymbolKind, name: &str, place: Place) -> Option<&mut Symbol> {
        if name.is_empty() {
            return None;
        }
        let scope = Name::from(self.scope.as_str());
        let symbol =
            Symbol { kind, name: Name::from(name), of: Name::default(), scope, place, declares: false };
        self.found.push(symbol);
        self.found.last_mut()
    }

    fn declare(&mut self, kind: SymbolKind, name: &At<Name>) {
        if let Some(symbol) = self.add(kind, &name.value, name.place) {
            symbol.declares = true;
        }
    }

    /// Adds the port or the setting of a pass.
    fn add_of(&mut self, kind: SymbolKind, of: &str, name: &At<Name>) {
        if let Some(symbol) = self.add(kind, &name.value, name.place) {
            symbol.of = Name::from(of);
        }
    }

    fn inputs(&mut self, inputs: &[InputDecl]) {
        for input in inputs {
            self.declare(SymbolKind::Input, &input.name);
            self.add(SymbolKind::Interface, &input.interface.value, input.interface.place);
        }
    }

    fn outputs(&mut self, outputs: &[OutputDecl]) {
        for output in outputs {
            self.declare(SymbolKind::Output, &output.name);
            self.link(&output.link);
        }
    }

    fn passes(&mut self, passes: &[Entry]) {
        for entry in passes {
            self.declare(SymbolKind::Pass, &entry.name);
            self.decl(&entry.name.value, &entry.decl);
        }
    }

    fn decl(&mut self, pass: &str, decl: &PassDecl) {
        match &decl.body {
            Body::Pass { kind, shader } => {
                self.add(SymbolKind::PassType, &kind.value, kind.place);
                if let Some(shader) = shader {
                    self.add(SymbolKind::Shader, &shader.value, shader.place);
                }
            }
            Body::Sub(Sub::File(file)) => {
                self.add(SymbolKind::File, &file.value, file.place);
            }
            Body::Sub(Sub::Inline { inputs, passes, outputs }) => {
                let around = self.scope.len();
                self.scope += if around == 0 { "" } else { "/" };
                self.scope += pass;
                self.inputs(inputs);
                self.passes(passes);
                self.outputs(outputs);
                self.scope.truncate(around);
            }
            Body::Group(_) | Body::Removed => {}
        }
        for link in &decl.links {
            self.add_of(SymbolKind::InputPort, pass, &link.port);
            self.link(link);
        }
        for set in &decl.set {
            self.add_of(SymbolKind::Setting, pass, &set.name);
            self.value(&set.value, set.place);
        }
        for out in &decl.outs {
            self.add_of(SymbolKind::OutputPort, pass, &out.port);
            if let Some(interface) = &out.interface {
                self.add(SymbolKind::Interface, &interface.value, interface.place);
            }
            if let Some(At { value: Size::Frame(a, b) | Size::Like(_, a, b) | Size::Fixed(a, b), .. }) =
                &out.size
            {
                self.dim(a);
                self.dim(b);
            }
            out.count.iter().for_each(|count| self.dim(&count.value));
            for fact in &out.facts {
                fact.value.iter().for_each(|value| self.value(value, fact.place));
            }
        }
        decl.when.iter().for_each(|when| self.formula(when));
        match &decl.off {
            Some(At { value: Off::Input(port), place }) => {
                self.add_of(SymbolKind::InputPort, pass, &At { value: port.clone(), place: *place });
            }
            Some(At { value: Off::Link(link), .. }) => self.link(link),
            None => {}
        }
    }

    fn dim(&mut self, dim: &Dim) {
        if let Dim::Formula(formula) = dim {
            self.formula(formula);
        }
    }

    fn value(&mut self, value: &SetValue, place: Place) {
        match value {
            SetValue::Value(_) => {}
            // `"$name"`
            SetValue::Parameter(name, _) => {
                let len = (place.end - place.start) as usize;
                if len == name.len() + 3 {
                    self.put(SymbolKind::Parameter, name, place.part(2, name.len()));
                }
            }
            SetValue::Formula(formula, _) => self.formula(formula),
        }
    }

    fn formula(&mut self, formula: &Formula) {
        if formula.text.content.is_none() {
            return;
        }
        let mut expr = formula.expr.clone();
        expr.parameters(&mut |(start, end), name, _| {
            let place = formula.text.within(start, end);
            let len = (place.end - place.start) as usize;
            // `$name` or `name`
            if let Some(sign) = len.checked_sub(name.len()) {
                self.put(SymbolKind::Parameter, name, place.part(sign, name.len()));
            }
        });
    }

    fn link(&mut self, link: &Link) {
        if let Some(end) = link.content_end {
            self.target(&link.target, Place { end, ..link.place });
        }
    }

    /// Adds the names of a link's text, which ends where the place does.
    fn target(&mut self, target: &Target, place: Place) {
        let text = target.to_string();
        let len = (place.end - place.start) as usize;
        let Some(at) = len.checked_sub(text.len()) else { return };
        let port = target.port.as_ref();
        let port_at = at + target.pass.len() + 1;
        if let ("in" | "out", Some(port)) = (&*target.pass, port) {
            let kind = if target.pass == "in" { SymbolKind::Input } else { SymbolKind::Output };
            self.put(kind, port, place.part(port_at, port.len()));
            return;
        }
        self.put(SymbolKind::Pass, &target.pass, place.part(at, target.pass.len()));
        if let Some(symbol) =
            port.and_then(|port| self.put(SymbolKind::OutputPort, port, place.part(port_at, port.len())))
        {
            symbol.of = target.pass.clone();
        }
    }

    /// Adds `parameter`, or `pass.setting`.
    fn path(&mut self, path: &At<Name>) {
        let Some((pass, setting)) = path.value.rsplit_once('.') else {
            self.add(SymbolKind::Parameter, &path.value, path.place);
            return;
        };
        if (path.place.end - path.place.start) as usize != path.value.len() + 2 {
            return;
        }
        self.put(SymbolKind::Pass, pass, path.place.part(1, pass.len()));
        if let Some(symbol) =
            self.put(SymbolKind::Setting, setting, path.place.part(pass.len() + 2, setting.len()))
        {
            symbol.of = Name::from(pass);
        }
    }

    fn patch(&mut self, patch: &Patch) {
        match patch {
            Patch::Replace { name, decl } => {
                self.add(SymbolKind::Pass, &name.value, name.place);
                self.decl(&name.value, decl);
            }
            Patch::Insert { name, decl, from, to } => {
                self.declare(SymbolKind::Pass, name);
                self.decl(&name.value, decl);
                for end in [from, to] {
                    let written = (end.place.end - end.place.start) as usize;
                    if written == end.value.to_string().len() + 2 {
                        self.target(&end.value, Place { end: end.place.end - 1, ..end.place });
                    }
                }
                // The input that reads is one of the pass, and no output.
                if let (Some(last), Some(port)) = (self.found.last_mut(), &to.value.port)
                    && last.kind == SymbolKind::OutputPort
                    && last.name == *port
                {
                    last.kind = SymbolKind::InputPort;
                }
            }
            Patch::Set { path, value, place } => {
                self.path(path);
                self.value(value, *place);
            }
            Patch::Remove { name } => {
                self.add(SymbolKind::Pass, &name.value, name.place);
            }
        }
    }
}
