//! The meanings of the names in the shaders of a pass.

use super::Source;
use crate::record::PortDesc;
use crate::scene_bindings;
use frame_graph::plan::{Plan, PlannedInput, PlannedPass, PlannedPort, ResourceId};
use frame_graph::{Name, ResourceDesc};
use std::sync::Arc;

/// A resource of a pass.
pub(super) struct Named {
    /// `port` or `port.member`.
    pub(super) name: String,
    /// Whether the pass may write it.
    pub(super) writable: bool,
    /// The source that it is bound to.
    pub(super) source: Source,
    /// Its description.
    pub(super) desc: ResourceDesc,
}

/// Everything of a pass that a name can mean.
pub(super) struct Names(Vec<Named>);

impl Names {
    pub(super) fn new(plan: &Plan, planned: &PlannedPass) -> Names {
        let named = |port: &str, member: &str, writable, source, id: ResourceId| {
            let name = if member.is_empty() { port.to_owned() } else { format!("{port}.{member}") };
            Named { name, writable, source, desc: plan.resources[id.0 as usize].desc.clone() }
        };
        let mut all = Vec::new();
        for input in &planned.inputs {
            for (i, (member, id)) in input.members.iter().enumerate() {
                let source = match &input.history {
                    Some(histories) => Source::Past(histories[i]),
                    None => Source::Resource(*id),
                };
                all.push(named(&input.port, member, false, source, *id));
            }
        }
        for output in &planned.outputs {
            for (member, id) in &output.members {
                all.push(named(&output.port, member, true, Source::Resource(*id), *id));
            }
            for (member, id) in &output.handed {
                all.push(named(&output.port, member, false, Source::Resource(*id), *id));
            }
        }
        Names(all)
    }

    /// By `port.member`, or as a global is called: `port_member`.
    pub(super) fn find(&self, name: &str) -> Option<&Named> {
        self.0.iter().find(|named| named.name == name || named.name.replace('.', "_") == name)
    }

    /// Names of globals that the pass's resources answer to.
    pub(super) fn own(&self) -> impl Iterator<Item = String> + '_ {
        self.0.iter().map(|named| named.name.replace('.', "_"))
    }

    /// All names of globals.
    pub(super) fn all(&self) -> impl Iterator<Item = String> + '_ {
        self.own().chain(scene_bindings::GLOBALS.iter().map(|(name, _)| (*name).to_owned()))
    }
}

/// An input of a plan, as a pass sees it.
pub(super) fn input(plan: &Plan, input: &PlannedInput) -> PortDesc {
    PortDesc {
        name: input.port.clone(),
        interface: input.interface.clone(),
        members: members(plan, &input.members),
        facts: Arc::clone(&input.facts),
        connected: true,
        past: input.history.is_some(),
    }
}

/// An output of a plan, as a pass sees it.
pub(super) fn output(plan: &Plan, output: &PlannedPort) -> PortDesc {
    PortDesc {
        name: output.port.clone(),
        interface: output.interface.clone(),
        members: output
            .members
            .iter()
            .chain(&output.handed)
            .map(|(name, id)| (name.clone(), plan.resources[id.0 as usize].desc.clone()))
            .collect(),
        facts: Arc::clone(&output.facts),
        connected: output.connected,
        past: false,
    }
}

fn members(plan: &Plan, ids: &[(Name, ResourceId)]) -> Vec<(Name, ResourceDesc)> {
    ids.iter().map(|(name, id)| (name.clone(), plan.resources[id.0 as usize].desc.clone())).collect()
}
