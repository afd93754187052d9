//! Which passes are on.

use super::wires::Found;
use super::{GraphOff, Linker};
use crate::description::{At, Off};
use crate::expression::{Env, Ty};
use data_file::{Traits, Value};
use std::rc::Rc;

impl Env for Traits {
    fn scene(&self, name: &str) -> Option<&Value> {
        self.values.get(name)
    }

    fn scene_names(&self) -> Vec<String> {
        self.values.keys().cloned().collect()
    }
}

impl Linker<'_> {
    /// Checks the types of all switches, and takes as on what has none.
    pub(super) fn check_switches(&mut self) {
        for node in self.nodes {
            let switched = node.decl.when.is_some() || node.decl.removed.is_some() || node.parent.is_some();
            self.on.push((!switched).then_some(true));
            let Some(when) = &node.decl.when else { continue };
            if let Err(error) = when.expr.check(&self.context.traits, Ty::Bool) {
                let error = when.error(error, &self.resolved.sources);
                self.errors.push(error);
            }
        }
    }

    /// Decides every switch.
    pub(super) fn find_switches(&mut self) {
        if !self.errors.is_empty() {
            // A switch that does not check has no value: what follows from the rest is still reported.
            self.on.iter_mut().for_each(|on| *on = Some(true));
            return;
        }
        // Sub-graphs come before what is in them.
        for i in 0..self.nodes.len() {
            if self.on[i].is_none() {
                self.on[i] = Some(self.decide(i));
            }
        }
    }

    fn decide(&mut self, node: usize) -> bool {
        let node_ref = &self.nodes[node];
        let decl = &node_ref.decl;
        let inside = node_ref.parent.is_none_or(|parent| self.is_on(parent as usize));
        inside
            && decl.removed.is_none()
            && decl.when.as_ref().is_none_or(|when| {
                let traits = &self.context.traits;
                let holds = when.expr.holds(traits).unwrap_or_else(|error| {
                    let error = when.error(error, &self.resolved.sources);
                    self.errors.push(error);
                    true
                });
                if !holds {
                    let mut facts = Vec::new();
                    when.expr.facts(traits, &mut facts);
                    let text = when.expr.text(false);
                    let why = if facts.is_empty() { text } else { format!("{text} ({})", facts.join(", ")) };
                    self.why.insert(node, why);
                }
                holds
            })
    }

    /// Finds what links of `off:` bring in the end, in place of passes that are off.
    pub(super) fn find_instead(&mut self) {
        for i in 0..self.nodes.len() {
            let Some(At { value: Off::Link(link), .. }) = &self.nodes[i].decl.off else { continue };
            let Some(used) = self.uses[i].as_ref().filter(|_| self.on[i] == Some(false)) else { continue };
            let names = Rc::clone(&used.names);
            let end = self.silently(|linker| {
                names.outputs.iter().find_map(|(_, interface)| {
                    match linker.follow(link, Some(interface), true) {
                        Found::End(end) if linker.stands_for(interface, &end) => Some(end),
                        _ => None,
                    }
                })
            });
            let text = match end {
                None => "nothing".to_owned(),
                Some(end) => {
                    let brought = self.end_text(&end);
                    if self.nodes[end.node as usize].name == link.target.pass {
                        format!("`{brought}`")
                    } else {
                        format!("`{brought}`, which `{}` leads to", link.target)
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
