//! Which passes are on.

use super::wires::Found;
use super::{GraphOff, Linker};
use crate::codes;
use crate::description::{At, Body, Off};
use crate::diagnostic::Diagnostic;
use crate::expression::{Env, Ty};
use crate::resource::Clear;
use crate::value::{Traits, Value};
use data_file::Name;
use std::rc::Rc;

/// Longest chain of switches that ask each other through `connected`.
const MAX_CHAIN: u32 = 128;

/// What the names in a switch stand for.
struct Scope<'a> {
    traits: &'a Traits,
    /// Every input, and whether it is linked to something that is on.
    inputs: Vec<(Name, bool)>,
}

impl Env for Scope<'_> {
    fn scene(&self, name: &str) -> Option<&Value> {
        self.traits.0.get(name)
    }

    fn scene_names(&self) -> Vec<String> {
        self.traits.0.keys().cloned().collect()
    }

    fn connected(&self, port: &str) -> Option<bool> {
        self.inputs.iter().find(|(name, _)| name == port).map(|(_, is)| *is)
    }

    fn ports(&self) -> Vec<String> {
        self.inputs.iter().map(|(name, _)| name.to_string()).collect()
    }
}

impl<'a> Linker<'a> {
    /// The inputs of a node, none of them connected.
    fn scope(&self, node: usize) -> Scope<'a> {
        let inputs = match &self.nodes[node].decl.body {
            Body::Group(group) => group.inputs.iter().map(|i| (i.name.value.clone(), false)).collect(),
            Body::Pass { .. } => {
                let used = self.uses[node].as_ref();
                used.map_or_else(Vec::new, |u| {
                    u.names.inputs.iter().map(|(n, _)| (n.clone(), false)).collect()
                })
            }
            Body::Sub { .. } | Body::Removed => Vec::new(),
        };
        Scope { traits: &self.context.traits, inputs }
    }

    /// Checks the types of all switches, and takes as on what has none.
    pub(super) fn check_switches(&mut self) {
        for (i, node) in self.nodes.iter().enumerate() {
            let switched = node.decl.when.is_some() || node.decl.removed.is_some() || node.parent.is_some();
            self.on.push((!switched).then_some(true));
            let Some(when) = &node.decl.when else { continue };
            let known = self.uses[i].is_some() || matches!(node.decl.body, Body::Group(_));
            if let Err(error) = when.expr.check(&self.scope(i), Ty::Bool)
                && (known || error.code != &codes::EXPRESSION_NAME)
            {
                let error = when.error(error, &self.resolved.sources);
                self.errors.push(error);
            }
        }
    }

    /// Decides every switch.
    pub(super) fn find_switches(&mut self) {
        if !self.errors.is_empty() {
            // A switch that does not check has no value: what follows from the rest is still told.
            self.on.iter_mut().for_each(|on| *on = Some(true));
            return;
        }
        for i in 0..self.nodes.len() {
            self.is_on(i);
        }
    }

    /// Whether a node is on.
    pub(super) fn is_on(&mut self, node: usize) -> bool {
        match self.on[node] {
            Some(on) => on,
            None => self.decide(node),
        }
    }

    fn decide(&mut self, node: usize) -> bool {
        let node_ref = &self.nodes[node];
        let decl = &node_ref.decl;
        if self.depth > MAX_CHAIN {
            let place = decl.when.as_ref().map_or(node_ref.place, |when| when.text.place);
            let error =
                Diagnostic::new(&codes::SWITCH_LOOP, "switches depend on each other through `connected`")
                    .label(self.span(place), "this one depends on itself, or on too many others");
            self.errors.push(error);
            self.on[node] = Some(true);
            return true;
        }
        self.depth += 1;
        let inside = node_ref.parent.is_none_or(|parent| self.is_on(parent as usize));
        let on = inside
            && decl.removed.is_none()
            && decl.when.as_ref().is_none_or(|when| {
                let scope = self.live_scope(node);
                let holds = when.expr.holds(&scope).unwrap_or_else(|error| {
                    let error = when.error(error, &self.resolved.sources);
                    self.errors.push(error);
                    true
                });
                if !holds {
                    let mut facts = Vec::new();
                    when.expr.facts(&scope, &mut facts);
                    let text = when.expr.text(false);
                    let why = if facts.is_empty() { text } else { format!("{text} ({})", facts.join(", ")) };
                    self.why.insert(node, why);
                }
                holds
            });
        self.depth -= 1;
        // In a loop, the error is reported once, by whoever closed it.
        *self.on[node].get_or_insert(on)
    }

    /// The inputs of a node, with what `connected` says of each that the switch asks about.
    fn live_scope(&mut self, node: usize) -> Scope<'a> {
        let mut scope = self.scope(node);
        let decl = &self.nodes[node].decl;
        let mut asked = Vec::new();
        if let Some(when) = &decl.when {
            when.expr.connected(&mut asked);
        }
        for (name, is) in &mut scope.inputs {
            if let Some(link) = decl.link(name)
                && asked.contains(&&*name)
            {
                let told = self.errors.len();
                let found = self.follow(link, None, true);
                // What is wrong with the link itself is told where it is checked against its input.
                let new = self.errors.split_off(told);
                self.errors.extend(new.into_iter().filter(|e| e.code == codes::SWITCH_LOOP.code));
                *is = matches!(found, Found::End(_) | Found::Told);
            }
        }
        scope
    }

    /// Finds what links of `off:` bring in the end, in place of passes that are off.
    pub(super) fn find_instead(&mut self) {
        for i in 0..self.nodes.len() {
            let Some(At { value: Off::Link(link), .. }) = &self.nodes[i].decl.off else { continue };
            let Some(used) = self.uses[i].as_ref().filter(|_| self.on[i] == Some(false)) else { continue };
            let names = Rc::clone(&used.names);
            let told = self.errors.len();
            let ends =
                names.outputs.iter().map(|(_, interface)| match self.follow(link, Some(interface), true) {
                    Found::End(end) if self.stands_for(interface, &end) => Some(end),
                    _ => None,
                });
            let end = ends.flatten().next();
            self.errors.truncate(told);
            let text = match end {
                None => "nothing".to_owned(),
                Some(end) => {
                    let brought = self.end_text(&end);
                    match end.constant {
                        Some(clear) => format!("{}, in place of `{brought}` too", constant_text(clear)),
                        None if self.nodes[end.node as usize].name != link.target.pass => {
                            format!("`{brought}`, which `{}` leads to", link.target)
                        }
                        None => format!("`{brought}`"),
                    }
                }
            };
            self.instead.insert(i, text);
        }
    }

    /// What is reported about a node that is off.
    pub(super) fn off(&self, node: usize) -> GraphOff {
        let (mut at, mut whole) = (node, String::new());
        while let Some(parent) = self.nodes[at].parent
            && self.on[parent as usize] == Some(false)
        {
            at = parent as usize;
            whole = format!("`{}` is off: ", self.nodes[at].name);
        }
        let decl = &self.nodes[at].decl;
        let why = match self.why.get(&at) {
            _ if decl.removed.is_some() => "removed by a patch",
            Some(why) => why,
            None => "off",
        };
        let own = self.nodes[node].decl.off.as_ref().map(|off| &off.value);
        let instead = match own {
            Some(Off::Constant(clear)) => constant_text(*clear),
            Some(Off::Input(input)) => format!("its input `{input}`"),
            Some(Off::Link(link)) => {
                self.instead.get(&node).cloned().unwrap_or_else(|| format!("`{}`", link.target))
            }
            None if at != node => format!("what `{}` says", self.nodes[at].name),
            None => "nothing".to_owned(),
        };
        GraphOff { why: format!("{whole}{why}"), instead }
    }
}

fn constant_text(clear: Clear) -> String {
    match clear {
        Clear::Zero => "Black".to_owned(),
        color => color.to_string(),
    }
}
